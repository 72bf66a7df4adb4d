#ifndef HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_PROXY_H_
#define HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_PROXY_H_

#include <openmm/serialization/SerializationProxy.h>

namespace HelfrichPlugin {

/** Writes a MonteCarloMembraneTension to XML and reads it back. */
class MonteCarloMembraneTensionProxy : public OpenMM::SerializationProxy {
public:
    MonteCarloMembraneTensionProxy();
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_PROXY_H_*/
