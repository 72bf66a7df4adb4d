#ifndef HELFRICH_VARIABLE_MASS_STEP_KERNEL_H_
#define HELFRICH_VARIABLE_MASS_STEP_KERNEL_H_

#include "HelfrichDynamics.h"
#include "SharedMembrane.h"
#include "openmm-helfrich/VariableMassLangevinIntegrator.h"
#include "openmm-helfrich/VariableMassVerletIntegrator.h"

#include <openmm/KernelFactory.h>
#include <openmm/reference/ReferencePlatform.h>

#include <memory>
#include <string>
#include <vector>

namespace HelfrichPlugin {

/** Makes the kernel of this file, for the platform Reference. */
class VariableMassKernelFactory : public OpenMM::KernelFactory {
public:
    OpenMM::KernelImpl* createKernelImpl(std::string name, const OpenMM::Platform& platform,
                                         OpenMM::ContextImpl& context) const;
};

/**
 * Time steps of variable masses in OpenMM's own arrays, on the platforms Reference and Helfrich.
 *
 * The state between two steps is OpenMM's, positions and velocities; momenta are made of these. What is kept besides,
 * the forces of the last step and the geometry of the plaquettes, are functions of it.
 */
class VariableMassStepKernel : public IntegrateVariableMassStepKernel {
public:
    VariableMassStepKernel(const std::string& name, const OpenMM::Platform& platform, OpenMM::ContextImpl& context);
    VariableMassStepKernel(const VariableMassStepKernel&) = delete;
    ~VariableMassStepKernel();
    void initialize(OpenMM::ContextImpl& context, const VariableMassIntegrator& integrator);
    void execute(OpenMM::ContextImpl& context, const VariableMassIntegrator& integrator, bool forcesAreValid);
    double computeKineticEnergy(OpenMM::ContextImpl& context);
    std::vector<double> computeMasses(OpenMM::ContextImpl& context);
    void createCheckpoint(std::ostream& stream) const;
    void loadCheckpoint(std::istream& stream);

private:
    /** Take over the triangles of all membranes, if they are others than before. */
    void findSurfaces(OpenMM::ContextImpl& context);
    /** The same, once it is settled which they are. */
    void findPresentSurfaces(OpenMM::ContextImpl& context);
    /** The arrays of the Context, where they are now. */
    HelfrichParticleArrays getParticles() const;
    /** The vectors of the box that surfaces live in, nm, or null. */
    const double* findBox() const;
    /** Make a step in place. */
    void advance(OpenMM::ContextImpl& context, double step, int groups);

    OpenMM::ReferencePlatform::PlatformData& data;
    std::string subject;
    /** The integrator, if it has a bath. */
    const VariableMassLangevinIntegrator* bath;
    HelfrichVariableMasses* masses;
    HelfrichTeam* team;
    std::vector<std::shared_ptr<SharedMembrane>> membranes;
    /** Of the triangles that the masses follow. */
    std::vector<double> fingerprints;
    bool isPeriodic, hasVirtualSites;
    /** The random numbers: those of the Context on platform Helfrich, else the ones here. */
    HelfrichStream* stream;
    HelfrichStream ownStream;
    /** The forces after the last step, their groups and the step; OpenMM's may have been overwritten. */
    std::vector<OpenMM::Vec3> forces;
    int forceGroups;
    long long stepCount;
    /** To go back to if a step fails. */
    std::vector<OpenMM::Vec3> oldPositions, oldVelocities;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_VARIABLE_MASS_STEP_KERNEL_H_*/
