#include "MonteCarloDomainSwapProxy.h"

#include "XmlElements.h"
#include "openmm-helfrich/MonteCarloDomainSwap.h"

#include <memory>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::xml;
using namespace OpenMM;
using std::string;

namespace {

const int VERSION = 1;
const string NAME = "MonteCarloDomainSwap";

} // namespace

MonteCarloDomainSwapProxy::MonteCarloDomainSwapProxy() : SerializationProxy("Helfrich" + NAME) {
}

void MonteCarloDomainSwapProxy::serialize(const void* object, SerializationNode& node) const {
    writeSurfaceMover(*static_cast<const MonteCarloDomainSwap*>(object), node, VERSION);
}

void* MonteCarloDomainSwapProxy::deserialize(const SerializationNode& node) const {
    std::unique_ptr<MonteCarloDomainSwap> force;
    within(NAME, node, [&] {
        checkVersion(NAME, node, VERSION);
        allow(NAME, node,
              {"type", "version", "forceGroup", "name", "temperature", "frequency", "attemptsPerEdge", "ensemble",
               "randomSeed"},
              {"Triangles"});
        force.reset(new MonteCarloDomainSwap({}, number(NAME, node, "temperature")));
        readSurfaceMover(node, *force);
    });
    return static_cast<Force*>(force.release());
}
