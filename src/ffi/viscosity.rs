//! The C interface to friction and noise along edges.

use super::membrane::cell;
use super::{EdgeBath, Status, guarded, slice, text};
use crate::dynamics::random::Stream;
use crate::dynamics::viscosity::{Bath, Motion, Viscosity};
use crate::membrane::Membrane;
use std::ffi::c_char;
use std::slice as slices;

/// Prepare sweeps over the edges of a membrane, among particles of these masses.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive; `masses` must hold a value for each particle of its System;
/// `viscosity` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Viscosity_create(
    subject: *const c_char,
    membrane: *const Membrane,
    num_particles: i64,
    masses: *const f64,
    viscosity: *mut *mut Viscosity,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let masses = unsafe { slice(masses, num_particles as usize) };
        let made = Viscosity::new(unsafe { &*membrane }.mesh(), masses);
        unsafe { viscosity.write(Box::into_raw(Box::new(made))) };
        Ok(())
    })
}

/// Destroy it; null is allowed.
///
/// # Safety
/// `viscosity` must come from [`Helfrich_Viscosity_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Viscosity_destroy(viscosity: *mut Viscosity) {
    if !viscosity.is_null() {
        drop(unsafe { Box::from_raw(viscosity) });
    }
}

/// Let friction and noise act along the present edges of a membrane. `box_vectors` has those of the periodic box, or is
/// null if there is none. A sweep that is refused changes nothing.
///
/// # Safety
/// `subject` must end with a NUL; `viscosity` must be alive, made for this membrane and used by no other thread, as
/// `stream`; `membrane` must be alive; `bath` must be readable; `positions` and `velocities` must hold three values for
/// each particle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Viscosity_sweep(
    subject: *const c_char,
    viscosity: *mut Viscosity,
    membrane: *const Membrane,
    num_particles: i64,
    positions: *mut f64,
    velocities: *mut f64,
    box_vectors: *const f64,
    bath: *const EdgeBath,
    stream: *mut Stream,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let membrane = unsafe { &*membrane };
        let cell = unsafe { cell(box_vectors) }?;
        let length = 3 * num_particles as usize;
        let motion = unsafe {
            Motion {
                positions: slices::from_raw_parts_mut(positions, length),
                velocities: slices::from_raw_parts_mut(velocities, length),
                cell: cell.as_ref(),
            }
        };
        let EdgeBath { friction, kt, lag } = unsafe { *bath };
        let bath = Bath { friction, kt, lag };
        let mesh = (membrane.mesh(), membrane.generation());
        unsafe { &mut *viscosity }.sweep(mesh, motion, bath, unsafe { &mut *stream })
    })
}
