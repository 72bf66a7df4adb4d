//! The C interface of the platform: teams of threads, time steps and random numbers.

use super::{ParticleArrays, Status, guarded, slice};
use crate::dynamics::integrate::{self, Dynamics, PARALLEL_FROM, Particles, WAKE_FROM};
use crate::dynamics::random::{self, Stream};
use crate::error::Error;
use crate::team::Team;
use std::ffi::c_int;
use std::{slice as slices, thread};

/// What messages start with.
const SUBJECT: &str = "Platform Helfrich";

/// The number of threads that this process can use at the same time.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Team_available() -> c_int {
    thread::available_parallelism().map_or(1, |threads| threads.get() as c_int)
}

/// Make a team of threads, the caller among them.
///
/// # Safety
/// `team` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Team_create(threads: c_int, team: *mut *mut Team) -> Status {
    guarded(SUBJECT, || {
        let made = Team::new(threads.max(1) as usize).map_err(|reason| {
            Error::Contract(format!(
                "{threads} threads could not be started ({reason}); set Threads to a smaller number"
            ))
        })?;
        unsafe { team.write(Box::into_raw(Box::new(made))) };
        Ok(())
    })
}

/// End the threads of a team; null is allowed.
///
/// # Safety
/// `team` must come from [`Helfrich_Team_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Team_destroy(team: *mut Team) {
    if !team.is_null() {
        drop(unsafe { Box::from_raw(team) });
    }
}

/// Whether time steps of so many particles use a team, which may be awake.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Dynamics_usesTeam(num_particles: i64, is_awake: c_int) -> c_int {
    let least = if is_awake != 0 { PARALLEL_FROM } else { WAKE_FROM };
    c_int::from(num_particles >= least as i64)
}

/// The 128 random bits of a number, for a key.
///
/// # Safety
/// `key` and `bits` must hold two values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Random_bits(key: *const u32, number: u64, bits: *mut u64) {
    let (key, bits) = (key.cast::<[u32; 2]>(), bits.cast::<[u64; 2]>());
    unsafe { bits.write(random::bits(*key, number)) };
}

/// Prepare time steps of particles with these masses.
///
/// # Safety
/// `masses` must hold `num_particles` values; `dynamics` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Dynamics_create(
    num_particles: i64,
    masses: *const f64,
    dynamics: *mut *mut Dynamics,
) -> Status {
    guarded(SUBJECT, || {
        let made = Dynamics::new(unsafe { slice(masses, num_particles as usize) });
        unsafe { dynamics.write(Box::into_raw(Box::new(made))) };
        Ok(())
    })
}

/// Destroy it; null is allowed.
///
/// # Safety
/// `dynamics` must come from [`Helfrich_Dynamics_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Dynamics_destroy(dynamics: *mut Dynamics) {
    if !dynamics.is_null() {
        drop(unsafe { Box::from_raw(dynamics) });
    }
}

impl ParticleArrays {
    /// # Safety
    /// The arrays must be as long as they should be, and used by nobody else meanwhile.
    pub(super) unsafe fn particles(&self) -> Particles<'_> {
        let length = 3 * self.num_particles as usize;
        unsafe {
            Particles {
                positions: slices::from_raw_parts_mut(self.positions, length),
                velocities: slices::from_raw_parts_mut(self.velocities, length),
                forces: slices::from_raw_parts(self.forces, length),
            }
        }
    }
}

/// A step of OpenMM's VerletIntegrator. `team` may be null.
///
/// # Safety
/// `dynamics` must be alive, `team` too or null and used by nobody else, and the arrays of `particles` must be
/// as it says, and not empty.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Dynamics_verlet(
    dynamics: *const Dynamics,
    team: *mut Team,
    particles: *const ParticleArrays,
    step: f64,
) -> Status {
    guarded(SUBJECT, || {
        let (dynamics, team) = unsafe { (&*dynamics, team.as_mut()) };
        dynamics.verlet(team, unsafe { (*particles).particles() }, step);
        Ok(())
    })
}

/// A step of OpenMM's LangevinMiddleIntegrator. `team` may be null.
///
/// # Safety
/// As for [`Helfrich_Dynamics_verlet`]; `stream` must be used by nobody else.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Dynamics_langevinMiddle(
    dynamics: *const Dynamics,
    team: *mut Team,
    particles: *const ParticleArrays,
    stream: *mut Stream,
    step: f64,
    friction: f64,
    kt: f64,
) -> Status {
    guarded(SUBJECT, || {
        let (dynamics, team, stream) = unsafe { (&*dynamics, team.as_mut(), &mut *stream) };
        let particles = unsafe { (*particles).particles() };
        dynamics.langevin_middle(team, particles, stream, (step, friction, kt));
        Ok(())
    })
}

/// A step of OpenMM's BrownianIntegrator. `team` may be null.
///
/// # Safety
/// As for [`Helfrich_Dynamics_langevinMiddle`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Dynamics_brownian(
    dynamics: *const Dynamics,
    team: *mut Team,
    particles: *const ParticleArrays,
    stream: *mut Stream,
    step: f64,
    friction: f64,
    kt: f64,
) -> Status {
    guarded(SUBJECT, || {
        let (dynamics, team, stream) = unsafe { (&*dynamics, team.as_mut(), &mut *stream) };
        let particles = unsafe { (*particles).particles() };
        dynamics.brownian(team, particles, stream, (step, friction, kt));
        Ok(())
    })
}

/// Set the forces on all particles to zero. `team` may be null.
///
/// # Safety
/// `forces` must hold three values for each particle and not be empty; `team` must be alive or null and used by
/// nobody else.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Dynamics_clear(
    team: *mut Team,
    num_particles: i64,
    forces: *mut f64,
) -> Status {
    guarded(SUBJECT, || {
        let forces = unsafe { slices::from_raw_parts_mut(forces, 3 * num_particles as usize) };
        integrate::clear(unsafe { team.as_mut() }, forces);
        Ok(())
    })
}

/// Write the normals of a stream's present draw, and go on to the next one; for tests of the generator.
///
/// # Safety
/// `stream` must be alive; `normals` must have room for `length` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Random_normals(
    stream: *mut Stream,
    length: i64,
    normals: *mut f64,
) -> Status {
    guarded(SUBJECT, || {
        if length > 0 {
            let out = unsafe { slices::from_raw_parts_mut(normals, length as usize) };
            random::normals(unsafe { &mut *stream }, out);
        }
        Ok(())
    })
}
