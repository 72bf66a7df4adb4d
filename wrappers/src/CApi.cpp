#include "ForceFactory.h"
#include "Shim.h"

#include <CApi.h>

#include <openmm/Context.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <memory>

using namespace HelfrichPlugin;
using OpenMM::OpenMMException;
using std::string;
using std::vector;

namespace {

template <class Wanted>
Wanted& as(const string& name, void* force) {
    // C hands over the address of an OpenMM::Force.
    OpenMM::Force* any = static_cast<OpenMM::Force*>(force);
    auto* found = dynamic_cast<Wanted*>(any);
    if (found == nullptr)
        throw OpenMMException(name + ": the force \"" + any->getName() + "\" is of another class");
    return *found;
}

template <class Wanted>
Wanted& asIntegrator(const string& name, void* integrator) {
    auto* found = dynamic_cast<Wanted*>(static_cast<OpenMM::Integrator*>(integrator));
    if (found == nullptr)
        throw OpenMMException(name + ": the integrator is of another class");
    return *found;
}

MembraneForce& asForce(void* force) {
    return as<MembraneForce>("MembraneForce", force);
}

/** A membrane force or a mover. */
TriangulatedForce& asTriangulated(void* force) {
    return as<TriangulatedForce>("MembraneForce", force);
}

OpenMM::Context& asContext(void* context) {
    return *static_cast<OpenMM::Context*>(context);
}

/** One of a mover's statistics. */
double pick(const string& mover, const std::map<string, double>& statistics, const string& name) {
    auto found = statistics.find(name);
    if (found != statistics.end())
        return found->second;
    string known;
    for (const auto& entry : statistics)
        known += (known.empty() ? "" : ", ") + entry.first;
    throw OpenMMException(mover + ": there is no statistic \"" + name + "\"; known are: " + known);
}

/** Run something that may throw; C gets a status and a message. */
template <class Body>
Helfrich_Status guarded(Body body) {
    try {
        body();
        return Helfrich_Success;
    } catch (const std::exception& error) {
        helfrich_setLastError(error.what());
    } catch (...) {
        helfrich_setLastError("openmm-helfrich: an unknown exception");
    }
    return Helfrich_Failure;
}

/** A value, or `nothing` if there is an error. */
template <class Value, class Body>
Value valueOr(Value nothing, Body body) {
    Value value = nothing;
    return guarded([&] { value = body(); }) == Helfrich_Success ? value : nothing;
}

/** A new force, or null. */
template <class Body>
OpenMM_Force* made(Body body) {
    return reinterpret_cast<OpenMM_Force*>(valueOr<OpenMM::Force*>(nullptr, body));
}

/** A new integrator, or null. */
template <class Body>
OpenMM_Integrator* madeIntegrator(Body body) {
    return reinterpret_cast<OpenMM_Integrator*>(valueOr<OpenMM::Integrator*>(nullptr, body));
}

/** The corners of so many triangles. */
vector<int> cornersOf(const string& owner, const int* triangles, int numTriangles) {
    if (numTriangles < 0)
        throw OpenMMException(owner + ": the number of triangles is negative");
    return vector<int>(triangles, triangles + 3 * (size_t) numTriangles);
}

} // namespace

// What the functions of OpenMMHelfrichCWrapper.h do, under other names: the exported ones are Rust's, which pass on to
// these. The build makes CApi.h of that header, so that these have its types (wrappers/declarations.rs).
extern "C" {

OpenMM_Force* helfrich_shim_createForce(const char* type, const int* triangles, int numTriangles, const double* values,
                                        int numValues, int form) {
    return made([&] {
        std::unique_ptr<MembraneForce> force(makeForce(type));
        HelfrichParameterInfo next;
        bool lacksOne =
            Helfrich_Potential_parameter(type, numValues, &next) == Helfrich_Success && std::isnan(next.defaultValue);
        if (lacksOne || numValues > force->getNumParameters())
            throw OpenMMException(string(type) + ": needs " + std::to_string(force->getNumParameters()) + " scalars");
        for (int i = 0; i < numValues; i++)
            force->setParameterValue(force->getParameterName(i), values[i]);
        if (form != 0)
            force->setForm(form);
        force->addTriangles(cornersOf(type, triangles, numTriangles));
        return force.release();
    });
}

void helfrich_shim_MembraneForce_destroy(OpenMM_Force* force) {
    delete reinterpret_cast<OpenMM::Force*>(force);
}

int helfrich_shim_MembraneForce_addTriangle(OpenMM_Force* force, int particle1, int particle2, int particle3) {
    return valueOr<int>(-1, [&] { return asTriangulated(force).addTriangle(particle1, particle2, particle3); });
}

int helfrich_shim_MembraneForce_getNumTriangles(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asTriangulated(force).getNumTriangles(); });
}

Helfrich_Status helfrich_shim_MembraneForce_getTriangle(OpenMM_Force* force, int index, int* corners) {
    return guarded([&] { asTriangulated(force).getTriangle(index, corners[0], corners[1], corners[2]); });
}

Helfrich_Status helfrich_shim_MembraneForce_getParameterValue(OpenMM_Force* force, const char* parameter,
                                                              double* value) {
    return guarded([&] { *value = asForce(force).getParameterValue(parameter); });
}

Helfrich_Status helfrich_shim_MembraneForce_setParameterValue(OpenMM_Force* force, const char* parameter,
                                                              double value) {
    return guarded([&] { asForce(force).setParameterValue(parameter, value); });
}

Helfrich_Status helfrich_shim_MembraneForce_setElementValues(OpenMM_Force* force, const char* parameter,
                                                             const double* values, int count) {
    return guarded([&] { asForce(force).setElementValues(parameter, vector<double>(values, values + count)); });
}

int helfrich_shim_MembraneForce_getNumElementValues(OpenMM_Force* force, const char* parameter) {
    return valueOr<int>(-1, [&] { return (int) asForce(force).getElementValues(parameter).size(); });
}

Helfrich_Status helfrich_shim_MembraneForce_getElementValues(OpenMM_Force* force, const char* parameter,
                                                             double* values) {
    return guarded([&] {
        const vector<double>& found = asForce(force).getElementValues(parameter);
        std::copy(found.begin(), found.end(), values);
    });
}

Helfrich_Status helfrich_shim_ParticleSurfaceForce_setParticles(OpenMM_Force* force, const int* particles, int count) {
    return guarded([&] {
        auto& owner = as<ParticleSurfaceForce>("ParticleSurfaceForce", force);
        if (count < 0)
            throw OpenMMException(owner.getTypeName() + ": the number of particles is negative");
        owner.setParticles(vector<int>(particles, particles + count));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setReference(OpenMM_Force* force, const double* positions, int numVertices,
                                                         const double* boxVectors) {
    return guarded([&] {
        MembraneForce& owner = asForce(force);
        if (numVertices < 0)
            throw OpenMMException(owner.getTypeName() + ": the number of vertices is negative");
        owner.setReferenceBox(boxVectors == nullptr ? vector<double>() : vector<double>(boxVectors, boxVectors + 9));
        owner.setVertexNumbers(vector<double>(positions, positions + 3 * (size_t) numVertices));
    });
}

Helfrich_Status helfrich_shim_LineTensionForce_setDomains(OpenMM_Force* force, const int* domains, int numVertices) {
    return guarded([&] {
        auto& owner = as<LineTensionForce>("LineTensionForce", force);
        if (numVertices < 0)
            throw OpenMMException(owner.getTypeName() + ": the number of vertices is negative");
        owner.setDomains(vector<int>(domains, domains + numVertices));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setForm(OpenMM_Force* force, int form) {
    return guarded([&] { asForce(force).setForm(form); });
}

int helfrich_shim_MembraneForce_getForm(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asForce(force).getForm(); });
}

int helfrich_shim_MembraneForce_getSwitch(OpenMM_Force* force, const char* name) {
    return valueOr<int>(-1, [&] { return asForce(force).getSwitch(name); });
}

Helfrich_Status helfrich_shim_MembraneForce_setSwitch(OpenMM_Force* force, const char* name, int on) {
    return guarded([&] { asForce(force).setSwitch(name, on != 0); });
}

Helfrich_Status helfrich_shim_MembraneForce_setBackend(OpenMM_Force* force, const char* backend) {
    return guarded([&] { asForce(force).setBackend(backend); });
}

Helfrich_Status helfrich_shim_MembraneForce_setUsesPeriodicBoundaryConditions(OpenMM_Force* force, int periodic) {
    return guarded([&] { asForce(force).setUsesPeriodicBoundaryConditions(periodic != 0); });
}

int helfrich_shim_MembraneForce_usesPeriodicBoundaryConditions(OpenMM_Force* force) {
    return valueOr<int>(-1, [&] { return asForce(force).usesPeriodicBoundaryConditions(); });
}

Helfrich_Status helfrich_shim_MembraneForce_setContextParameter(OpenMM_Force* force, const char* parameter,
                                                                const char* name) {
    return guarded([&] { asForce(force).setContextParameter(parameter, name); });
}

Helfrich_Status helfrich_shim_MembraneForce_addEnergyParameterDerivative(OpenMM_Force* force, const char* name) {
    return guarded([&] { asForce(force).addEnergyParameterDerivative(name); });
}

Helfrich_Status helfrich_shim_MembraneForce_updateParametersInContext(OpenMM_Force* force, OpenMM_Context* context) {
    return guarded([&] { asForce(force).updateParametersInContext(asContext(context)); });
}
Helfrich_Status helfrich_shim_MembraneForce_getTrianglesInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                  int* corners) {
    return guarded([&] {
        vector<int> found = asTriangulated(force).getTrianglesInContext(asContext(context));
        std::copy(found.begin(), found.end(), corners);
    });
}

Helfrich_Status helfrich_shim_MembraneForce_getVirial(OpenMM_Force* force, OpenMM_Context* context, int groups,
                                                      double* virial) {
    return guarded([&] {
        vector<double> found = asTriangulated(force).getVirial(asContext(context), groups);
        std::copy(found.begin(), found.end(), virial);
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setTrianglesInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                  const int* corners, int numTriangles) {
    return guarded([&] {
        TriangulatedForce& surface = asTriangulated(force);
        surface.setTrianglesInContext(asContext(context), cornersOf(surface.getTypeName(), corners, numTriangles));
    });
}

Helfrich_Status helfrich_shim_MembraneForce_getPermutationInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                    int* permutation) {
    return guarded([&] {
        vector<int> found = asTriangulated(force).getPermutationInContext(asContext(context));
        std::copy(found.begin(), found.end(), permutation);
    });
}

Helfrich_Status helfrich_shim_MembraneForce_setPermutationInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                    const int* permutation, int numVertices) {
    return guarded([&] {
        TriangulatedForce& surface = asTriangulated(force);
        if (numVertices < 0)
            throw OpenMMException(surface.getTypeName() + ": the number of vertices is negative");
        surface.setPermutationInContext(asContext(context), vector<int>(permutation, permutation + numVertices));
    });
}

int64_t helfrich_shim_MembraneForce_saveConnectivity(OpenMM_Force* force, OpenMM_Context* context, char* buffer,
                                                     int64_t size) {
    return valueOr<int64_t>(-1, [&] {
        string saved = asTriangulated(force).saveConnectivity(asContext(context));
        if ((int64_t) saved.size() <= size)
            std::copy(saved.begin(), saved.end(), buffer);
        return (int64_t) saved.size();
    });
}

Helfrich_Status helfrich_shim_MembraneForce_restoreConnectivity(OpenMM_Force* force, OpenMM_Context* context,
                                                                const char* saved, int64_t size) {
    return guarded([&] {
        TriangulatedForce& surface = asTriangulated(force);
        if (size < 0)
            throw OpenMMException(surface.getTypeName() + ": the number of bytes is negative");
        surface.restoreConnectivity(asContext(context), string(saved, (size_t) size));
    });
}

Helfrich_Status helfrich_shim_LineTensionForce_getDomainsInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                   int* domains) {
    return guarded([&] {
        auto& owner = as<LineTensionForce>("LineTensionForce", force);
        vector<int> found = owner.getDomainsInContext(asContext(context));
        std::copy(found.begin(), found.end(), domains);
    });
}

OpenMM_Force* helfrich_shim_MonteCarloBondFlip_create(const int* triangles, int numTriangles, double temperature,
                                                      int frequency, double attemptsPerEdge, int minDegree,
                                                      int maxDegree, double maxEdgeLength) {
    return made([&] {
        vector<int> corners = cornersOf("MonteCarloBondFlip", triangles, numTriangles);
        return new MonteCarloBondFlip(corners, temperature, frequency, attemptsPerEdge, minDegree, maxDegree,
                                      maxEdgeLength);
    });
}

Helfrich_Status helfrich_shim_MonteCarloBondFlip_updateParametersInContext(OpenMM_Force* force,
                                                                           OpenMM_Context* context) {
    return guarded(
        [&] { as<MonteCarloBondFlip>("MonteCarloBondFlip", force).updateParametersInContext(asContext(context)); });
}

Helfrich_Status helfrich_shim_MonteCarloBondFlip_getStatistic(OpenMM_Force* force, OpenMM_Context* context,
                                                              const char* name, double* value) {
    return guarded([&] {
        *value = pick("MonteCarloBondFlip",
                      as<MonteCarloBondFlip>("MonteCarloBondFlip", force).getStatistics(asContext(context)), name);
    });
}

OpenMM_Force* helfrich_shim_MonteCarloDomainSwap_create(const int* triangles, int numTriangles, double temperature,
                                                        int frequency, double attemptsPerEdge) {
    return made([&] {
        vector<int> corners = cornersOf("MonteCarloDomainSwap", triangles, numTriangles);
        return new MonteCarloDomainSwap(corners, temperature, frequency, attemptsPerEdge);
    });
}

Helfrich_Status helfrich_shim_MonteCarloDomainSwap_updateParametersInContext(OpenMM_Force* force,
                                                                             OpenMM_Context* context) {
    return guarded(
        [&] { as<MonteCarloDomainSwap>("MonteCarloDomainSwap", force).updateParametersInContext(asContext(context)); });
}

Helfrich_Status helfrich_shim_MonteCarloDomainSwap_getStatistic(OpenMM_Force* force, OpenMM_Context* context,
                                                                const char* name, double* value) {
    return guarded([&] {
        *value = pick("MonteCarloDomainSwap",
                      as<MonteCarloDomainSwap>("MonteCarloDomainSwap", force).getStatistics(asContext(context)), name);
    });
}

OpenMM_Force* helfrich_shim_MonteCarloMembraneTension_create(double temperature, double tension, int frequency,
                                                             int axes, double pullingForce) {
    return made([&] {
        return new MonteCarloMembraneTension(temperature, tension, frequency, (MonteCarloMembraneTension::Axes) axes,
                                             pullingForce);
    });
}

Helfrich_Status helfrich_shim_MonteCarloMembraneTension_updateParametersInContext(OpenMM_Force* force,
                                                                                  OpenMM_Context* context) {
    return guarded([&] {
        as<MonteCarloMembraneTension>("MonteCarloMembraneTension", force).updateParametersInContext(asContext(context));
    });
}

Helfrich_Status helfrich_shim_MonteCarloMembraneTension_getStatistic(OpenMM_Force* force, OpenMM_Context* context,
                                                                     const char* name, double* value) {
    return guarded([&] {
        *value = pick(
            "MonteCarloMembraneTension",
            as<MonteCarloMembraneTension>("MonteCarloMembraneTension", force).getStatistics(asContext(context)), name);
    });
}

OpenMM_Force* helfrich_shim_SurfaceViscosityThermostat_create(const int* triangles, int numTriangles, double friction,
                                                              double temperature, int frequency) {
    return made([&] {
        vector<int> corners = cornersOf("SurfaceViscosityThermostat", triangles, numTriangles);
        return new SurfaceViscosityThermostat(corners, friction, temperature, frequency);
    });
}

Helfrich_Status helfrich_shim_SurfaceViscosityThermostat_updateParametersInContext(OpenMM_Force* force,
                                                                                   OpenMM_Context* context) {
    return guarded([&] {
        as<SurfaceViscosityThermostat>("SurfaceViscosityThermostat", force)
            .updateParametersInContext(asContext(context));
    });
}

Helfrich_Status helfrich_shim_SurfaceViscosityThermostat_setFrictionParameter(OpenMM_Force* force, const char* name) {
    return guarded(
        [&] { as<SurfaceViscosityThermostat>("SurfaceViscosityThermostat", force).setFrictionParameter(name); });
}

// A getter, which gives a value that cannot be if the force is of another class, and a setter.
#define MOVER_VALUE(Mover, Type, Name, Nothing, Cast)                                                                  \
    Type helfrich_shim_##Mover##_get##Name(OpenMM_Force* force) {                                                      \
        return valueOr<Type>(Nothing, [&] { return as<Mover>(#Mover, force).get##Name(); });                           \
    }                                                                                                                  \
    Helfrich_Status helfrich_shim_##Mover##_set##Name(OpenMM_Force* force, Type value) {                               \
        return guarded([&] { as<Mover>(#Mover, force).set##Name((Cast) value); });                                     \
    }
MOVER_VALUE(MonteCarloBondFlip, double, DefaultTemperature, std::nan(""), double)
MOVER_VALUE(MonteCarloBondFlip, int, Frequency, -1, int)
MOVER_VALUE(MonteCarloBondFlip, double, AttemptsPerEdge, std::nan(""), double)
MOVER_VALUE(MonteCarloBondFlip, int, MinDegree, -1, int)
MOVER_VALUE(MonteCarloBondFlip, int, MaxDegree, -1, int)
MOVER_VALUE(MonteCarloBondFlip, double, MaxEdgeLength, std::nan(""), double)
MOVER_VALUE(MonteCarloBondFlip, int, Ensemble, -1, MonteCarloBondFlip::Ensemble)
MOVER_VALUE(MonteCarloBondFlip, int, RandomNumberSeed, -1, int)
MOVER_VALUE(MonteCarloDomainSwap, double, DefaultTemperature, std::nan(""), double)
MOVER_VALUE(MonteCarloDomainSwap, int, Frequency, -1, int)
MOVER_VALUE(MonteCarloDomainSwap, double, AttemptsPerEdge, std::nan(""), double)
MOVER_VALUE(MonteCarloDomainSwap, int, Ensemble, -1, MonteCarloDomainSwap::Ensemble)
MOVER_VALUE(MonteCarloDomainSwap, int, RandomNumberSeed, -1, int)
MOVER_VALUE(MonteCarloMembraneTension, double, DefaultTemperature, std::nan(""), double)
MOVER_VALUE(MonteCarloMembraneTension, double, DefaultTension, std::nan(""), double)
MOVER_VALUE(MonteCarloMembraneTension, double, DefaultPullingForce, std::nan(""), double)
MOVER_VALUE(MonteCarloMembraneTension, int, Frequency, -1, int)
MOVER_VALUE(MonteCarloMembraneTension, int, Axes, -1, MonteCarloMembraneTension::Axes)
MOVER_VALUE(MonteCarloMembraneTension, int, ScaleMoleculesAsRigid, -1, bool)
MOVER_VALUE(MonteCarloMembraneTension, int, AdaptiveMoves, -1, int)
MOVER_VALUE(MonteCarloMembraneTension, int, RandomNumberSeed, -1, int)
MOVER_VALUE(SurfaceViscosityThermostat, double, DefaultFriction, std::nan(""), double)
MOVER_VALUE(SurfaceViscosityThermostat, double, DefaultTemperature, std::nan(""), double)
MOVER_VALUE(SurfaceViscosityThermostat, int, Frequency, -1, int)
MOVER_VALUE(SurfaceViscosityThermostat, int, RandomNumberSeed, -1, int)
#undef MOVER_VALUE

OpenMM_Integrator* helfrich_shim_VariableMassVerletIntegrator_create(double stepSize, double density) {
    return madeIntegrator([&] { return new VariableMassVerletIntegrator(stepSize, density); });
}

OpenMM_Integrator* helfrich_shim_VariableMassLangevinIntegrator_create(double temperature, double frictionCoeff,
                                                                       double stepSize, double density) {
    return madeIntegrator(
        [&] { return new VariableMassLangevinIntegrator(temperature, frictionCoeff, stepSize, density); });
}

#define INTEGRATOR_VALUE(Owner, Type, Name, Nothing)                                                                   \
    Type helfrich_shim_##Owner##_get##Name(OpenMM_Integrator* integrator) {                                            \
        return valueOr<Type>(Nothing, [&] { return asIntegrator<Owner>(#Owner, integrator).get##Name(); });            \
    }                                                                                                                  \
    Helfrich_Status helfrich_shim_##Owner##_set##Name(OpenMM_Integrator* integrator, Type value) {                     \
        return guarded([&] { asIntegrator<Owner>(#Owner, integrator).set##Name(value); });                             \
    }
INTEGRATOR_VALUE(VariableMassVerletIntegrator, double, Density, std::nan(""))
INTEGRATOR_VALUE(VariableMassLangevinIntegrator, double, Density, std::nan(""))
INTEGRATOR_VALUE(VariableMassLangevinIntegrator, double, Temperature, std::nan(""))
INTEGRATOR_VALUE(VariableMassLangevinIntegrator, double, Friction, std::nan(""))
INTEGRATOR_VALUE(VariableMassLangevinIntegrator, int, RandomNumberSeed, -1)
#undef INTEGRATOR_VALUE
}
