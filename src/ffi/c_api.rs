//! The C API of the force classes, in the style of OpenMM's C wrapper: `Helfrich_BendingForce_create` and so on.
//!
//! The build makes these functions of their declarations in `wrappers/include/OpenMMHelfrichCWrapper.h` and
//! `OpenMMHelfrichCForces.h` (`wrappers/declarations.rs`). They are Rust's, because a Rust library exports only Rust's own
//! symbols; what they do is in `wrappers/src/CApi.cpp` and `CApiMovers.cpp`.
//!
//! A force is an `OpenMM_Force` that `OpenMM_System_addForce` takes. Functions that can fail return a
//! [`Status`](crate::ffi::Status), or a null pointer; [`crate::ffi::Helfrich_lastError`] has the message.
//!
//! # Safety
//! Every function takes pointers of C: a force made by one of the `create` functions and not yet
//! destroyed (or given to a System that still lives), texts that end with a NUL, and arrays of the
//! length that is passed beside them.

#![allow(non_snake_case, reason = "names follow OpenMM's C API")]
#![allow(missing_docs, reason = "the header has a comment where the name does not say all")]
#![allow(clippy::missing_safety_doc, reason = "the safety of all functions is stated above")]
#![allow(clippy::too_many_arguments, reason = "a class has as many as it has")]

use super::shim;
use crate::openmm::{OpenMM_Context, OpenMM_Force, OpenMM_Integrator};
use crate::potentials::codes::Status as Helfrich_Status;
use std::ffi::{c_char, c_double, c_int};

/// A force of any class; null if an argument is refused.
///
/// # Safety
/// `class` must end with a NUL, and `triangles` hold three values a triangle.
pub(crate) unsafe fn create(
    class: *const c_char,
    triangles: *const c_int,
    num_triangles: c_int,
    values: &[f64],
    form: c_int,
) -> *mut OpenMM_Force {
    let (corners, count) = (triangles, num_triangles);
    let (scalars, length) = (values.as_ptr(), values.len() as c_int);
    unsafe { shim::helfrich_shim_createForce(class, corners, count, scalars, length, form) }
}

/// A function that only passes on to the shim.
macro_rules! forward {
    ($(#[$doc:meta])* $name:ident => $shim:ident($($argument:ident: $type:ty),*) $(-> $result:ty)?) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $type),*) $(-> $result)? {
            unsafe { shim::$shim($($argument),*) }
        }
    };
}

/// The `create` of a force class; scalars that it does not take have a default.
macro_rules! create {
    ($(#[$doc:meta])* $name:ident $class:ident($($parameter:ident),*) $($form:ident)?) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            triangles: *const c_int,
            num_triangles: c_int,
            $($parameter: c_double,)*
            $($form: c_int,)?
        ) -> *mut OpenMM_Force {
            let class = concat!(stringify!($class), "\0").as_ptr().cast();
            let form = [$($form,)? 0][0];
            unsafe { create(class, triangles, num_triangles, &[$($parameter),*], form) }
        }
    };
}

/// The `get` of a scalar.
macro_rules! get {
    ($(#[$doc:meta])* $name:ident $class:ident $parameter:ident) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(force: *mut OpenMM_Force) -> c_double {
            let mut value = f64::NAN;
            let name = concat!(stringify!($parameter), "\0").as_ptr().cast();
            match unsafe { Helfrich_MembraneForce_getParameterValue(force, name, &mut value) } {
                Helfrich_Status::Success => value,
                Helfrich_Status::Failure => f64::NAN,
            }
        }
    };
}

/// The `set` of a scalar.
macro_rules! set {
    ($(#[$doc:meta])* $name:ident $class:ident $parameter:ident) => {
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(force: *mut OpenMM_Force, value: c_double) -> Helfrich_Status {
            let name = concat!(stringify!($parameter), "\0").as_ptr().cast();
            unsafe { Helfrich_MembraneForce_setParameterValue(force, name, value) }
        }
    };
}

include!(concat!(env!("OUT_DIR"), "/c_api.rs"));

#[cfg(test)]
mod tests {
    use crate::potentials;

    /// Scalars have names in the header, but come to the shim as a list.
    #[test]
    fn create_takes_the_scalars_in_their_order() {
        assert!(super::CREATED.len() == potentials::REGISTRY.len());
        for (class, scalars) in super::CREATED {
            let parameters = potentials::find(class).unwrap().parameters().iter();
            let names = parameters.map(|parameter| parameter.name.to_str().unwrap());
            assert!(names.take(scalars.len()).eq(scalars.iter().copied()), "{class}");
        }
    }
}
