#ifndef HELFRICH_MONTE_CARLO_BOND_FLIP_PROXY_H_
#define HELFRICH_MONTE_CARLO_BOND_FLIP_PROXY_H_

#include <openmm/serialization/SerializationProxy.h>

namespace HelfrichPlugin {

/** Writes a MonteCarloBondFlip to XML and reads it back. */
class MonteCarloBondFlipProxy : public OpenMM::SerializationProxy {
public:
    MonteCarloBondFlipProxy();
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_BOND_FLIP_PROXY_H_*/
