#ifndef HELFRICH_SHIM_H_
#define HELFRICH_SHIM_H_

/** What the Rust core calls beside the functions that CApi.h has. The build makes Rust's declarations of these. */

#include "openmm-helfrich/internal/Status.h"

#include <OpenMMCWrapper.h>

extern "C" {

/** A force of a membrane; null, and the last error, if an argument is refused. */
OpenMM_Force* helfrich_shim_createForce(const char* type, const int* triangles, int numTriangles, const double* values,
                                        int numValues, int form);
void helfrich_shim_acceptOpenMM(const char* version);
/** Fails if OpenMM is of another version. */
Helfrich_Status helfrich_shim_registerSerialization();
void helfrich_shim_registerPlatform();
void helfrich_shim_adoptKernels();
/** As Helfrich_Platform_check(). */
Helfrich_Status helfrich_shim_checkPlatform(const void* system, const void* integrator);
void* helfrich_shim_createImpl(const void* force);
}

#endif /*HELFRICH_SHIM_H_*/
