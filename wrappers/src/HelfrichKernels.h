#ifndef HELFRICH_KERNELS_H_
#define HELFRICH_KERNELS_H_

#include "HelfrichPlatform.h"

#include <openmm/Kernel.h>
#include <openmm/KernelFactory.h>
#include <openmm/kernels.h>

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace HelfrichPlugin {

/** Makes the kernels of this file, and of VariableMassStepKernel.h. */
class HelfrichKernelFactory : public OpenMM::KernelFactory {
public:
    OpenMM::KernelImpl* createKernelImpl(std::string name, const OpenMM::Platform& platform,
                                         OpenMM::ContextImpl& context) const;
    /** What it can make. */
    static std::vector<std::string> getKernelNames();
};

/** Clears the forces before an evaluation. */
class HelfrichCalcForcesAndEnergyKernel : public OpenMM::CalcForcesAndEnergyKernel {
public:
    HelfrichCalcForcesAndEnergyKernel(const std::string& name, const OpenMM::Platform& platform,
                                      OpenMM::ContextImpl& context);
    void initialize(const OpenMM::System& system);
    void beginComputation(OpenMM::ContextImpl& context, bool includeForce, bool includeEnergy, int groups);
    double finishComputation(OpenMM::ContextImpl& context, bool includeForce, bool includeEnergy, int groups,
                             bool& valid);

private:
    HelfrichPlatform::PlatformData& data;
    /** Reference's kernel, for energies without forces, and for virtual sites. */
    OpenMM::Kernel reference;
    bool hasVirtualSites;
};

/** Reference's kernel, with the random streams of the Context in its checkpoints. */
class HelfrichUpdateStateDataKernel : public OpenMM::UpdateStateDataKernel {
public:
    HelfrichUpdateStateDataKernel(const std::string& name, const OpenMM::Platform& platform,
                                  OpenMM::ContextImpl& context);
    void initialize(const OpenMM::System& system);
    double getTime(const OpenMM::ContextImpl& context) const;
    void setTime(OpenMM::ContextImpl& context, double time);
    long long getStepCount(const OpenMM::ContextImpl& context) const;
    void setStepCount(const OpenMM::ContextImpl& context, long long count);
    void getPositions(OpenMM::ContextImpl& context, std::vector<OpenMM::Vec3>& positions, bool allowPeriodic);
    void setPositions(OpenMM::ContextImpl& context, const std::vector<OpenMM::Vec3>& positions);
    void getVelocities(OpenMM::ContextImpl& context, std::vector<OpenMM::Vec3>& velocities);
    void setVelocities(OpenMM::ContextImpl& context, const std::vector<OpenMM::Vec3>& velocities);
    void computeShiftedVelocities(OpenMM::ContextImpl& context, double timeShift,
                                  std::vector<OpenMM::Vec3>& velocities);
    void getForces(OpenMM::ContextImpl& context, std::vector<OpenMM::Vec3>& forces);
    void getEnergyParameterDerivatives(OpenMM::ContextImpl& context, std::map<std::string, double>& derivs);
    void getPeriodicBoxVectors(OpenMM::ContextImpl& context, OpenMM::Vec3& a, OpenMM::Vec3& b, OpenMM::Vec3& c) const;
    void setPeriodicBoxVectors(OpenMM::ContextImpl& context, const OpenMM::Vec3& a, const OpenMM::Vec3& b,
                               const OpenMM::Vec3& c);
    void createCheckpoint(OpenMM::ContextImpl& context, std::ostream& stream);
    void loadCheckpoint(OpenMM::ContextImpl& context, std::istream& stream);

private:
    /** Read what Reference's checkpoint does not have. */
    void loadOurs(OpenMM::ContextImpl& context, std::istream& stream);

    HelfrichPlatform::PlatformData& data;
    OpenMM::Kernel kernel;
    /** What the kernel refers to. */
    OpenMM::UpdateStateDataKernel& reference;
};

/**
 * What the kernels of integrators share. Constraints and virtual sites are left to Reference's kernels, kinetic
 * energies too.
 */
class TimeStep {
public:
    TimeStep(const std::string& name, const OpenMM::Platform& platform, OpenMM::ContextImpl& context);
    TimeStep(const TimeStep&) = delete;
    ~TimeStep();
    void initialize(const OpenMM::System& system);
    /** Whether Reference's kernel has to do all steps. */
    bool isDelegated() const {
        return dynamics == nullptr;
    }
    /** The arrays of the Context, where they are now. */
    HelfrichParticleArrays getParticles() const;
    /** Note that a step has been made. */
    void advance(double time);

    HelfrichPlatform::PlatformData& data;
    OpenMM::Kernel reference;
    /** Null if steps are delegated. */
    HelfrichDynamics* dynamics;
};

class HelfrichIntegrateVerletStepKernel : public OpenMM::IntegrateVerletStepKernel {
public:
    HelfrichIntegrateVerletStepKernel(const std::string& name, const OpenMM::Platform& platform,
                                      OpenMM::ContextImpl& context);
    void initialize(const OpenMM::System& system, const OpenMM::VerletIntegrator& integrator);
    void execute(OpenMM::ContextImpl& context, const OpenMM::VerletIntegrator& integrator);
    double computeKineticEnergy(OpenMM::ContextImpl& context, const OpenMM::VerletIntegrator& integrator);

private:
    TimeStep step;
};

class HelfrichIntegrateLangevinMiddleStepKernel : public OpenMM::IntegrateLangevinMiddleStepKernel {
public:
    HelfrichIntegrateLangevinMiddleStepKernel(const std::string& name, const OpenMM::Platform& platform,
                                              OpenMM::ContextImpl& context);
    void initialize(const OpenMM::System& system, const OpenMM::LangevinMiddleIntegrator& integrator);
    void execute(OpenMM::ContextImpl& context, const OpenMM::LangevinMiddleIntegrator& integrator);
    double computeKineticEnergy(OpenMM::ContextImpl& context, const OpenMM::LangevinMiddleIntegrator& integrator);

private:
    TimeStep step;
    HelfrichStream* stream;
};

class HelfrichIntegrateBrownianStepKernel : public OpenMM::IntegrateBrownianStepKernel {
public:
    HelfrichIntegrateBrownianStepKernel(const std::string& name, const OpenMM::Platform& platform,
                                        OpenMM::ContextImpl& context);
    void initialize(const OpenMM::System& system, const OpenMM::BrownianIntegrator& integrator);
    void execute(OpenMM::ContextImpl& context, const OpenMM::BrownianIntegrator& integrator);
    double computeKineticEnergy(OpenMM::ContextImpl& context, const OpenMM::BrownianIntegrator& integrator);

private:
    TimeStep step;
    HelfrichStream* stream;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_KERNELS_H_*/
