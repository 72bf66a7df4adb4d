#ifndef HELFRICH_MEMBRANE_CROWD_H_
#define HELFRICH_MEMBRANE_CROWD_H_

#include "HelfrichDynamics.h"

#include <openmm/Vec3.h>
#include <openmm/internal/ContextImpl.h>

#include <vector>

namespace HelfrichPlugin {

class SharedMembrane;

/** What is computed at once: forces, energies, both. */
struct Computation {
    OpenMM::ContextImpl& context;
    /** A bit for each force group. */
    int groups;
    const std::vector<OpenMM::Vec3>& positions;
    bool includeEnergy;
    /** These are added, unless it is null. */
    std::vector<OpenMM::Vec3>* forces;
    bool includeDerivatives;
};

/** The membranes of a Context that share no particles, which its threads evaluate side by side. */
class MembraneCrowd {
public:
    MembraneCrowd();
    MembraneCrowd(const MembraneCrowd&) = delete;
    ~MembraneCrowd();
    /** Whether threads evaluate membranes, rather than share each of them. */
    bool usesTeam() const {
        return isShared;
    }
    /** Another computation begins. */
    void begin() {
        isDone = false;
    }
    /**
     * Evaluate all of them, once in a computation.
     *
     * @param membrane     the one that is asked for
     * @param computation  what to compute
     * @return whether that membrane is one of them
     */
    bool evaluate(const SharedMembrane& membrane, const Computation& computation);

private:
    /** Find the membranes. */
    void gather(OpenMM::ContextImpl& context);

    HelfrichCrowd* core;
    std::vector<SharedMembrane*> membranes;
    std::vector<HelfrichTurn> turns;
    /** Whether the membranes are known, and whether they have been evaluated in the present computation. */
    bool isGathered, isDone;
    /** Whether there are enough membranes for all threads. */
    bool isShared;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MEMBRANE_CROWD_H_*/
