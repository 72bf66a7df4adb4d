#ifndef OPENMM_HELFRICH_H_
#define OPENMM_HELFRICH_H_

/* .ci/potentials.py writes this file, from the headers in openmm-helfrich/. */

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
#include "openmm-helfrich/MembraneForce.h"
#include "openmm-helfrich/MonteCarloBondFlip.h"
#include "openmm-helfrich/MonteCarloDomainSwap.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"
#include "openmm-helfrich/MonteCarloMover.h"
#include "openmm-helfrich/MonteCarloSurfaceMover.h"
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
#include "openmm-helfrich/TriangulatedForce.h"
#include "openmm-helfrich/VariableMassIntegrator.h"
#include "openmm-helfrich/VariableMassLangevinIntegrator.h"
#include "openmm-helfrich/VariableMassVerletIntegrator.h"

/** Apply a macro to the name of each force class: the list that plugin and Python are made from. */
// clang-format off: one a line
#define HELFRICH_FORCES(apply) \
    apply(AreaDifferenceForce) \
    apply(BendingForce) \
    apply(DihedralForce) \
    apply(EdgeTensionForce) \
    apply(EnclosedVolumeForce) \
    apply(GaussianCurvatureForce) \
    apply(LimForce) \
    apply(LineTensionForce) \
    apply(LinearElasticForce) \
    apply(NeoHookeanForce) \
    apply(OsmoticPressureForce) \
    apply(ParticleSurfaceForce) \
    apply(PlaquetteAreaForce) \
    apply(PressureForce) \
    apply(SkalakForce) \
    apply(SpringForce) \
    apply(SurfaceAreaForce) \
    apply(SurfaceRepulsionForce) \
    apply(SurfaceTensionForce) \
    apply(TriangleAreaForce) \
    apply(TriangleAreaRepulsionForce) \
    apply(TriangleHeightForce)
// clang-format on

#endif /*OPENMM_HELFRICH_H_*/
