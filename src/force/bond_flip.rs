//! Bond flips for Rust programs.

use super::check;
use super::owned::{Owned, handed_over, setters, statistic, statistics};
use crate::error::{Error, Result};
use crate::ffi::c_api;
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

    setters! {
        /// Try flips every so many steps, or never if it is 0.
        ///
        /// # Errors
        /// A number below zero.
        fn set_frequency(steps: c_int) = Helfrich_MonteCarloBondFlip_setFrequency;

        /// Try so many flips each time, for each edge.
        ///
        /// # Errors
        /// A number that is not from 0 to 1000.
        fn set_attempts_per_edge(attempts: f64) = Helfrich_MonteCarloBondFlip_setAttemptsPerEdge;
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

    setters! {
        /// Let no new edge be longer than this, nm; 0 for any length.
        ///
        /// # Errors
        /// A length that is not finite, or below zero.
        fn set_max_edge_length(length: f64) = Helfrich_MonteCarloBondFlip_setMaxEdgeLength;

        /// Let a demon pay for flips in place of a bath, or a bath again.
        ///
        /// # Errors
        /// None.
        fn set_microcanonical(demon: bool) = Helfrich_MonteCarloBondFlip_setEnsemble;

        /// Seed the random numbers; 0 for a seed of its own in each Context.
        ///
        /// # Errors
        /// None.
        fn set_seed(seed: c_int) = Helfrich_MonteCarloBondFlip_setRandomNumberSeed;
    }

    statistics!(Helfrich_MonteCarloBondFlip_getStatistic);

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
        let count = unsafe { c_api::Helfrich_MembraneForce_getNumTriangles(force) };
        let count = usize::try_from(count).map_err(|_| Error::Contract(last_error()))?;
        let mut triangles = vec![[0; 3]; count];
        // SAFETY: the caller's promise, and there is room for all triangles.
        check(unsafe {
            c_api::Helfrich_MembraneForce_getTrianglesInContext(
                force,
                context,
                triangles.as_flattened_mut().as_mut_ptr(),
            )
        })?;
        Ok(triangles)
    }

    handed_over!();
}
