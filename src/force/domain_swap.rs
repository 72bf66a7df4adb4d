//! Exchanges between neighbours for Rust programs.

use super::owned::{Owned, handed_over, setters, statistic, statistics};
use super::{MonteCarloBondFlip, check};
use crate::error::{Error, Result};
use crate::ffi::c_api;
use crate::openmm::{OpenMM_Context, OpenMM_Force};
use std::collections::BTreeSet;
use std::ffi::c_int;

/// What makes the components of a membrane diffuse: an OpenMM `Force` that lets neighbours exchange what they are. The
/// C++ class of this name says how.
///
/// ```
/// use openmm_helfrich::force::MonteCarloDomainSwap;
/// let octahedron =
///     [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mut mover = MonteCarloDomainSwap::new(&octahedron, 300.0)?;
/// mover.set_frequency(20)?.set_attempts_per_edge(0.3)?.set_seed(1)?;
/// assert!(mover.set_attempts_per_edge(f64::NAN).is_err());
/// # Ok::<(), openmm_helfrich::error::Error>(())
/// ```
pub struct MonteCarloDomainSwap {
    force: Owned,
}

impl MonteCarloDomainSwap {
    /// Exchanges on triangles of particle indices, counter-clockwise seen from outside, at a temperature in K, with the
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
            c_api::Helfrich_MonteCarloDomainSwap_create(corners, count, temperature, 10, 0.1)
        };
        // SAFETY: nobody else has it.
        let force = unsafe { Owned::new(force) }?;
        Ok(Self { force })
    }

    setters! {
        /// Try exchanges every so many steps, or never if it is 0.
        ///
        /// # Errors
        /// A number below zero.
        fn set_frequency(steps: c_int) = Helfrich_MonteCarloDomainSwap_setFrequency;

        /// Try so many exchanges each time, for each edge.
        ///
        /// # Errors
        /// A number that is not from 0 to 1000.
        fn set_attempts_per_edge(attempts: f64) = Helfrich_MonteCarloDomainSwap_setAttemptsPerEdge;

        /// Let a demon pay for exchanges in place of a bath, or a bath again.
        ///
        /// # Errors
        /// None.
        fn set_microcanonical(demon: bool) = Helfrich_MonteCarloDomainSwap_setEnsemble;

        /// Seed the random numbers; 0 for a seed of its own in each Context.
        ///
        /// # Errors
        /// None.
        fn set_seed(seed: c_int) = Helfrich_MonteCarloDomainSwap_setRandomNumberSeed;
    }

    statistics!(Helfrich_MonteCarloDomainSwap_getStatistic);

    /// For each vertex of a Context, in ascending order of particle index, the one whose values it has now; for any membrane
    /// force or mover of it.
    ///
    /// # Errors
    /// A Context that the force does not belong to.
    ///
    /// # Safety
    /// As for [`Self::statistic`].
    pub unsafe fn permutation_in(
        force: *mut OpenMM_Force,
        context: *mut OpenMM_Context,
    ) -> Result<Vec<c_int>> {
        // SAFETY: the caller's promise.
        let triangles = unsafe { MonteCarloBondFlip::triangles_in(force, context) }?;
        let vertices: BTreeSet<_> = triangles.as_flattened().iter().collect();
        let mut permutation = vec![0; vertices.len()];
        // SAFETY: the caller's promise, and there is room for all vertices.
        check(unsafe {
            c_api::Helfrich_MembraneForce_getPermutationInContext(
                force,
                context,
                permutation.as_mut_ptr(),
            )
        })?;
        Ok(permutation)
    }

    /// Let the vertices of a Context have each other's values.
    ///
    /// # Errors
    /// What is no permutation, or a Context that the force does not belong to.
    ///
    /// # Safety
    /// As for [`Self::statistic`].
    pub unsafe fn set_permutation_in(
        force: *mut OpenMM_Force,
        context: *mut OpenMM_Context,
        permutation: &[c_int],
    ) -> Result<()> {
        // SAFETY: the caller's promise, and the vertices are as many as is said.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setPermutationInContext(
                force,
                context,
                permutation.as_ptr(),
                permutation.len() as c_int,
            )
        })
    }

    handed_over!();
}
