#ifndef HELFRICH_VARIABLE_MASS_INTEGRATOR_H_
#define HELFRICH_VARIABLE_MASS_INTEGRATOR_H_

#include "internal/Core.h"
#include "internal/VariableMassKernel.h"

#include <openmm/Integrator.h>
#include <openmm/Kernel.h>
#include <openmm/OpenMMException.h>
#include <openmm/Platform.h>
#include <openmm/System.h>

#include <cmath>
#include <string>
#include <vector>

namespace HelfrichPlugin {

/**
 * What VariableMassVerletIntegrator and VariableMassLangevinIntegrator have in common: the masses of vertices follow
 * the areas of their plaquettes.
 */
class VariableMassIntegrator : public OpenMM::Integrator {
public:
    /**
     * Get the mass per area of surfaces, amu/nm^2, or 0 if each surface keeps its mass.
     */
    double getDensity() const {
        return density;
    }
    /**
     * Set the mass per area of surfaces, amu/nm^2, for Contexts that are made from now on: a vertex has the mass
     * density times its area. With 0 each connected surface keeps the mass M that its vertices have in the System
     * together, and a vertex has M times its share of the area.
     */
    void setDensity(double density) {
        if (!(density >= 0 && std::isfinite(density)))
            fail("density must be a finite number of amu/nm^2, or 0 for surfaces of constant mass, got " +
                 formatted(density));
        this->density = density;
    }
    /**
     * Get the masses that the particles of the Context have at its present positions, amu; 0 for those that do not
     * move.
     */
    std::vector<double> getMasses() const {
        checkBound();
        return getKernel().computeMasses(*context);
    }
    /**
     * Advance a simulation through time by taking a series of time steps.
     *
     * @param steps  the number of time steps to take
     */
    void step(int steps) {
        checkBound();
        for (int i = 0; i < steps; i++) {
            bool areValid = !context->updateContextState() && forcesAreValid;
            forcesAreValid = false;
            getKernel().execute(*context, *this, areValid);
            forcesAreValid = true;
        }
    }
    /**
     * Get the name of the class, as messages and XML have it.
     */
    const std::string& getTypeName() const {
        return type;
    }

protected:
    VariableMassIntegrator(const std::string& type, double stepSize, double density)
        : type(type), density(0), isBound(false), forcesAreValid(false) {
        if (!(stepSize >= 0 && std::isfinite(stepSize)))
            fail("stepSize must be a finite number of ps, zero or above, got " + formatted(stepSize));
        setStepSize(stepSize);
        setConstraintTolerance(1e-5);
        setDensity(density);
    }
    [[noreturn]] void fail(const std::string& message) const {
        throw OpenMM::OpenMMException(type + ": " + message);
    }
#ifndef SWIG
    void initialize(OpenMM::ContextImpl& contextImpl) {
        if (owner != nullptr && &contextImpl.getOwner() != owner)
            fail("it belongs to another Context already; each Context needs an Integrator of its own");
        const OpenMM::Platform& platform = contextImpl.getPlatform();
        if (!platform.supportsKernels({IntegrateVariableMassStepKernel::Name()}))
            fail("the platform " + platform.getName() + " has no such time steps; make the Context with the platform " +
                 "Helfrich or Reference, and call Helfrich_register() before (Python does by itself)");
        context = &contextImpl;
        owner = &contextImpl.getOwner();
        kernel = platform.createKernel(IntegrateVariableMassStepKernel::Name(), contextImpl);
        forcesAreValid = false;
        try {
            getKernel().initialize(contextImpl, *this);
        } catch (...) {
            // There will be no Context that the destructor could tell of its end.
            kernel = OpenMM::Kernel();
            context = nullptr;
            owner = nullptr;
            throw;
        }
        isBound = true;
    }
    void cleanup() {
        kernel = OpenMM::Kernel();
        isBound = false;
    }
    /** None, for the platform to be refused with a reason. */
    std::vector<std::string> getKernelNames() {
        return {};
    }
    void stateChanged(OpenMM::State::DataType) {
        forcesAreValid = false;
    }
    double computeKineticEnergy() {
        return getKernel().computeKineticEnergy(*context);
    }
    bool kineticEnergyRequiresForce() const {
        return false;
    }
    /** Momenta of the Maxwell distribution, with the masses at the present positions. */
    std::vector<OpenMM::Vec3> getVelocitiesForTemperature(const OpenMM::System& system, double temperature,
                                                          int randomSeed) const {
        std::vector<OpenMM::Vec3> velocities = Integrator::getVelocitiesForTemperature(system, temperature, randomSeed);
        std::vector<double> masses = getMasses();
        // They are those of the System's masses.
        for (size_t i = 0; i < masses.size(); i++)
            if (masses[i] != 0)
                velocities[i] *= std::sqrt(system.getParticleMass((int) i) / masses[i]);
        return velocities;
    }
    void createCheckpoint(std::ostream& stream) const {
        getKernel().createCheckpoint(stream);
    }
    void loadCheckpoint(std::istream& stream) {
        getKernel().loadCheckpoint(stream);
    }
#endif

private:
    void checkBound() const {
        if (!isBound)
            fail("it is not bound to a Context");
    }
    IntegrateVariableMassStepKernel& getKernel() const {
        return kernel.getAs<IntegrateVariableMassStepKernel>();
    }

    std::string type;
    double density;
    /** OpenMM asks for kinetic energies and velocities through const methods. */
    mutable OpenMM::Kernel kernel;
    bool isBound, forcesAreValid;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_VARIABLE_MASS_INTEGRATOR_H_*/
