#ifndef HELFRICH_INTEGRATORS_H_
#define HELFRICH_INTEGRATORS_H_

#include <openmm/CompoundIntegrator.h>
#include <openmm/internal/ContextImpl.h>

#include <string>
#include <typeinfo>

namespace HelfrichPlugin {

/** Whether an integrator has many copies of the System, each with its own positions. */
inline bool isOfCopies(const OpenMM::Integrator& integrator) {
    // Its plugin is not linked; the name of a class is part of what compilers call its type.
    return std::string(typeid(integrator).name()).find("RPMDIntegrator") != std::string::npos;
}

/** The integrator that makes the present step. */
inline const OpenMM::Integrator& findIntegrator(OpenMM::ContextImpl& context) {
    const OpenMM::Integrator& integrator = context.getIntegrator();
    auto* compound = dynamic_cast<const OpenMM::CompoundIntegrator*>(&integrator);
    return compound == nullptr ? integrator : compound->getIntegrator(compound->getCurrentIntegrator());
}

} // namespace HelfrichPlugin

#endif /*HELFRICH_INTEGRATORS_H_*/
