#ifndef HELFRICH_CORE_FUNCTIONS_H_
#define HELFRICH_CORE_FUNCTIONS_H_

/**
 * The C functions of the Rust core (src/ffi.rs and src/ffi/). The build compares them with Rust's, and makes Rust's
 * structures from those here (wrappers/declarations.rs). Core.h has check(), which turns the core's message into an
 * OpenMMException.
 */

#include "Status.h"

#include <stdint.h>

extern "C" {

struct HelfrichMembrane;
struct HelfrichNumbers;

/** The scalars a potential can have at most. */
#define HELFRICH_MAX_PARAMETERS 4

struct HelfrichParameterInfo {
    const char* name;
    /** The unit is (kJ/mol)^energy nm^length. */
    int energy, length;
    /** NaN if there is none. */
    double defaultValue;
    /** 0: only as a scalar; 1: also for each vertex; 2: also for each triangle; 3: also for each particle; 4: also for
     * each edge. */
    int per;
    /** Whether it stands behind the form in constructors. */
    int last;
};

struct HelfrichTerm {
    int potential, form;
    /** One bit for each switch. */
    uint32_t switches;
    int wantsDerivatives;
    double values[HELFRICH_MAX_PARAMETERS];
    /** Values of single elements, null where there are none. */
    const double* fields[HELFRICH_MAX_PARAMETERS];
    int64_t fieldLengths[HELFRICH_MAX_PARAMETERS];
    /** Particles beside the vertices, null where there are none. */
    const int* particles;
    int64_t numParticles;
    /** What the user has given for each vertex, null where there is nothing. */
    const HelfrichNumbers* numbers;
};

struct HelfrichNative;

/** A buffer that a GPU platform needs for an evaluation. */
struct HelfrichNativeBuffer {
    int64_t itemSize, items;
    /** Null if the host has nothing for it. */
    const uint8_t* data;
    int64_t dataSize;
    /** Changes with the data. */
    uint64_t version;
};

/** A pass of an evaluation there. */
struct HelfrichNativePass {
    const char* name;
    int64_t groups;
};

/** What an evaluation there takes; it holds until the next plan is made. */
struct HelfrichNativePlan {
    int64_t numBuffers, numPasses, numTargets, numRuns;
    /** Four numbers each. */
    const int *targets, *runs;
    /** Changes with the targets and runs. */
    uint64_t version;
    /** The lattice reaches 2 to this power to both sides, nm; INT_MIN where the device has to find out. */
    int extent;
    /** The unit of length as a power of two, nm. */
    int unit;
    int64_t numVertices;
    /** The particle of each vertex, and the first vertex of its connected part. */
    const uint32_t *particles, *anchors;
};

/** A membrane that has all triangles of another among its own, and follows its flips. */
struct HelfrichFollower {
    HelfrichMembrane* membrane;
    int64_t firstTriangle;
    const HelfrichTerm* terms;
    int64_t numTerms;
};

struct HelfrichContribution {
    double energy;
    double byParameter[HELFRICH_MAX_PARAMETERS];
};

/** What is evaluated of one of several membranes. */
struct HelfrichTurn {
    /** The class that messages shall name. */
    const char* subject;
    HelfrichMembrane* membrane;
    const HelfrichTerm* terms;
    int64_t numTerms;
    /** One a term, or null. */
    HelfrichContribution* contributions;
    /** The vectors of its periodic box, or null. */
    const double* boxVectors;
};

/** What bond flips may do. */
struct HelfrichFlipRules {
    /** kT, kJ/mol. */
    double temperature;
    int minDegree, maxDegree;
    /** nm; 0 for any. */
    double maxEdgeLength;
    /** Whether a demon takes the place of a bath. */
    int demon;
};

/** The state of a mover: the key of its random numbers, and how many flips were tried, made and refused for what
 * reason.
 */
struct HelfrichFlipState {
    uint32_t key[2];
    uint64_t attempts, accepted, byBorder, byDegree, byLength, byShape, byEnergy, byEdge;
    /** kJ/mol. */
    double demonEnergy;
};

/** How neighbours exchange what they are. */
struct HelfrichSwapRules {
    /** kT, kJ/mol. */
    double temperature;
    /** Whether a demon takes the place of a bath. */
    int demon;
};

/** The state of a mover of this kind, as above. */
struct HelfrichSwapState {
    uint32_t key[2];
    uint64_t attempts, accepted, byKind, byEnergy;
    /** kJ/mol. */
    double demonEnergy;
};

int64_t Helfrich_lastError(char* buffer, int64_t size);
void helfrich_setLastError(const char* message);
const char* Helfrich_openmmVersion();
void Helfrich_register();
Helfrich_Status Helfrich_Potential_find(const char* potential, int* index);
int Helfrich_Potential_isContact(int potential);
Helfrich_Status Helfrich_Potential_parameter(const char* potential, int index, HelfrichParameterInfo* info);
Helfrich_Status Helfrich_Potential_form(const char* potential, int index, const char** what, const char** name);
Helfrich_Status Helfrich_Potential_switch(const char* potential, int index, const char** name);
Helfrich_Status Helfrich_Potential_check(const char* potential, int index, double value);
/** How many numbers it wants for each vertex, or 0; what they are called, or null. */
int Helfrich_Potential_numbers(const char* potential, const char** name);
/** Whether they say of what kind a vertex is, so that neighbours can exchange them: 1 or 0. */
int Helfrich_Potential_hasKinds(const char* potential);
/** `box` has the vectors of the periodic box that positions among them are in, or is null. */
Helfrich_Status Helfrich_Potential_checkNumbers(const char* potential, const double* numbers, int64_t count,
                                                const double* box);
/** What a force object has for each vertex, after what it has had `before` or null. */
HelfrichNumbers* Helfrich_Numbers_create(const HelfrichNumbers* before, const double* numbers, int64_t count,
                                         const double* box);
/** A version of numbers, or of values by vertex that go with them, that no others have. */
uint64_t Helfrich_Numbers_takeVersion(void);
/** Set as many as before, in the order that vertices have exchanged theirs to. */
Helfrich_Status Helfrich_Numbers_rearrange(HelfrichNumbers* numbers, const double* values, int64_t count,
                                           uint64_t version);
void Helfrich_Numbers_destroy(HelfrichNumbers* numbers);
Helfrich_Status Helfrich_Membrane_create(const char* subject, const int* triangles, int64_t numTriangles,
                                         int64_t numParticles, HelfrichMembrane** membrane);
void Helfrich_Membrane_destroy(HelfrichMembrane* membrane);
/** Whether it is settled that the processor evaluates it: 1 or 0. */
int Helfrich_Membrane_isOnProcessor(const HelfrichMembrane* membrane);
Helfrich_Status Helfrich_Membrane_choose(const char* subject, HelfrichMembrane* membrane, const char* backend);
/** Whether OpenMM's GPU platforms shall evaluate it themselves: 0 no, 1 if they can, 2 or it is an error. */
int Helfrich_Membrane_wishesNative(const HelfrichMembrane* membrane);
/** Copy what holds for forces without a backend of their own; returns its length, or -1 for an error. */
int64_t Helfrich_getBackend(char* buffer, int64_t size);
Helfrich_Status Helfrich_checkBackend(const char* subject, const char* backend);
const char* Helfrich_Native_source(int isDouble);
int Helfrich_Native_canEvaluate(int potential, int isPeriodic);
HelfrichNative* Helfrich_Native_create(int isDouble);
void Helfrich_Native_destroy(HelfrichNative* native);
/** Whether Helfrich_Native_look() must come before terms are evaluated. */
int Helfrich_Native_mustLook(const HelfrichNative* native, const HelfrichMembrane* membrane, const HelfrichTerm* terms,
                             int64_t numTerms);
/** Evaluate on the processor, for its errors, and choose the unit of length. */
Helfrich_Status Helfrich_Native_look(const char* subject, HelfrichNative* native, HelfrichMembrane* membrane,
                                     const HelfrichTerm* terms, int64_t numTerms, int64_t numParticles,
                                     const double* positions, const double* boxVectors);
/** For each scalar of each term, `derivatives` has the number of the derivative that it adds to, or -1. */
Helfrich_Status Helfrich_Native_plan(const char* subject, HelfrichNative* native, HelfrichMembrane* membrane,
                                     const double* boxVectors, const HelfrichTerm* terms, int64_t numTerms,
                                     int energies, int forces, const int* derivatives, HelfrichNativePlan* plan);
HelfrichNativeBuffer Helfrich_Native_buffer(const HelfrichNative* native, int64_t number);
HelfrichNativePass Helfrich_Native_pass(const HelfrichNative* native, int64_t number);
/** Note that a GPU platform has evaluated. */
void Helfrich_Native_count();
int64_t Helfrich_Membrane_numEdges(const HelfrichMembrane* membrane);
void Helfrich_Membrane_edges(const HelfrichMembrane* membrane, int* particles);
/** Whether it spans the periodic box in which it was evaluated last: 1 or 0. */
int Helfrich_Membrane_spans(const HelfrichMembrane* membrane);
Helfrich_Status Helfrich_Membrane_checkTerm(const char* subject, HelfrichMembrane* membrane, const HelfrichTerm* term);
Helfrich_Status Helfrich_Membrane_checkParticles(const char* subject, const HelfrichMembrane* membrane,
                                                 const HelfrichTerm* term);
void Helfrich_Membrane_setThreads(HelfrichMembrane* membrane, int threads);
/** `box` has the three box vectors, or is null where the surface is not in a periodic box. */
Helfrich_Status Helfrich_Membrane_evaluate(const char* subject, HelfrichMembrane* membrane, const HelfrichTerm* terms,
                                           int64_t numTerms, int64_t numParticles, const double* positions,
                                           const double* box, HelfrichContribution* contributions, double* forces);
/** Add to nine numbers, row by row. */
Helfrich_Status Helfrich_Membrane_addVirial(const char* subject, HelfrichMembrane* membrane, const HelfrichTerm* terms,
                                            int64_t numTerms, int64_t numParticles, const double* positions,
                                            const double* box, double* virial);
Helfrich_Status Helfrich_Membrane_checkFlips(const char* subject, const HelfrichMembrane* membrane,
                                             const HelfrichFlipRules* rules);
Helfrich_Status Helfrich_Membrane_flip(const char* subject, HelfrichMembrane* membrane, const HelfrichTerm* terms,
                                       int64_t numTerms, int64_t numParticles, const double* positions,
                                       const double* box, const HelfrichFlipRules* rules, int64_t attempts,
                                       HelfrichFlipState* state, int64_t* made, double* forceChange,
                                       const HelfrichFollower* followers, int64_t numFollowers);
/**
 * Let neighbours exchange what they are. `kinds` has the same number for vertices that are alike, `sources` gets the
 * vertex whose values each one has then, and `version` is what terms will have for theirs that have been changed.
 */
Helfrich_Status Helfrich_Membrane_swap(const char* subject, HelfrichMembrane* membrane, const HelfrichTerm* terms,
                                       int64_t numTerms, int64_t numParticles, const double* positions,
                                       const double* box, const HelfrichSwapRules* rules, int64_t attempts,
                                       HelfrichSwapState* state, const uint32_t* kinds, uint32_t* sources,
                                       uint64_t version, int64_t* made, double* forceChange);
int64_t Helfrich_Membrane_numTriangles(const HelfrichMembrane* membrane);
int64_t Helfrich_Membrane_numVertices(const HelfrichMembrane* membrane);
void Helfrich_Membrane_triangles(const HelfrichMembrane* membrane, int* corners);
Helfrich_Status Helfrich_Membrane_setTriangles(const char* subject, HelfrichMembrane* membrane, const int* corners,
                                               int64_t numTriangles);
int64_t Helfrich_Membrane_order(const HelfrichMembrane* membrane, uint32_t* order);
Helfrich_Status Helfrich_Membrane_restore(const char* subject, HelfrichMembrane* membrane, const int* corners,
                                          const uint32_t* order, int64_t flips);
double Helfrich_Membrane_fingerprint(const HelfrichMembrane* membrane);
/**
 * Whether an OpenMM::System under an OpenMM::Integrator is one for the platform Helfrich (PlatformChoice.h); the
 * last error says why not.
 */
Helfrich_Status Helfrich_Platform_check(const void* system, const void* integrator);
/** `force` is the address of an OpenMM::Force. */
void* Helfrich_createImpl(const void* force);

/* What OpenMM calls when it loads the library as a plugin. */
void registerPlatforms();
void registerKernelFactories();

/* For Python. Texts are copied into a buffer of `size` bytes; the result is their length, or -1 for an error. */
void Helfrich_acceptOpenMM(const char* version);
/** Turn triangles outward, in place; `box` has the vectors of the periodic box that vertices are in, or is null. */
Helfrich_Status Helfrich_Mesh_orient(int64_t numVertices, const double* vertices, int64_t numTriangles,
                                     int64_t* triangles, const double* box);
Helfrich_Status Helfrich_setBackend(const char* backend);
/** One GPU a line, with what is known of it between tabs. */
int64_t Helfrich_adapters(char* buffer, int64_t size);
/** One measurement a line. */
int64_t Helfrich_backendTimings(char* buffer, int64_t size);
/** How many evaluations the processor, GPUs and OpenMM's GPU platforms have done: three numbers. */
void Helfrich_evaluations(uint64_t* counts);

/* For tests. */
int64_t Helfrich_Membrane_count();
Helfrich_Status Helfrich_injectGpuFault(const char* kind, int64_t after);
}

#endif /*HELFRICH_CORE_FUNCTIONS_H_*/
