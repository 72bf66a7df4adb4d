#include "VariableMassIntegratorProxy.h"

#include "XmlElements.h"
#include "openmm-helfrich/VariableMassLangevinIntegrator.h"
#include "openmm-helfrich/VariableMassVerletIntegrator.h"

#include <memory>
#include <set>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::xml;
using namespace OpenMM;
using std::string;

namespace {

const int VERSION = 1;
const string VERLET = "VariableMassVerletIntegrator", LANGEVIN = "VariableMassLangevinIntegrator";

/** What both have, and Integrators of OpenMM too. */
const std::set<string> PROPERTIES = {
    "type", "version", "stepSize", "density", "constraintTolerance", "integrationForceGroups"};

void writeCommon(const VariableMassIntegrator& integrator, SerializationNode& node) {
    node.setIntProperty("version", VERSION)
        .setDoubleProperty("stepSize", integrator.getStepSize())
        .setDoubleProperty("density", integrator.getDensity())
        .setDoubleProperty("constraintTolerance", integrator.getConstraintTolerance())
        .setIntProperty("integrationForceGroups", integrator.getIntegrationForceGroups());
}

void readCommon(const SerializationNode& node, VariableMassIntegrator& integrator) {
    const string& type = integrator.getTypeName();
    integrator.setDensity(numberOr(type, node, "density", integrator.getDensity()));
    integrator.setConstraintTolerance(numberOr(type, node, "constraintTolerance", integrator.getConstraintTolerance()));
    integrator.setIntegrationForceGroups(
        integerOr(type, node, "integrationForceGroups", integrator.getIntegrationForceGroups()));
}

} // namespace

VariableMassVerletIntegratorProxy::VariableMassVerletIntegratorProxy() : SerializationProxy("Helfrich" + VERLET) {
}

void VariableMassVerletIntegratorProxy::serialize(const void* object, SerializationNode& node) const {
    writeCommon(*static_cast<const VariableMassVerletIntegrator*>(object), node);
}

void* VariableMassVerletIntegratorProxy::deserialize(const SerializationNode& node) const {
    std::unique_ptr<VariableMassVerletIntegrator> integrator;
    within(VERLET, node, [&] {
        checkVersion(VERLET, node, VERSION);
        allow(VERLET, node, PROPERTIES, {});
        integrator.reset(new VariableMassVerletIntegrator(number(VERLET, node, "stepSize")));
        readCommon(node, *integrator);
    });
    return static_cast<Integrator*>(integrator.release());
}

VariableMassLangevinIntegratorProxy::VariableMassLangevinIntegratorProxy() : SerializationProxy("Helfrich" + LANGEVIN) {
}

void VariableMassLangevinIntegratorProxy::serialize(const void* object, SerializationNode& node) const {
    const auto& integrator = *static_cast<const VariableMassLangevinIntegrator*>(object);
    writeCommon(integrator, node);
    node.setDoubleProperty("temperature", integrator.getTemperature())
        .setDoubleProperty("friction", integrator.getFriction())
        .setIntProperty("randomSeed", integrator.getRandomNumberSeed());
}

void* VariableMassLangevinIntegratorProxy::deserialize(const SerializationNode& node) const {
    std::unique_ptr<VariableMassLangevinIntegrator> integrator;
    within(LANGEVIN, node, [&] {
        checkVersion(LANGEVIN, node, VERSION);
        std::set<string> properties = PROPERTIES;
        properties.insert({"temperature", "friction", "randomSeed"});
        allow(LANGEVIN, node, properties, {});
        integrator.reset(new VariableMassLangevinIntegrator(number(LANGEVIN, node, "temperature"),
                                                            number(LANGEVIN, node, "friction"),
                                                            number(LANGEVIN, node, "stepSize")));
        readCommon(node, *integrator);
        integrator->setRandomNumberSeed(integerOr(LANGEVIN, node, "randomSeed", integrator->getRandomNumberSeed()));
    });
    return static_cast<Integrator*>(integrator.release());
}
