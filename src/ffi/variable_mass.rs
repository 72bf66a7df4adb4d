//! The C interface to [`crate::dynamics::variable_mass`].

use super::membrane::cell;
use super::{ParticleArrays, SheetInput, Status, guarded, slice, text};
use crate::dynamics::plaquettes::Sheet;
use crate::dynamics::random::Stream;
use crate::dynamics::variable_mass::VariableMasses;
use crate::team::Team;
use std::ffi::c_char;
use std::slice as slices;

/// Prepare time steps of particles with the masses of a System, and a density of surfaces or 0.
///
/// # Safety
/// `masses` must hold `num_particles` values; `made` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_VariableMasses_create(
    subject: *const c_char,
    num_particles: i64,
    masses: *const f64,
    density: f64,
    made: *mut *mut VariableMasses,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let masses = unsafe { slice(masses, num_particles as usize) };
        let masses = Box::new(VariableMasses::new(masses, density));
        unsafe { made.write(Box::into_raw(masses)) };
        Ok(())
    })
}

/// Destroy them; null is allowed.
///
/// # Safety
/// `masses` must come from [`Helfrich_VariableMasses_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_VariableMasses_destroy(masses: *mut VariableMasses) {
    if !masses.is_null() {
        drop(unsafe { Box::from_raw(masses) });
    }
}

/// Go on with the surfaces that the triangles of some forces make up.
///
/// # Safety
/// `subject` must end with a NUL; `masses` must be alive and used by nobody else; `sheets` must hold `count` values,
/// each with as many corners as it says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_VariableMasses_setSurfaces(
    subject: *const c_char,
    masses: *mut VariableMasses,
    sheets: *const SheetInput,
    count: i64,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let sheets = unsafe { slice(sheets, count as usize) };
        let sheets = sheets.iter().map(|sheet| Sheet {
            triangles: unsafe { slice(sheet.corners.cast(), sheet.num_triangles as usize) },
            is_periodic: sheet.is_periodic != 0,
        });
        unsafe { &mut *masses }.set_surfaces(&sheets.collect::<Vec<_>>())
    })
}

/// Write the masses of all particles at some positions.
///
/// # Safety
/// As for [`Helfrich_VariableMasses_begin`]; `out` must have room for a value for each particle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_VariableMasses_get(
    subject: *const c_char,
    masses: *mut VariableMasses,
    particles: *const ParticleArrays,
    box_vectors: *const f64,
    out: *mut f64,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let particles = unsafe { (*particles).particles() };
        let cell = unsafe { cell(box_vectors) }?;
        let found = unsafe { &mut *masses }.masses(particles.positions, cell.as_ref())?;
        unsafe { slices::from_raw_parts_mut(out, found.len()) }.copy_from_slice(&found);
        Ok(())
    })
}

/// Begin a time step: half a kick and the drift. `team` may be null, and `box_vectors` where no surface is periodic.
///
/// # Safety
/// `subject` must end with a NUL; `masses` must be alive, `team` too or null, and both used by nobody else;
/// `box_vectors` must be readable or null; the arrays of `particles` must be as it says, and not empty.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_VariableMasses_begin(
    subject: *const c_char,
    masses: *mut VariableMasses,
    team: *mut Team,
    particles: *const ParticleArrays,
    box_vectors: *const f64,
    step: f64,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let (masses, team) = unsafe { (&mut *masses, team.as_mut()) };
        let cell = unsafe { cell(box_vectors) }?;
        masses.begin(team, unsafe { (*particles).particles() }, cell.as_ref(), step)
    })
}

/// Finish a time step with the forces at the new positions: the other half of the kick.
///
/// # Safety
/// As for [`Helfrich_VariableMasses_begin`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_VariableMasses_finish(
    subject: *const c_char,
    masses: *mut VariableMasses,
    team: *mut Team,
    particles: *const ParticleArrays,
    box_vectors: *const f64,
    step: f64,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let (masses, team) = unsafe { (&mut *masses, team.as_mut()) };
        let cell = unsafe { cell(box_vectors) }?;
        masses.finish(team, unsafe { (*particles).particles() }, cell.as_ref(), step)
    })
}

/// Let a bath act on the momenta for some time, ps.
///
/// # Safety
/// As for [`Helfrich_VariableMasses_begin`]; `stream` must be used by nobody else.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_VariableMasses_bathe(
    subject: *const c_char,
    masses: *mut VariableMasses,
    team: *mut Team,
    particles: *const ParticleArrays,
    box_vectors: *const f64,
    stream: *mut Stream,
    time: f64,
    friction: f64,
    kt: f64,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let (masses, team, stream) = unsafe { (&mut *masses, team.as_mut(), &mut *stream) };
        let cell = unsafe { cell(box_vectors) }?;
        let particles = unsafe { (*particles).particles() };
        masses.bathe(team, particles, cell.as_ref(), stream, (time, friction, kt))
    })
}
