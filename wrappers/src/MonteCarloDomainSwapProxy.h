#ifndef HELFRICH_MONTE_CARLO_DOMAIN_SWAP_PROXY_H_
#define HELFRICH_MONTE_CARLO_DOMAIN_SWAP_PROXY_H_

#include <openmm/serialization/SerializationProxy.h>

namespace HelfrichPlugin {

/** Writes a MonteCarloDomainSwap to XML and reads it back. */
class MonteCarloDomainSwapProxy : public OpenMM::SerializationProxy {
public:
    MonteCarloDomainSwapProxy();
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_DOMAIN_SWAP_PROXY_H_*/
