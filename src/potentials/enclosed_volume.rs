//! Global volume: E = ½ k_V (V − V₀)² / V₀, equation (2) of doi:10.1103/PhysRevE.108.015301.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term, Total, relative_spring};
use crate::mesh::geometry::{TotalPartials, Totals};

/// The membrane resists changes of the volume that it encloses.
pub struct EnclosedVolume;

impl Potential for EnclosedVolume {
    fn name(&self) -> &'static str {
        "EnclosedVolumeForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"modulus", 1, -3, Domain::NonNegative),
                Parameter::new(c"target", 0, 3, Domain::Positive),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TOTALS
    }

    fn needs_outside(&self) -> bool {
        true
    }

    fn reference(&self, term: &Term) -> Option<Total> {
        Some(Total::Volume(term.values[1]))
    }

    fn totals(
        &self,
        &Term { values: [modulus, target, ..], .. }: &Term,
        totals: &Totals,
        partials: &mut TotalPartials,
    ) -> Contribution {
        let (sums, slope) = relative_spring(modulus, target, totals.volume);
        partials.volume += slope;
        Contribution::from(sums)
    }
}
