#ifndef HELFRICH_VARIABLE_MASS_INTEGRATOR_PROXY_H_
#define HELFRICH_VARIABLE_MASS_INTEGRATOR_PROXY_H_

#include <openmm/serialization/SerializationProxy.h>

namespace HelfrichPlugin {

/** Writes a VariableMassVerletIntegrator to XML and reads it back. */
class VariableMassVerletIntegratorProxy : public OpenMM::SerializationProxy {
public:
    VariableMassVerletIntegratorProxy();
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;
};

/** The same for a VariableMassLangevinIntegrator. */
class VariableMassLangevinIntegratorProxy : public OpenMM::SerializationProxy {
public:
    VariableMassLangevinIntegratorProxy();
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_VARIABLE_MASS_INTEGRATOR_PROXY_H_*/
