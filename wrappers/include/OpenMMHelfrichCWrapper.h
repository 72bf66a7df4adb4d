#ifndef OPENMM_HELFRICH_CWRAPPER_H_
#define OPENMM_HELFRICH_CWRAPPER_H_

/**
 * The plugin's forces for C, in the style of OpenMMCWrapper.h. Link libOpenMMHelfrich.so and libOpenMM.so.
 *
 * A create function makes an OpenMM_Force for OpenMM_System_addForce(), which takes it over; a force that no
 * System owns is deleted with Helfrich_MembraneForce_destroy(). What the forces compute, and the units of
 * their scalars, is documented in the C++ headers in openmm-helfrich/.
 *
 * The create functions return null for failure, most others a Helfrich_Status; Helfrich_lastError() then has the
 * message. (OpenMM's own C functions end the program instead.)
 */

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
 * Register the platform Helfrich, which OpenMM then chooses for membranes where no other is named, and the readers
 * of XML. OpenMM does so itself where it loads the library as a plugin.
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
/** One value for each vertex (in ascending order of particle index) or triangle; count 0 goes back. */
extern Helfrich_Status Helfrich_MembraneForce_setElementValues(OpenMM_Force* force, const char* parameter,
                                                               const double* values, int count);
/**
 * Set where the vertices are at rest: three numbers for each, nm, in ascending order of particle index. `boxVectors`
 * are the nine numbers of the periodic box in which that is, nm, or null. Forces with a reference need it after their
 * creation.
 */
extern Helfrich_Status Helfrich_MembraneForce_setReference(OpenMM_Force* force, const double* positions,
                                                           int numVertices, const double* boxVectors);
/** Choose a bending scheme or a form of the dihedral potential or of springs. */
extern Helfrich_Status Helfrich_MembraneForce_setForm(OpenMM_Force* force, int form);
/** Switch something on or off: "unsignedSpontaneousCurvature" of a BendingForce. */
extern Helfrich_Status Helfrich_MembraneForce_setSwitch(OpenMM_Force* force, const char* name, int on);
/** What computes the force: "cpu", "gpu", "gpu:single", "gpu:double", "auto", or "" for what the process has chosen. */
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

/** The schemes of BendingForce. */
typedef enum {
    Helfrich_BendingForce_Julicher = 0,
    Helfrich_BendingForce_GompperKroll = 1,
    Helfrich_BendingForce_GompperKrollBarycentric = 2,
    Helfrich_BendingForce_JulicherVoronoi = 3,
    Helfrich_BendingForce_Espriu = 4
} Helfrich_BendingForce_Scheme;

/** The forms of DihedralForce. */
typedef enum {
    Helfrich_DihedralForce_Quartic = 0,
    Helfrich_DihedralForce_Cosine = 1,
    Helfrich_DihedralForce_Exp = 2,
    Helfrich_DihedralForce_SmoothExp = 3,
    Helfrich_DihedralForce_SmoothExp46 = 4
} Helfrich_DihedralForce_Form;

/** The coefficients of LimForce. */
typedef enum { Helfrich_LimForce_Lim2002 = 0, Helfrich_LimForce_Amoudruz2023 = 1 } Helfrich_LimForce_Coefficients;
/** The forms of SpringForce. */
typedef enum { Helfrich_SpringForce_Harmonic = 0, Helfrich_SpringForce_WLCPower = 1 } Helfrich_SpringForce_Form;

/** The attractions of ParticleSurfaceForce. */
typedef enum {
    Helfrich_ParticleSurfaceForce_WCA = 0,
    Helfrich_ParticleSurfaceForce_LennardJones = 1,
    Helfrich_ParticleSurfaceForce_NineThree = 2
} Helfrich_ParticleSurfaceForce_Attraction;

/* `triangles` holds three particle indices a triangle, counter-clockwise seen from outside. */

extern OpenMM_Force* Helfrich_SurfaceAreaForce_create(const int* triangles, int numTriangles, double modulus,
                                                      double target);
extern double Helfrich_SurfaceAreaForce_getModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceAreaForce_setModulus(OpenMM_Force* force, double modulus);
extern double Helfrich_SurfaceAreaForce_getTarget(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceAreaForce_setTarget(OpenMM_Force* force, double target);

extern OpenMM_Force* Helfrich_EnclosedVolumeForce_create(const int* triangles, int numTriangles, double modulus,
                                                         double target);
extern double Helfrich_EnclosedVolumeForce_getModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_EnclosedVolumeForce_setModulus(OpenMM_Force* force, double modulus);
extern double Helfrich_EnclosedVolumeForce_getTarget(OpenMM_Force* force);
extern Helfrich_Status Helfrich_EnclosedVolumeForce_setTarget(OpenMM_Force* force, double target);

extern OpenMM_Force* Helfrich_BendingForce_create(const int* triangles, int numTriangles, double rigidity,
                                                  double spontaneousCurvature, int scheme);
extern double Helfrich_BendingForce_getRigidity(OpenMM_Force* force);
extern Helfrich_Status Helfrich_BendingForce_setRigidity(OpenMM_Force* force, double rigidity);
extern double Helfrich_BendingForce_getSpontaneousCurvature(OpenMM_Force* force);
extern Helfrich_Status Helfrich_BendingForce_setSpontaneousCurvature(OpenMM_Force* force, double spontaneousCurvature);

extern OpenMM_Force* Helfrich_TriangleHeightForce_create(const int* triangles, int numTriangles, double minHeight,
                                                         double epsilon);
extern double Helfrich_TriangleHeightForce_getMinHeight(OpenMM_Force* force);
extern Helfrich_Status Helfrich_TriangleHeightForce_setMinHeight(OpenMM_Force* force, double minHeight);
extern double Helfrich_TriangleHeightForce_getEpsilon(OpenMM_Force* force);
extern Helfrich_Status Helfrich_TriangleHeightForce_setEpsilon(OpenMM_Force* force, double epsilon);

extern OpenMM_Force* Helfrich_DihedralForce_create(const int* triangles, int numTriangles, double stiffness, int form);
extern double Helfrich_DihedralForce_getStiffness(OpenMM_Force* force);
extern Helfrich_Status Helfrich_DihedralForce_setStiffness(OpenMM_Force* force, double stiffness);
extern double Helfrich_DihedralForce_getRestAngle(OpenMM_Force* force);
extern Helfrich_Status Helfrich_DihedralForce_setRestAngle(OpenMM_Force* force, double restAngle);

extern OpenMM_Force* Helfrich_TriangleAreaForce_create(const int* triangles, int numTriangles, double modulus,
                                                       double target);
extern double Helfrich_TriangleAreaForce_getModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_TriangleAreaForce_setModulus(OpenMM_Force* force, double modulus);
extern double Helfrich_TriangleAreaForce_getTarget(OpenMM_Force* force);
extern Helfrich_Status Helfrich_TriangleAreaForce_setTarget(OpenMM_Force* force, double target);

extern OpenMM_Force* Helfrich_PlaquetteAreaForce_create(const int* triangles, int numTriangles, double stiffness,
                                                        double target);
extern double Helfrich_PlaquetteAreaForce_getStiffness(OpenMM_Force* force);
extern Helfrich_Status Helfrich_PlaquetteAreaForce_setStiffness(OpenMM_Force* force, double stiffness);
extern double Helfrich_PlaquetteAreaForce_getTarget(OpenMM_Force* force);
extern Helfrich_Status Helfrich_PlaquetteAreaForce_setTarget(OpenMM_Force* force, double target);

extern OpenMM_Force* Helfrich_TriangleAreaRepulsionForce_create(const int* triangles, int numTriangles, double minArea,
                                                                double epsilon);
extern double Helfrich_TriangleAreaRepulsionForce_getMinArea(OpenMM_Force* force);
extern Helfrich_Status Helfrich_TriangleAreaRepulsionForce_setMinArea(OpenMM_Force* force, double minArea);
extern double Helfrich_TriangleAreaRepulsionForce_getEpsilon(OpenMM_Force* force);
extern Helfrich_Status Helfrich_TriangleAreaRepulsionForce_setEpsilon(OpenMM_Force* force, double epsilon);

extern OpenMM_Force* Helfrich_SurfaceRepulsionForce_create(const int* triangles, int numTriangles, double distance,
                                                           double epsilon);
extern double Helfrich_SurfaceRepulsionForce_getDistance(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceRepulsionForce_setDistance(OpenMM_Force* force, double distance);
extern double Helfrich_SurfaceRepulsionForce_getEpsilon(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceRepulsionForce_setEpsilon(OpenMM_Force* force, double epsilon);

/** Acts on no particles until Helfrich_ParticleSurfaceForce_setParticles() has named them. */
extern OpenMM_Force* Helfrich_ParticleSurfaceForce_create(const int* triangles, int numTriangles, double distance,
                                                          double epsilon, double adhesion, double radius,
                                                          int attraction);
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setParticles(OpenMM_Force* force, const int* particles, int count);
extern double Helfrich_ParticleSurfaceForce_getDistance(OpenMM_Force* force);
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setDistance(OpenMM_Force* force, double distance);
extern double Helfrich_ParticleSurfaceForce_getEpsilon(OpenMM_Force* force);
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setEpsilon(OpenMM_Force* force, double epsilon);
extern double Helfrich_ParticleSurfaceForce_getAdhesion(OpenMM_Force* force);
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setAdhesion(OpenMM_Force* force, double adhesion);
extern double Helfrich_ParticleSurfaceForce_getRadius(OpenMM_Force* force);
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setRadius(OpenMM_Force* force, double radius);

extern OpenMM_Force* Helfrich_EdgeTensionForce_create(const int* triangles, int numTriangles, double tension);
extern double Helfrich_EdgeTensionForce_getTension(OpenMM_Force* force);
extern Helfrich_Status Helfrich_EdgeTensionForce_setTension(OpenMM_Force* force, double tension);

extern OpenMM_Force* Helfrich_GaussianCurvatureForce_create(const int* triangles, int numTriangles, double modulus);
extern double Helfrich_GaussianCurvatureForce_getModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_GaussianCurvatureForce_setModulus(OpenMM_Force* force, double modulus);

/* Helfrich_MembraneForce_setReference() gives these four their shape at rest. */

extern OpenMM_Force* Helfrich_SkalakForce_create(const int* triangles, int numTriangles, double shearModulus,
                                                 double areaModulus);
extern double Helfrich_SkalakForce_getShearModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SkalakForce_setShearModulus(OpenMM_Force* force, double shearModulus);
extern double Helfrich_SkalakForce_getAreaModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SkalakForce_setAreaModulus(OpenMM_Force* force, double areaModulus);

extern OpenMM_Force* Helfrich_LimForce_create(const int* triangles, int numTriangles, double shearModulus,
                                              double areaModulus, int coefficients);
extern double Helfrich_LimForce_getShearModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_LimForce_setShearModulus(OpenMM_Force* force, double shearModulus);
extern double Helfrich_LimForce_getAreaModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_LimForce_setAreaModulus(OpenMM_Force* force, double areaModulus);
extern OpenMM_Force* Helfrich_PressureForce_create(const int* triangles, int numTriangles, double pressure);
extern double Helfrich_PressureForce_getPressure(OpenMM_Force* force);
extern Helfrich_Status Helfrich_PressureForce_setPressure(OpenMM_Force* force, double pressure);

extern OpenMM_Force* Helfrich_SurfaceTensionForce_create(const int* triangles, int numTriangles, double tension);
extern double Helfrich_SurfaceTensionForce_getTension(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SurfaceTensionForce_setTension(OpenMM_Force* force, double tension);

extern OpenMM_Force* Helfrich_OsmoticPressureForce_create(const int* triangles, int numTriangles, double solutes,
                                                          double concentration, double thermalEnergy);
extern double Helfrich_OsmoticPressureForce_getSolutes(OpenMM_Force* force);
extern Helfrich_Status Helfrich_OsmoticPressureForce_setSolutes(OpenMM_Force* force, double solutes);
extern double Helfrich_OsmoticPressureForce_getConcentration(OpenMM_Force* force);
extern Helfrich_Status Helfrich_OsmoticPressureForce_setConcentration(OpenMM_Force* force, double concentration);
extern double Helfrich_OsmoticPressureForce_getThermalEnergy(OpenMM_Force* force);
extern Helfrich_Status Helfrich_OsmoticPressureForce_setThermalEnergy(OpenMM_Force* force, double thermalEnergy);

extern OpenMM_Force* Helfrich_AreaDifferenceForce_create(const int* triangles, int numTriangles, double modulus,
                                                         double target);
extern double Helfrich_AreaDifferenceForce_getModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_AreaDifferenceForce_setModulus(OpenMM_Force* force, double modulus);
extern double Helfrich_AreaDifferenceForce_getTarget(OpenMM_Force* force);
extern Helfrich_Status Helfrich_AreaDifferenceForce_setTarget(OpenMM_Force* force, double target);
extern OpenMM_Force* Helfrich_NeoHookeanForce_create(const int* triangles, int numTriangles, double shearModulus,
                                                     double areaModulus);
extern double Helfrich_NeoHookeanForce_getShearModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_NeoHookeanForce_setShearModulus(OpenMM_Force* force, double shearModulus);
extern double Helfrich_NeoHookeanForce_getAreaModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_NeoHookeanForce_setAreaModulus(OpenMM_Force* force, double areaModulus);

extern OpenMM_Force* Helfrich_LinearElasticForce_create(const int* triangles, int numTriangles, double shearModulus,
                                                        double areaModulus);
extern double Helfrich_LinearElasticForce_getShearModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_LinearElasticForce_setShearModulus(OpenMM_Force* force, double shearModulus);
extern double Helfrich_LinearElasticForce_getAreaModulus(OpenMM_Force* force);
extern Helfrich_Status Helfrich_LinearElasticForce_setAreaModulus(OpenMM_Force* force, double areaModulus);

extern OpenMM_Force* Helfrich_SpringForce_create(const int* triangles, int numTriangles, double stiffness, double ratio,
                                                 int form);
extern double Helfrich_SpringForce_getStiffness(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SpringForce_setStiffness(OpenMM_Force* force, double stiffness);
extern double Helfrich_SpringForce_getRatio(OpenMM_Force* force);
extern Helfrich_Status Helfrich_SpringForce_setRatio(OpenMM_Force* force, double ratio);

extern OpenMM_Force* Helfrich_LineTensionForce_create(const int* triangles, int numTriangles, double tension);
extern double Helfrich_LineTensionForce_getTension(OpenMM_Force* force);
extern Helfrich_Status Helfrich_LineTensionForce_setTension(OpenMM_Force* force, double tension);
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
 * Bond flips. The functions of Helfrich_MembraneForce for triangles and destroy() are for this class too. Getters
 * return NaN or -1 for failure.
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

/* Constant tension. Helfrich_MembraneForce_destroy() is for this class too. Getters return NaN or -1 for failure. */
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

/*
 * Friction and noise along edges. The functions of Helfrich_MembraneForce for triangles and destroy() are for this
 * class too. Getters return NaN or -1 for failure.
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

#ifdef __cplusplus
}
#endif

#endif /*OPENMM_HELFRICH_CWRAPPER_H_*/
