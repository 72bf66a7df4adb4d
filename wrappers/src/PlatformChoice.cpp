#include "PlatformChoice.h"
#include "openmm-helfrich/MembraneForce.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"
#include "openmm-helfrich/TriangulatedForce.h"
#include "openmm-helfrich/VariableMassIntegrator.h"
#include "openmm-helfrich/internal/Core.h"

#include <OpenMM.h>

#include <algorithm>
#include <typeindex>
#include <vector>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

namespace {

/**
 * How many particles the terms of other forces may refer to for each vertex of a membrane. Ten bonds are twenty
 * particles: with as many, N = 1002, a step takes 0.31 ms on Helfrich, 0.53 ms on CPU, and 1.6 ms on OpenCL with
 * PoCL; with thirty, OpenCL is as fast. See docs/platforms.md.
 */
const double PARTICLES_PER_VERTEX = 20;

/** Speeds as Platform::getSpeed has them: Reference is 1, CPU 10, OpenCL 50, CUDA and HIP 100. */
const double FASTEST = 1000, SLOWEST = 0.5;

/** A force that no platform computes much faster than Reference does, and the particles that its terms refer to. */
struct CheapForce {
    std::type_index type;
    double (*countParticles)(const Force& force, const System& system);
};

double countNothing(const Force&, const System&) {
    return 0;
}

double countAll(const Force&, const System& system) {
    return system.getNumParticles();
}

/** For forces whose terms have the same number of particles each. */
template <class ForceClass, int (ForceClass::*count)() const, int particles>
double countTerms(const Force& force, const System&) {
    return particles * (static_cast<const ForceClass&>(force).*count)();
}

double countCompoundBonds(const Force& force, const System&) {
    auto& bonds = static_cast<const CustomCompoundBondForce&>(force);
    return (double) bonds.getNumBonds() * bonds.getNumParticlesPerBond();
}

double countCentroids(const Force& force, const System&) {
    auto& bonds = static_cast<const CustomCentroidBondForce&>(force);
    double sum = (double) bonds.getNumBonds() * bonds.getNumGroupsPerBond();
    vector<int> particles;
    vector<double> weights;
    for (int i = 0; i < bonds.getNumGroups(); i++) {
        bonds.getGroupParameters(i, particles, weights);
        sum += (double) particles.size();
    }
    return sum;
}

const CheapForce CHEAP_FORCES[] = {
    {typeid(HarmonicBondForce), countTerms<HarmonicBondForce, &HarmonicBondForce::getNumBonds, 2>},
    {typeid(CustomBondForce), countTerms<CustomBondForce, &CustomBondForce::getNumBonds, 2>},
    {typeid(HarmonicAngleForce), countTerms<HarmonicAngleForce, &HarmonicAngleForce::getNumAngles, 3>},
    {typeid(CustomAngleForce), countTerms<CustomAngleForce, &CustomAngleForce::getNumAngles, 3>},
    {typeid(PeriodicTorsionForce), countTerms<PeriodicTorsionForce, &PeriodicTorsionForce::getNumTorsions, 4>},
    {typeid(RBTorsionForce), countTerms<RBTorsionForce, &RBTorsionForce::getNumTorsions, 4>},
    {typeid(CustomTorsionForce), countTerms<CustomTorsionForce, &CustomTorsionForce::getNumTorsions, 4>},
    {typeid(CMAPTorsionForce), countTerms<CMAPTorsionForce, &CMAPTorsionForce::getNumTorsions, 8>},
    {typeid(CustomExternalForce), countTerms<CustomExternalForce, &CustomExternalForce::getNumParticles, 1>},
    {typeid(CustomCompoundBondForce), countCompoundBonds},
    {typeid(CustomCentroidBondForce), countCentroids},
    {typeid(RMSDForce), countAll},
    {typeid(RGForce), countAll},
    {typeid(OrientationRestraintForce), countAll},
    // They act now and then, or on a few numbers.
    {typeid(CustomVolumeForce), countNothing},
    {typeid(CMMotionRemover), countNothing},
    {typeid(AndersenThermostat), countNothing},
    {typeid(MonteCarloBarostat), countNothing},
    {typeid(MonteCarloAnisotropicBarostat), countNothing},
    {typeid(MonteCarloMembraneBarostat), countNothing},
    {typeid(MonteCarloFlexibleBarostat), countNothing},
    {typeid(MonteCarloMembraneTension), countNothing},
    // It is computed in Python, from positions in the processor's memory, on every platform.
    {typeid(PythonForce), countNothing},
};

/** Integrators whose steps cost time in proportion to the number of particles. */
const std::type_index CHEAP_INTEGRATORS[] = {
    typeid(VerletIntegrator),         typeid(LangevinMiddleIntegrator),   typeid(LangevinIntegrator),
    typeid(BrownianIntegrator),       typeid(NoseHooverIntegrator),       typeid(CustomIntegrator),
    typeid(VariableVerletIntegrator), typeid(VariableLangevinIntegrator),
};

/** Whether a force is for OpenMM's GPU platforms only. */
bool isForDevices(const TriangulatedForce& force) {
    auto* membrane = dynamic_cast<const MembraneForce*>(&force);
    if (membrane == nullptr)
        return false;
    string backend = membrane->getBackend();
    char text[64] = "";
    if (backend.empty() && Helfrich_getBackend(text, sizeof(text)) > 0)
        backend = text;
    return backend == "native";
}

/** The vertices of all membranes and what the other forces have, as a System is gone through. */
struct Tally {
    explicit Tally(const System& system) : system(system), isVertex(system.getNumParticles()), particles(0) {
    }
    /** Take in a force; returns what about it costs too much, or an empty text. */
    string add(const Force& force);

    const System& system;
    vector<bool> isVertex;
    double particles;
};

/** The name of a force's class where OpenMM has one, or else the force's own. */
string nameOf(const Force& force) {
    try {
        return SerializationProxy::getProxy(typeid(force)).getTypeName();
    } catch (const OpenMMException&) {
        return force.getName();
    }
}

string Tally::add(const Force& force) {
    // Movers cost less than the evaluations of the membrane.
    if (auto* membrane = dynamic_cast<const TriangulatedForce*>(&force)) {
        if (isForDevices(*membrane))
            return "the backend \"native\" is for platforms of GPUs";
        for (int particle : membrane->getTriangles())
            // The Context will say so if there is no such particle.
            if (particle >= 0 && particle < (int) isVertex.size())
                isVertex[particle] = true;
        return "";
    }
    if (auto* variables = dynamic_cast<const CustomCVForce*>(&force)) {
        for (int i = 0; i < variables->getNumCollectiveVariables(); i++) {
            string reason = add(variables->getCollectiveVariable(i));
            if (!reason.empty())
                return reason;
        }
        return "";
    }
    for (const CheapForce& cheap : CHEAP_FORCES)
        if (cheap.type == typeid(force)) {
            particles += cheap.countParticles(force, system);
            return "";
        }
    return nameOf(force) + " costs more than membranes do";
}

bool hasVariableMasses(const Integrator& integrator) {
    if (auto* compound = dynamic_cast<const CompoundIntegrator*>(&integrator)) {
        for (int i = 0; i < compound->getNumIntegrators(); i++)
            if (hasVariableMasses(compound->getIntegrator(i)))
                return true;
    }
    return dynamic_cast<const VariableMassIntegrator*>(&integrator) != nullptr;
}

string whyNotIntegrator(const Integrator& integrator) {
    if (auto* compound = dynamic_cast<const CompoundIntegrator*>(&integrator)) {
        for (int i = 0; i < compound->getNumIntegrators(); i++) {
            string reason = whyNotIntegrator(compound->getIntegrator(i));
            if (!reason.empty())
                return reason;
        }
        return "";
    }
    bool isCheap = std::any_of(std::begin(CHEAP_INTEGRATORS), std::end(CHEAP_INTEGRATORS),
                               [&](std::type_index type) { return type == typeid(integrator); });
    return isCheap ? "" : "the steps of its integrator may cost more than membranes do";
}

/** The membrane force of the Context that is being made, and how often the speed was asked for since. */
thread_local const ForceImpl* pending = nullptr;
thread_local int timesAsked = 0;
/** How many entries of the platform have refused it. */
thread_local int timesRefused = 0;

} // namespace

string HelfrichPlugin::whyNotHelfrich(const System& system, const Integrator& integrator) {
    // Whatever the System costs, no faster platform has the time steps.
    if (hasVariableMasses(integrator))
        return "";
    Tally tally(system);
    for (int i = 0; i < system.getNumForces(); i++) {
        string reason = tally.add(system.getForce(i));
        if (!reason.empty())
            return reason;
    }
    auto vertices = std::count(tally.isVertex.begin(), tally.isVertex.end(), true);
    // Where there is no membrane the steps are what the other forces must not cost more than.
    auto carriers = vertices > 0 ? vertices : system.getNumParticles();
    // Reference's code looks after constraints, one at a time.
    double particles = tally.particles + 2.0 * system.getNumConstraints();
    if (particles > PARTICLES_PER_VERTEX * (double) carriers)
        return "terms of other forces refer to " + std::to_string((long long) particles) + " particles, with " +
            std::to_string(carriers) + (vertices > 0 ? " vertices of membranes" : " particles in the System");
    return whyNotIntegrator(integrator);
}

void PlatformChoice::begin(const ForceImpl& membrane) {
    pending = &membrane;
    timesAsked = timesRefused = 0;
}

void PlatformChoice::end() {
    pending = nullptr;
}

double PlatformChoice::askSpeed() {
    timesAsked++;
    return pending != nullptr ? FASTEST : SLOWEST;
}

bool PlatformChoice::isUnasked() {
    return timesAsked >= 2 && pending != nullptr;
}

bool PlatformChoice::hasMembrane(const ContextImpl& context) {
    // A note may be left of a Context that could not be made for another reason.
    auto& impls = context.getForceImpls();
    return std::find(impls.begin(), impls.end(), pending) != impls.end();
}

void PlatformChoice::refuse() {
    // Both entries of the platform refuse, and then the choice is over.
    if (++timesRefused == 2) {
        pending = nullptr;
        timesAsked = 0;
    }
}
