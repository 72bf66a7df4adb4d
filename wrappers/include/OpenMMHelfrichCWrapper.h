#ifndef OPENMM_HELFRICH_CWRAPPER_H_
#define OPENMM_HELFRICH_CWRAPPER_H_

/**
 * The plugin's forces for C, in the style of OpenMMCWrapper.h. Link libOpenMMHelfrich.so and libOpenMM.so.
 *
 * A create function makes an OpenMM_Force for OpenMM_System_addForce(), which takes it over; a force that no
 * System owns is deleted with Helfrich_MembraneForce_destroy(). The C++ headers in openmm-helfrich/ have the formulas.
 *
 * The create functions return null for failure, most others a Helfrich_Status; Helfrich_lastError() then has the
 * message. (OpenMM's own C functions end the program instead.) What results are written to must not be null, and
 * must have room for them.
 *
 * Units are OpenMM's: nm, ps, amu, kJ/mol, K, radians. The environment variable HELFRICH_BACKEND chooses what computes
 * membranes in the whole process, as setBackend does for one force.
 */

#include "OpenMMHelfrichCForces.h"
#include "openmm-helfrich/internal/Status.h"

#include <OpenMMCWrapper.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Copy the message of this thread's last failure into a buffer of `size` bytes; returns its length. */
extern int64_t Helfrich_lastError(char* buffer, int64_t size);
/** The version of OpenMM that the plugin was built for. */
extern const char* Helfrich_openmmVersion(void);

/**
 * Register the platform Helfrich, which OpenMM then chooses for membranes where no other is named, readers and writers
 * of XML, and the steps of the integrators of variable masses. Call it first. OpenMM does so itself where it loads the
 * library as a plugin.
 */
extern void Helfrich_register(void);

/* For every force. `parameter` is the name of a scalar, such as "rigidity". */
extern void Helfrich_MembraneForce_destroy(OpenMM_Force* force);
/** Returns the index of the new triangle, or -1 for failure. */
extern int Helfrich_MembraneForce_addTriangle(OpenMM_Force* force, int particle1, int particle2, int particle3);
/** Returns -1 for failure. */
extern int Helfrich_MembraneForce_getNumTriangles(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MembraneForce_getTriangle(OpenMM_Force* force, int index, int* corners);
extern Helfrich_Status Helfrich_MembraneForce_getParameterValue(OpenMM_Force* force, const char* parameter,
                                                                double* value);
extern Helfrich_Status Helfrich_MembraneForce_setParameterValue(OpenMM_Force* force, const char* parameter,
                                                                double value);
/**
 * One value for each vertex (in ascending order of particle index), triangle, edge (in ascending order of the particles
 * at its ends, of a DihedralForce) or particle (in the order of setParticles, the radii of a ParticleSurfaceForce);
 * count 0 goes back to the scalar.
 */
extern Helfrich_Status Helfrich_MembraneForce_setElementValues(OpenMM_Force* force, const char* parameter,
                                                               const double* values, int count);
/** Returns how many values of single elements a scalar has: 0 without, or -1 for failure. */
extern int Helfrich_MembraneForce_getNumElementValues(OpenMM_Force* force, const char* parameter);
extern Helfrich_Status Helfrich_MembraneForce_getElementValues(OpenMM_Force* force, const char* parameter,
                                                               double* values);
/**
 * Set where the vertices are at rest: three numbers for each, nm, in ascending order of particle index. `boxVectors`
 * are the nine numbers of the periodic box in which that is, nm, or null. Forces with a reference need it after their
 * creation.
 */
extern Helfrich_Status Helfrich_MembraneForce_setReference(OpenMM_Force* force, const double* positions,
                                                           int numVertices, const double* boxVectors);
/** Choose a bending scheme, or a form of the dihedral potential, of springs, of Lim's law or of attraction. */
extern Helfrich_Status Helfrich_MembraneForce_setForm(OpenMM_Force* force, int form);
/** Returns -1 for failure. */
extern int Helfrich_MembraneForce_getForm(OpenMM_Force* force);
/** Switch on or off: "unsignedSpontaneousCurvature" of a BendingForce, "onlyBetweenParts" of a SurfaceRepulsionForce.
 */
extern Helfrich_Status Helfrich_MembraneForce_setSwitch(OpenMM_Force* force, const char* name, int on);
/** Returns 1, 0, or -1 for failure. */
extern int Helfrich_MembraneForce_getSwitch(OpenMM_Force* force, const char* name);
/** What computes the force: "cpu", "native", "gpu", "gpu:single", "gpu:double", "gpu@1" (the second adapter), "auto",
 * or "" for the choice of the process. */
extern Helfrich_Status Helfrich_MembraneForce_setBackend(OpenMM_Force* force, const char* backend);
/** Say whether the surface lives in the periodic box of the Context. */
extern Helfrich_Status Helfrich_MembraneForce_setUsesPeriodicBoundaryConditions(OpenMM_Force* force, int periodic);
/** Returns 1, 0, or -1 for failure. */
extern int Helfrich_MembraneForce_usesPeriodicBoundaryConditions(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MembraneForce_setContextParameter(OpenMM_Force* force, const char* parameter,
                                                                  const char* name);
extern Helfrich_Status Helfrich_MembraneForce_addEnergyParameterDerivative(OpenMM_Force* force, const char* name);
extern Helfrich_Status Helfrich_MembraneForce_updateParametersInContext(OpenMM_Force* force, OpenMM_Context* context);
/** Write three particle indices a triangle, as they are in the Context now. */
extern Helfrich_Status Helfrich_MembraneForce_getTrianglesInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                    int* corners);
/**
 * Write the derivative of the energy of all membrane forces of the Context in some force groups (-1: all) with respect
 * to a homogeneous strain of positions and periodic box, nine numbers row by row, kJ/mol.
 */
extern Helfrich_Status Helfrich_MembraneForce_getVirial(OpenMM_Force* force, OpenMM_Context* context, int groups,
                                                        double* virial);
extern Helfrich_Status Helfrich_MembraneForce_setTrianglesInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                    const int* corners, int numTriangles);
/** Write for each vertex, in ascending order of particle index, the one whose values it has in the Context now. */
extern Helfrich_Status Helfrich_MembraneForce_getPermutationInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                      int* permutation);
extern Helfrich_Status Helfrich_MembraneForce_setPermutationInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                      const int* permutation, int numVertices);
/**
 * Copy all that is needed to go on with the same triangles and bits, but positions, if the buffer has room for it;
 * returns its length, or -1 for failure.
 */
extern int64_t Helfrich_MembraneForce_saveConnectivity(OpenMM_Force* force, OpenMM_Context* context, char* buffer,
                                                       int64_t size);
/** Go on with what Helfrich_MembraneForce_saveConnectivity() has copied. */
extern Helfrich_Status Helfrich_MembraneForce_restoreConnectivity(OpenMM_Force* force, OpenMM_Context* context,
                                                                  const char* saved, int64_t size);

/* What some forces have beside their scalars. */

/** Name the particles that the surface acts on; until then there are none. */
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setParticles(OpenMM_Force* force, const int* particles, int count);
/** Say to which domain each vertex belongs, in ascending order of particle index; needed after the creation. */
extern Helfrich_Status Helfrich_LineTensionForce_setDomains(OpenMM_Force* force, const int* domains, int numVertices);
/** Write the domain of each vertex as it is in a Context now. */
extern Helfrich_Status Helfrich_LineTensionForce_getDomainsInContext(OpenMM_Force* force, OpenMM_Context* context,
                                                                     int* domains);

/** Who pays for the flips of a MonteCarloBondFlip. */
typedef enum {
    Helfrich_MonteCarloBondFlip_Canonical = 0,
    Helfrich_MonteCarloBondFlip_Microcanonical = 1
} Helfrich_MonteCarloBondFlip_Ensemble;

/*
 * Bond flips: the temperature in K, which is the Context parameter "BondFlipTemperature", every how many steps,
 * attempts for each edge then, least and most neighbours, and nm, or 0 for no bound. The functions of
 * Helfrich_MembraneForce for triangles and destroy() are for this class too. Getters return NaN or -1 for failure.
 */
extern OpenMM_Force* Helfrich_MonteCarloBondFlip_create(const int* triangles, int numTriangles, double temperature,
                                                        int frequency, double attemptsPerEdge, int minDegree,
                                                        int maxDegree, double maxEdgeLength);
extern double Helfrich_MonteCarloBondFlip_getDefaultTemperature(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setDefaultTemperature(OpenMM_Force* force,
                                                                         double defaultTemperature);
extern int Helfrich_MonteCarloBondFlip_getFrequency(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setFrequency(OpenMM_Force* force, int frequency);
extern double Helfrich_MonteCarloBondFlip_getAttemptsPerEdge(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setAttemptsPerEdge(OpenMM_Force* force, double attemptsPerEdge);
extern int Helfrich_MonteCarloBondFlip_getMinDegree(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setMinDegree(OpenMM_Force* force, int minDegree);
extern int Helfrich_MonteCarloBondFlip_getMaxDegree(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setMaxDegree(OpenMM_Force* force, int maxDegree);
extern double Helfrich_MonteCarloBondFlip_getMaxEdgeLength(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setMaxEdgeLength(OpenMM_Force* force, double maxEdgeLength);
extern int Helfrich_MonteCarloBondFlip_getEnsemble(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setEnsemble(OpenMM_Force* force, int ensemble);
extern int Helfrich_MonteCarloBondFlip_getRandomNumberSeed(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_setRandomNumberSeed(OpenMM_Force* force, int randomNumberSeed);
extern Helfrich_Status Helfrich_MonteCarloBondFlip_updateParametersInContext(OpenMM_Force* force,
                                                                             OpenMM_Context* context);
/** `name` is "attempts", "accepted" or another that MonteCarloBondFlip.h tells. */
extern Helfrich_Status Helfrich_MonteCarloBondFlip_getStatistic(OpenMM_Force* force, OpenMM_Context* context,
                                                                const char* name, double* value);

/** Who pays for the exchanges of a MonteCarloDomainSwap. */
typedef enum {
    Helfrich_MonteCarloDomainSwap_Canonical = 0,
    Helfrich_MonteCarloDomainSwap_Microcanonical = 1
} Helfrich_MonteCarloDomainSwap_Ensemble;

/* The same of exchanges; the Context parameter is "DomainSwapTemperature". */
extern OpenMM_Force* Helfrich_MonteCarloDomainSwap_create(const int* triangles, int numTriangles, double temperature,
                                                          int frequency, double attemptsPerEdge);
extern double Helfrich_MonteCarloDomainSwap_getDefaultTemperature(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloDomainSwap_setDefaultTemperature(OpenMM_Force* force,
                                                                           double defaultTemperature);
extern int Helfrich_MonteCarloDomainSwap_getFrequency(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloDomainSwap_setFrequency(OpenMM_Force* force, int frequency);
extern double Helfrich_MonteCarloDomainSwap_getAttemptsPerEdge(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloDomainSwap_setAttemptsPerEdge(OpenMM_Force* force, double attemptsPerEdge);
extern int Helfrich_MonteCarloDomainSwap_getEnsemble(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloDomainSwap_setEnsemble(OpenMM_Force* force, int ensemble);
extern int Helfrich_MonteCarloDomainSwap_getRandomNumberSeed(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloDomainSwap_setRandomNumberSeed(OpenMM_Force* force, int randomNumberSeed);
extern Helfrich_Status Helfrich_MonteCarloDomainSwap_updateParametersInContext(OpenMM_Force* force,
                                                                               OpenMM_Context* context);
/** `name` is "attempts", "accepted" or another that MonteCarloDomainSwap.h tells. */
extern Helfrich_Status Helfrich_MonteCarloDomainSwap_getStatistic(OpenMM_Force* force, OpenMM_Context* context,
                                                                  const char* name, double* value);

/** Which edges of the box a MonteCarloMembraneTension changes. */
typedef enum {
    Helfrich_MonteCarloMembraneTension_XYIsotropic = 0,
    Helfrich_MonteCarloMembraneTension_XYIndependent = 1,
    Helfrich_MonteCarloMembraneTension_XYConstantArea = 2,
    Helfrich_MonteCarloMembraneTension_ZOnly = 3
} Helfrich_MonteCarloMembraneTension_Axes;

/*
 * Constant tension: K, kJ/mol/nm^2, every how many steps, axes, and kJ/mol/nm, which are the Context parameters
 * "MembraneTensionTemperature", "MembraneTension" and "MembranePullingForce" (those that the axes use).
 * Helfrich_MembraneForce_destroy() is for this class too. Getters return NaN or -1 for failure.
 */
extern OpenMM_Force* Helfrich_MonteCarloMembraneTension_create(double temperature, double tension, int frequency,
                                                               int axes, double pullingForce);
extern double Helfrich_MonteCarloMembraneTension_getDefaultTemperature(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setDefaultTemperature(OpenMM_Force* force,
                                                                                double defaultTemperature);
extern double Helfrich_MonteCarloMembraneTension_getDefaultTension(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setDefaultTension(OpenMM_Force* force, double defaultTension);
extern double Helfrich_MonteCarloMembraneTension_getDefaultPullingForce(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setDefaultPullingForce(OpenMM_Force* force,
                                                                                 double defaultPullingForce);
extern int Helfrich_MonteCarloMembraneTension_getFrequency(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setFrequency(OpenMM_Force* force, int frequency);
extern int Helfrich_MonteCarloMembraneTension_getAxes(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setAxes(OpenMM_Force* force, int axes);
extern int Helfrich_MonteCarloMembraneTension_getScaleMoleculesAsRigid(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setScaleMoleculesAsRigid(OpenMM_Force* force,
                                                                                   int scaleMoleculesAsRigid);
extern int Helfrich_MonteCarloMembraneTension_getAdaptiveMoves(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setAdaptiveMoves(OpenMM_Force* force, int adaptiveMoves);
extern int Helfrich_MonteCarloMembraneTension_getRandomNumberSeed(OpenMM_Force* force);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_setRandomNumberSeed(OpenMM_Force* force,
                                                                              int randomNumberSeed);
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_updateParametersInContext(OpenMM_Force* force,
                                                                                    OpenMM_Context* context);
/** `name` is "attempts", "accepted" or another that MonteCarloMembraneTension.h tells. */
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_getStatistic(OpenMM_Force* force, OpenMM_Context* context,
                                                                       const char* name, double* value);
/** Copy what is needed to go on with the same moves, if the buffer has room for it; the length, or -1 for failure. */
extern int64_t Helfrich_MonteCarloMembraneTension_saveState(OpenMM_Force* force, OpenMM_Context* context, char* buffer,
                                                            int64_t size);
/** Go on with what Helfrich_MonteCarloMembraneTension_saveState() has copied. */
extern Helfrich_Status Helfrich_MonteCarloMembraneTension_restoreState(OpenMM_Force* force, OpenMM_Context* context,
                                                                       const char* saved, int64_t size);

/*
 * Friction and noise along edges: amu/ps, K, which are the Context parameters "SurfaceViscosityFriction" and
 * "SurfaceViscosityTemperature", and every how many steps. The functions of Helfrich_MembraneForce for triangles and
 * destroy() are for this class too. Getters return NaN or -1 for failure.
 */
extern OpenMM_Force* Helfrich_SurfaceViscosityThermostat_create(const int* triangles, int numTriangles, double friction,
                                                                double temperature, int frequency);
extern double Helfrich_SurfaceViscosityThermostat_getDefaultFriction(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceViscosityThermostat_setDefaultFriction(OpenMM_Force* force,
                                                                              double defaultFriction);
extern double Helfrich_SurfaceViscosityThermostat_getDefaultTemperature(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceViscosityThermostat_setDefaultTemperature(OpenMM_Force* force,
                                                                                 double defaultTemperature);
extern int Helfrich_SurfaceViscosityThermostat_getFrequency(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceViscosityThermostat_setFrequency(OpenMM_Force* force, int frequency);
extern int Helfrich_SurfaceViscosityThermostat_getRandomNumberSeed(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceViscosityThermostat_setRandomNumberSeed(OpenMM_Force* force,
                                                                               int randomNumberSeed);
/** Name the Context parameter that holds the friction, in place of "SurfaceViscosityFriction". */
extern Helfrich_Status Helfrich_SurfaceViscosityThermostat_setFrictionParameter(OpenMM_Force* force, const char* name);
extern Helfrich_Status Helfrich_SurfaceViscosityThermostat_updateParametersInContext(OpenMM_Force* force,
                                                                                     OpenMM_Context* context);
/** Copy what is needed to go on with the same noise, if the buffer has room for it; the length, or -1 for failure. */
extern int64_t Helfrich_SurfaceViscosityThermostat_saveState(OpenMM_Force* force, OpenMM_Context* context, char* buffer,
                                                             int64_t size);
/** Go on with what Helfrich_SurfaceViscosityThermostat_saveState() has copied. */
extern Helfrich_Status Helfrich_SurfaceViscosityThermostat_restoreState(OpenMM_Force* force, OpenMM_Context* context,
                                                                        const char* saved, int64_t size);

/*
 * Integrators of membranes whose vertices carry the mass of their plaquettes. The functions of OpenMM_Integrator are
 * for these, too. Getters return NaN or -1 for failure. Step sizes are in ps, temperatures in K, couplings to the bath
 * in 1/ps, densities in amu/nm^2, 0 standing for surfaces of constant mass. getMasses writes the present mass of every
 * particle, amu; 0 for those that do not move.
 */
extern OpenMM_Integrator* Helfrich_VariableMassVerletIntegrator_create(double stepSize, double density);
extern double Helfrich_VariableMassVerletIntegrator_getDensity(OpenMM_Integrator* integrator);
extern Helfrich_Status Helfrich_VariableMassVerletIntegrator_setDensity(OpenMM_Integrator* integrator, double density);
extern Helfrich_Status Helfrich_VariableMassVerletIntegrator_getMasses(OpenMM_Integrator* integrator, double* masses);
extern OpenMM_Integrator* Helfrich_VariableMassLangevinIntegrator_create(double temperature, double frictionCoeff,
                                                                         double stepSize, double density);
extern double Helfrich_VariableMassLangevinIntegrator_getDensity(OpenMM_Integrator* integrator);
extern Helfrich_Status Helfrich_VariableMassLangevinIntegrator_setDensity(OpenMM_Integrator* integrator,
                                                                          double density);
extern Helfrich_Status Helfrich_VariableMassLangevinIntegrator_getMasses(OpenMM_Integrator* integrator, double* masses);
extern double Helfrich_VariableMassLangevinIntegrator_getTemperature(OpenMM_Integrator* integrator);
extern Helfrich_Status Helfrich_VariableMassLangevinIntegrator_setTemperature(OpenMM_Integrator* integrator,
                                                                              double temperature);
extern double Helfrich_VariableMassLangevinIntegrator_getFriction(OpenMM_Integrator* integrator);
extern Helfrich_Status Helfrich_VariableMassLangevinIntegrator_setFriction(OpenMM_Integrator* integrator,
                                                                           double friction);
extern int Helfrich_VariableMassLangevinIntegrator_getRandomNumberSeed(OpenMM_Integrator* integrator);
extern Helfrich_Status Helfrich_VariableMassLangevinIntegrator_setRandomNumberSeed(OpenMM_Integrator* integrator,
                                                                                   int randomNumberSeed);

#ifdef __cplusplus
}
#endif

#endif /*OPENMM_HELFRICH_CWRAPPER_H_*/
