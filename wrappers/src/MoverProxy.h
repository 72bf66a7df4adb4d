#ifndef HELFRICH_MOVER_PROXY_H_
#define HELFRICH_MOVER_PROXY_H_

#include <openmm/serialization/SerializationProxy.h>

namespace HelfrichPlugin {

/** Writes a mover, or a thermostat, to XML and reads it back; MoverProxy.cpp says what each class has. */
template <class Mover>
class MoverProxy : public OpenMM::SerializationProxy {
public:
    MoverProxy();
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MOVER_PROXY_H_*/
