//! Constant tension for Rust programs.

use super::check;
use super::owned::{Owned, statistic};
use crate::c_api;
use crate::error::Result;
use crate::openmm::{OpenMM_Context, OpenMM_Force};
use std::ffi::c_int;

/// Which edges of the box change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// x and y by the same factor.
    XyIsotropic = 0,
    /// x or y, by chance.
    XyIndependent = 1,
    /// x by a factor and y by its inverse.
    XyConstantArea = 2,
    /// z, against the pulling force.
    ZOnly = 3,
}

/// What keeps a membrane that spans the periodic box at constant tension: an OpenMM `Force` that scales the box and
/// all positions with it. The C++ class of this name says how.
///
/// ```
/// use openmm_helfrich::force::{Axes, MonteCarloMembraneTension};
/// let mut mover = MonteCarloMembraneTension::new(300.0, 0.5, Axes::XyIsotropic)?;
/// mover.set_frequency(20)?.set_adaptive_moves(100)?.set_seed(1)?;
/// assert!(mover.set_frequency(-1).is_err());
/// assert!(MonteCarloMembraneTension::new(-1.0, 0.5, Axes::ZOnly).is_err());
/// # Ok::<(), openmm_helfrich::error::Error>(())
/// ```
pub struct MonteCarloMembraneTension {
    force: Owned,
}

impl MonteCarloMembraneTension {
    /// Moves at a temperature in K, with the defaults of the C++ class. `tension` is the tension of the frame,
    /// kJ/mol/nm², or for [`Axes::ZOnly`] the pulling force, kJ/mol/nm.
    ///
    /// # Errors
    /// A temperature that is not above zero, or a tension that is not finite.
    pub fn new(temperature: f64, tension: f64, axes: Axes) -> Result<Self> {
        let (in_plane, along_z) = if axes == Axes::ZOnly { (0.0, tension) } else { (tension, 0.0) };
        // SAFETY: there are no pointers.
        let force = unsafe {
            c_api::Helfrich_MonteCarloMembraneTension_create(
                temperature,
                in_plane,
                25,
                axes as c_int,
                along_z,
            )
        };
        // SAFETY: nobody else has it.
        let force = unsafe { Owned::new(force) }?;
        Ok(Self { force })
    }

    /// Try a move every so many steps, or never if it is 0.
    ///
    /// # Errors
    /// A number below zero.
    pub fn set_frequency(&mut self, steps: c_int) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloMembraneTension_setFrequency(self.force.as_ptr(), steps)
        })?;
        Ok(self)
    }

    /// Adapt the width of so many moves.
    ///
    /// # Errors
    /// A number below zero.
    pub fn set_adaptive_moves(&mut self, moves: c_int) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloMembraneTension_setAdaptiveMoves(self.force.as_ptr(), moves)
        })?;
        Ok(self)
    }

    /// Move molecules other than periodic membranes by their centres, or scale every particle.
    ///
    /// # Errors
    /// None.
    pub fn set_scale_molecules_as_rigid(&mut self, rigid: bool) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MonteCarloMembraneTension_setScaleMoleculesAsRigid(
                self.force.as_ptr(),
                rigid.into(),
            )
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
            c_api::Helfrich_MonteCarloMembraneTension_setRandomNumberSeed(self.force.as_ptr(), seed)
        })?;
        Ok(self)
    }

    /// One of the statistics of a Context, such as "accepted".
    ///
    /// # Errors
    /// An unknown name, or a Context that the force does not belong to.
    ///
    /// # Safety
    /// `force` must be a MonteCarloMembraneTension, and `context` a Context, of OpenMM's C API; both must be alive.
    pub unsafe fn statistic(
        force: *mut OpenMM_Force,
        context: *mut OpenMM_Context,
        name: &str,
    ) -> Result<f64> {
        // SAFETY: the caller's promise.
        unsafe {
            statistic(c_api::Helfrich_MonteCarloMembraneTension_getStatistic, force, context, name)
        }
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
