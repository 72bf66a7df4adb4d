#ifndef HELFRICH_SHARED_MEMBRANE_H_
#define HELFRICH_SHARED_MEMBRANE_H_

#include "HelfrichDynamics.h"
#include "MembraneCrowd.h"
#include "NativeMembrane.h"
#include "openmm-helfrich/internal/Core.h"

#include <openmm/Vec3.h>
#include <openmm/internal/ContextImpl.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace HelfrichPlugin {

class MembraneForce;
class MembraneForceImpl;
class SurfaceMoverImpl;
class SurfaceViscosityThermostatImpl;
struct SavedConnectivity;

/** What moves of a surface change: its edges, or what the vertices are. */
enum class MoverKind { Flips, Swaps };

/** The number of these. */
const int NUM_MOVER_KINDS = 2;

/** What decides the bits of evaluations beside positions. */
struct Connectivity {
    /** The particles at the corners of the triangles, three for each. */
    std::vector<int> corners;
    /** The vertices, in the order in which sums are formed. */
    std::vector<uint32_t> order;
    /** How many flips there have been since the order was made. */
    int64_t flips;
    /** For each vertex the one whose values it has, as the user gave them; empty if every one has its own. */
    std::vector<uint32_t> permutation;
};

/**
 * A mesh in one Context, shared by all forces on the same triangles, so that the geometry is computed
 * once per evaluation. The first of the forces that an evaluation asks for is its leader and computes
 * the sum of all that are asked for; the others add nothing. Its connectivity changes by bond flips, and whose values
 * vertices have by exchanges.
 */
class SharedMembrane {
public:
    /**
     * Join the membrane of a Context that has these triangles, or make it.
     *
     * @param subject    the class that messages shall name
     * @param context    the Context
     * @param triangles  the particle indices of the corners, three for each triangle
     */
    static std::shared_ptr<SharedMembrane> acquire(const std::string& subject, OpenMM::ContextImpl& context,
                                                   const std::vector<int>& triangles);
    /** All membranes of a Context, in the order in which they were made. */
    static std::vector<std::shared_ptr<SharedMembrane>> findAll(OpenMM::ContextImpl& context);
    ~SharedMembrane();
    SharedMembrane(const SharedMembrane&) = delete;
    SharedMembrane& operator=(const SharedMembrane&) = delete;
    /** Add a force to the membrane; OpenMM makes them in the order in which it will call them. */
    void join(MembraneForceImpl* member);
    /** Refuse a force that sees another periodic box than those that are there: one of them sees none. */
    void checkAgreement(const MembraneForceImpl& joining) const;
    void leave(MembraneForceImpl* member);
    /** Refuse a force that joins and would not follow flips of other membranes with the same particles. */
    void checkJoining(const std::string& subject, int potential) const;
    /** Add what moves something, of which there can be one of each kind. */
    void join(SurfaceMoverImpl* joining, OpenMM::ContextImpl& context);
    void leave(SurfaceMoverImpl* leaving, OpenMM::ContextImpl& context);
    /** Add what lets friction act along edges. */
    void join(SurfaceViscosityThermostatImpl* thermostat) {
        thermostats.push_back(thermostat);
    }
    void leave(SurfaceViscosityThermostatImpl* thermostat) {
        thermostats.erase(std::remove(thermostats.begin(), thermostats.end(), thermostat), thermostats.end());
    }
    /** Whether a member is the first whose force group is among those asked for, of those that are evaluated like it.
     */
    bool isLeader(const MembraneForceImpl& member, int groups) const;
    /**
     * Let the platform evaluate a force that joins, if it can and if that is wanted; platforms.py tells people.
     *
     * @param force      the force
     * @param potential  the number of its potential
     * @return whether it will
     */
    bool startNative(const MembraneForce& force, OpenMM::ContextImpl& context, int potential);
    /** Have the platform compute the derivative with respect to a Context parameter. */
    void requestDerivative(const std::string& parameter) {
        native->requestDerivative(parameter);
    }
    /** Evaluate all members in some force groups that the platform evaluates. */
    void evaluateNatively(const std::string& subject, OpenMM::ContextImpl& context, int groups, bool forces,
                          bool energy);
    /**
     * Evaluate all members in some force groups.
     *
     * @param subject      the class that messages shall name
     * @param context      the Context
     * @param groups       a bit for each force group
     * @param positions    of all particles, nm
     * @param includeEnergy  whether the energy is wanted; it is 0 otherwise
     * @param forces       of all particles, kJ/mol/nm; the forces are added, unless it is null
     * @param derivatives  of the energy with respect to Context parameters; those asked for are added,
     *                     unless it is null
     * @return the energy, kJ/mol
     */
    double evaluate(const std::string& subject, OpenMM::ContextImpl& context, int groups,
                    const std::vector<OpenMM::Vec3>& positions, bool includeEnergy, std::vector<OpenMM::Vec3>* forces,
                    std::map<std::string, double>* derivatives);
    /** What TriangulatedForce::getVirial() returns: the sum over all membranes of a Context. */
    static std::vector<double> sumVirials(OpenMM::ContextImpl& context, int groups);
    /**
     * Try to flip edges.
     *
     * @param subject    the class that messages shall name
     * @param context    the Context
     * @param groups     a bit for each force group whose members' energy counts
     * @param positions  of all particles, nm
     * @param rules      what flips may do
     * @param attempts   how many to try
     * @param state      what has come of flips so far, and the random numbers
     * @param forceChange  if it is not null and there are flips, receives the change of the forces, kJ/mol/nm
     * @return how many were made
     */
    int64_t flip(const std::string& subject, OpenMM::ContextImpl& context, int groups,
                 const std::vector<OpenMM::Vec3>& positions, const HelfrichFlipRules& rules, int64_t attempts,
                 HelfrichFlipState& state, std::vector<OpenMM::Vec3>* forceChange);
    /** Prepare sweeps of friction over the edges, for particles of these masses; the caller destroys it. */
    HelfrichViscosity* makeViscosity(const std::string& subject, const std::vector<double>& masses) const;
    /**
     * Let friction and noise act along the present edges.
     *
     * @param subject     the class that messages shall name
     * @param context     the Context
     * @param viscosity   what makeViscosity() has made
     * @param bath        friction and noise
     * @param positions   of all particles, nm; they change if the bath has a lag
     * @param velocities  of all particles, nm/ps
     * @param random      the random numbers
     */
    void sweep(const std::string& subject, OpenMM::ContextImpl& context, HelfrichViscosity& viscosity,
               const HelfrichEdgeBath& bath, std::vector<OpenMM::Vec3>& positions,
               std::vector<OpenMM::Vec3>& velocities, HelfrichStream& random);
    /**
     * Try to let neighbours exchange what they are, in all members.
     *
     * @param rules        how exchanges are accepted
     * @param state        what has come of them so far, and the random numbers
     * @param forceChange  as of flip(), and so is all else
     * @return how many were made
     */
    int64_t swap(const std::string& subject, OpenMM::ContextImpl& context, int groups,
                 const std::vector<OpenMM::Vec3>& positions, const HelfrichSwapRules& rules, int64_t attempts,
                 HelfrichSwapState& state, std::vector<OpenMM::Vec3>* forceChange);
    /** Bring what a member has of each vertex, as the user made it, into the order that there is now. */
    void arrange(std::vector<double>& values) const;
    /** Note that values of a member have changed. */
    void forgetKinds() {
        kinds.clear();
    }
    /** Refuse rules that make no sense, or that the present triangles violate. */
    void checkRules(const std::string& subject, const HelfrichFlipRules& rules) const {
        check(Helfrich_Membrane_checkFlips(subject.c_str(), core, &rules));
    }
    /**
     * Take up what a Context before this one has left, if its State is the one that this Context has: so
     * Context::reinitialize() loses nothing. OpenMM tells no force when it has loaded a State; so this comes before the
     * first use of the connectivity, whichever that is, and from then on nothing is waiting.
     */
    void settle(OpenMM::ContextImpl& context);
    /** The corners of the triangles as they are now. */
    std::vector<int> getPresentTriangles(OpenMM::ContextImpl& context) {
        settle(context);
        return getConnectivity().corners;
    }
    /** The same without settling anything, for what is made before a State may be loaded. */
    std::vector<int> findTriangles() const {
        return getConnectivity().corners;
    }
    /** Go on with other triangles; if they are refused, everything stays as it was. */
    void setTriangles(const std::string& subject, OpenMM::ContextImpl& context, const std::vector<int>& corners);
    /** For each vertex the one whose values it has, as the user gave them. */
    std::vector<int> getPermutation(const std::string& subject, OpenMM::ContextImpl& context);
    /** Go on with another one; if it is refused, everything stays as it was. */
    void setPermutation(const std::string& subject, OpenMM::ContextImpl& context, const std::vector<int>& permutation);
    /** A number that tells the present triangles from others, 0 for those of the System. */
    double getFingerprint() const {
        return Helfrich_Membrane_fingerprint(core);
    }
    /** The same for the permutation, 0 where every vertex has its own values. */
    double getPermutationFingerprint() const {
        return permutationFingerprint;
    }
    /** Whether something has to be saved to go on with the same bits. */
    bool needsSaving() const;
    /** What restore() takes; SavedConnectivity.cpp has the format. */
    std::string save(OpenMM::ContextImpl& context);
    /** Go on with what had been saved; if it is refused, everything stays as it was. */
    void restore(const std::string& subject, OpenMM::ContextImpl& context, const std::string& saved);
    /** Save all membranes of a Context that need it. */
    static std::vector<std::string> saveAll(OpenMM::ContextImpl& context);
    /**
     * Restore all membranes of a Context. Those that had nothing to save have the triangles of the System again. If one
     * is refused, all stay as they were.
     */
    static void restoreAll(const std::string& subject, OpenMM::ContextImpl& context,
                           const std::vector<std::string>& saved);
    /** Refuse a term that cannot be evaluated on this membrane. */
    void checkTerm(const std::string& subject, const HelfrichTerm& term) const {
        check(Helfrich_Membrane_checkTerm(subject.c_str(), core, &term));
    }
    /** Refuse particles of a term that do not exist, come twice or are vertices. */
    void checkParticles(const std::string& subject, const HelfrichTerm& term) const {
        check(Helfrich_Membrane_checkParticles(subject.c_str(), core, &term));
    }
    const std::vector<int>& getTriangles() const {
        return triangles;
    }
    /** Whether its sides are nearest images in the periodic box. */
    bool isPeriodic() const;
    int64_t getNumEdges() const {
        return Helfrich_Membrane_numEdges(core);
    }
    /** Whether any member acts on what is near. */
    bool hasContacts() const;
    /** Whether it is settled that the processor evaluates it. */
    bool isOnProcessor() const {
        return Helfrich_Membrane_isOnProcessor(core) != 0;
    }
    /** Let a MembraneCrowd evaluate it, with one thread, where there are enough membranes for all threads. */
    void joinCrowd(bool isAlone);
    bool isInCrowd() const {
        return inCrowd;
    }
    /** Note what to compute; returns whether there is anything. */
    bool prepare(const Computation& computation);
    /** What prepare() has noted. */
    HelfrichTurn getTurn(const Computation& computation);
    /** The pairs of particles that edges connect. */
    std::vector<std::pair<int, int>> getEdges() const;

private:
    /** What a membrane leaves to the next Context, and how to tell the State that it belongs to. */
    struct Left {
        std::vector<int> triangles;
        /** The Context's parameters of its movers. */
        std::map<std::string, double> parameters;
        long long step;
        /** Of the positions, where an integrator has set a parameter back; otherwise 0. */
        uint64_t checksum;
        std::string saved;
    };
    /** What the Context that this thread has destroyed last has left. */
    struct Estate {
        const OpenMM::ContextImpl* context = nullptr;
        std::vector<Left> left;
        ~Estate();
    };
    static thread_local Estate estate;
    /** A Context may live longer, in a variable of the program. */
    static thread_local bool hasNoEstate;

    SharedMembrane(const std::string& subject, OpenMM::ContextImpl& context, const std::vector<int>& triangles);

    /** Choose what computes the forces: what one of them asks for, whichever joins first, or what holds for all. */
    void chooseForAll(const OpenMM::System& system);
    /**
     * Whether the members are forces of this very Context. When a Context cannot be made, OpenMM leaves
     * its forces behind and frees its memory, and the next Context may get the same address.
     */
    bool belongsTo(OpenMM::ContextImpl& context) const;
    /** A membrane whose triangles are some of another's, one after the other. */
    struct Link {
        std::weak_ptr<SharedMembrane> other;
        /** The place of the first of them. */
        int64_t firstTriangle;
        /** The fingerprint of the part that the whole has followed. */
        double followed;
    };
    /** Refuse a force that uses periodic boundary conditions if the members do not, or the other way round. */
    void checkAgreementWithMembers(const MembraneForceImpl& joining, const std::string& where) const;
    /** Note it if the triangles of one membrane are among those of another. */
    static void link(const std::shared_ptr<SharedMembrane>& whole, const std::shared_ptr<SharedMembrane>& part);
    /** Whether all members act on contacts, so that they may follow flips of parts. */
    bool hasOnlyContacts() const;
    /** Have the present triangles of all parts. */
    void followParts(OpenMM::ContextImpl& context);
    /** Any of its movers, or null. */
    const SurfaceMoverImpl* findMover() const;
    /** Refuse two triangulations of the same particles if one of them changes, unless it can follow the other. */
    static void refuseOthers(const std::string& subject, const SharedMembrane& one, const SharedMembrane& other);
    /** Refuse what has to be asked or told of the parts. */
    void refuseParts(const std::string& subject, const std::string& advice) const;
    /** Which members: those that the platform evaluates, all others, or both. */
    enum class Which { Native, Others, All };
    /** Note the members in some force groups, and their terms. */
    void collect(OpenMM::ContextImpl& context, int groups, Which which = Which::All);
    /** Refuse barostats that would tear a membrane that has been found to span the box. */
    void noteSpanning(const std::string& subject, OpenMM::ContextImpl& context);
    /** The vectors of the box that the members live in, nm, or null. */
    const double* findBox(OpenMM::ContextImpl& context);
    Connectivity getConnectivity() const;
    void setConnectivity(const std::string& subject, const Connectivity& connectivity);
    /** Refuse the present triangles if a mover cannot go on from there, and go back to others. */
    void checkMovers(const std::string& subject, const Connectivity& before);
    /** Let the vertices have each other's values, in all members. */
    void rearrange(const std::vector<uint32_t>& sources, uint64_t version);
    /** Go on with another permutation, empty for none. */
    void setPermutation(const std::vector<uint32_t>& wanted);
    /** Find which vertices are alike in all members; returns whether any of these says what vertices are. */
    bool findKinds();
    /** Take what has been saved of these triangles, or stay as before. The Context does not know yet. */
    void take(const std::string& subject, const SavedConnectivity& saved);
    /** The same of what forces give a new Context. */
    void startAgain(const std::string& subject);
    /** Tell the Context of another state, and let the movers go on from what has been saved, if anything. */
    void announce(OpenMM::ContextImpl& context, const SavedConnectivity* saved);
    /** The same, where the Context is being evaluated. */
    void tellMovers(OpenMM::ContextImpl& context, const SavedConnectivity* saved);
    /** Leave the connectivity to a Context that goes on with the same State. */
    void leaveBehind(OpenMM::ContextImpl& context);
    /** Let what has been left of this membrane wait for settle(). */
    void inherit();
    /** Whether a Context has the State that belongs to what has been left. */
    bool isHeir(OpenMM::ContextImpl& context) const;
    /** The smallest index of a particle, which stands for the membrane in what is saved. */
    int getSmallestParticle() const;

    std::vector<int> triangles;
    HelfrichMembrane* core;
    std::vector<MembraneForceImpl*> members;
    /** What the platform evaluates, or null. */
    std::unique_ptr<NativeMembrane> native;
    /** For each scalar of each term the number of the derivative that it adds to. */
    std::vector<int> derivativeNumbers;
    bool inCrowd;
    /** By their kinds, or null. */
    SurfaceMoverImpl* movers[NUM_MOVER_KINDS];
    /** What lets friction act along edges. */
    std::vector<SurfaceViscosityThermostatImpl*> thermostats;
    /** Whether one of them has left. */
    bool hasLeftBehind;
    /** As in Connectivity. */
    std::vector<uint32_t> permutation;
    double permutationFingerprint;
    /** A number for each vertex, the same for those that are alike; empty until they are asked for. */
    std::vector<uint32_t> kinds;
    /** Whether it has been found to span the box, and no barostat tears it. */
    bool spans;
    /** Membranes that this one is made up of, and those that it is part of. */
    std::vector<Link> parts, wholes;
    /** What waits to be taken up, or null. */
    std::unique_ptr<Left> inherited;
    /** OpenCL and CUDA evaluate on a thread of their own. */
    std::mutex settling;
    OpenMM::Vec3 box[3];
    std::vector<MembraneForceImpl*> active;
    std::vector<HelfrichTerm> terms;
    std::vector<HelfrichContribution> contributions;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SHARED_MEMBRANE_H_*/
