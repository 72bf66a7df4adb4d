#ifndef HELFRICH_SURFACE_MOVER_IMPL_H_
#define HELFRICH_SURFACE_MOVER_IMPL_H_

#include "OnMembrane.h"
#include "openmm-helfrich/MonteCarloSurfaceMover.h"
#include "openmm-helfrich/internal/UpdatableImpl.h"

#include <openmm/internal/ForceImpl.h>

namespace HelfrichPlugin {

/** Where a mover is between rounds. Checkpoints hold it as it lies in memory. */
struct MoverSchedule {
    /** How many updates of the Context's state there were since moves were last tried. */
    int64_t updates;
    /** How many times moves were tried. */
    int64_t rounds;
    /** The time that has been simulated, ps. */
    double time;
};

static_assert(sizeof(MoverSchedule) == 24, "the schedule of a mover has no gaps");

/**
 * What the implementations of movers of a surface have in common: when they act, and that the Context's State belongs
 * to the membrane's present connectivity or permutation, which it does not hold. A fingerprint of that is a parameter
 * of the Context.
 */
class SurfaceMoverImpl : public OpenMM::ForceImpl, public UpdatableImpl, public OnMembrane, public StatisticsImpl {
public:
    void initialize(OpenMM::ContextImpl& context);
    const MonteCarloSurfaceMover& getOwner() const {
        return owner;
    }
    void updateContextState(OpenMM::ContextImpl& context, bool& forcesInvalid);
    double calcForcesAndEnergy(OpenMM::ContextImpl& context, bool includeForces, bool includeEnergy, int groups);
    std::map<std::string, double> getDefaultParameters();
    std::vector<std::string> getKernelNames() {
        return {};
    }
    void updateParametersInContext(OpenMM::ContextImpl& context);
    std::map<std::string, double> getStatistics(OpenMM::ContextImpl& context) const;
    /** What it moves. */
    virtual MoverKind getKind() const = 0;
    /** Refuse the present triangles if it could not go on from there. */
    virtual void checkTriangles() const {
    }
    /** The fingerprint of what it moves; 0 for what the System has. */
    virtual double getFingerprint() const = 0;
    /** How long the state of a kind of movers is. */
    static size_t getStateSize(MoverKind kind);
    /** What has come of moves until now. */
    std::string getState(OpenMM::ContextImpl& context) const;
    /** Go on from there. */
    void setState(const std::string& restored);
    /** Set the Context's parameter to the present fingerprint. */
    void announce(OpenMM::ContextImpl& context);
    /** That parameter. */
    double getAnnounced(OpenMM::ContextImpl& context);
    /** Whether the parameter is right, or one that the integrator has set back. */
    bool isRight(OpenMM::ContextImpl& context);
    /** The name of that parameter. The force itself may be gone when a Context is destroyed. */
    const std::string& getParameter() const {
        return parameter;
    }
    /** Whether any step or evaluation has looked at the parameter. */
    bool isInUse() const {
        return announced != nullptr;
    }
    /** Whether positions are OpenMM's own array of doubles. */
    bool isInPlace() const {
        return inPlace;
    }

protected:
    /** Where a mover keeps its state. */
    struct Tally {
        void* data;
        size_t size;
        /** Of the random numbers, among the data. */
        uint32_t* key;
        /** The second word of the key of the first mover of a kind; integrators' streams count from zero. */
        uint32_t firstKey;
    };
    /**
     * @param owner        the force
     * @param temperature  the Context parameter of its temperature
     * @param parameter    that of the fingerprint
     * @param tally        its state
     */
    SurfaceMoverImpl(const MonteCarloSurfaceMover& owner, const std::string& temperature, const std::string& parameter,
                     const Tally& tally);
    /** Leave the membrane; derived classes do so first of all when they end, since it asks for what they have. */
    void leave();
    /** Copy the rules of the force; if they are refused, everything stays as it was. */
    virtual void copyRules() = 0;
    /**
     * Try moves.
     *
     * @param context      the Context
     * @param groups       a bit for each force group whose energy counts
     * @param positions    of all particles, nm
     * @param attempts     how many to try
     * @param forceChange  if it is not null and moves are made, receives the change of the forces, kJ/mol/nm
     * @return how many were made
     */
    virtual int64_t attempt(OpenMM::ContextImpl& context, int groups, const std::vector<OpenMM::Vec3>& positions,
                            int64_t attempts, std::vector<OpenMM::Vec3>* forceChange) = 0;
    /** What was tried, made and refused, by the names of statistics. */
    virtual std::map<std::string, double> getCounts() const = 0;
    /** What a Context's State belongs to if it is not what the Context has, and how to set that. */
    virtual std::string describeForeign() const = 0;
    /** kT of the bath, kJ/mol. */
    double findBath(OpenMM::ContextImpl& context) const;

private:
    /** Copy the values of the force; if they are refused, everything stays as it was. */
    void copyValues();
    /** Refuse to go on if the parameter says that the Context's State belongs to something else. */
    void checkAnnounced(OpenMM::ContextImpl& context);
    /** Whether the Context has been stepped from when the parameter was found right, and no State was loaded. */
    bool hasGoneOn(OpenMM::ContextImpl& context) const;
    /** The time since the last update, ps, or 0 if time has jumped. */
    double getTimeSinceUpdate(OpenMM::ContextImpl& context) const;
    /**
     * Give velocities of half a step ago half of the kick of the forces before the moves, in place of that of the
     * forces after them, which the integrator will give for the whole step: as if the moves came between two half
     * kicks.
     */
    void shareKick(OpenMM::ContextImpl& context, double stepSize);

    const MonteCarloSurfaceMover& owner;
    /** Where the forces are; null before they have been initialised. */
    OpenMM::ContextImpl* home;
    std::string temperature, parameter;
    Tally tally;
    MoverSchedule schedule;
    int frequency;
    double attemptsPerEdge;
    /** Whether positions are OpenMM's own array of doubles. */
    bool inPlace;
    std::vector<OpenMM::Vec3> positions, velocities;
    /** Of the particles that move. */
    std::vector<std::pair<int, double>> inverseMasses;
    /** By how much moves have changed forces, kJ/mol/nm. */
    std::vector<OpenMM::Vec3> forceChange;
    /** Where OpenMM keeps the parameter, once it is there. */
    const double* announced;
    /** What it should be, and what it was when a step began, which it may become again: see mayRevert. */
    double present, replaced;
    /** Whether the integrator sets parameters back that change during a step. */
    bool mayRevert;
    /** When the parameter was last found right, and when the step thereafter ends. */
    double seenTime, nextTime;
    long long seenStep;
    /** When the Context's state was last updated. */
    double lastTime;
    long long lastStep;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SURFACE_MOVER_IMPL_H_*/
