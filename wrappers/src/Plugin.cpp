#include "ForceFactory.h"
#include "HelfrichPlatform.h"
#include "MembraneForceImpl.h"
#include "MembraneForceProxy.h"
#include "MonteCarloBondFlipImpl.h"
#include "MonteCarloDomainSwapImpl.h"
#include "MonteCarloMembraneTensionImpl.h"
#include "MoverProxy.h"
#include "PlatformChoice.h"
#include "Shim.h"
#include "SurfaceViscosityThermostatImpl.h"
#include "VariableMassIntegratorProxy.h"
#include "VariableMassStepKernel.h"

#include <openmm/Platform.h>

#include <iostream>
#include <typeinfo>

using namespace HelfrichPlugin;

namespace {

template <class ForceClass>
void registerForce(const std::string& name) {
    OpenMM::SerializationProxy::registerProxy(typeid(ForceClass), new MembraneForceProxy(name, makeForce<ForceClass>));
}

template <class Mover>
void registerMover() {
    OpenMM::SerializationProxy::registerProxy(typeid(Mover), new MoverProxy<Mover>());
}

/** The OpenMM that may load this: the one of the build, unless another is known to have the same interface. */
std::string& acceptedVersion() {
    static std::string version = HELFRICH_OPENMM_VERSION;
    return version;
}

bool isRightVersion() {
    return OpenMM::Platform::getOpenMMVersion() == acceptedVersion();
}

/** This plugin's platform, or null: the library may be in memory twice, and the first copy has registered it. */
HelfrichPlatform* findPlatform() {
    for (int i = 0; i < OpenMM::Platform::getNumPlatforms(); i++)
        if (auto* platform = dynamic_cast<HelfrichPlatform*>(&OpenMM::Platform::getPlatform(i)))
            return platform;
    return nullptr;
}

} // namespace

// The core exports these under names that OpenMM's plugin loader and the force classes look for.
extern "C" {

void helfrich_shim_acceptOpenMM(const char* version) {
    acceptedVersion() = version;
}

Helfrich_Status helfrich_shim_registerSerialization() {
    if (!isRightVersion()) {
        std::cerr << "openmm-helfrich was built against OpenMM " << HELFRICH_OPENMM_VERSION
                  << " and cannot be used with OpenMM " << OpenMM::Platform::getOpenMMVersion()
                  << ". Rebuild it against this version.\n";
        return Helfrich_Failure;
    }
#define REGISTER(ForceClass) registerForce<ForceClass>(#ForceClass);
    HELFRICH_FORCES(REGISTER)
#undef REGISTER
    registerMover<MonteCarloBondFlip>();
    registerMover<MonteCarloDomainSwap>();
    registerMover<MonteCarloMembraneTension>();
    registerMover<SurfaceViscosityThermostat>();
    OpenMM::SerializationProxy::registerProxy(typeid(VariableMassVerletIntegrator),
                                              new VariableMassVerletIntegratorProxy());
    OpenMM::SerializationProxy::registerProxy(typeid(VariableMassLangevinIntegrator),
                                              new VariableMassLangevinIntegratorProxy());
    // A second copy of the library in memory leaves the first one's kernel.
    const std::string kernel = IntegrateVariableMassStepKernel::Name();
    OpenMM::Platform& reference = OpenMM::Platform::getPlatformByName("Reference");
    if (!reference.supportsKernels({kernel}))
        reference.registerKernelFactory(kernel, new VariableMassKernelFactory());
    return Helfrich_Success;
}

void helfrich_shim_registerPlatform() {
    // Of another version nothing is registered here; registerSerialization complains.
    if (!isRightVersion() || findPlatform() != nullptr)
        return;
    try {
        // Twice: see PlatformChoice.h. It is one object, of which OpenMM's list has two entries.
        auto* platform = new HelfrichPlatform();
        OpenMM::Platform::registerPlatform(platform);
        OpenMM::Platform::registerPlatform(platform);
    } catch (const std::exception& error) {
        std::cerr << "openmm-helfrich: platform Helfrich is not available: " << error.what() << "\n";
    }
}

void helfrich_shim_adoptKernels() {
    try {
        if (HelfrichPlatform* platform = findPlatform())
            platform->adoptReferenceKernels();
    } catch (const std::exception& error) {
        std::cerr << "openmm-helfrich: platform Helfrich lacks kernels of other plugins: " << error.what() << "\n";
    }
}

Helfrich_Status helfrich_shim_checkPlatform(const void* system, const void* integrator) {
    std::string reason;
    try {
        reason = whyNotHelfrich(*static_cast<const OpenMM::System*>(system),
                                *static_cast<const OpenMM::Integrator*>(integrator));
    } catch (const std::exception& error) {
        reason = error.what();
    }
    helfrich_setLastError(reason.c_str());
    return reason.empty() ? Helfrich_Success : Helfrich_Failure;
}

void* helfrich_shim_createImpl(const void* force) {
    try {
        const auto& owner = *static_cast<const OpenMM::Force*>(force);
        OpenMM::ForceImpl* impl = nullptr;
        if (auto* flips = dynamic_cast<const MonteCarloBondFlip*>(&owner))
            impl = new MonteCarloBondFlipImpl(*flips);
        else if (auto* swaps = dynamic_cast<const MonteCarloDomainSwap*>(&owner))
            impl = new MonteCarloDomainSwapImpl(*swaps);
        else if (auto* tension = dynamic_cast<const MonteCarloMembraneTension*>(&owner))
            impl = new MonteCarloMembraneTensionImpl(*tension);
        else if (auto* thermostat = dynamic_cast<const SurfaceViscosityThermostat*>(&owner))
            impl = new SurfaceViscosityThermostatImpl(*thermostat);
        else
            impl = new MembraneForceImpl(dynamic_cast<const MembraneForce&>(owner));
        return impl;
    } catch (const std::exception& error) {
        helfrich_setLastError(error.what());
        return nullptr;
    }
}
}
