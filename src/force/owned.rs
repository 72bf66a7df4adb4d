//! What all forces have in common for Rust programs.

use super::{c_text, check};
use crate::error::{Error, Result};
use crate::ffi::c_api;
use crate::ffi::{Status, last_error};
use crate::openmm::{OpenMM_Context, OpenMM_Force};
use std::ffi::{c_char, c_double};
use std::ptr::NonNull;

/// A force that no System owns yet.
pub(super) struct Owned(NonNull<OpenMM_Force>);

/// The C function that reads a statistic of a class of movers.
type GetStatistic = unsafe extern "C" fn(
    *mut OpenMM_Force,
    *mut OpenMM_Context,
    *const c_char,
    *mut c_double,
) -> Status;

impl Owned {
    /// What a C function has made, or the message of why it has not.
    ///
    /// # Safety
    /// `force` must be null, or a force that nobody owns.
    pub unsafe fn new(force: *mut OpenMM_Force) -> Result<Self> {
        NonNull::new(force).map(Self).ok_or_else(|| Error::Contract(last_error()))
    }

    pub fn as_ptr(&self) -> *mut OpenMM_Force {
        self.0.as_ptr()
    }

    pub fn into_openmm(self) -> *mut OpenMM_Force {
        let force = self.as_ptr();
        std::mem::forget(self);
        force
    }
}

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: no System has taken it over.
        unsafe { c_api::Helfrich_MembraneForce_destroy(self.as_ptr()) };
    }
}

/// One of the statistics of a mover in a Context.
///
/// # Errors
/// An unknown name, or a Context that the force does not belong to.
///
/// # Safety
/// `get` must be of the force's class; `force` and `context` must be of OpenMM's C API, and alive.
pub(super) unsafe fn statistic(
    get: GetStatistic,
    force: *mut OpenMM_Force,
    context: *mut OpenMM_Context,
    name: &str,
) -> Result<f64> {
    let name = c_text(name)?;
    let mut value = f64::NAN;
    // SAFETY: the caller's promise, and the name ends with a NUL.
    check(unsafe { get(force, context, name.as_ptr(), &mut value) })?;
    Ok(value)
}

/// Methods that hand one value over to a function of the C API, which may refuse it.
macro_rules! setters {
    ($($(#[$doc:meta])* fn $name:ident($value:ident: $kind:ty) = $setter:ident;)*) => {$(
        $(#[$doc])*
        pub fn $name(&mut self, $value: $kind) -> Result<&mut Self> {
            // SAFETY: the force is alive.
            check(unsafe { c_api::$setter(self.force.as_ptr(), $value.into()) })?;
            Ok(self)
        }
    )*};
}

/// The methods that hand the force of a class over to OpenMM.
macro_rules! handed_over {
    () => {
        /// The force as OpenMM's C API knows it, to steer it when a System has taken it over.
        pub fn as_openmm(&self) -> *mut OpenMM_Force {
            self.force.as_ptr()
        }

        /// The force for `OpenMM_System_addForce`, which takes it over.
        pub fn into_openmm(self) -> *mut OpenMM_Force {
            self.force.into_openmm()
        }
    };
}

/// The method that reads a statistic of a class of movers.
macro_rules! statistics {
    ($get:ident) => {
        /// One of the statistics of a Context, such as "accepted".
        ///
        /// # Errors
        /// An unknown name, or a Context that the force does not belong to.
        ///
        /// # Safety
        /// `force` must be one of this class, and `context` a Context, of OpenMM's C API; both must be alive.
        pub unsafe fn statistic(
            force: *mut OpenMM_Force,
            context: *mut OpenMM_Context,
            name: &str,
        ) -> Result<f64> {
            // SAFETY: the caller's promise.
            unsafe { statistic(c_api::$get, force, context, name) }
        }
    };
}

pub(super) use {handed_over, setters, statistics};
