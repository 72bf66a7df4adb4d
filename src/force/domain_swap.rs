//! Exchanges between neighbours for Rust programs.

use super::owned::{Owned, statistic};
use super::{MonteCarloBondFlip, check};
use crate::c_api;
use crate::error::{Error, Result};
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

    /// Try exchanges every so many steps, or never if it is 0.
    ///
    /// # Errors
    /// A number below zero.
    pub fn set_frequency(&mut self, steps: c_int) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloDomainSwap_setFrequency(self.force.as_ptr(), steps)
        })?;
        Ok(self)
    }

    /// Try so many exchanges each time, for each edge.
    ///
    /// # Errors
    /// A number that is not from 0 to 1000.
    pub fn set_attempts_per_edge(&mut self, attempts: f64) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloDomainSwap_setAttemptsPerEdge(self.force.as_ptr(), attempts)
        })?;
        Ok(self)
    }

    /// Let a demon pay for exchanges in place of a bath, or a bath again.
    ///
    /// # Errors
    /// None.
    pub fn set_microcanonical(&mut self, demon: bool) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloDomainSwap_setEnsemble(self.force.as_ptr(), demon.into())
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
            c_api::Helfrich_MonteCarloDomainSwap_setRandomNumberSeed(self.force.as_ptr(), seed)
        })?;
        Ok(self)
    }

    /// One of the statistics of a Context, such as "accepted".
    ///
    /// # Errors
    /// An unknown name, or a Context that the force does not belong to.
    ///
    /// # Safety
    /// `force` must be a MonteCarloDomainSwap, and `context` a Context, of OpenMM's C API; both must be alive.
    pub unsafe fn statistic(
        force: *mut OpenMM_Force,
        context: *mut OpenMM_Context,
        name: &str,
    ) -> Result<f64> {
        let get = c_api::Helfrich_MonteCarloDomainSwap_getStatistic;
        // SAFETY: the caller's promise.
        unsafe { statistic(get, force, context, name) }
    }

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
                force.cast(),
                context.cast(),
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
                force.cast(),
                context.cast(),
                permutation.as_ptr(),
                permutation.len() as c_int,
            )
        })
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
