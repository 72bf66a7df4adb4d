#include "MonteCarloMembraneTensionProxy.h"

#include "XmlElements.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"

#include <memory>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::xml;
using namespace OpenMM;
using std::string;

namespace {

const int VERSION = 1;
const string NAME = "MonteCarloMembraneTension";
/** The names of the axes, by their numbers. */
const string AXES[] = {"XYIsotropic", "XYIndependent", "XYConstantArea", "ZOnly"};

} // namespace

MonteCarloMembraneTensionProxy::MonteCarloMembraneTensionProxy() : SerializationProxy("Helfrich" + NAME) {
}

void MonteCarloMembraneTensionProxy::serialize(const void* object, SerializationNode& node) const {
    const MonteCarloMembraneTension& force = *static_cast<const MonteCarloMembraneTension*>(object);
    writeMover(force, node, VERSION);
    node.setDoubleProperty("tension", force.getDefaultTension())
        .setStringProperty("axes", AXES[force.getAxes()])
        .setDoubleProperty("pullingForce", force.getDefaultPullingForce())
        .setBoolProperty("scaleMoleculesAsRigid", force.getScaleMoleculesAsRigid())
        .setIntProperty("adaptiveMoves", force.getAdaptiveMoves());
}

void* MonteCarloMembraneTensionProxy::deserialize(const SerializationNode& node) const {
    std::unique_ptr<MonteCarloMembraneTension> force;
    within(NAME, node, [&] {
        checkVersion(NAME, node, VERSION);
        allow(NAME, node,
              {"type", "version", "forceGroup", "name", "temperature", "tension", "frequency", "axes", "pullingForce",
               "scaleMoleculesAsRigid", "adaptiveMoves", "randomSeed"},
              {});
        force.reset(new MonteCarloMembraneTension(number(NAME, node, "temperature")));
        readMover(node, *force);
        force->setDefaultTension(numberOr(NAME, node, "tension", force->getDefaultTension()));
        force->setAxes(constantOr(NAME, node, "axes", AXES, force->getAxes()));
        force->setDefaultPullingForce(numberOr(NAME, node, "pullingForce", force->getDefaultPullingForce()));
        if (node.hasProperty("scaleMoleculesAsRigid"))
            force->setScaleMoleculesAsRigid(boolean(NAME, node, "scaleMoleculesAsRigid"));
        force->setAdaptiveMoves(integerOr(NAME, node, "adaptiveMoves", force->getAdaptiveMoves()));
    });
    return static_cast<Force*>(force.release());
}
