/*
 * Movers and integrators for C.
 */

#include "CApiSupport.h"

#include <cmath>
#include <map>

using namespace HelfrichPlugin;
using OpenMM::OpenMMException;
using std::string;
using std::vector;

namespace {

/** One of a mover's statistics. */
double pick(const string& mover, const std::map<string, double>& statistics, const char* wanted) {
    string name = nameOf(mover, wanted);
    auto found = statistics.find(name);
    if (found != statistics.end())
        return found->second;
    string known;
    for (const auto& entry : statistics)
        known += (known.empty() ? "" : ", ") + entry.first;
    throw OpenMMException(mover + ": there is no statistic \"" + name + "\"; known are: " + known);
}

template <class Wanted>
Wanted& asIntegrator(const string& name, void* integrator) {
    if (integrator == nullptr)
        throw OpenMMException(name +
                              ": the integrator is null; the function that should have made it had the reason in " +
                              "Helfrich_lastError()");
    auto* found = dynamic_cast<Wanted*>(static_cast<OpenMM::Integrator*>(integrator));
    if (found == nullptr)
        throw OpenMMException(name + ": the integrator is of another class");
    return *found;
}

/** A new integrator, or null. */
template <class Body>
OpenMM_Integrator* madeIntegrator(Body body) {
    return reinterpret_cast<OpenMM_Integrator*>(valueOr<OpenMM::Integrator*>(nullptr, body));
}

} // namespace

extern "C" {

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
    return guarded([&] {
        auto& owner = as<SurfaceViscosityThermostat>("SurfaceViscosityThermostat", force);
        owner.setFrictionParameter(nameOf(owner.getTypeName(), name));
    });
}

// Bytes that go into a buffer and come back.
#define MOVER_STATE(Mover)                                                                                             \
    int64_t helfrich_shim_##Mover##_saveState(OpenMM_Force* force, OpenMM_Context* context, char* buffer,              \
                                              int64_t size) {                                                          \
        return valueOr<int64_t>(                                                                                       \
            -1, [&] { return copied(as<Mover>(#Mover, force).saveState(asContext(context)), buffer, size); });         \
    }                                                                                                                  \
    Helfrich_Status helfrich_shim_##Mover##_restoreState(OpenMM_Force* force, OpenMM_Context* context,                 \
                                                         const char* saved, int64_t size) {                            \
        return guarded(                                                                                                \
            [&] { as<Mover>(#Mover, force).restoreState(asContext(context), bytesOf(#Mover, saved, size)); });         \
    }
MOVER_STATE(MonteCarloMembraneTension)
MOVER_STATE(SurfaceViscosityThermostat)
#undef MOVER_STATE

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

#define INTEGRATOR_MASSES(Owner)                                                                                       \
    Helfrich_Status helfrich_shim_##Owner##_getMasses(OpenMM_Integrator* integrator, double* masses) {                 \
        return guarded([&] {                                                                                           \
            vector<double> found = asIntegrator<Owner>(#Owner, integrator).getMasses();                                \
            std::copy(found.begin(), found.end(), masses);                                                             \
        });                                                                                                            \
    }
INTEGRATOR_MASSES(VariableMassVerletIntegrator)
INTEGRATOR_MASSES(VariableMassLangevinIntegrator)
#undef INTEGRATOR_MASSES
}
