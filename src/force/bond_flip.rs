//! Bond flips for Rust programs.

use super::check;
use super::owned::{Owned, statistic};
use crate::c_api;
use crate::error::{Error, Result};
use crate::ffi::last_error;
use crate::openmm::{OpenMM_Context, OpenMM_Force};
use std::ffi::c_int;

/// What makes a membrane fluid: an OpenMM `Force` that flips edges of its triangles. The C++ class of this name
/// says how.
///
/// ```
/// use openmm_helfrich::force::MonteCarloBondFlip;
/// let octahedron =
///     [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mut mover = MonteCarloBondFlip::new(&octahedron, 300.0)?;
/// mover.set_frequency(20)?.set_attempts_per_edge(0.3)?.set_degrees(3, 8)?.set_seed(1)?;
/// assert!(mover.set_max_edge_length(f64::NAN).is_err());
/// # Ok::<(), openmm_helfrich::error::Error>(())
/// ```
pub struct MonteCarloBondFlip {
    force: Owned,
}

impl MonteCarloBondFlip {
    /// Flips on triangles of particle indices, counter-clockwise seen from outside, at a temperature in K, with the
    /// defaults of the C++ class.
    ///
    /// # Errors
    /// A temperature that is not above zero.
    pub fn new(triangles: &[[c_int; 3]], temperature: f64) -> Result<Self> {
        let count = c_int::try_from(triangles.len())
            .map_err(|_| Error::Contract("too many triangles".to_owned()))?;
        let corners = triangles.as_flattened().as_ptr();
        // SAFETY: the array is as long as is said, and the shim copies it.
        let force = unsafe {
            c_api::Helfrich_MonteCarloBondFlip_create(
                corners,
                count,
                temperature,
                10,
                0.1,
                3,
                10,
                0.0,
            )
        };
        // SAFETY: nobody else has it.
        let force = unsafe { Owned::new(force) }?;
        Ok(Self { force })
    }

    /// Try flips every so many steps, or never if it is 0.
    ///
    /// # Errors
    /// A number below zero.
    pub fn set_frequency(&mut self, steps: c_int) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloBondFlip_setFrequency(self.force.as_ptr(), steps)
        })?;
        Ok(self)
    }

    /// Try so many flips each time, for each edge.
    ///
    /// # Errors
    /// A number that is not from 0 to 1000.
    pub fn set_attempts_per_edge(&mut self, attempts: f64) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloBondFlip_setAttemptsPerEdge(self.force.as_ptr(), attempts)
        })?;
        Ok(self)
    }

    /// Leave every vertex with so many neighbours.
    ///
    /// # Errors
    /// A number below 3.
    pub fn set_degrees(&mut self, min: c_int, max: c_int) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloBondFlip_setMinDegree(self.force.as_ptr(), min)
        })?;
        // SAFETY: as above.
        check(unsafe {
            c_api::Helfrich_MonteCarloBondFlip_setMaxDegree(self.force.as_ptr(), max)
        })?;
        Ok(self)
    }

    /// Let no new edge be longer than this, nm; 0 for any length.
    ///
    /// # Errors
    /// A length that is not finite, or below zero.
    pub fn set_max_edge_length(&mut self, length: f64) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloBondFlip_setMaxEdgeLength(self.force.as_ptr(), length)
        })?;
        Ok(self)
    }

    /// Let a demon pay for flips in place of a bath, or a bath again.
    ///
    /// # Errors
    /// None.
    pub fn set_microcanonical(&mut self, demon: bool) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloBondFlip_setEnsemble(self.force.as_ptr(), demon.into())
        })?;
        Ok(self)
    }

    /// Seed the random numbers; 0 for a seed of its own in each Context.
    ///
    /// # Errors
    /// None.
    pub fn set_seed(&mut self, seed: c_int) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloBondFlip_setRandomNumberSeed(self.force.as_ptr(), seed)
        })?;
        Ok(self)
    }

    /// One of the statistics of a Context, such as "accepted".
    ///
    /// # Errors
    /// An unknown name, or a Context that the force does not belong to.
    ///
    /// # Safety
    /// `force` must be a MonteCarloBondFlip, and `context` a Context, of OpenMM's C API; both must be alive.
    pub unsafe fn statistic(
        force: *mut OpenMM_Force,
        context: *mut OpenMM_Context,
        name: &str,
    ) -> Result<f64> {
        // SAFETY: the caller's promise.
        unsafe { statistic(c_api::Helfrich_MonteCarloBondFlip_getStatistic, force, context, name) }
    }

    /// The particles at the corners of the triangles in a Context, for any membrane force or mover of it.
    ///
    /// # Errors
    /// A Context that the force does not belong to.
    ///
    /// # Safety
    /// As for [`Self::statistic`].
    pub unsafe fn triangles_in(
        force: *mut OpenMM_Force,
        context: *mut OpenMM_Context,
    ) -> Result<Vec<[c_int; 3]>> {
        // SAFETY: the caller's promise.
        let count = unsafe { c_api::Helfrich_MembraneForce_getNumTriangles(force.cast()) };
        let count = usize::try_from(count).map_err(|_| Error::Contract(last_error()))?;
        let mut triangles = vec![[0; 3]; count];
        // SAFETY: the caller's promise, and there is room for all triangles.
        check(unsafe {
            c_api::Helfrich_MembraneForce_getTrianglesInContext(
                force.cast(),
                context.cast(),
                triangles.as_flattened_mut().as_mut_ptr(),
            )
        })?;
        Ok(triangles)
    }

    /// The force as OpenMM's C API knows it, to steer it when a System has taken it over.
    pub fn as_openmm(&self) -> *mut OpenMM_Force {
        self.force.as_openmm()
    }

    /// The force for `OpenMM_System_addForce`, which takes it over.
    pub fn into_openmm(self) -> *mut OpenMM_Force {
        self.force.into_openmm()
    }
}
