#ifndef HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_PROXY_H_
#define HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_PROXY_H_

#include <openmm/serialization/SerializationProxy.h>

namespace HelfrichPlugin {

/** Writes a SurfaceViscosityThermostat to XML and reads it back. */
class SurfaceViscosityThermostatProxy : public OpenMM::SerializationProxy {
public:
    SurfaceViscosityThermostatProxy();
    void serialize(const void* object, OpenMM::SerializationNode& node) const;
    void* deserialize(const OpenMM::SerializationNode& node) const;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_PROXY_H_*/
