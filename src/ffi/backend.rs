//! The C interface to [`crate::backend`]: see [`crate::ffi`] for its conventions.

#![allow(non_snake_case, reason = "names follow OpenMM's C API")]

use crate::backend::{self, Choice, Kind};
use crate::error::{Error, Result};
use crate::evaluator::check_backend;
use crate::ffi::{Status, copy_out, guarded, text};
use crate::membrane::Membrane;
use std::ffi::{c_char, c_int};

/// Choose what computes the forces of all Contexts that are made from now on, as [`Choice`] is written.
///
/// # Safety
/// `choice` must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_setBackend(choice: *const c_char) -> Status {
    let choice = unsafe { text(choice) };
    guarded("set_backend", || {
        let choice = choice.parse()?;
        check_backend(choice)?;
        backend::set_global(choice);
        Ok(())
    })
}

/// Copy a text into a buffer; returns its length, or −1 if there is none.
///
/// # Safety
/// `buffer` must have room for `size` bytes.
unsafe fn written(
    subject: &str,
    buffer: *mut c_char,
    size: i64,
    text: impl FnOnce() -> Result<String>,
) -> i64 {
    let mut length = -1;
    let status = guarded(subject, || {
        length = unsafe { copy_out(&text()?, buffer, size) };
        Ok(())
    });
    match status {
        Status::Success => length,
        Status::Failure => -1,
    }
}

/// Copy the choice for the process into a buffer; returns its length, or −1 if the environment variable
/// HELFRICH_BACKEND is wrong.
///
/// # Safety
/// `buffer` must have room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_getBackend(buffer: *mut c_char, size: i64) -> i64 {
    unsafe { written("get_backend", buffer, size, || Ok(backend::global()?.to_string())) }
}

/// Refuse what is no choice. `subject` is the class that messages shall name.
///
/// # Safety
/// Both texts must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_checkBackend(
    subject: *const c_char,
    choice: *const c_char,
) -> Status {
    let choice = unsafe { text(choice) };
    guarded(unsafe { text(subject) }, || choice.parse::<Choice>().map(|_| ()))
}

/// Let a force join a membrane with its own choice, or an empty text.
///
/// # Safety
/// The texts must end with a NUL; `membrane` must be alive and used by no other thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_choose(
    subject: *const c_char,
    membrane: *mut Membrane,
    choice: *const c_char,
) -> Status {
    let choice = unsafe { text(choice) };
    guarded(unsafe { text(subject) }, || {
        let wish = if choice.is_empty() { None } else { Some(choice.parse()?) };
        unsafe { &mut *membrane }.choose(wish)
    })
}

/// Whether OpenMM's GPU platforms shall evaluate a membrane themselves: 0 no, 1 if they can, 2 or it is an error.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_wishesNative(membrane: *const Membrane) -> c_int {
    match unsafe { &*membrane }.choice().map(|choice| choice.kind) {
        Some(Kind::Native) => 2,
        Some(Kind::Cpu | Kind::Gpu) => 0,
        Some(Kind::Auto) | None => 1,
    }
}

/// Note that a GPU platform of OpenMM has evaluated.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Native_count() {
    backend::count_evaluation(Kind::Native);
}

/// The evaluations that the processor, GPUs and OpenMM's GPU platforms have done in this process.
///
/// # Safety
/// `counts` must have room for three values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_evaluations(counts: *mut u64) {
    let found = backend::evaluations();
    unsafe { std::slice::from_raw_parts_mut(counts, 3) }.copy_from_slice(&found);
}

/// List the GPUs, one a line: name, kind, interface, driver, and 1 or 0 for double precision and for
/// timestamps, separated by tabs. Returns the length.
///
/// # Safety
/// `buffer` must have room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_adapters(buffer: *mut c_char, size: i64) -> i64 {
    unsafe { written("adapters", buffer, size, || Ok(adapter_lines())) }
}

/// The measurements that decide what `auto` chooses, one a line: see `report` in
/// `src/evaluator/gpu/calibration.rs`. Returns the length.
///
/// # Safety
/// `buffer` must have room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_backendTimings(buffer: *mut c_char, size: i64) -> i64 {
    unsafe { written("adapters", buffer, size, || Ok(timing_lines())) }
}

/// For tests of what happens when a GPU fails. Kinds: "adapter", none is found; "memory", there is not enough of
/// it; "lost", the device goes; "none", no more faults; "prefer", `auto` takes any GPU for any mesh from now on,
/// if `after` is not 0. A fault happens at its `after`-th next occasion.
///
/// # Safety
/// `kind` must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_injectGpuFault(kind: *const c_char, after: i64) -> Status {
    let kind = unsafe { text(kind) };
    guarded("inject_fault", || inject(kind, after as u64))
}

#[cfg(feature = "gpu")]
fn inject(kind: &str, after: u64) -> Result<()> {
    use crate::evaluator::gpu::calibration;
    use crate::evaluator::gpu::faults::{Fault, inject};
    let fault = match kind {
        "prefer" => {
            calibration::prefer_gpu(after != 0);
            return Ok(());
        }
        "none" => None,
        "adapter" => Some(Fault::Adapter),
        "memory" => Some(Fault::Memory),
        "lost" => Some(Fault::Lost),
        _ => return Err(Error::Contract(format!("there is no fault \"{kind}\""))),
    };
    inject(fault, after);
    Ok(())
}

#[cfg(feature = "gpu")]
fn adapter_lines() -> String {
    use crate::evaluator::gpu::adapters;
    let line = |adapter: &adapters::Adapter| {
        let (double, timestamps) = (adapter.has_double.into(), adapter.has_timestamps.into());
        let flags: [u8; 2] = [double, timestamps];
        let words = [&adapter.name, adapter.kind, adapter.interface, &adapter.driver];
        let words = words.map(|word| word.replace(['\t', '\n'], " ")).join("\t");
        format!("{words}\t{}\t{}\n", flags[0], flags[1])
    };
    adapters::all().iter().map(line).collect()
}

#[cfg(feature = "gpu")]
fn timing_lines() -> String {
    crate::evaluator::gpu::calibration::report()
}

#[cfg(not(feature = "gpu"))]
fn inject(_: &str, _: u64) -> Result<()> {
    Err(Error::Contract("this build has no GPU that could fail".to_owned()))
}

#[cfg(not(feature = "gpu"))]
fn adapter_lines() -> String {
    String::new()
}

#[cfg(not(feature = "gpu"))]
fn timing_lines() -> String {
    String::new()
}
