//! What is asked of an evaluator.

use super::{Contribution, Term};
use crate::error::{Error, Result};

/// Terms to evaluate together at some positions, and where the results go.
pub struct Request<'a, 't> {
    /// What to evaluate.
    pub terms: &'a [Term<'t>],
    /// Of all particles, x y z of one after the other, nm.
    pub positions: &'a [f64],
    /// Is set to the energy of each term; empty if nobody wants to know.
    pub energies: &'a mut [Contribution],
    /// Is **added** to, kJ/mol/nm, in the layout of the positions; `None` if nobody wants to know.
    pub forces: Option<&'a mut [f64]>,
}

/// Evaluates any terms on one mesh.
pub trait Evaluator {
    /// Do what is asked.
    ///
    /// # Errors
    /// A position of the mesh that is not finite; a triangle without area; an energy that overflows, if energies are
    /// wanted; arrays of wrong length. Nothing has been added to the forces then.
    fn evaluate(&mut self, request: Request) -> Result<()>;
}

impl<'a, 't> Request<'a, 't> {
    /// Neither energies nor forces yet.
    pub fn new(terms: &'a [Term<'t>], positions: &'a [f64]) -> Self {
        Self { terms, positions, energies: &mut [], forces: None }
    }

    /// With a place for the energy of each term, or none.
    #[must_use]
    pub fn with_energies(self, energies: &'a mut [Contribution]) -> Self {
        Self { energies, ..self }
    }

    /// With forces to add to, or none.
    #[must_use]
    pub fn with_forces(self, forces: impl Into<Option<&'a mut [f64]>>) -> Self {
        Self { forces: forces.into(), ..self }
    }

    /// The same request again, which lends its arrays to another evaluator for a while.
    pub fn again(&mut self) -> Request<'_, 't> {
        Request {
            terms: self.terms,
            positions: self.positions,
            energies: self.energies,
            forces: self.forces.as_deref_mut(),
        }
    }

    /// Refuse arrays of wrong length.
    ///
    /// # Errors
    /// Says how long they are to be.
    pub fn check(&self, particles: usize) -> Result<()> {
        let fits = |forces: &&mut [f64]| forces.len() == self.positions.len();
        let counts = self.energies.is_empty() || self.energies.len() == self.terms.len();
        if self.positions.len() >= 3 * particles && self.forces.as_ref().is_none_or(fits) && counts
        {
            return Ok(());
        }
        Err(Error::Contract(format!(
            "needs positions and forces of {particles} particles or more and one contribution a term, or none"
        )))
    }
}
