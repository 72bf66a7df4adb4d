#ifndef HELFRICH_VARIABLE_MASS_KERNEL_H_
#define HELFRICH_VARIABLE_MASS_KERNEL_H_

#include <openmm/KernelImpl.h>
#include <openmm/internal/ContextImpl.h>

#include <iosfwd>
#include <string>
#include <vector>

namespace HelfrichPlugin {

class VariableMassIntegrator;

/**
 * What integrators of variable masses ask of a platform. Like forces, integrators are compiled into several libraries,
 * and what implements this into the plugin only.
 */
class IntegrateVariableMassStepKernel : public OpenMM::KernelImpl {
public:
    static std::string Name() {
        return "IntegrateVariableMassStep";
    }
    IntegrateVariableMassStepKernel(const std::string& name, const OpenMM::Platform& platform)
        : KernelImpl(name, platform) {
    }
    /** Take over the masses of the System and the surfaces of the Context, whose forces are there already. */
    virtual void initialize(OpenMM::ContextImpl& context, const VariableMassIntegrator& integrator) = 0;
    /** Make a time step; `forcesAreValid` if nothing has happened since the last one. */
    virtual void execute(OpenMM::ContextImpl& context, const VariableMassIntegrator& integrator,
                         bool forcesAreValid) = 0;
    /** kJ/mol. */
    virtual double computeKineticEnergy(OpenMM::ContextImpl& context) = 0;
    /** Of all particles at the present positions, amu. */
    virtual std::vector<double> computeMasses(OpenMM::ContextImpl& context) = 0;
    /** Write the random numbers, unless the platform's checkpoints have them. */
    virtual void createCheckpoint(std::ostream& stream) const = 0;
    virtual void loadCheckpoint(std::istream& stream) = 0;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_VARIABLE_MASS_KERNEL_H_*/
