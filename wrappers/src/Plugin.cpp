#include "ForceFactory.h"
#include "MembraneForceImpl.h"
#include "MembraneForceProxy.h"

#include <openmm/Platform.h>

#include <iostream>
#include <typeinfo>

using namespace HelfrichPlugin;

namespace {

template <class ForceClass>
void registerForce(const std::string& name) {
    OpenMM::SerializationProxy::registerProxy(typeid(ForceClass), new MembraneForceProxy(name, makeForce<ForceClass>));
}

} // namespace

// The core exports these under names that OpenMM's plugin loader and the force classes look for.
extern "C" {

int helfrich_shim_registerSerialization() {
    std::string found = OpenMM::Platform::getOpenMMVersion();
    if (found != HELFRICH_OPENMM_VERSION) {
        std::cerr << "openmm-helfrich was built against OpenMM " << HELFRICH_OPENMM_VERSION
                  << " and cannot be used with OpenMM " << found << ". Rebuild it against this version.\n";
        return 1;
    }
#define REGISTER(ForceClass) registerForce<ForceClass>(#ForceClass);
    HELFRICH_FORCES(REGISTER)
#undef REGISTER
    return 0;
}

void* helfrich_shim_createImpl(const void* force) {
    try {
        OpenMM::ForceImpl* impl = new MembraneForceImpl(*static_cast<const MembraneForce*>(force));
        return impl;
    } catch (const std::exception& error) {
        helfrich_setLastError(error.what());
        return nullptr;
    }
}
}
