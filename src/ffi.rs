//! The C interface: what the C++ shim, the Python package and OpenMM's plugin loader call.
//!
//! Every function that can fail returns a [`Status`]; after a failure [`Helfrich_lastError`] has
//! the message of the calling thread. No panic leaves a function. `CoreFunctions.h` in
//! `wrappers/include/openmm-helfrich/internal/` and `wrappers/src/HelfrichDynamics.h` declare them for C++; the build
//! stops where the two differ.

#![allow(non_snake_case, reason = "names follow OpenMM's C API")]

mod backend;
pub mod c_api;
mod crowd;
mod declared;
mod dynamics;
#[cfg(test)]
mod fuzz;
mod membrane;
mod mesh;
mod moves;
mod native;
mod plugin;
mod potentials;
mod records;
mod shim;
mod variable_mass;
mod viscosity;

pub use backend::*;
pub use crowd::*;
pub use dynamics::*;
pub use membrane::*;
pub use mesh::*;
pub use moves::*;
pub use native::*;
pub use plugin::*;
pub use potentials::*;
pub use records::*;
pub use variable_mass::*;
pub use viscosity::*;

use crate::error::Result;
pub use crate::potentials::codes::Status;
use std::cell::RefCell;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

thread_local! {
    static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Keep a message for [`Helfrich_lastError`].
pub(crate) fn set_last_error(message: String) {
    LAST_ERROR.with(|last| *last.borrow_mut() = message);
}

/// Run a fallible body and turn its result, or its panic, into a status and a message.
pub(crate) fn guarded(subject: &str, body: impl FnOnce() -> Result<()>) -> Status {
    let message = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return Status::Success,
        Ok(Err(error)) => format!("{}: {error}", error.class().unwrap_or(subject)),
        Err(panic) => {
            let text = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or("no message");
            format!("{subject}: internal error in openmm-helfrich, please report it: {text}")
        }
    };
    set_last_error(message);
    Status::Failure
}

/// The text behind a pointer; a name that is not text is a name that nobody knows.
///
/// # Safety
/// `text` must be null or end with a NUL.
pub(crate) unsafe fn text<'a>(text: *const c_char) -> &'a str {
    if text.is_null() {
        return "";
    }
    unsafe { CStr::from_ptr(text) }.to_str().unwrap_or("?")
}

/// A slice that may be empty with a null pointer.
///
/// # Safety
/// `data` must point to `length` values, unless `length` is 0.
unsafe fn slice<'a, T>(data: *const T, length: usize) -> &'a [T] {
    // A negative count has become, without its sign, one that no memory holds.
    let fits = length <= isize::MAX as usize / size_of::<T>().max(1);
    assert!(fits && (length == 0 || !data.is_null()), "there is no array of {length} values");
    if length == 0 { &[] } else { unsafe { slice::from_raw_parts(data, length) } }
}

/// Copy a message with its NUL into a buffer, cutting it if need be; returns its whole length.
///
/// # Safety
/// `buffer` must have room for `size` bytes, unless `size` is 0.
pub(crate) unsafe fn copy_out(message: &str, buffer: *mut c_char, size: i64) -> i64 {
    if size > 0 {
        let length = message.len().min(size as usize - 1);
        let bytes = unsafe { slice::from_raw_parts_mut(buffer.cast::<u8>(), length + 1) };
        bytes[..length].copy_from_slice(&message.as_bytes()[..length]);
        bytes[length] = 0;
    }
    message.len() as i64
}

/// Copy the message of this thread's last failure into a buffer of `size` bytes; returns its length.
///
/// # Safety
/// `buffer` must have room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_lastError(buffer: *mut c_char, size: i64) -> i64 {
    LAST_ERROR.with(|last| unsafe { copy_out(&last.borrow(), buffer, size) })
}

/// Lets the shim report what it caught.
///
/// # Safety
/// `message` must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn helfrich_setLastError(message: *const c_char) {
    set_last_error(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned());
}

/// The message of this thread's last failure.
pub fn last_error() -> String {
    LAST_ERROR.with(|last| last.borrow().clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::potentials::{Contribution, MAX_PARAMETERS};

    fn last_error() -> String {
        let mut buffer = vec![0u8; 500];
        let length = unsafe { Helfrich_lastError(buffer.as_mut_ptr().cast(), 500) };
        buffer.truncate(length as usize);
        String::from_utf8(buffer).unwrap()
    }

    /// A term with a number that is not in the registry: a mistake of the shim, not of a user.
    fn provoke_panic() -> Status {
        let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let mut membrane = std::ptr::null_mut();
        let term = TermInput {
            potential: 99,
            form: 0,
            switches: 0,
            wants_derivatives: 0,
            values: [1.0; MAX_PARAMETERS],
            fields: [std::ptr::null(); MAX_PARAMETERS],
            field_lengths: [0; MAX_PARAMETERS],
            particles: std::ptr::null(),
            num_particles: 0,
            numbers: std::ptr::null(),
        };
        let mut contribution = Contribution::default();
        unsafe {
            let made = Helfrich_Membrane_create(
                c"Test".as_ptr(),
                triangles.as_ptr().cast(),
                4,
                4,
                &mut membrane,
            );
            assert_eq!(made, Status::Success);
            let status = Helfrich_Membrane_evaluate(
                c"Test".as_ptr(),
                membrane,
                &term,
                1,
                4,
                [0.0; 12].as_ptr(),
                std::ptr::null(),
                &mut contribution,
                std::ptr::null_mut(),
            );
            Helfrich_Membrane_destroy(membrane);
            status
        }
    }

    #[test]
    fn a_panic_becomes_a_message() {
        assert_eq!(provoke_panic(), Status::Failure);
        assert!(last_error().contains("internal error") && last_error().contains("out of bounds"));
    }

    #[test]
    fn long_messages_are_cut_not_overrun() {
        assert_eq!(provoke_panic(), Status::Failure);
        let mut buffer = [7u8; 6];
        let length = unsafe { Helfrich_lastError(buffer.as_mut_ptr().cast(), 5) };
        assert!(length > 5);
        assert_eq!(&buffer, b"Test\0\x07");
    }

    #[test]
    fn errors_start_with_the_subject() {
        let status = unsafe { Helfrich_Potential_check(c"BendingForce".as_ptr(), 0, -1.0) };
        assert_eq!(status, Status::Failure);
        assert_eq!(
            last_error(),
            "BendingForce: rigidity must be a finite number, zero or above, got -1"
        );
        let mut membrane = std::ptr::null_mut();
        let status = unsafe {
            Helfrich_Membrane_create(
                c"SurfaceAreaForce".as_ptr(),
                std::ptr::null(),
                0,
                9,
                &mut membrane,
            )
        };
        assert!(
            status == Status::Failure
                && last_error().starts_with("SurfaceAreaForce: the mesh has no triangles")
        );
    }
}
