#ifndef OPENMM_HELFRICH_H_
#define OPENMM_HELFRICH_H_

/** All forces and integrators of the plugin. */

#include "openmm-helfrich/AreaDifferenceForce.h"
#include "openmm-helfrich/BendingForce.h"
#include "openmm-helfrich/DihedralForce.h"
#include "openmm-helfrich/EdgeTensionForce.h"
#include "openmm-helfrich/EnclosedVolumeForce.h"
#include "openmm-helfrich/GaussianCurvatureForce.h"
#include "openmm-helfrich/LimForce.h"
#include "openmm-helfrich/LineTensionForce.h"
#include "openmm-helfrich/LinearElasticForce.h"
#include "openmm-helfrich/MonteCarloBondFlip.h"
#include "openmm-helfrich/MonteCarloDomainSwap.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"
#include "openmm-helfrich/NeoHookeanForce.h"
#include "openmm-helfrich/OsmoticPressureForce.h"
#include "openmm-helfrich/ParticleSurfaceForce.h"
#include "openmm-helfrich/PlaquetteAreaForce.h"
#include "openmm-helfrich/PressureForce.h"
#include "openmm-helfrich/SkalakForce.h"
#include "openmm-helfrich/SpringForce.h"
#include "openmm-helfrich/SurfaceAreaForce.h"
#include "openmm-helfrich/SurfaceRepulsionForce.h"
#include "openmm-helfrich/SurfaceTensionForce.h"
#include "openmm-helfrich/SurfaceViscosityThermostat.h"
#include "openmm-helfrich/TriangleAreaForce.h"
#include "openmm-helfrich/TriangleAreaRepulsionForce.h"
#include "openmm-helfrich/TriangleHeightForce.h"
#include "openmm-helfrich/VariableMassLangevinIntegrator.h"
#include "openmm-helfrich/VariableMassVerletIntegrator.h"

/** Apply a macro to the name of each force class: the list that the plugin and Python are made from. */
// clang-format off: one a line
#define HELFRICH_FORCES(apply) \
    apply(SurfaceAreaForce) \
    apply(EnclosedVolumeForce) \
    apply(BendingForce) \
    apply(TriangleHeightForce) \
    apply(DihedralForce) \
    apply(TriangleAreaForce) \
    apply(PlaquetteAreaForce) \
    apply(TriangleAreaRepulsionForce) \
    apply(SurfaceRepulsionForce) \
    apply(ParticleSurfaceForce) \
    apply(EdgeTensionForce) \
    apply(GaussianCurvatureForce) \
    apply(SkalakForce) \
    apply(LimForce) \
    apply(PressureForce) \
    apply(SurfaceTensionForce) \
    apply(OsmoticPressureForce) \
    apply(AreaDifferenceForce) \
    apply(NeoHookeanForce) \
    apply(LinearElasticForce) \
    apply(SpringForce) \
    apply(LineTensionForce)
// clang-format on

#endif /*OPENMM_HELFRICH_H_*/
