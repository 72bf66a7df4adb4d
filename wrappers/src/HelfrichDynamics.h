#ifndef HELFRICH_DYNAMICS_H_
#define HELFRICH_DYNAMICS_H_

/**
 * The C functions of the Rust core for the platform. The build compares them with Rust's, as those of CoreFunctions.h.
 */

#include "openmm-helfrich/internal/CoreFunctions.h"

extern "C" {

/** Threads that wait for work; one user at a time. */
struct HelfrichTeam;

/** Several membranes that are evaluated side by side. */
struct HelfrichCrowd;

/** Masses, ready for time steps. */
struct HelfrichDynamics;

/** Masses that follow plaquettes, ready for time steps. */
struct HelfrichVariableMasses;

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

/** The triangles of a force. */
struct HelfrichSheet {
    const int* corners;
    int64_t numTriangles;
    /** Whether its sides are nearest images in the periodic box. */
    int isPeriodic;
};

int Helfrich_Team_available();
Helfrich_Status Helfrich_Team_create(int threads, HelfrichTeam** team);
void Helfrich_Team_destroy(HelfrichTeam* team);
HelfrichCrowd* Helfrich_Crowd_create();
void Helfrich_Crowd_destroy(HelfrichCrowd* crowd);
/** Without a team this thread does it alone; forces may be null. No two membranes may have a particle in common. */
Helfrich_Status Helfrich_Crowd_evaluate(HelfrichCrowd* crowd, HelfrichTeam* team, const HelfrichTurn* turns,
                                        int64_t numTurns, int64_t numParticles, const double* positions,
                                        double* forces);
/** Whether steps of so many particles use a team; it is awake if it evaluates membranes. */
int Helfrich_Dynamics_usesTeam(int64_t numParticles, int isAwake);
Helfrich_Status Helfrich_Dynamics_create(int64_t numParticles, const double* masses, HelfrichDynamics** dynamics);
void Helfrich_Dynamics_destroy(HelfrichDynamics* dynamics);
Helfrich_Status Helfrich_Dynamics_verlet(const HelfrichDynamics* dynamics, HelfrichTeam* team,
                                         const HelfrichParticleArrays* particles, double step);
Helfrich_Status Helfrich_Dynamics_langevinMiddle(const HelfrichDynamics* dynamics, HelfrichTeam* team,
                                                 const HelfrichParticleArrays* particles, HelfrichStream* stream,
                                                 double step, double friction, double kT);
Helfrich_Status Helfrich_Dynamics_brownian(const HelfrichDynamics* dynamics, HelfrichTeam* team,
                                           const HelfrichParticleArrays* particles, HelfrichStream* stream, double step,
                                           double friction, double kT);
/** The 128 random bits of a number, for a key: `bits` gets two values. */
void Helfrich_Random_bits(const uint32_t* key, uint64_t number, uint64_t* bits);
/** The normals of a stream's present draw, which ends with it; for tests. */
Helfrich_Status Helfrich_Random_normals(HelfrichStream* stream, int64_t length, double* normals);
Helfrich_Status Helfrich_Viscosity_create(const char* subject, const HelfrichMembrane* membrane, int64_t numParticles,
                                          const double* masses, HelfrichViscosity** viscosity);
void Helfrich_Viscosity_destroy(HelfrichViscosity* viscosity);
Helfrich_Status Helfrich_Viscosity_sweep(const char* subject, HelfrichViscosity* viscosity,
                                         const HelfrichMembrane* membrane, int64_t numParticles, double* positions,
                                         double* velocities, const double* box, const HelfrichEdgeBath* bath,
                                         HelfrichStream* stream);
Helfrich_Status Helfrich_Dynamics_clear(HelfrichTeam* team, int64_t numParticles, double* forces);
/** `subject` is the class that messages shall name, `boxVectors` null where no surface is periodic. */
Helfrich_Status Helfrich_VariableMasses_create(const char* subject, int64_t numParticles, const double* masses,
                                               double density, HelfrichVariableMasses** made);
void Helfrich_VariableMasses_destroy(HelfrichVariableMasses* masses);
Helfrich_Status Helfrich_VariableMasses_setSurfaces(const char* subject, HelfrichVariableMasses* masses,
                                                    const HelfrichSheet* sheets, int64_t count);
/** Write a mass for each particle. */
Helfrich_Status Helfrich_VariableMasses_get(const char* subject, HelfrichVariableMasses* masses,
                                            const HelfrichParticleArrays* particles, const double* boxVectors,
                                            double* out);
/** From a step's start to its new positions, with the forces at the old ones. */
Helfrich_Status Helfrich_VariableMasses_begin(const char* subject, HelfrichVariableMasses* masses, HelfrichTeam* team,
                                              const HelfrichParticleArrays* particles, const double* boxVectors,
                                              double step);
/** To the step's end, with the forces at the new positions. */
Helfrich_Status Helfrich_VariableMasses_finish(const char* subject, HelfrichVariableMasses* masses, HelfrichTeam* team,
                                               const HelfrichParticleArrays* particles, const double* boxVectors,
                                               double step);
Helfrich_Status Helfrich_VariableMasses_bathe(const char* subject, HelfrichVariableMasses* masses, HelfrichTeam* team,
                                              const HelfrichParticleArrays* particles, const double* boxVectors,
                                              HelfrichStream* stream, double time, double friction, double kT);
}

#endif /*HELFRICH_DYNAMICS_H_*/
