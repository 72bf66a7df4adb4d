#ifndef HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_IMPL_H_
#define HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_IMPL_H_

#include "HelfrichDynamics.h"
#include "OnMembrane.h"
#include "openmm-helfrich/SurfaceViscosityThermostat.h"

#include <openmm/internal/ForceImpl.h>

#include <vector>

namespace HelfrichPlugin {

/** What a SurfaceViscosityThermostat has come to in a Context. Checkpoints hold it as it lies in memory. */
struct ViscosityState {
    /** A draw is a sweep over all edges. */
    HelfrichStream random;
    /** How many updates of the Context's state there were since the last sweep. */
    int64_t updates;
};

static_assert(sizeof(ViscosityState) == 24, "the state of a thermostat has no gaps");

/** Lets friction and noise act along the edges of a membrane. */
class SurfaceViscosityThermostatImpl : public OpenMM::ForceImpl,
                                       public UpdatableImpl,
                                       public OnMembrane,
                                       public StateImpl {
public:
    explicit SurfaceViscosityThermostatImpl(const SurfaceViscosityThermostat& owner);
    ~SurfaceViscosityThermostatImpl();
    void initialize(OpenMM::ContextImpl& context);
    const SurfaceViscosityThermostat& getOwner() const {
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
    std::string saveState() const;
    void restoreState(const std::string& saved);
    /** What all thermostats of a Context have come to, in their order. */
    static std::vector<ViscosityState> saveAll(const OpenMM::ContextImpl& context);
    /** Let the thermostats of a Context go on from there; where one is missing on either side, the others do. */
    static void restoreAll(const OpenMM::ContextImpl& context, const std::vector<ViscosityState>& states);

private:
    /** The friction that the Context has now, amu/ps. */
    double getFriction(OpenMM::ContextImpl& context) const;

    const SurfaceViscosityThermostat& owner;
    const std::string frictionParameter;
    HelfrichViscosity* viscosity;
    ViscosityState state;
    int frequency;
    bool hasVirtualSites;
    /** OpenMM's own arrays of doubles, on Reference and what derives from it, or else copies. */
    std::vector<OpenMM::Vec3>*positions, *velocities;
    std::vector<OpenMM::Vec3> copies[2];
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_IMPL_H_*/
