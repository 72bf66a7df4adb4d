#include "MonteCarloBondFlipImpl.h"

#include "Integrators.h"
#include "Movers.h"

#include <openmm/CompoundIntegrator.h>
#include <openmm/CustomCVForce.h>
#include <openmm/CustomIntegrator.h>
#include <openmm/System.h>
#include <openmm/reference/ReferencePlatform.h>
#include <openmm/reference/SimTKOpenMMRealType.h>

#include <cmath>
#include <limits>
#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;
using std::vector;

namespace {

/** The second word of the random numbers' key, plus the number of the mover; integrators' streams count from zero. */
const uint32_t KEY = 0x464c0000;

/** A step that no other follows. */
const long long NEVER = -2;

/** How many movers a System has before this one. */
uint32_t findNumber(const System& system, const MonteCarloBondFlip& owner) {
    uint32_t number = 0;
    for (int i = 0; i < system.getNumForces(); i++) {
        if (&system.getForce(i) == &owner)
            break;
        if (dynamic_cast<const MonteCarloBondFlip*>(&system.getForce(i)) != nullptr)
            number++;
    }
    return number;
}

/** Refuse triangulated forces on some particles in a force that evaluates others in a Context of its own. */
void refuseIn(const MonteCarloBondFlip& owner, const std::set<int>& particles, const Force& contained,
              const string& outer) {
    if (auto* variables = dynamic_cast<const CustomCVForce*>(&contained))
        for (int i = 0; i < variables->getNumCollectiveVariables(); i++)
            refuseIn(owner, particles, variables->getCollectiveVariable(i), outer);
    if (auto* force = dynamic_cast<const TriangulatedForce*>(&contained))
        for (int particle : force->getTriangles())
            if (particles.count(particle) != 0)
                throw OpenMMException(owner.getTypeName() + ": particle " + std::to_string(particle) + " has a " +
                                      force->getTypeName() + " inside of the force \"" + outer +
                                      "\", which would not see flips; add it to the System itself");
}

/** Refuse forces on the same particles that are evaluated in a Context of their own, which flips would not reach. */
void refuseContained(const MonteCarloBondFlip& owner, ContextImpl& context) {
    const vector<int>& corners = owner.getTriangles();
    const std::set<int> particles(corners.begin(), corners.end());
    for (const ForceImpl* impl : context.getForceImpls())
        for (const Force* contained : impl->getContainedForces())
            refuseIn(owner, particles, *contained, impl->getOwner().getName());
}

/** Refuse an integrator of many copies of the System, which have their own positions but would share connectivity. */
void refuseCopies(const MonteCarloBondFlip& owner, const Integrator& integrator) {
    if (isOfCopies(integrator))
        throw OpenMMException(owner.getTypeName() +
                              ": the beads of an RPMDIntegrator would flip the bonds that they share, each by its own "
                              "energy, which is no ensemble; choose another integrator, or leave out the flips");
}

/**
 * Whether an integrator writes parameters of the Context during a step, from copies that it made at the step's
 * beginning: Reference's CustomIntegrator always does, others if they compute parameters.
 */
bool writesParameters(const Integrator& integrator, ContextImpl& context, bool onReference) {
    if (auto* compound = dynamic_cast<const CompoundIntegrator*>(&integrator)) {
        for (int i = 0; i < compound->getNumIntegrators(); i++)
            if (writesParameters(compound->getIntegrator(i), context, onReference))
                return true;
        return false;
    }
    auto* custom = dynamic_cast<const CustomIntegrator*>(&integrator);
    if (custom == nullptr || onReference)
        return custom != nullptr;
    for (int i = 0; i < custom->getNumComputations(); i++) {
        CustomIntegrator::ComputationType type;
        string variable, expression;
        custom->getComputationStep(i, type, variable, expression);
        if (context.getParameters().count(variable) != 0)
            return true;
    }
    return false;
}

} // namespace

MonteCarloBondFlipImpl::MonteCarloBondFlipImpl(const MonteCarloBondFlip& owner)
    : owner(owner), home(nullptr), parameter(owner.getConnectivityParameter()), state(), rules(), frequency(0),
      attemptsPerEdge(0), inPlace(false), announced(nullptr), present(0), replaced(0), mayRevert(false), seenTime(0),
      nextTime(0), seenStep(NEVER), lastTime(0), lastStep(NEVER) {
}

MonteCarloBondFlipImpl::~MonteCarloBondFlipImpl() {
    if (membrane != nullptr)
        membrane->leave(this, *home);
}

void MonteCarloBondFlipImpl::initialize(ContextImpl& context) {
    home = &context;
    inPlace = dynamic_cast<const ReferencePlatform*>(&context.getPlatform()) != nullptr;
    refuseContained(owner, context);
    refuseCopies(owner, context.getIntegrator());
    membrane = SharedMembrane::acquire(owner.getTypeName(), context, owner.getTriangles());
    try {
        copyValues();
        membrane->join(this, context);
    } catch (...) {
        // OpenMM will not delete this object any more; the membrane shall not stay for ever.
        membrane.reset();
        throw;
    }
    const vector<int>& corners = owner.getTriangles();
    for (int particle : std::set<int>(corners.begin(), corners.end()))
        if (double mass = context.getSystem().getParticleMass(particle))
            inverseMasses.emplace_back(particle, 1 / mass);
    state.flips.key[0] = toKey(owner.getRandomNumberSeed());
    state.flips.key[1] = KEY + findNumber(context.getSystem(), owner);
}

void MonteCarloBondFlipImpl::copyValues() {
    HelfrichFlipRules updated;
    updated.temperature = BOLTZ * owner.getDefaultTemperature();
    updated.minDegree = owner.getMinDegree();
    updated.maxDegree = owner.getMaxDegree();
    updated.maxEdgeLength = owner.getMaxEdgeLength();
    updated.demon = owner.getEnsemble() == MonteCarloBondFlip::Microcanonical;
    membrane->checkRules(owner.getTypeName(), updated);
    rules = updated;
    frequency = owner.getFrequency();
    attemptsPerEdge = owner.getAttemptsPerEdge();
}

map<string, double> MonteCarloBondFlipImpl::getDefaultParameters() {
    return {{MonteCarloBondFlip::Temperature(), owner.getDefaultTemperature()}, {parameter, 0.0}};
}

double MonteCarloBondFlipImpl::getAnnounced(ContextImpl& context) {
    if (announced == nullptr) {
        // OpenMM makes the parameters after it has initialised the forces, and then keeps them in their places.
        announced = &context.getParameters().at(parameter);
        mayRevert = writesParameters(context.getIntegrator(), context, inPlace);
    }
    return *announced;
}

void MonteCarloBondFlipImpl::updateContextState(ContextImpl& context, bool& forcesInvalid) {
    checkConnectivity(context);
    // To this the integrator may set the parameter back during the step.
    replaced = getAnnounced(context);
    state.time += getTimeSinceUpdate(context);
    lastTime = context.getTime();
    lastStep = context.getStepCount();
    if (frequency == 0 || ++state.updates < frequency)
        return;
    state.updates = 0;
    // Whatever fraction of an attempt a round has, round n ends with floor(n x) attempts.
    double perRound = attemptsPerEdge * (double) membrane->getNumEdges();
    double done = std::floor((double) state.rounds * perRound);
    auto attempts = (int64_t) (std::floor((double) ++state.rounds * perRound) - done);
    if (attempts == 0)
        return;
    if (rules.demon == 0)
        rules.temperature = findThermalEnergy(owner.getTypeName(), context, MonteCarloBondFlip::Temperature());
    if (!inPlace)
        context.getPositions(positions);
    const vector<Vec3>& now =
        inPlace ? *static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())->positions : positions;
    const Integrator& integrator = findIntegrator(context);
    vector<Vec3>* wanted = isLeapfrog(integrator) ? &forceChange : nullptr;
    if (membrane->flip(owner.getTypeName(), context, integrator.getIntegrationForceGroups(), now, rules, attempts,
                       state.flips, wanted) > 0) {
        forcesInvalid = true;
        if (wanted != nullptr)
            shareKick(context, integrator.getStepSize());
        double before = replaced;
        announceConnectivity(context);
        replaced = before;
    }
}

void MonteCarloBondFlipImpl::shareKick(ContextImpl& context, double stepSize) {
    if (!inPlace)
        context.getVelocities(velocities);
    vector<Vec3>& now =
        inPlace ? *static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())->velocities : velocities;
    for (const auto& [particle, inverseMass] : inverseMasses)
        now[particle] -= forceChange[particle] * (0.5 * stepSize * inverseMass);
    if (!inPlace)
        context.setVelocities(velocities);
}

double MonteCarloBondFlipImpl::calcForcesAndEnergy(ContextImpl& context, bool, bool, int) {
    checkConnectivity(context);
    if (getAnnounced(context) != present)
        context.setParameter(parameter, present);
    return 0;
}

void MonteCarloBondFlipImpl::announceConnectivity(ContextImpl& context) {
    present = replaced = membrane->getFingerprint();
    if (getAnnounced(context) != present)
        context.setParameter(parameter, present);
}

bool MonteCarloBondFlipImpl::isRight(ContextImpl& context) {
    double said = getAnnounced(context);
    return said == present || (mayRevert && said == replaced && hasGoneOn(context));
}

void MonteCarloBondFlipImpl::checkConnectivity(ContextImpl& context) {
    membrane->settle(context);
    if (isRight(context)) {
        seenTime = context.getTime();
        nextTime = seenTime + context.getIntegrator().getStepSize();
        seenStep = context.getStepCount();
        return;
    }
    throw OpenMMException(owner.getTypeName() + ": the Context parameter " + parameter +
                          " says that positions belong to other triangles than the Context has: a State or checkpoint "
                          "was loaded, which does not hold the connectivity. Load what helfrich.save_state() has saved "
                          "with helfrich.load_state(), or give the Context the triangles with setTrianglesInContext()");
}

bool MonteCarloBondFlipImpl::hasGoneOn(ContextImpl& context) const {
    // A user may have set one of the two to zero.
    long long steps = context.getStepCount() - seenStep;
    double time = context.getTime();
    return steps == 0 || steps == 1 || time == seenTime || time == nextTime;
}

double MonteCarloBondFlipImpl::getTimeSinceUpdate(ContextImpl& context) const {
    // A user may set the time, or load another State, between two steps.
    long long step = context.getStepCount();
    double passed = context.getTime() - lastTime;
    return (step == lastStep || step == lastStep + 1) && passed > 0 ? passed : 0.0;
}

MoverState MonteCarloBondFlipImpl::getState(ContextImpl& context) const {
    MoverState now = state;
    now.time += getTimeSinceUpdate(context);
    return now;
}

void MonteCarloBondFlipImpl::setState(const MoverState& restored) {
    state = restored;
    lastStep = NEVER;
}

void MonteCarloBondFlipImpl::updateParametersInContext(ContextImpl& context) {
    if (owner.getTriangles() != membrane->getTriangles())
        throw OpenMMException(owner.getTypeName() + ": the triangles have changed since the Context was made; call " +
                              "Context::reinitialize()");
    membrane->settle(context);
    copyValues();
}

map<string, double> MonteCarloBondFlipImpl::getStatistics(ContextImpl& context) const {
    membrane->settle(context);
    const HelfrichFlipState& flips = state.flips;
    double time = getState(context).time;
    auto ratio = [](double above, double below) {
        return below > 0 ? above / below : std::numeric_limits<double>::quiet_NaN();
    };
    auto accepted = (double) flips.accepted, attempts = (double) flips.attempts;
    return {{"attempts", attempts},
            {"accepted", accepted},
            {"refusedByBorder", (double) flips.byBorder},
            {"refusedByDegree", (double) flips.byDegree},
            {"refusedByLength", (double) flips.byLength},
            {"refusedByShape", (double) flips.byShape},
            {"refusedByEnergy", (double) flips.byEnergy},
            {"refusedByEdge", (double) flips.byEdge},
            {"acceptance", ratio(accepted, attempts)},
            {"time", time},
            {"rate", ratio(accepted, time * (double) membrane->getNumEdges())},
            {"demonEnergy", flips.demonEnergy}};
}
