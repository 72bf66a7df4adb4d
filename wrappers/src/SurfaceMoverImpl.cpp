#include "SurfaceMoverImpl.h"

#include "Integrators.h"
#include "Movers.h"

#include <openmm/CompoundIntegrator.h>
#include <openmm/CustomCVForce.h>
#include <openmm/CustomIntegrator.h>
#include <openmm/System.h>
#include <openmm/reference/ReferencePlatform.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;
using std::vector;

namespace {

/** A step that no other follows. */
const long long NEVER = -2;

/** How many movers of the same kind a System has before this one. */
uint32_t findNumber(const System& system, const MonteCarloSurfaceMover& owner) {
    return countBefore(system, owner, [&](const Force& force) {
        auto* other = dynamic_cast<const MonteCarloSurfaceMover*>(&force);
        return other != nullptr && other->getTypeName() == owner.getTypeName();
    });
}

/** Refuse triangulated forces on some particles in a force that evaluates others in a Context of its own. */
void refuseIn(const MonteCarloSurfaceMover& owner, const std::set<int>& particles, const Force& contained,
              const string& outer) {
    if (auto* variables = dynamic_cast<const CustomCVForce*>(&contained))
        for (int i = 0; i < variables->getNumCollectiveVariables(); i++)
            refuseIn(owner, particles, variables->getCollectiveVariable(i), outer);
    if (auto* force = dynamic_cast<const TriangulatedForce*>(&contained))
        for (int particle : force->getTriangles())
            if (particles.count(particle) != 0)
                throw OpenMMException(owner.getTypeName() + ": particle " + std::to_string(particle) + " has a " +
                                      force->getTypeName() + " inside of the force \"" + outer +
                                      "\", which would not see what it changes; add it to the System itself");
}

/** Refuse forces on the same particles that are evaluated in a Context of their own, which moves would not reach. */
void refuseContained(const MonteCarloSurfaceMover& owner, ContextImpl& context) {
    const vector<int>& corners = owner.getTriangles();
    const std::set<int> particles(corners.begin(), corners.end());
    for (const ForceImpl* impl : context.getForceImpls())
        for (const Force* contained : impl->getContainedForces())
            refuseIn(owner, particles, *contained, impl->getOwner().getName());
}

/** Refuse an integrator of many copies of the System, which have their own positions but would share the surface. */
void refuseCopies(const MonteCarloSurfaceMover& owner, const Integrator& integrator) {
    if (isOfCopies(integrator))
        throw OpenMMException(
            owner.getTypeName() +
            ": the beads of an RPMDIntegrator would change the surface that they share, each by its own "
            "energy, which is no ensemble; choose another integrator, or leave this mover out");
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

SurfaceMoverImpl::SurfaceMoverImpl(const MonteCarloSurfaceMover& owner, const string& temperature,
                                   const string& parameter, const Tally& tally)
    : OnMembrane(owner.getTypeName()), owner(owner), home(nullptr), temperature(temperature), parameter(parameter),
      tally(tally), schedule(), frequency(0), attemptsPerEdge(0), inPlace(false), announced(nullptr), present(0),
      replaced(0), mayRevert(false), seenTime(0), nextTime(0), seenStep(NEVER), lastTime(0), lastStep(NEVER) {
}

void SurfaceMoverImpl::leave() {
    if (membrane != nullptr)
        membrane->leave(this, *home);
}

void SurfaceMoverImpl::initialize(ContextImpl& context) {
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
    tally.key[0] = toKey(owner.getRandomNumberSeed());
    tally.key[1] = tally.firstKey + findNumber(context.getSystem(), owner);
}

void SurfaceMoverImpl::copyValues() {
    copyRules();
    frequency = owner.getFrequency();
    attemptsPerEdge = owner.getAttemptsPerEdge();
}

double SurfaceMoverImpl::findBath(ContextImpl& context) const {
    return findThermalEnergy(owner.getTypeName(), context, temperature);
}

map<string, double> SurfaceMoverImpl::getDefaultParameters() {
    return {{temperature, owner.getDefaultTemperature()}, {parameter, 0.0}};
}

double SurfaceMoverImpl::getAnnounced(ContextImpl& context) {
    if (announced == nullptr) {
        // OpenMM makes the parameters after it has initialised the forces, and then keeps them in their places.
        announced = &context.getParameters().at(parameter);
        mayRevert = writesParameters(context.getIntegrator(), context, inPlace);
    }
    return *announced;
}

void SurfaceMoverImpl::updateContextState(ContextImpl& context, bool& forcesInvalid) {
    checkAnnounced(context);
    // To this the integrator may set the parameter back during the step.
    replaced = getAnnounced(context);
    schedule.time += getTimeSinceUpdate(context);
    lastTime = context.getTime();
    lastStep = context.getStepCount();
    if (frequency == 0 || ++schedule.updates < frequency)
        return;
    schedule.updates = 0;
    // Whatever fraction of an attempt a round has, round n ends with floor(n x) attempts.
    double perRound = attemptsPerEdge * (double) membrane->getNumEdges();
    double done = std::floor((double) schedule.rounds * perRound);
    auto attempts = (int64_t) (std::floor((double) ++schedule.rounds * perRound) - done);
    if (attempts == 0)
        return;
    if (!inPlace)
        context.getPositions(positions);
    const vector<Vec3>& now =
        inPlace ? *static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())->positions : positions;
    const Integrator& integrator = findIntegrator(context);
    vector<Vec3>* wanted = isLeapfrog(integrator) ? &forceChange : nullptr;
    double before = replaced;
    int64_t made = 0;
    try {
        made = attempt(context, integrator.getIntegrationForceGroups(), now, attempts, wanted);
    } catch (...) {
        // Forces may fail after moves have been made.
        if (getFingerprint() != present)
            announce(context);
        throw;
    }
    if (made > 0) {
        forcesInvalid = true;
        if (wanted != nullptr)
            shareKick(context, integrator.getStepSize());
        announce(context);
        replaced = before;
    }
}

void SurfaceMoverImpl::shareKick(ContextImpl& context, double stepSize) {
    if (!inPlace)
        context.getVelocities(velocities);
    vector<Vec3>& now =
        inPlace ? *static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())->velocities : velocities;
    for (const auto& [particle, inverseMass] : inverseMasses)
        now[particle] -= forceChange[particle] * (0.5 * stepSize * inverseMass);
    if (!inPlace)
        context.setVelocities(velocities);
}

double SurfaceMoverImpl::calcForcesAndEnergy(ContextImpl& context, bool, bool, int) {
    checkAnnounced(context);
    if (getAnnounced(context) != present)
        context.setParameter(parameter, present);
    return 0;
}

void SurfaceMoverImpl::announce(ContextImpl& context) {
    present = replaced = getFingerprint();
    if (getAnnounced(context) != present)
        context.setParameter(parameter, present);
}

bool SurfaceMoverImpl::isRight(ContextImpl& context) {
    double said = getAnnounced(context);
    return said == present || (mayRevert && said == replaced && hasGoneOn(context));
}

void SurfaceMoverImpl::checkAnnounced(ContextImpl& context) {
    membrane->settle(context);
    if (isRight(context)) {
        seenTime = context.getTime();
        nextTime = seenTime + context.getIntegrator().getStepSize();
        seenStep = context.getStepCount();
        return;
    }
    throw OpenMMException(owner.getTypeName() + ": the Context parameter " + parameter + " says that " +
                          describeForeign());
}

bool SurfaceMoverImpl::hasGoneOn(ContextImpl& context) const {
    // A user may have set one of the two to zero.
    long long steps = context.getStepCount() - seenStep;
    double time = context.getTime();
    return steps == 0 || steps == 1 || time == seenTime || time == nextTime;
}

double SurfaceMoverImpl::getTimeSinceUpdate(ContextImpl& context) const {
    // A user may set the time, or load another State, between two steps.
    long long step = context.getStepCount();
    double passed = context.getTime() - lastTime;
    return (step == lastStep || step == lastStep + 1) && passed > 0 ? passed : 0.0;
}

size_t SurfaceMoverImpl::getStateSize(MoverKind kind) {
    size_t tally = kind == MoverKind::Flips ? sizeof(HelfrichFlipState) : sizeof(HelfrichSwapState);
    return tally + sizeof(MoverSchedule);
}

string SurfaceMoverImpl::getState(ContextImpl& context) const {
    MoverSchedule now = schedule;
    now.time += getTimeSinceUpdate(context);
    string state(static_cast<const char*>(tally.data), tally.size);
    return state.append(reinterpret_cast<const char*>(&now), sizeof(now));
}

void SurfaceMoverImpl::setState(const string& restored) {
    std::memcpy(tally.data, restored.data(), tally.size);
    std::memcpy(&schedule, restored.data() + tally.size, sizeof(schedule));
    lastStep = NEVER;
}

void SurfaceMoverImpl::updateParametersInContext(ContextImpl& context) {
    if (owner.getTriangles() != membrane->getTriangles())
        throw OpenMMException(owner.getTypeName() + ": the triangles have changed since the Context was made; call " +
                              "Context::reinitialize()");
    membrane->settle(context);
    copyValues();
}

map<string, double> SurfaceMoverImpl::getStatistics(ContextImpl& context) const {
    membrane->settle(context);
    map<string, double> found = getCounts();
    double time = schedule.time + getTimeSinceUpdate(context);
    auto ratio = [](double above, double below) {
        return below > 0 ? above / below : std::numeric_limits<double>::quiet_NaN();
    };
    found["time"] = time;
    found["acceptance"] = ratio(found["accepted"], found["attempts"]);
    found["rate"] = ratio(found["accepted"], time * (double) membrane->getNumEdges());
    return found;
}
