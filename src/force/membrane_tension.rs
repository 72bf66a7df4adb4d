//! Constant tension for Rust programs.

use super::check;
use super::owned::{Owned, handed_over, setters, statistic, statistics};
use crate::error::Result;
use crate::ffi::c_api;
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

    setters! {
        /// Try a move every so many steps, or never if it is 0.
        ///
        /// # Errors
        /// A number below zero.
        fn set_frequency(steps: c_int) = Helfrich_MonteCarloMembraneTension_setFrequency;

        /// Adapt the width of so many moves.
        ///
        /// # Errors
        /// A number below zero.
        fn set_adaptive_moves(moves: c_int) = Helfrich_MonteCarloMembraneTension_setAdaptiveMoves;

        /// Move molecules other than periodic membranes by their centres, or scale every particle.
        ///
        /// # Errors
        /// None.
        fn set_scale_molecules_as_rigid(rigid: bool) = Helfrich_MonteCarloMembraneTension_setScaleMoleculesAsRigid;

        /// Seed the random numbers; 0 for a seed of its own in each Context.
        ///
        /// # Errors
        /// None.
        fn set_seed(seed: c_int) = Helfrich_MonteCarloMembraneTension_setRandomNumberSeed;
    }

    statistics!(Helfrich_MonteCarloMembraneTension_getStatistic);

    handed_over!();
}
