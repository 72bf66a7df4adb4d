#ifndef HELFRICH_DYNAMICS_H_
#define HELFRICH_DYNAMICS_H_

/**
 * The C functions of the Rust core for the platform (src/ffi/dynamics.rs; the two change together). Those that
 * return a status can be given to check().
 */

#include "openmm-helfrich/internal/Core.h"

extern "C" {

/** Threads that wait for work; one user at a time. */
struct HelfrichTeam;

/** Masses, ready for time steps. */
struct HelfrichDynamics;

/** A sequence of random numbers and the place in it. */
struct HelfrichStream {
    /** The seed, and the number of the stream among those of a Context. */
    uint32_t key[2];
    uint64_t draws;
};

/** Three values for each particle. */
struct HelfrichParticleArrays {
    int64_t numParticles;
    double *positions, *velocities;
    const double* forces;
};

/** What acts along the edges of a membrane: src/dynamics/viscosity.rs. */
struct HelfrichViscosity;

struct HelfrichEdgeBath {
    /** Friction times time, amu. */
    double friction;
    /** kJ/mol. */
    double kt;
    /** How long before the positions they act, ps. */
    double lag;
};

int Helfrich_Team_available();
int Helfrich_Team_create(int threads, HelfrichTeam** team);
void Helfrich_Team_destroy(HelfrichTeam* team);
int Helfrich_Dynamics_usesTeam(int64_t numParticles);
int Helfrich_Dynamics_create(int64_t numParticles, const double* masses, HelfrichDynamics** dynamics);
void Helfrich_Dynamics_destroy(HelfrichDynamics* dynamics);
int Helfrich_Dynamics_verlet(const HelfrichDynamics* dynamics, HelfrichTeam* team,
                             const HelfrichParticleArrays* particles, double step);
int Helfrich_Dynamics_langevinMiddle(const HelfrichDynamics* dynamics, HelfrichTeam* team,
                                     const HelfrichParticleArrays* particles, HelfrichStream* stream, double step,
                                     double friction, double kT);
int Helfrich_Dynamics_brownian(const HelfrichDynamics* dynamics, HelfrichTeam* team,
                               const HelfrichParticleArrays* particles, HelfrichStream* stream, double step,
                               double friction, double kT);
/** The 128 random bits of a number, for a key: `bits` gets two values. */
void Helfrich_Random_bits(const uint32_t* key, uint64_t number, uint64_t* bits);
int Helfrich_Viscosity_create(const char* subject, const HelfrichMembrane* membrane, int64_t numParticles,
                              const double* masses, HelfrichViscosity** viscosity);
void Helfrich_Viscosity_destroy(HelfrichViscosity* viscosity);
int Helfrich_Viscosity_sweep(const char* subject, HelfrichViscosity* viscosity, const HelfrichMembrane* membrane,
                             int64_t numParticles, double* positions, double* velocities, const double* box,
                             const HelfrichEdgeBath* bath, HelfrichStream* stream);
int Helfrich_Dynamics_clear(HelfrichTeam* team, int64_t numParticles, double* forces);
}

#endif /*HELFRICH_DYNAMICS_H_*/
