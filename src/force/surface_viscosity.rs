//! Surface viscosity for Rust programs.

use super::owned::{Owned, handed_over, setters};
use super::{c_text, check};
use crate::error::{Error, Result};
use crate::ffi::c_api;
use crate::openmm::OpenMM_Force;
use std::ffi::c_int;

/// What makes a membrane viscous: an OpenMM `Force` that lets friction and noise act along the edges of its triangles.
/// The C++ class of this name says how.
///
/// ```
/// use openmm_helfrich::force::SurfaceViscosityThermostat;
/// let octahedron =
///     [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mut thermostat = SurfaceViscosityThermostat::new(&octahedron, 20.0, 300.0)?;
/// thermostat.set_frequency(2)?.set_friction_parameter("FrictionOfA")?.set_seed(1)?;
/// assert!(thermostat.set_frequency(-1).is_err());
/// assert!(SurfaceViscosityThermostat::new(&octahedron, -20.0, 300.0).is_err());
/// # Ok::<(), openmm_helfrich::error::Error>(())
/// ```
pub struct SurfaceViscosityThermostat {
    force: Owned,
}

impl SurfaceViscosityThermostat {
    /// Friction in amu/ps and noise of a temperature in K at every step, on triangles of particle indices,
    /// counter-clockwise seen from outside.
    ///
    /// # Errors
    /// A friction below zero, or a temperature that is not above it.
    pub fn new(triangles: &[[c_int; 3]], friction: f64, temperature: f64) -> Result<Self> {
        let count = c_int::try_from(triangles.len())
            .map_err(|_| Error::Contract("too many triangles".to_owned()))?;
        let corners = triangles.as_flattened().as_ptr();
        // SAFETY: the array is as long as is said, and the shim copies it.
        let force = unsafe {
            c_api::Helfrich_SurfaceViscosityThermostat_create(
                corners,
                count,
                friction,
                temperature,
                1,
            )
        };
        // SAFETY: nobody else has it.
        let force = unsafe { Owned::new(force) }?;
        Ok(Self { force })
    }

    setters! {
        /// Act every so many steps, or never if it is 0.
        ///
        /// # Errors
        /// A number below zero.
        fn set_frequency(steps: c_int) = Helfrich_SurfaceViscosityThermostat_setFrequency;
    }

    /// Name the Context parameter that holds the friction.
    ///
    /// # Errors
    /// An empty name, or that of the temperature.
    pub fn set_friction_parameter(&mut self, name: &str) -> Result<&mut Self> {
        let name = c_text(name)?;
        // SAFETY: the force is alive and the name ends with a NUL.
        check(unsafe {
            c_api::Helfrich_SurfaceViscosityThermostat_setFrictionParameter(
                self.force.as_ptr(),
                name.as_ptr(),
            )
        })?;
        Ok(self)
    }

    setters! {
        /// Seed the random numbers; 0 for a seed of its own in each Context.
        ///
        /// # Errors
        /// None.
        fn set_seed(seed: c_int) = Helfrich_SurfaceViscosityThermostat_setRandomNumberSeed;
    }

    handed_over!();
}
