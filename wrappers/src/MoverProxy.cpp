#include "MoverProxy.h"

#include "XmlElements.h"
#include "openmm-helfrich/MonteCarloBondFlip.h"
#include "openmm-helfrich/MonteCarloDomainSwap.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"
#include "openmm-helfrich/SurfaceViscosityThermostat.h"

#include <memory>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::xml;
using namespace OpenMM;
using std::set;
using std::string;

namespace {

const int VERSION = 1;

/** The attributes that all have. */
const set<string> COMMON = {"type", "version", "forceGroup", "name", "temperature", "frequency", "randomSeed"};

/** The names of the axes of a MonteCarloMembraneTension, by their numbers. */
const string AXES[] = {"XYIsotropic", "XYIndependent", "XYConstantArea", "ZOnly"};

/**
 * What a class has: its name, its attributes beside the common ones, its children, how to write these, and how to read
 * all.
 */
template <class Mover>
struct Elements;

template <>
struct Elements<MonteCarloBondFlip> {
    static constexpr const char* NAME = "MonteCarloBondFlip";
    const set<string> attributes = {"attemptsPerEdge", "ensemble", "minDegree", "maxDegree", "maxEdgeLength"};
    const set<string> children = {"Triangles"};

    void write(const MonteCarloBondFlip& force, SerializationNode& node) const {
        writeSurfaceMover(force, node, VERSION);
        node.setIntProperty("minDegree", force.getMinDegree())
            .setIntProperty("maxDegree", force.getMaxDegree())
            .setDoubleProperty("maxEdgeLength", force.getMaxEdgeLength());
    }

    std::unique_ptr<MonteCarloBondFlip> read(const SerializationNode& node) const {
        const MonteCarloBondFlip defaults({}, 1.0);
        std::unique_ptr<MonteCarloBondFlip> force(new MonteCarloBondFlip(
            {}, number(NAME, node, "temperature"), defaults.getFrequency(), defaults.getAttemptsPerEdge(),
            integerOr(NAME, node, "minDegree", defaults.getMinDegree()),
            integerOr(NAME, node, "maxDegree", defaults.getMaxDegree()),
            numberOr(NAME, node, "maxEdgeLength", defaults.getMaxEdgeLength())));
        readSurfaceMover(node, *force);
        return force;
    }
};

template <>
struct Elements<MonteCarloDomainSwap> {
    static constexpr const char* NAME = "MonteCarloDomainSwap";
    const set<string> attributes = {"attemptsPerEdge", "ensemble"};
    const set<string> children = {"Triangles"};

    void write(const MonteCarloDomainSwap& force, SerializationNode& node) const {
        writeSurfaceMover(force, node, VERSION);
    }

    std::unique_ptr<MonteCarloDomainSwap> read(const SerializationNode& node) const {
        std::unique_ptr<MonteCarloDomainSwap> force(new MonteCarloDomainSwap({}, number(NAME, node, "temperature")));
        readSurfaceMover(node, *force);
        return force;
    }
};

template <>
struct Elements<MonteCarloMembraneTension> {
    static constexpr const char* NAME = "MonteCarloMembraneTension";
    const set<string> attributes = {"tension", "axes", "pullingForce", "scaleMoleculesAsRigid", "adaptiveMoves"};
    const set<string> children;

    void write(const MonteCarloMembraneTension& force, SerializationNode& node) const {
        writeMover(force, node, VERSION);
        node.setDoubleProperty("tension", force.getDefaultTension())
            .setStringProperty("axes", AXES[force.getAxes()])
            .setDoubleProperty("pullingForce", force.getDefaultPullingForce())
            .setBoolProperty("scaleMoleculesAsRigid", force.getScaleMoleculesAsRigid())
            .setIntProperty("adaptiveMoves", force.getAdaptiveMoves());
    }

    std::unique_ptr<MonteCarloMembraneTension> read(const SerializationNode& node) const {
        std::unique_ptr<MonteCarloMembraneTension> force(
            new MonteCarloMembraneTension(number(NAME, node, "temperature")));
        readMover(node, *force);
        force->setDefaultTension(numberOr(NAME, node, "tension", force->getDefaultTension()));
        force->setAxes(constantOr(NAME, node, "axes", AXES, force->getAxes()));
        force->setDefaultPullingForce(numberOr(NAME, node, "pullingForce", force->getDefaultPullingForce()));
        if (node.hasProperty("scaleMoleculesAsRigid"))
            force->setScaleMoleculesAsRigid(boolean(NAME, node, "scaleMoleculesAsRigid"));
        force->setAdaptiveMoves(integerOr(NAME, node, "adaptiveMoves", force->getAdaptiveMoves()));
        return force;
    }
};

template <>
struct Elements<SurfaceViscosityThermostat> {
    static constexpr const char* NAME = "SurfaceViscosityThermostat";
    const set<string> attributes = {"friction", "frictionParameter"};
    const set<string> children = {"Triangles"};

    void write(const SurfaceViscosityThermostat& force, SerializationNode& node) const {
        writeMover(force, node, VERSION);
        node.setDoubleProperty("friction", force.getDefaultFriction())
            .setStringProperty("frictionParameter", force.getFrictionParameter());
        writeTriangles(force, node);
    }

    std::unique_ptr<SurfaceViscosityThermostat> read(const SerializationNode& node) const {
        std::unique_ptr<SurfaceViscosityThermostat> force(
            new SurfaceViscosityThermostat({}, number(NAME, node, "friction"), number(NAME, node, "temperature")));
        readMover(node, *force);
        if (node.hasProperty("frictionParameter"))
            force->setFrictionParameter(text(NAME, node, "frictionParameter"));
        readTriangles(NAME, node, *force);
        return force;
    }
};

} // namespace

template <class Mover>
MoverProxy<Mover>::MoverProxy() : SerializationProxy(string("Helfrich") + Elements<Mover>::NAME) {
}

template <class Mover>
void MoverProxy<Mover>::serialize(const void* object, SerializationNode& node) const {
    Elements<Mover>().write(*static_cast<const Mover*>(object), node);
}

template <class Mover>
void* MoverProxy<Mover>::deserialize(const SerializationNode& node) const {
    const string name = Elements<Mover>::NAME;
    std::unique_ptr<Mover> force;
    within(name, node, [&] {
        checkVersion(name, node, VERSION);
        const Elements<Mover> elements;
        set<string> attributes = elements.attributes;
        attributes.insert(COMMON.begin(), COMMON.end());
        allow(name, node, attributes, elements.children);
        force = elements.read(node);
    });
    return static_cast<Force*>(force.release());
}

template class HelfrichPlugin::MoverProxy<MonteCarloBondFlip>;
template class HelfrichPlugin::MoverProxy<MonteCarloDomainSwap>;
template class HelfrichPlugin::MoverProxy<MonteCarloMembraneTension>;
template class HelfrichPlugin::MoverProxy<SurfaceViscosityThermostat>;
