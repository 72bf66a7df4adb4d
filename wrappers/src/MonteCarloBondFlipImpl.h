#ifndef HELFRICH_MONTE_CARLO_BOND_FLIP_IMPL_H_
#define HELFRICH_MONTE_CARLO_BOND_FLIP_IMPL_H_

#include "SharedMembrane.h"
#include "openmm-helfrich/MonteCarloBondFlip.h"

#include <openmm/internal/ForceImpl.h>

namespace HelfrichPlugin {

/** What a MonteCarloBondFlip has come to in a Context. Checkpoints hold it as it lies in memory. */
struct MoverState {
    HelfrichFlipState flips;
    /** How many updates of the Context's state there were since flips were last tried. */
    int64_t updates;
    /** How many times flips were tried. */
    int64_t rounds;
    /** The time that has been simulated, ps. */
    double time;
};

static_assert(sizeof(MoverState) == 104, "the state of a mover has no gaps");

/** Flips edges of a membrane. */
class MonteCarloBondFlipImpl : public OpenMM::ForceImpl,
                               public UpdatableImpl,
                               public ConnectivityImpl,
                               public StatisticsImpl {
public:
    explicit MonteCarloBondFlipImpl(const MonteCarloBondFlip& owner);
    ~MonteCarloBondFlipImpl();
    void initialize(OpenMM::ContextImpl& context);
    const MonteCarloBondFlip& getOwner() const {
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
    std::vector<int> getTrianglesInContext(OpenMM::ContextImpl& context) const {
        return membrane->getPresentTriangles(context);
    }
    void setTrianglesInContext(OpenMM::ContextImpl& context, const std::vector<int>& corners) {
        membrane->setTriangles(owner.getTypeName(), context, corners);
    }
    std::string saveConnectivity(OpenMM::ContextImpl& context) const {
        return membrane->save(context);
    }
    void restoreConnectivity(OpenMM::ContextImpl& context, const std::string& saved) {
        membrane->restore(owner.getTypeName(), context, saved);
    }
    std::vector<double> getVirial(OpenMM::ContextImpl& context, int groups) const {
        return SharedMembrane::sumVirials(context, groups);
    }
    const HelfrichFlipRules& getRules() const {
        return rules;
    }
    /** What has come of flips until now. */
    MoverState getState(OpenMM::ContextImpl& context) const;
    /** Go on from there. */
    void setState(const MoverState& restored);
    /** Let the Context's parameter say which triangles there are. */
    void announceConnectivity(OpenMM::ContextImpl& context);
    /** The Context's parameter for the triangles. */
    double getAnnounced(OpenMM::ContextImpl& context);
    /** Whether the parameter is that of the present triangles, or one that the integrator has set back. */
    bool isRight(OpenMM::ContextImpl& context);
    /** The name of that parameter. The force itself may be gone when a Context is destroyed. */
    const std::string& getConnectivityParameter() const {
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

private:
    /** Copy the values of the force; if they are refused, everything stays as it was. */
    void copyValues();
    /** Refuse to go on if the parameter says that the Context's State belongs to other triangles. */
    void checkConnectivity(OpenMM::ContextImpl& context);
    /** Whether the Context has been stepped from when the parameter was found right, and no State was loaded. */
    bool hasGoneOn(OpenMM::ContextImpl& context) const;
    /** The time since the last update, ps, or 0 if time has jumped. */
    double getTimeSinceUpdate(OpenMM::ContextImpl& context) const;
    /**
     * Give velocities of half a step ago half of the kick of the forces before the flips, in place of that of the
     * forces after them, which the integrator will give for the whole step: as if the flips came between two half
     * kicks.
     */
    void shareKick(OpenMM::ContextImpl& context, double stepSize);

    const MonteCarloBondFlip& owner;
    /** Where the forces are; null before they have been initialised. */
    OpenMM::ContextImpl* home;
    std::string parameter;
    std::shared_ptr<SharedMembrane> membrane;
    MoverState state;
    HelfrichFlipRules rules;
    int frequency;
    double attemptsPerEdge;
    /** Whether positions are OpenMM's own array of doubles. */
    bool inPlace;
    std::vector<OpenMM::Vec3> positions, velocities;
    /** Of the particles that move. */
    std::vector<std::pair<int, double>> inverseMasses;
    /** By how much flips have changed forces, kJ/mol/nm. */
    std::vector<OpenMM::Vec3> forceChange;
    /** Where OpenMM keeps that parameter, once it is there. */
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

#endif /*HELFRICH_MONTE_CARLO_BOND_FLIP_IMPL_H_*/
