#include "MonteCarloMembraneTensionProxy.h"

#include "XmlElements.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"

#include <algorithm>
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
    node.setIntProperty("version", VERSION)
        .setIntProperty("forceGroup", force.getForceGroup())
        .setStringProperty("name", force.getName())
        .setDoubleProperty("temperature", force.getDefaultTemperature())
        .setDoubleProperty("tension", force.getDefaultTension())
        .setIntProperty("frequency", force.getFrequency())
        .setStringProperty("axes", AXES[force.getAxes()])
        .setDoubleProperty("pullingForce", force.getDefaultPullingForce())
        .setBoolProperty("scaleMoleculesAsRigid", force.getScaleMoleculesAsRigid())
        .setIntProperty("adaptiveMoves", force.getAdaptiveMoves())
        .setIntProperty("randomSeed", force.getRandomNumberSeed());
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
        force->setDefaultTension(numberOr(NAME, node, "tension", force->getDefaultTension()));
        force->setFrequency(integerOr(NAME, node, "frequency", force->getFrequency()));
        string axes = node.hasProperty("axes") ? text(NAME, node, "axes") : AXES[force->getAxes()];
        auto found = std::find(std::begin(AXES), std::end(AXES), axes);
        if (found == std::end(AXES))
            refuse(NAME, node, "axes", "XYIsotropic, XYIndependent, XYConstantArea or ZOnly");
        force->setAxes((MonteCarloMembraneTension::Axes) (found - std::begin(AXES)));
        force->setDefaultPullingForce(numberOr(NAME, node, "pullingForce", force->getDefaultPullingForce()));
        if (node.hasProperty("scaleMoleculesAsRigid"))
            force->setScaleMoleculesAsRigid(boolean(NAME, node, "scaleMoleculesAsRigid"));
        force->setAdaptiveMoves(integerOr(NAME, node, "adaptiveMoves", force->getAdaptiveMoves()));
        force->setRandomNumberSeed(integerOr(NAME, node, "randomSeed", force->getRandomNumberSeed()));
        force->setForceGroup(integerOr(NAME, node, "forceGroup", force->getForceGroup()));
        if (node.hasProperty("name"))
            force->setName(text(NAME, node, "name"));
    });
    return static_cast<Force*>(force.release());
}
