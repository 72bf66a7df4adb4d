//! The C interface to [`crate::evaluator::gpu::native`]: evaluations by OpenMM's own GPU platforms.

use super::membrane::{cell, read_terms, with_terms};
use super::{NativeBuffer, NativePass, NativePlan, Status, TermInput, guarded, slice, text};
use crate::evaluator::gpu::Precision;
use crate::evaluator::gpu::native::{self, Native, Wanted};
use crate::membrane::Membrane;
use crate::potentials::REGISTRY;
use std::ffi::{c_char, c_int};

fn precision(is_double: c_int) -> Precision {
    if is_double != 0 { Precision::Double } else { Precision::Single }
}

/// The program of a precision; it lives as long as the library.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Native_source(is_double: c_int) -> *const c_char {
    native::source(precision(is_double)).as_ptr()
}

/// Whether a platform can evaluate a potential, by its number: 1 or 0.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Native_canEvaluate(potential: c_int, is_periodic: c_int) -> c_int {
    let named = REGISTRY.get(potential as usize);
    named.is_some_and(|named| native::is_native(*named, is_periodic != 0)).into()
}

/// Plans for a membrane in one precision.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Native_create(is_double: c_int) -> *mut Native {
    Box::into_raw(Box::new(Native::new(precision(is_double))))
}

/// Destroy them; null is allowed.
///
/// # Safety
/// `native` must come from [`Helfrich_Native_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Native_destroy(native: *mut Native) {
    if !native.is_null() {
        drop(unsafe { Box::from_raw(native) });
    }
}

/// Whether [`Helfrich_Native_look`] must come before terms are evaluated: 1 or 0.
///
/// # Safety
/// As of [`Helfrich_Native_plan`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Native_mustLook(
    native: *const Native,
    membrane: *const Membrane,
    terms: *const TermInput,
    num_terms: i64,
) -> c_int {
    let terms = unsafe { read_terms(terms, num_terms) };
    let (native, membrane) = unsafe { (&*native, &*membrane) };
    c_int::from(!native.has_unit() || membrane.must_look(&terms))
}

/// Evaluate terms on the processor, to name what a device would not, and choose the unit of length by the positions.
///
/// # Safety
/// As of [`Helfrich_Membrane_evaluate`](super::Helfrich_Membrane_evaluate); `native` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Native_look(
    subject: *const c_char,
    native: *mut Native,
    membrane: *mut Membrane,
    terms: *const TermInput,
    num_terms: i64,
    num_particles: i64,
    positions: *const f64,
    box_vectors: *const f64,
) -> Status {
    let (given, at) = ((terms, num_terms), (positions, num_particles));
    guarded(unsafe { text(subject) }, || unsafe {
        with_terms(given, at, box_vectors, |terms, at| {
            let (native, membrane) = (&mut *native, &mut *membrane);
            membrane.look(terms, at, &mut vec![0.0; at.positions.len()])?;
            native.set_unit(membrane.mesh(), at);
            Ok(())
        })
    })
}

/// Say what an evaluation of terms takes. `derivatives` has `HELFRICH_MAX_PARAMETERS` numbers a term.
///
/// # Safety
/// `subject` must end with a NUL; `native` and `membrane` must be alive and used by no other thread; the arrays must hold
/// what is said.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Native_plan(
    subject: *const c_char,
    native: *mut Native,
    membrane: *mut Membrane,
    box_vectors: *const f64,
    terms: *const TermInput,
    num_terms: i64,
    energies: c_int,
    forces: c_int,
    derivatives: *const c_int,
    plan: *mut NativePlan,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let terms = unsafe { read_terms(terms, num_terms) };
        let derivatives = unsafe { slice(derivatives.cast(), num_terms as usize) };
        let (native, membrane) = unsafe { (&mut *native, &mut *membrane) };
        for term in &terms {
            membrane.check(term)?;
        }
        let generation = membrane.generation();
        let (terms, mesh) = membrane.equip(&terms)?;
        let cell = unsafe { cell(box_vectors) }?;
        let wanted = Wanted {
            cell: cell.as_ref(),
            energies: energies != 0,
            forces: forces != 0,
            derivatives,
        };
        native.plan(mesh, generation, &terms, &wanted)?;
        let (particles, anchors) = native.vertices();
        let made = native.last_plan();
        unsafe {
            plan.write(NativePlan {
                num_buffers: made.buffers.len() as i64,
                num_passes: made.passes.len() as i64,
                num_targets: made.targets.len() as i64,
                num_runs: made.runs.len() as i64,
                targets: made.targets.as_ptr().cast(),
                runs: made.runs.as_ptr().cast(),
                version: made.version,
                extent: made.extent,
                unit: native.unit(),
                num_vertices: particles.len() as i64,
                particles: particles.as_ptr(),
                anchors: anchors.as_ptr(),
            });
        }
        Ok(())
    })
}

/// A buffer of the last plan.
///
/// # Safety
/// `native` must be alive and `number` one of its buffers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Native_buffer(
    native: *const Native,
    number: i64,
) -> NativeBuffer {
    let buffer = &unsafe { &*native }.last_plan().buffers[number as usize];
    NativeBuffer {
        item_size: buffer.item as i64,
        items: buffer.items as i64,
        data: if buffer.version == 0 { std::ptr::null() } else { buffer.data.as_ptr() },
        data_size: buffer.data.len() as i64,
        version: buffer.version,
    }
}

/// A pass of the last plan.
///
/// # Safety
/// `native` must be alive and `number` one of its passes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Native_pass(native: *const Native, number: i64) -> NativePass {
    let (name, groups) = unsafe { &*native }.last_plan().passes[number as usize];
    NativePass { name: name.as_ptr(), groups: groups as i64 }
}
