#include "MonteCarloMembraneTensionImpl.h"

#include "Barostats.h"
#include "HelfrichDynamics.h"
#include "Integrators.h"
#include "Movers.h"
#include "openmm-helfrich/internal/Core.h"

#include <openmm/System.h>
#include <openmm/reference/ReferencePlatform.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;
using std::vector;

namespace {

const string NAME = "MonteCarloMembraneTension";

/** The second word of the random numbers' key, plus the number of the mover; integrators and flips have others. */
const uint32_t KEY = 0x4d540000;

/** The width of the first moves, and the largest, as fractions of the box; how often a width is looked at, and changed
 * by what, as OpenMM's barostats do. */
const double FIRST_WIDTH = 0.01, LARGEST_WIDTH = 0.3, FEWEST_ACCEPTED = 0.25, MOST_ACCEPTED = 0.75, FACTOR = 1.1;
const int FEWEST_TRIED = 10;

/** A double in [0, 1) of the upper 53 bits. */
double toUniform(uint64_t bits) {
    return (double) (bits >> 11) / (double) (1ULL << 53);
}

bool changesPlane(const MonteCarloMembraneTension& mover) {
    return mover.getAxes() != MonteCarloMembraneTension::ZOnly;
}

/** Refuse a second mover of the same axes; returns how many movers come before this one. */
uint32_t findNumber(const System& system, const MonteCarloMembraneTension& owner) {
    uint32_t number = 0;
    bool isPassed = false;
    for (int i = 0; i < system.getNumForces(); i++) {
        auto* other = dynamic_cast<const MonteCarloMembraneTension*>(&system.getForce(i));
        if (other == nullptr)
            continue;
        if (other == &owner)
            isPassed = true;
        else if (changesPlane(*other) == changesPlane(owner))
            throw OpenMMException(NAME + ": two of them, \"" + owner.getName() + "\" and \"" + other->getName() +
                                  "\", change the box along " + (changesPlane(owner) ? "x and y" : "z") +
                                  "; one is enough, of a lower frequency if need be");
        else if (!isPassed)
            number++;
    }
    return number;
}

vector<MonteCarloMembraneTensionImpl*> findAll(const ContextImpl& context) {
    vector<MonteCarloMembraneTensionImpl*> found;
    for (ForceImpl* impl : context.getForceImpls())
        if (auto* mover = dynamic_cast<MonteCarloMembraneTensionImpl*>(impl))
            found.push_back(mover);
    return found;
}

} // namespace

MonteCarloMembraneTensionImpl::MonteCarloMembraneTensionImpl(const MonteCarloMembraneTension& owner)
    : owner(owner), axes(owner.getAxes()), rigidMolecules(owner.getScaleMoleculesAsRigid()), state(), frequency(0),
      adaptiveMoves(0), hasVirtualSites(false), inPlace(nullptr) {
}

void MonteCarloMembraneTensionImpl::initialize(ContextImpl& context) {
    const System& system = context.getSystem();
    if (!system.usesPeriodicBoundaryConditions())
        throw OpenMMException(NAME +
                              ": no force of the System uses periodic boundary conditions, so that it has no box to "
                              "change; setUsesPeriodicBoundaryConditions(True) makes those of membranes do so");
    if (isOfCopies(context.getIntegrator()))
        throw OpenMMException(NAME +
                              ": the beads of an RPMDIntegrator have positions of their own, which would not be scaled "
                              "together; choose another integrator");
    refuseBarostats(NAME, system);
    ScaledBodies::refuseConstraints(NAME, context, rigidMolecules);
    state.key[0] = toKey(owner.getRandomNumberSeed());
    state.key[1] = KEY + findNumber(system, owner);
    for (int i = 0; i < system.getNumParticles(); i++)
        hasVirtualSites = hasVirtualSites || system.isVirtualSite(i);
    if (dynamic_cast<const ReferencePlatform*>(&context.getPlatform()) != nullptr)
        inPlace = static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())->positions;
    copyValues();
}

void MonteCarloMembraneTensionImpl::copyValues() {
    frequency = owner.getFrequency();
    adaptiveMoves = owner.getAdaptiveMoves();
}

map<string, double> MonteCarloMembraneTensionImpl::getDefaultParameters() {
    map<string, double> defaults = {{MonteCarloMembraneTension::Temperature(), owner.getDefaultTemperature()}};
    if (axes == MonteCarloMembraneTension::ZOnly)
        defaults[MonteCarloMembraneTension::PullingForce()] = owner.getDefaultPullingForce();
    else if (axes != MonteCarloMembraneTension::XYConstantArea)
        defaults[MonteCarloMembraneTension::Tension()] = owner.getDefaultTension();
    return defaults;
}

double MonteCarloMembraneTensionImpl::getFinite(ContextImpl& context, const string& name) const {
    double value = context.getParameter(name);
    if (!std::isfinite(value))
        throw OpenMMException(NAME + ": the Context parameter " + name + " must be finite, got " + formatted(value));
    return value;
}

double MonteCarloMembraneTensionImpl::getEnergy(ContextImpl& context) const {
    return context.calcForcesAndEnergy(false, true, findIntegrator(context).getIntegrationForceGroups());
}

void MonteCarloMembraneTensionImpl::updateContextState(ContextImpl& context, bool& forcesInvalid) {
    if (frequency == 0 || ++state.updates < frequency)
        return;
    state.updates = 0;
    if (bodies == nullptr)
        bodies.reset(new ScaledBodies(context, rigidMolecules));
    // Each move has two times two numbers of 64 bits.
    uint64_t bits[4], number = 2 * (uint64_t) state.attempts;
    Helfrich_Random_bits(state.key, number, bits);
    Helfrich_Random_bits(state.key, number + 1, bits + 2);
    Vec3 box[3];
    context.getPeriodicBoxVectors(box[0], box[1], box[2]);
    Move move = choose(context, box, toUniform(bits[0]), toUniform(bits[1]));
    bool accepted = attempt(context, box, move, toUniform(bits[2]));
    state.attempts++;
    state.accepted += accepted;
    adapt(move, accepted);
    // An integrator may have kept forces of before, which the energies' evaluations need not have left alone.
    forcesInvalid = true;
}

MonteCarloMembraneTensionImpl::Move MonteCarloMembraneTensionImpl::choose(ContextImpl& context, const Vec3 box[3],
                                                                          double first, double second) {
    const double lengths[] = {box[0][0], box[1][1], box[2][2]}, area = lengths[0] * lengths[1];
    Move move = {0, 0, 0, Vec3(1, 1, 1), 0};
    int axis = 2;
    switch (axes) {
    case MonteCarloMembraneTension::XYIsotropic:
        move.value = area;
        break;
    case MonteCarloMembraneTension::XYIndependent:
        move.kind = axis = first < 0.5 ? 0 : 1;
        move.value = lengths[axis];
        break;
    case MonteCarloMembraneTension::XYConstantArea:
        // Only changes of the logarithm matter.
        move.value = 1;
        break;
    case MonteCarloMembraneTension::ZOnly:
        move.value = lengths[axis];
        break;
    }
    double& width = state.kinds[move.kind].width;
    if (width == 0)
        width = FIRST_WIDTH * move.value;
    move.change = width * (2 * second - 1);
    const double ratio = (move.value + move.change) / move.value;
    switch (axes) {
    case MonteCarloMembraneTension::XYIsotropic:
        move.scale[0] = move.scale[1] = std::sqrt(ratio);
        move.work = getFinite(context, MonteCarloMembraneTension::Tension()) * move.change;
        break;
    case MonteCarloMembraneTension::XYIndependent:
        move.scale[axis] = ratio;
        move.work = getFinite(context, MonteCarloMembraneTension::Tension()) * move.change * lengths[1 - axis];
        break;
    case MonteCarloMembraneTension::XYConstantArea:
        move.scale[0] = std::exp(move.change);
        move.scale[1] = 1 / move.scale[0];
        break;
    case MonteCarloMembraneTension::ZOnly:
        move.scale[axis] = ratio;
        move.work = getFinite(context, MonteCarloMembraneTension::PullingForce()) * move.change;
        break;
    }
    return move;
}

bool MonteCarloMembraneTensionImpl::attempt(ContextImpl& context, const Vec3 box[3], const Move& move, double chance) {
    double thermalEnergy = findThermalEnergy(NAME, context, MonteCarloMembraneTension::Temperature());
    // There is no box of no length, or less; the square root of a negative area is not a number.
    if (!(move.scale[0] > 0 && move.scale[1] > 0 && move.scale[2] > 0))
        return false;
    double energy = getEnergy(context);
    if (std::isnan(energy))
        throw OpenMMException(NAME + ": the potential energy is not a number");
    if (inPlace != nullptr)
        before = *inPlace;
    else
        context.getPositions(before);
    after = before;
    bodies->scale(move.scale, after);
    Vec3 scaled[3];
    for (int i = 0; i < 3; i++)
        for (int axis = 0; axis < 3; axis++)
            scaled[i][axis] = box[i][axis] * move.scale[axis];
    bool accepted = false;
    try {
        place(context, scaled, after);
        if (hasVirtualSites)
            context.computeVirtualSites();
        double logarithm = axes == MonteCarloMembraneTension::XYConstantArea
            ? 0.0
            : bodies->getNumBodies() * std::log(move.scale[0] * move.scale[1] * move.scale[2]);
        double exponent = (energy - getEnergy(context) + move.work) / thermalEnergy + logarithm;
        // An energy that is not a number is never accepted.
        accepted = exponent >= 0 || chance < std::exp(exponent);
    } catch (...) {
        // Such as a box too small for a cutoff.
        place(context, box, before);
        throw;
    }
    if (!accepted)
        place(context, box, before);
    return accepted;
}

void MonteCarloMembraneTensionImpl::place(ContextImpl& context, const Vec3 box[3], const vector<Vec3>& positions) {
    context.setPeriodicBoxVectors(box[0], box[1], box[2]);
    if (inPlace != nullptr)
        *inPlace = positions;
    else
        context.setPositions(positions);
}

void MonteCarloMembraneTensionImpl::adapt(const Move& move, bool accepted) {
    if (state.attempts > adaptiveMoves)
        return;
    TensionState::Kind& kind = state.kinds[move.kind];
    kind.tried++;
    kind.taken += accepted;
    if (kind.tried < FEWEST_TRIED)
        return;
    double share = (double) kind.taken / (double) kind.tried;
    if (share < FEWEST_ACCEPTED)
        kind.width /= FACTOR;
    else if (share > MOST_ACCEPTED)
        kind.width = std::min(kind.width * FACTOR, LARGEST_WIDTH * move.value);
    else
        return;
    kind.tried = kind.taken = 0;
}

void MonteCarloMembraneTensionImpl::updateParametersInContext(ContextImpl&) {
    if (owner.getAxes() != axes || owner.getScaleMoleculesAsRigid() != rigidMolecules)
        throw OpenMMException(NAME +
                              ": the axes, or what is scaled as rigid, have changed since the Context was made; call "
                              "Context::reinitialize()");
    copyValues();
}

map<string, double> MonteCarloMembraneTensionImpl::getStatistics(ContextImpl&) const {
    auto attempts = (double) state.attempts, accepted = (double) state.accepted;
    map<string, double> statistics = {
        {"attempts", attempts},
        {"accepted", accepted},
        {"acceptance", attempts > 0 ? accepted / attempts : std::numeric_limits<double>::quiet_NaN()},
        {"adapting", state.attempts < adaptiveMoves ? 1.0 : 0.0},
        {"bodies", bodies == nullptr ? 0.0 : bodies->getNumBodies()}};
    if (axes == MonteCarloMembraneTension::XYIndependent) {
        statistics["widthX"] = state.kinds[0].width;
        statistics["widthY"] = state.kinds[1].width;
    } else {
        statistics["width"] = state.kinds[0].width;
    }
    return statistics;
}

string MonteCarloMembraneTensionImpl::saveState() const {
    return string(reinterpret_cast<const char*>(&state), sizeof(state));
}

void MonteCarloMembraneTensionImpl::restoreState(const string& saved) {
    if (saved.size() != sizeof(state))
        throw OpenMMException(NAME + ": the saved state has " + std::to_string(saved.size()) + " bytes, not " +
                              std::to_string(sizeof(state)) + "; it is damaged");
    TensionState found;
    std::memcpy(&found, saved.data(), sizeof(found));
    bool isSane = found.updates >= 0 && found.accepted >= 0 && found.accepted <= found.attempts;
    for (const TensionState::Kind& kind : found.kinds)
        isSane = isSane && kind.width >= 0 && std::isfinite(kind.width) && kind.taken >= 0 && kind.taken <= kind.tried;
    if (!isSane)
        throw OpenMMException(NAME + ": the saved state has counts or widths that cannot be; it is damaged");
    state = found;
}

vector<TensionState> MonteCarloMembraneTensionImpl::saveAll(const ContextImpl& context) {
    vector<TensionState> states;
    for (const auto* mover : findAll(context))
        states.push_back(mover->state);
    return states;
}

void MonteCarloMembraneTensionImpl::restoreAll(const ContextImpl& context, const vector<TensionState>& states) {
    vector<MonteCarloMembraneTensionImpl*> movers = findAll(context);
    for (size_t i = 0; i < std::min(movers.size(), states.size()); i++)
        movers[i]->state = states[i];
}
