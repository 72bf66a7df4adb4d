#ifndef OPENMM_HELFRICH_CFORCES_H_
#define OPENMM_HELFRICH_CFORCES_H_

/* .ci/potentials.py writes this file, from the headers in openmm-helfrich/. */

/*
 * The forces for C, each with its scalars. OpenMMHelfrichCWrapper.h includes them.
 *
 * `triangles` holds three particle indices a triangle, counter-clockwise seen from outside. Schemes
 * and forms are numbers of the enumerations.
 */

#include "openmm-helfrich/internal/Status.h"

#include <OpenMMCWrapper.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Area-difference elasticity. */
extern OpenMM_Force* Helfrich_AreaDifferenceForce_create(const int* triangles, int numTriangles, double modulus,
                                                         double target);
/** Get the modulus m, kJ/mol/nm^2. */
extern double Helfrich_AreaDifferenceForce_getModulus(OpenMM_Force* force);
/** Set the modulus m, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_AreaDifferenceForce_setModulus(OpenMM_Force* force, double modulus);
/** Get the target M0 of the integral of mean curvature, nm. */
extern double Helfrich_AreaDifferenceForce_getTarget(OpenMM_Force* force);
/** Set the target M0 of the integral of mean curvature, nm, of either sign. */
extern Helfrich_Status Helfrich_AreaDifferenceForce_setTarget(OpenMM_Force* force, double target);

/** The discretisations. */
typedef enum {
    Helfrich_BendingForce_Julicher = 0,
    Helfrich_BendingForce_GompperKroll = 1,
    Helfrich_BendingForce_GompperKrollBarycentric = 2,
    Helfrich_BendingForce_JulicherVoronoi = 3,
    Helfrich_BendingForce_Espriu = 4
} Helfrich_BendingForce_Scheme;

/** Bending energy of a fluid membrane (Helfrich), with spontaneous curvature, in five discretisations. */
extern OpenMM_Force* Helfrich_BendingForce_create(const int* triangles, int numTriangles, double rigidity,
                                                  double spontaneousCurvature, int scheme);
/** Get the bending rigidity kappa, kJ/mol. */
extern double Helfrich_BendingForce_getRigidity(OpenMM_Force* force);
/** Set the bending rigidity kappa, kJ/mol, zero or above. Values of single vertices are given up. */
extern Helfrich_Status Helfrich_BendingForce_setRigidity(OpenMM_Force* force, double rigidity);
/** Get the spontaneous curvature C0, 1/nm, positive for bulging outward. */
extern double Helfrich_BendingForce_getSpontaneousCurvature(OpenMM_Force* force);
/** Set the spontaneous curvature C0, 1/nm, positive for bulging outward. Values of single vertices are given up. */
extern Helfrich_Status Helfrich_BendingForce_setSpontaneousCurvature(OpenMM_Force* force, double spontaneousCurvature);

/** The functions of the angle x = phi - phi0, brought into (-pi, pi], with c = 1 - cos x. */
typedef enum {
    Helfrich_DihedralForce_Quartic = 0,
    Helfrich_DihedralForce_Cosine = 1,
    Helfrich_DihedralForce_Exp = 2,
    Helfrich_DihedralForce_SmoothExp = 3,
    Helfrich_DihedralForce_SmoothExp46 = 4
} Helfrich_DihedralForce_Form;

/** Stiff hinges between neighbouring triangles. */
extern OpenMM_Force* Helfrich_DihedralForce_create(const int* triangles, int numTriangles, double stiffness, int form);
/** Get the stiffness K, kJ/mol. */
extern double Helfrich_DihedralForce_getStiffness(OpenMM_Force* force);
/** Set the stiffness K, kJ/mol, zero or above. Values of single edges are given up. */
extern Helfrich_Status Helfrich_DihedralForce_setStiffness(OpenMM_Force* force, double stiffness);
/** Get the angle phi0 at rest. */
extern double Helfrich_DihedralForce_getRestAngle(OpenMM_Force* force);
/** Set the angle phi0 at rest, from -pi to pi, positive for convex edges. Values of single edges are given up. */
extern Helfrich_Status Helfrich_DihedralForce_setRestAngle(OpenMM_Force* force, double restAngle);

/** The line tension of a membrane's borders. */
extern OpenMM_Force* Helfrich_EdgeTensionForce_create(const int* triangles, int numTriangles, double tension);
/** Get the energy per length, kJ/mol/nm. */
extern double Helfrich_EdgeTensionForce_getTension(OpenMM_Force* force);
/** Set the energy per length, kJ/mol/nm. */
extern Helfrich_Status Helfrich_EdgeTensionForce_setTension(OpenMM_Force* force, double tension);

/** Keeps the volume V that a membrane encloses near a target V0. */
extern OpenMM_Force* Helfrich_EnclosedVolumeForce_create(const int* triangles, int numTriangles, double modulus,
                                                         double target);
/** Get the volume modulus kV, kJ/mol/nm^3. */
extern double Helfrich_EnclosedVolumeForce_getModulus(OpenMM_Force* force);
/** Set the volume modulus kV, kJ/mol/nm^3, zero or above. */
extern Helfrich_Status Helfrich_EnclosedVolumeForce_setModulus(OpenMM_Force* force, double modulus);
/** Get the target volume V0, nm^3. */
extern double Helfrich_EnclosedVolumeForce_getTarget(OpenMM_Force* force);
/** Set the target volume V0, nm^3, above zero. */
extern Helfrich_Status Helfrich_EnclosedVolumeForce_setTarget(OpenMM_Force* force, double target);

/** The elasticity of Gaussian curvature. */
extern OpenMM_Force* Helfrich_GaussianCurvatureForce_create(const int* triangles, int numTriangles, double modulus);
/** Get the modulus kappa_G, kJ/mol. */
extern double Helfrich_GaussianCurvatureForce_getModulus(OpenMM_Force* force);
/** Set the modulus kappa_G, kJ/mol. Values of single vertices are given up. */
extern Helfrich_Status Helfrich_GaussianCurvatureForce_setModulus(OpenMM_Force* force, double modulus);

/** Sets of coefficients. */
typedef enum { Helfrich_LimForce_Lim2002 = 0, Helfrich_LimForce_Amoudruz2023 = 1 } Helfrich_LimForce_Coefficients;

/**
 * Elasticity of the skeleton of a red blood cell, which hardens, against a reference shape. Its reference:
 * Helfrich_MembraneForce_setReference().
 */
extern OpenMM_Force* Helfrich_LimForce_create(const int* triangles, int numTriangles, double shearModulus,
                                              double areaModulus, int coefficients);
/** Get the modulus mu, kJ/mol/nm^2. */
extern double Helfrich_LimForce_getShearModulus(OpenMM_Force* force);
/** Set the modulus mu, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_LimForce_setShearModulus(OpenMM_Force* force, double shearModulus);
/** Get the modulus K, kJ/mol/nm^2. */
extern double Helfrich_LimForce_getAreaModulus(OpenMM_Force* force);
/** Set the modulus K, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_LimForce_setAreaModulus(OpenMM_Force* force, double areaModulus);

/** The tension of the line between domains of a membrane. Its domains: Helfrich_LineTensionForce_setDomains(). */
extern OpenMM_Force* Helfrich_LineTensionForce_create(const int* triangles, int numTriangles, double tension);
/** Get the energy per length, kJ/mol/nm. */
extern double Helfrich_LineTensionForce_getTension(OpenMM_Force* force);
/** Set the energy per length, kJ/mol/nm. */
extern Helfrich_Status Helfrich_LineTensionForce_setTension(OpenMM_Force* force, double tension);

/**
 * The simplest elasticity against a reference shape, quadratic in Green's strain e of each triangle. Its reference:
 * Helfrich_MembraneForce_setReference().
 */
extern OpenMM_Force* Helfrich_LinearElasticForce_create(const int* triangles, int numTriangles, double shearModulus,
                                                        double areaModulus);
/** Get the shear modulus mu, kJ/mol/nm^2. */
extern double Helfrich_LinearElasticForce_getShearModulus(OpenMM_Force* force);
/** Set the shear modulus mu, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_LinearElasticForce_setShearModulus(OpenMM_Force* force, double shearModulus);
/** Get the area modulus K, kJ/mol/nm^2. */
extern double Helfrich_LinearElasticForce_getAreaModulus(OpenMM_Force* force);
/** Set the area modulus K, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_LinearElasticForce_setAreaModulus(OpenMM_Force* force, double areaModulus);

/**
 * Elasticity of a rubber-like membrane against a reference shape. Its reference: Helfrich_MembraneForce_setReference().
 */
extern OpenMM_Force* Helfrich_NeoHookeanForce_create(const int* triangles, int numTriangles, double shearModulus,
                                                     double areaModulus);
/** Get the shear modulus mu, kJ/mol/nm^2. */
extern double Helfrich_NeoHookeanForce_getShearModulus(OpenMM_Force* force);
/** Set the shear modulus mu, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_NeoHookeanForce_setShearModulus(OpenMM_Force* force, double shearModulus);
/** Get the area modulus K, kJ/mol/nm^2. */
extern double Helfrich_NeoHookeanForce_getAreaModulus(OpenMM_Force* force);
/** Set the area modulus K, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_NeoHookeanForce_setAreaModulus(OpenMM_Force* force, double areaModulus);

/** The osmotic pressure of solutes that cannot pass a membrane, which water can. */
extern OpenMM_Force* Helfrich_OsmoticPressureForce_create(const int* triangles, int numTriangles, double solutes,
                                                          double concentration, double thermalEnergy);
/** Get the number n of solutes inside. */
extern double Helfrich_OsmoticPressureForce_getSolutes(OpenMM_Force* force);
/** Set the number n of solutes inside, above zero. */
extern Helfrich_Status Helfrich_OsmoticPressureForce_setSolutes(OpenMM_Force* force, double solutes);
/** Get the concentration c of solutes outside, 1/nm^3. */
extern double Helfrich_OsmoticPressureForce_getConcentration(OpenMM_Force* force);
/** Set the concentration c of solutes outside, 1/nm^3, above zero. */
extern Helfrich_Status Helfrich_OsmoticPressureForce_setConcentration(OpenMM_Force* force, double concentration);
/** Get the thermal energy kT, kJ/mol. */
extern double Helfrich_OsmoticPressureForce_getThermalEnergy(OpenMM_Force* force);
/** Set the thermal energy kT, kJ/mol, above zero. */
extern Helfrich_Status Helfrich_OsmoticPressureForce_setThermalEnergy(OpenMM_Force* force, double thermalEnergy);

/** What attracts particles to the surface. */
typedef enum {
    Helfrich_ParticleSurfaceForce_WCA = 0,
    Helfrich_ParticleSurfaceForce_LennardJones = 1,
    Helfrich_ParticleSurfaceForce_NineThree = 2
} Helfrich_ParticleSurfaceForce_Attraction;

/**
 * A surface that other particles cannot pass, and may adhere to. Its particles:
 * Helfrich_ParticleSurfaceForce_setParticles().
 */
extern OpenMM_Force* Helfrich_ParticleSurfaceForce_create(const int* triangles, int numTriangles, double distance,
                                                          double epsilon, double adhesion, double radius,
                                                          int attraction);
/** Get the gap D below which there is a repulsion, nm. */
extern double Helfrich_ParticleSurfaceForce_getDistance(OpenMM_Force* force);
/** Set the gap D below which there is a repulsion, nm, above zero. */
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setDistance(OpenMM_Force* force, double distance);
/** Get the strength of the repulsion, kJ/mol. */
extern double Helfrich_ParticleSurfaceForce_getEpsilon(OpenMM_Force* force);
/** Set the strength of the repulsion, kJ/mol, zero or above. */
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setEpsilon(OpenMM_Force* force, double epsilon);
/** Get the energy by area w of what touches, kJ/mol/nm^2. */
extern double Helfrich_ParticleSurfaceForce_getAdhesion(OpenMM_Force* force);
/** Set the energy by area w of what touches, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setAdhesion(OpenMM_Force* force, double adhesion);
/** Get the radius R of all particles, nm. */
extern double Helfrich_ParticleSurfaceForce_getRadius(OpenMM_Force* force);
/** Set the radius R of all particles, nm, zero or above. Values of single particles are given up. */
extern Helfrich_Status Helfrich_ParticleSurfaceForce_setRadius(OpenMM_Force* force, double radius);

/** Keeps the plaquettes of all N vertices alike. */
extern OpenMM_Force* Helfrich_PlaquetteAreaForce_create(const int* triangles, int numTriangles, double stiffness,
                                                        double target);
/** Get the stiffness k, (3/2) kB T in the paper, kJ/mol. */
extern double Helfrich_PlaquetteAreaForce_getStiffness(OpenMM_Force* force);
/** Set the stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above. */
extern Helfrich_Status Helfrich_PlaquetteAreaForce_setStiffness(OpenMM_Force* force, double stiffness);
/** Get the target A0 of the total area, nm^2. */
extern double Helfrich_PlaquetteAreaForce_getTarget(OpenMM_Force* force);
/** Set the target A0 of the total area, nm^2, above zero. */
extern Helfrich_Status Helfrich_PlaquetteAreaForce_setTarget(OpenMM_Force* force, double target);

/** A pressure difference across a membrane that encloses the volume V. */
extern OpenMM_Force* Helfrich_PressureForce_create(const int* triangles, int numTriangles, double pressure);
/** Get the pressure difference p, inside less outside, kJ/mol/nm^3. */
extern double Helfrich_PressureForce_getPressure(OpenMM_Force* force);
/** Set the pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar). */
extern Helfrich_Status Helfrich_PressureForce_setPressure(OpenMM_Force* force, double pressure);

/**
 * Elasticity of a membrane with a skeleton, such as that of a red blood cell, against a reference shape. Its reference:
 * Helfrich_MembraneForce_setReference().
 */
extern OpenMM_Force* Helfrich_SkalakForce_create(const int* triangles, int numTriangles, double shearModulus,
                                                 double areaModulus);
/** Get the modulus mu, kJ/mol/nm^2. */
extern double Helfrich_SkalakForce_getShearModulus(OpenMM_Force* force);
/** Set the modulus mu, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_SkalakForce_setShearModulus(OpenMM_Force* force, double shearModulus);
/** Get the modulus K, kJ/mol/nm^2. */
extern double Helfrich_SkalakForce_getAreaModulus(OpenMM_Force* force);
/** Set the modulus K, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_SkalakForce_setAreaModulus(OpenMM_Force* force, double areaModulus);

/** The functions f of the length. */
typedef enum { Helfrich_SpringForce_Harmonic = 0, Helfrich_SpringForce_WLCPower = 1 } Helfrich_SpringForce_Form;

/**
 * Springs along the edges, a network such as the spectrin skeleton of a red blood cell. Its reference:
 * Helfrich_MembraneForce_setReference().
 */
extern OpenMM_Force* Helfrich_SpringForce_create(const int* triangles, int numTriangles, double stiffness, double ratio,
                                                 int form);
/** Get the stiffness k of all springs at rest, kJ/mol/nm^2. */
extern double Helfrich_SpringForce_getStiffness(OpenMM_Force* force);
/** Set the stiffness k of all springs at rest, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_SpringForce_setStiffness(OpenMM_Force* force, double stiffness);
/** Get the length at rest as a share of the longest, l0/lmax. */
extern double Helfrich_SpringForce_getRatio(OpenMM_Force* force);
/** Set the length at rest as a share of the longest, l0/lmax, above zero and below one. */
extern Helfrich_Status Helfrich_SpringForce_setRatio(OpenMM_Force* force, double ratio);

/** Keeps the total area A of a membrane near a target A0. */
extern OpenMM_Force* Helfrich_SurfaceAreaForce_create(const int* triangles, int numTriangles, double modulus,
                                                      double target);
/** Get the area modulus kA, kJ/mol/nm^2. */
extern double Helfrich_SurfaceAreaForce_getModulus(OpenMM_Force* force);
/** Set the area modulus kA, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_SurfaceAreaForce_setModulus(OpenMM_Force* force, double modulus);
/** Get the target area A0, nm^2. */
extern double Helfrich_SurfaceAreaForce_getTarget(OpenMM_Force* force);
/** Set the target area A0, nm^2, above zero. */
extern Helfrich_Status Helfrich_SurfaceAreaForce_setTarget(OpenMM_Force* force, double target);

/**
 * Keeps surfaces from passing through themselves and each other, by a repulsion of vertices and triangles and of edges.
 */
extern OpenMM_Force* Helfrich_SurfaceRepulsionForce_create(const int* triangles, int numTriangles, double distance,
                                                           double epsilon);
/** Get the distance D below which there is a repulsion, nm. */
extern double Helfrich_SurfaceRepulsionForce_getDistance(OpenMM_Force* force);
/** Set the distance D below which there is a repulsion, nm, above zero. */
extern Helfrich_Status Helfrich_SurfaceRepulsionForce_setDistance(OpenMM_Force* force, double distance);
/** Get the strength, kJ/mol. */
extern double Helfrich_SurfaceRepulsionForce_getEpsilon(OpenMM_Force* force);
/** Set the strength, kJ/mol, zero or above. */
extern Helfrich_Status Helfrich_SurfaceRepulsionForce_setEpsilon(OpenMM_Force* force, double epsilon);

/** A surface tension on the total area A of a membrane. */
extern OpenMM_Force* Helfrich_SurfaceTensionForce_create(const int* triangles, int numTriangles, double tension);
/** Get the tension sigma, kJ/mol/nm^2. */
extern double Helfrich_SurfaceTensionForce_getTension(OpenMM_Force* force);
/** Set the tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign. */
extern Helfrich_Status Helfrich_SurfaceTensionForce_setTension(OpenMM_Force* force, double tension);

/** Keeps the area a of each triangle near a target a0. */
extern OpenMM_Force* Helfrich_TriangleAreaForce_create(const int* triangles, int numTriangles, double modulus,
                                                       double target);
/** Get the area modulus kA, kJ/mol/nm^2. */
extern double Helfrich_TriangleAreaForce_getModulus(OpenMM_Force* force);
/** Set the area modulus kA, kJ/mol/nm^2, zero or above. */
extern Helfrich_Status Helfrich_TriangleAreaForce_setModulus(OpenMM_Force* force, double modulus);
/** Get the target area a0 of each triangle, nm^2. */
extern double Helfrich_TriangleAreaForce_getTarget(OpenMM_Force* force);
/** Set the target area a0 of each triangle, nm^2, above zero. Values of single triangles are given up. */
extern Helfrich_Status Helfrich_TriangleAreaForce_setTarget(OpenMM_Force* force, double target);

/** Keeps triangles from vanishing by a repulsion at small areas. */
extern OpenMM_Force* Helfrich_TriangleAreaRepulsionForce_create(const int* triangles, int numTriangles, double minArea,
                                                                double epsilon);
/** Get the area a_m below which the repulsion is strong, nm^2. */
extern double Helfrich_TriangleAreaRepulsionForce_getMinArea(OpenMM_Force* force);
/** Set the area a_m below which the repulsion is strong, nm^2, zero or above. */
extern Helfrich_Status Helfrich_TriangleAreaRepulsionForce_setMinArea(OpenMM_Force* force, double minArea);
/** Get the strength, kJ/mol. */
extern double Helfrich_TriangleAreaRepulsionForce_getEpsilon(OpenMM_Force* force);
/** Set the strength, kJ/mol, zero or above. */
extern Helfrich_Status Helfrich_TriangleAreaRepulsionForce_setEpsilon(OpenMM_Force* force, double epsilon);

/** Keeps triangles from degenerating by a repulsion at small heights. */
extern OpenMM_Force* Helfrich_TriangleHeightForce_create(const int* triangles, int numTriangles, double minHeight,
                                                         double epsilon);
/** Get the height d, nm. */
extern double Helfrich_TriangleHeightForce_getMinHeight(OpenMM_Force* force);
/** Set the height d, nm, zero or above. */
extern Helfrich_Status Helfrich_TriangleHeightForce_setMinHeight(OpenMM_Force* force, double minHeight);
/** Get the strength epsilon, kJ/mol. */
extern double Helfrich_TriangleHeightForce_getEpsilon(OpenMM_Force* force);
/** Set the strength epsilon, kJ/mol, zero or above. */
extern Helfrich_Status Helfrich_TriangleHeightForce_setEpsilon(OpenMM_Force* force, double epsilon);

#ifdef __cplusplus
}
#endif

#endif /*OPENMM_HELFRICH_CFORCES_H_*/
