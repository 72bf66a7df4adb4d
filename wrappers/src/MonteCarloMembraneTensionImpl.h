#ifndef HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_IMPL_H_
#define HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_IMPL_H_

#include "ScaledBodies.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"

#include <openmm/internal/ForceImpl.h>

#include <memory>
#include <vector>

namespace HelfrichPlugin {

/** The state of a MonteCarloMembraneTension in a Context. Checkpoints hold it as it lies in memory. */
struct TensionState {
    /** Of moves of one kind: XYIndependent has two, x and y. */
    struct Kind {
        /** How far a move goes at most; 0 before the first. */
        double width;
        /** Moves since the width was last changed. */
        int64_t tried, taken;
    };
    /** The seed, and a number that tells movers of the same seed apart. */
    uint32_t key[2];
    /** How many updates of the Context's state there were since a move was last tried. */
    int64_t updates;
    int64_t attempts, accepted;
    Kind kinds[2];
};

static_assert(sizeof(TensionState) == 80, "the state of a mover has no gaps");

/** Changes the periodic box at constant tension. */
class MonteCarloMembraneTensionImpl : public OpenMM::ForceImpl,
                                      public UpdatableImpl,
                                      public StatisticsImpl,
                                      public StateImpl {
public:
    explicit MonteCarloMembraneTensionImpl(const MonteCarloMembraneTension& owner);
    void initialize(OpenMM::ContextImpl& context);
    const MonteCarloMembraneTension& getOwner() const {
        return owner;
    }
    void updateContextState(OpenMM::ContextImpl& context, bool& forcesInvalid);
    double calcForcesAndEnergy(OpenMM::ContextImpl&, bool, bool, int) {
        return 0;
    }
    std::map<std::string, double> getDefaultParameters();
    std::vector<std::string> getKernelNames() {
        return {};
    }
    void updateParametersInContext(OpenMM::ContextImpl& context);
    std::map<std::string, double> getStatistics(OpenMM::ContextImpl& context) const;
    std::string saveState() const;
    void restoreState(const std::string& saved);
    /** The states of all movers of a Context, in their order. */
    static std::vector<TensionState> saveAll(const OpenMM::ContextImpl& context);
    /** Let the movers of a Context go on from there; where one is missing on either side, the others do. */
    static void restoreAll(const OpenMM::ContextImpl& context, const std::vector<TensionState>& states);

private:
    /** A change of the box. */
    struct Move {
        int kind;
        /** What is changed uniformly by at most a width: an area, a length or a logarithm. */
        double value, change;
        /** By how much each axis is scaled. */
        OpenMM::Vec3 scale;
        /** tau dA_p or f dL, kJ/mol. */
        double work;
    };

    /** Copy the values of the force that may change. */
    void copyValues();
    /** A Context parameter, which must be finite. */
    double getFinite(OpenMM::ContextImpl& context, const std::string& name) const;
    /** The potential energy that integrators see, kJ/mol. */
    double getEnergy(OpenMM::ContextImpl& context) const;
    /** Choose a move by two random numbers in [0, 1). */
    Move choose(OpenMM::ContextImpl& context, const OpenMM::Vec3 box[3], double first, double second);
    /** Make the move of the Context, or leave it as it was. */
    bool attempt(OpenMM::ContextImpl& context, const OpenMM::Vec3 box[3], const Move& move, double chance);
    /** Put particles and box where they shall be. */
    void place(OpenMM::ContextImpl& context, const OpenMM::Vec3 box[3], const std::vector<OpenMM::Vec3>& positions);
    /** Adapt the width of one kind of moves. */
    void adapt(const Move& move, bool accepted);

    const MonteCarloMembraneTension& owner;
    const MonteCarloMembraneTension::Axes axes;
    const bool rigidMolecules;
    TensionState state;
    int frequency, adaptiveMoves;
    /** What is scaled, found before the first move: OpenMM knows molecules when all forces are there. */
    std::unique_ptr<ScaledBodies> bodies;
    bool hasVirtualSites;
    /** OpenMM's own array of doubles, on Reference and what derives from it, or else null. */
    std::vector<OpenMM::Vec3>* inPlace;
    std::vector<OpenMM::Vec3> before, after;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_IMPL_H_*/
