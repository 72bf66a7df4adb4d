#include "MonteCarloBondFlipProxy.h"

#include "XmlElements.h"
#include "openmm-helfrich/MonteCarloBondFlip.h"

#include <memory>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::xml;
using namespace OpenMM;
using std::string;

namespace {

const int VERSION = 1;
const string NAME = "MonteCarloBondFlip";

} // namespace

MonteCarloBondFlipProxy::MonteCarloBondFlipProxy() : SerializationProxy("Helfrich" + NAME) {
}

void MonteCarloBondFlipProxy::serialize(const void* object, SerializationNode& node) const {
    const MonteCarloBondFlip& force = *static_cast<const MonteCarloBondFlip*>(object);
    writeSurfaceMover(force, node, VERSION);
    node.setIntProperty("minDegree", force.getMinDegree())
        .setIntProperty("maxDegree", force.getMaxDegree())
        .setDoubleProperty("maxEdgeLength", force.getMaxEdgeLength());
}

void* MonteCarloBondFlipProxy::deserialize(const SerializationNode& node) const {
    std::unique_ptr<MonteCarloBondFlip> force;
    within(NAME, node, [&] {
        checkVersion(NAME, node, VERSION);
        allow(NAME, node,
              {"type", "version", "forceGroup", "name", "temperature", "frequency", "attemptsPerEdge", "minDegree",
               "maxDegree", "maxEdgeLength", "ensemble", "randomSeed"},
              {"Triangles"});
        const MonteCarloBondFlip defaults({}, 1.0);
        force.reset(new MonteCarloBondFlip({}, number(NAME, node, "temperature"), defaults.getFrequency(),
                                           defaults.getAttemptsPerEdge(),
                                           integerOr(NAME, node, "minDegree", defaults.getMinDegree()),
                                           integerOr(NAME, node, "maxDegree", defaults.getMaxDegree()),
                                           numberOr(NAME, node, "maxEdgeLength", defaults.getMaxEdgeLength())));
        readSurfaceMover(node, *force);
    });
    return static_cast<Force*>(force.release());
}
