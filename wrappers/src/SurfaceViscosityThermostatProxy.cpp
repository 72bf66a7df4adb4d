#include "SurfaceViscosityThermostatProxy.h"

#include "XmlElements.h"
#include "openmm-helfrich/SurfaceViscosityThermostat.h"

#include <memory>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::xml;
using namespace OpenMM;
using std::string;

namespace {

const int VERSION = 1;
const string NAME = "SurfaceViscosityThermostat";

} // namespace

SurfaceViscosityThermostatProxy::SurfaceViscosityThermostatProxy() : SerializationProxy("Helfrich" + NAME) {
}

void SurfaceViscosityThermostatProxy::serialize(const void* object, SerializationNode& node) const {
    const SurfaceViscosityThermostat& force = *static_cast<const SurfaceViscosityThermostat*>(object);
    writeMover(force, node, VERSION);
    node.setDoubleProperty("friction", force.getDefaultFriction())
        .setStringProperty("frictionParameter", force.getFrictionParameter());
    writeTriangles(force, node);
}

void* SurfaceViscosityThermostatProxy::deserialize(const SerializationNode& node) const {
    std::unique_ptr<SurfaceViscosityThermostat> force;
    within(NAME, node, [&] {
        checkVersion(NAME, node, VERSION);
        allow(NAME, node,
              {"type", "version", "forceGroup", "name", "friction", "frictionParameter", "temperature", "frequency",
               "randomSeed"},
              {"Triangles"});
        force.reset(
            new SurfaceViscosityThermostat({}, number(NAME, node, "friction"), number(NAME, node, "temperature")));
        readMover(node, *force);
        if (node.hasProperty("frictionParameter"))
            force->setFrictionParameter(text(NAME, node, "frictionParameter"));
        readTriangles(NAME, node, *force);
    });
    return static_cast<Force*>(force.release());
}
