//! What every evaluator refuses.

use crate::error::{Error, Result};
use crate::mesh::geometry::TotalPartials;
use crate::potentials::{Contribution, Term};

/// Refuse an energy that is not finite; names the force.
pub fn check_energies(terms: &[Term], contributions: &[Contribution]) -> Result<()> {
    for (term, contribution) in terms.iter().zip(contributions) {
        if !contribution.energy.is_finite() {
            let (force, energy) = (term.potential.name(), contribution.energy);
            return Err(Error::NonFiniteEnergy { force, energy });
        }
    }
    Ok(())
}

/// Refuse an energy of totals whose derivatives are not finite, so that no force would be; names the force.
pub fn check_totals(
    term: &Term,
    contribution: &Contribution,
    partials: &TotalPartials,
) -> Result<()> {
    if partials.are_finite() {
        return Ok(());
    }
    let (force, energy) = (term.potential.name(), contribution.energy);
    Err(Error::NonFiniteEnergy { force, energy })
}
