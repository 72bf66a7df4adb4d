#ifndef OPENMM_HELFRICH_H_
#define OPENMM_HELFRICH_H_

/** All forces of the plugin. */

#include "openmm-helfrich/BendingForce.h"
#include "openmm-helfrich/EnclosedVolumeForce.h"
#include "openmm-helfrich/SurfaceAreaForce.h"
#include "openmm-helfrich/TriangleHeightForce.h"

#endif /*OPENMM_HELFRICH_H_*/
