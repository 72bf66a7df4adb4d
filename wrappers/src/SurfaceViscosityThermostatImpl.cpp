#include "SurfaceViscosityThermostatImpl.h"

#include "Integrators.h"
#include "Movers.h"

#include <openmm/BrownianIntegrator.h>
#include <openmm/CustomIntegrator.h>
#include <openmm/System.h>
#include <openmm/reference/ReferencePlatform.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;
using std::vector;

namespace {

const string NAME = "SurfaceViscosityThermostat";

/** The second word of the random numbers' key, plus the number of the thermostat; integrators and movers have others.
 */
const uint32_t KEY = 0x53560000;

vector<SurfaceViscosityThermostatImpl*> findAll(const ContextImpl& context) {
    vector<SurfaceViscosityThermostatImpl*> found;
    for (ForceImpl* impl : context.getForceImpls())
        if (auto* thermostat = dynamic_cast<SurfaceViscosityThermostatImpl*>(impl))
            found.push_back(thermostat);
    return found;
}

/** Refuse two that one Context parameter would have to hold different values for. */
void compare(const SurfaceViscosityThermostat& one, const SurfaceViscosityThermostat& other) {
    auto refuse = [&](const string& parameter, double here, double there, const string& remedy) {
        throw OpenMMException(NAME + ": \"" + one.getName() + "\" and \"" + other.getName() +
                              "\" have the Context parameter " + parameter + " in common, but the defaults " +
                              formatted(here) + " and " + formatted(there) + "; " + remedy);
    };
    if (one.getFrictionParameter() == other.getFrictionParameter() &&
        one.getDefaultFriction() != other.getDefaultFriction())
        refuse(one.getFrictionParameter(), one.getDefaultFriction(), other.getDefaultFriction(),
               "give each a parameter of its own with setFrictionParameter()");
    if (one.getDefaultTemperature() != other.getDefaultTemperature())
        refuse(SurfaceViscosityThermostat::Temperature(), one.getDefaultTemperature(), other.getDefaultTemperature(),
               "give them the same temperature");
}

/** Compare with all others of a System; returns how many come before. */
uint32_t findNumber(const System& system, const SurfaceViscosityThermostat& owner) {
    return countBefore(system, owner, [&](const Force& force) {
        auto* other = dynamic_cast<const SurfaceViscosityThermostat*>(&force);
        if (other != nullptr)
            compare(*other, owner);
        return other != nullptr;
    });
}

/** Whether an integrator has velocities of half a step ago when it updates the state of the Context. */
bool isLate(const Integrator& integrator) {
    return isLeapfrog(integrator) || isVariableLeapfrog(integrator);
}

/** Refuse integrators whose velocities are not those of the canonical distribution, as far as is known. */
void checkIntegrator(const Integrator& integrator) {
    if (auto* compound = dynamic_cast<const CompoundIntegrator*>(&integrator)) {
        for (int i = 0; i < compound->getNumIntegrators(); i++)
            checkIntegrator(compound->getIntegrator(i));
        return;
    }
    string reason;
    if (isOfCopies(integrator))
        reason = "the beads of an RPMDIntegrator have velocities of their own, which would not be damped";
    else if (dynamic_cast<const BrownianIntegrator*>(&integrator) != nullptr)
        reason = "a BrownianIntegrator has no velocities that anything could damp";
    else if (dynamic_cast<const QTBIntegrator*>(&integrator) != nullptr)
        reason = "the velocities of a QTBIntegrator are not those of one temperature";
    else if (!isLate(integrator) && dynamic_cast<const CustomIntegrator*>(&integrator) == nullptr)
        reason = "it is not known of which moment the integrator's velocities are";
    else
        return;
    throw OpenMMException(NAME + ": " + reason +
                          "; choose another integrator, such as VerletIntegrator or LangevinMiddleIntegrator");
}

/** Refuse vertices that do not move as their velocities say. */
void checkVertices(const System& system, const std::set<int>& vertices) {
    for (int i = 0; i < system.getNumConstraints(); i++) {
        int one, other;
        double distance;
        system.getConstraintParameters(i, one, other, distance);
        if (vertices.count(one) + vertices.count(other) > 0)
            throw OpenMMException(NAME + ": the constraint between the particles " + std::to_string(one) + " and " +
                                  std::to_string(other) +
                                  " would not survive friction along the edges at either; remove it");
    }
    for (int vertex : vertices)
        if (system.isVirtualSite(vertex))
            throw OpenMMException(NAME + ": particle " + std::to_string(vertex) +
                                  " is a virtual site and has no velocity of its own; leave out its triangles");
}

} // namespace

SurfaceViscosityThermostatImpl::SurfaceViscosityThermostatImpl(const SurfaceViscosityThermostat& owner)
    : OnMembrane(NAME), owner(owner), frictionParameter(owner.getFrictionParameter()), viscosity(nullptr), state(),
      frequency(0), hasVirtualSites(false), positions(&copies[0]), velocities(&copies[1]) {
}

SurfaceViscosityThermostatImpl::~SurfaceViscosityThermostatImpl() {
    Helfrich_Viscosity_destroy(viscosity);
    if (membrane != nullptr)
        membrane->leave(this);
}

void SurfaceViscosityThermostatImpl::initialize(ContextImpl& context) {
    const System& system = context.getSystem();
    checkIntegrator(context.getIntegrator());
    state.random.key[0] = toKey(owner.getRandomNumberSeed());
    state.random.key[1] = KEY + findNumber(system, owner);
    const vector<int>& corners = owner.getTriangles();
    // First of all, since it sees to it that there are such particles.
    membrane = SharedMembrane::acquire(NAME, context, corners);
    vector<double> masses;
    for (int i = 0; i < system.getNumParticles(); i++) {
        masses.push_back(system.getParticleMass(i));
        hasVirtualSites = hasVirtualSites || system.isVirtualSite(i);
    }
    try {
        checkVertices(system, std::set<int>(corners.begin(), corners.end()));
        viscosity = membrane->makeViscosity(NAME, masses);
    } catch (...) {
        // OpenMM will not delete this object any more; the membrane shall not stay for ever.
        membrane.reset();
        throw;
    }
    membrane->join(this);
    if (dynamic_cast<const ReferencePlatform*>(&context.getPlatform()) != nullptr) {
        auto* data = static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData());
        positions = data->positions;
        velocities = data->velocities;
    }
    frequency = owner.getFrequency();
}

map<string, double> SurfaceViscosityThermostatImpl::getDefaultParameters() {
    return {{frictionParameter, owner.getDefaultFriction()},
            {SurfaceViscosityThermostat::Temperature(), owner.getDefaultTemperature()}};
}

double SurfaceViscosityThermostatImpl::getFriction(ContextImpl& context) const {
    double friction = context.getParameter(frictionParameter);
    if (!(friction >= 0 && std::isfinite(friction)))
        throw OpenMMException(NAME + ": the Context parameter " + frictionParameter +
                              " must be a finite number of amu/ps, 0 or more, got " + formatted(friction));
    return friction;
}

void SurfaceViscosityThermostatImpl::updateContextState(ContextImpl& context, bool& forcesInvalid) {
    if (frequency == 0 || ++state.updates < frequency)
        return;
    state.updates = 0;
    const Integrator& integrator = findIntegrator(context);
    const bool late = isLate(integrator);
    // That of a variable step is the last one's: it has led here.
    const double stepSize = integrator.getStepSize();
    HelfrichEdgeBath bath = {getFriction(context) * frequency * stepSize,
                             findThermalEnergy(NAME, context, SurfaceViscosityThermostat::Temperature()),
                             late ? stepSize / 2 : 0};
    const bool isCopy = positions == &copies[0];
    if (isCopy) {
        context.getPositions(*positions);
        context.getVelocities(*velocities);
    }
    membrane->sweep(NAME, context, *viscosity, bath, *positions, *velocities, state.random);
    if (isCopy)
        context.setVelocities(*velocities);
    if (!late)
        return;
    if (isCopy)
        context.setPositions(*positions);
    if (hasVirtualSites)
        context.computeVirtualSites();
    forcesInvalid = true;
}

void SurfaceViscosityThermostatImpl::updateParametersInContext(ContextImpl&) {
    if (owner.getTriangles() != membrane->getTriangles())
        throw OpenMMException(NAME + ": the triangles have changed since the Context was made; call " +
                              "Context::reinitialize()");
    frequency = owner.getFrequency();
}

string SurfaceViscosityThermostatImpl::saveState() const {
    return string(reinterpret_cast<const char*>(&state), sizeof(state));
}

void SurfaceViscosityThermostatImpl::restoreState(const string& saved) {
    if (saved.size() != sizeof(state))
        throw OpenMMException(NAME + ": the saved state has " + std::to_string(saved.size()) + " bytes, not " +
                              std::to_string(sizeof(state)) + "; it is damaged");
    std::memcpy(&state, saved.data(), sizeof(state));
}

vector<ViscosityState> SurfaceViscosityThermostatImpl::saveAll(const ContextImpl& context) {
    vector<ViscosityState> states;
    for (const auto* thermostat : findAll(context))
        states.push_back(thermostat->state);
    return states;
}

void SurfaceViscosityThermostatImpl::restoreAll(const ContextImpl& context, const vector<ViscosityState>& states) {
    vector<SurfaceViscosityThermostatImpl*> thermostats = findAll(context);
    for (size_t i = 0; i < std::min(thermostats.size(), states.size()); i++)
        thermostats[i]->state = states[i];
}
