#ifndef HELFRICH_MEMBRANE_FORCE_PROXY_H_
#define HELFRICH_MEMBRANE_FORCE_PROXY_H_

#include "openmm-helfrich/MembraneForce.h"

#include <openmm/serialization/SerializationProxy.h>

namespace HelfrichPlugin {

/**
 * Writes any membrane force to XML and reads it back, scalars and form by their names. One object of
 * this class is registered for each force class.
 */
class MembraneForceProxy : public OpenMM::SerializationProxy {
public:
    /** Makes a force with any allowed scalars, to be overwritten by those that are read. */
    typedef MembraneForce* (*Factory)();
    MembraneForceProxy(const std::string& forceName, Factory create);
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;

private:
    void readForce(const OpenMM::SerializationNode& node, MembraneForce& force) const;
    void readParameters(const OpenMM::SerializationNode& parameters, MembraneForce& force) const;
    void readOtherParticles(const OpenMM::SerializationNode& node, MembraneForce& force) const;
    std::string forceName;
    Factory create;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MEMBRANE_FORCE_PROXY_H_*/
