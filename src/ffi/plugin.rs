//! The C interface of the plugin: what OpenMM calls when it loads the library, and what the force classes need.

use super::Status;
use super::shim::*;
use std::ffi::{CStr, c_char, c_void};

/// The version of OpenMM that this library was built against.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_openmmVersion() -> *const c_char {
    const VERSION: &CStr = match CStr::from_bytes_with_nul(
        concat!(env!("HELFRICH_OPENMM_VERSION"), "\0").as_bytes(),
    ) {
        Ok(version) => version,
        Err(_) => panic!("a version has no NUL inside"),
    };
    VERSION.as_ptr()
}

/// Let an OpenMM of another version load this library, whose C++ interface is known to be that of the build.
///
/// # Safety
/// `version` must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_acceptOpenMM(version: *const c_char) {
    unsafe { helfrich_shim_acceptOpenMM(version) };
}

/// OpenMM's plugin entry point for platforms: registers the platform `Helfrich`.
#[unsafe(no_mangle)]
pub extern "C" fn registerPlatforms() {
    // SAFETY: the shim's function takes nothing and throws nothing.
    unsafe { helfrich_shim_registerPlatform() };
}

/// OpenMM's plugin entry point for kernels. The forces need none; their XML readers are registered here.
#[unsafe(no_mangle)]
pub extern "C" fn registerKernelFactories() {
    // SAFETY: the shim's functions take nothing and throw nothing. If OpenMM is of another version the first says
    // so on the standard error and registers nothing: a plugin in a folder must not stop the others.
    unsafe {
        if helfrich_shim_registerSerialization() == Status::Success {
            helfrich_shim_adoptKernels();
        }
    }
}

/// Do what OpenMM does when it loads the library as a plugin: for programs that are linked to it.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_register() {
    registerPlatforms();
    registerKernelFactories();
}

/// Whether a System under an integrator is one for the platform `Helfrich`: 0, or else 1 and the last error says why
/// not.
///
/// # Safety
/// `system` must be an `OpenMM::System` and `integrator` an `OpenMM::Integrator` that are alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Platform_check(
    system: *const c_void,
    integrator: *const c_void,
) -> Status {
    unsafe { helfrich_shim_checkPlatform(system, integrator) }
}

/// Make the implementation of a force. The force classes are compiled into several libraries (this one,
/// the Python extension), their implementation into this one only, so that all forces of a Context meet
/// in one registry.
///
/// # Safety
/// `force` must be a `MembraneForce` that is alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_createImpl(force: *const c_void) -> *mut c_void {
    unsafe { helfrich_shim_createImpl(force) }
}
