#ifndef HELFRICH_INTEGRATORS_H_
#define HELFRICH_INTEGRATORS_H_

#include <openmm/CompoundIntegrator.h>
#include <openmm/DPDIntegrator.h>
#include <openmm/LangevinMiddleIntegrator.h>
#include <openmm/NoseHooverIntegrator.h>
#include <openmm/QTBIntegrator.h>
#include <openmm/VariableLangevinIntegrator.h>
#include <openmm/VariableVerletIntegrator.h>
#include <openmm/VerletIntegrator.h>
#include <openmm/internal/ContextImpl.h>

#include <string>
#include <typeinfo>

namespace HelfrichPlugin {

/** Whether an integrator has many copies of the System, each with its own positions. */
inline bool isOfCopies(const OpenMM::Integrator& integrator) {
    // Its plugin is not linked; the name of a class is part of what compilers call its type.
    return std::string(typeid(integrator).name()).find("RPMDIntegrator") != std::string::npos;
}

/** Whether an integrator keeps velocities of half a step ago and gives them the kick of a whole step at once. */
inline bool isLeapfrog(const OpenMM::Integrator& integrator) {
    return dynamic_cast<const OpenMM::VerletIntegrator*>(&integrator) != nullptr ||
        dynamic_cast<const OpenMM::LangevinMiddleIntegrator*>(&integrator) != nullptr ||
        dynamic_cast<const OpenMM::NoseHooverIntegrator*>(&integrator) != nullptr ||
        dynamic_cast<const OpenMM::DPDIntegrator*>(&integrator) != nullptr ||
        dynamic_cast<const OpenMM::QTBIntegrator*>(&integrator) != nullptr;
}

/** Whether it does so with steps that it chooses one by one: the half step ago is one of the step before. */
inline bool isVariableLeapfrog(const OpenMM::Integrator& integrator) {
    return dynamic_cast<const OpenMM::VariableVerletIntegrator*>(&integrator) != nullptr ||
        dynamic_cast<const OpenMM::VariableLangevinIntegrator*>(&integrator) != nullptr;
}

/** The integrator that makes the present step. */
inline const OpenMM::Integrator& findIntegrator(OpenMM::ContextImpl& context) {
    const OpenMM::Integrator& integrator = context.getIntegrator();
    auto* compound = dynamic_cast<const OpenMM::CompoundIntegrator*>(&integrator);
    return compound == nullptr ? integrator : compound->getIntegrator(compound->getCurrentIntegrator());
}

} // namespace HelfrichPlugin

#endif /*HELFRICH_INTEGRATORS_H_*/
