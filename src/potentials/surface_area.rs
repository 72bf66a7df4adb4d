//! Global area: E = ½ k_A (A − A₀)² / A₀, equation (1) of doi:10.1103/PhysRevE.108.015301.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term, Total, relative_spring};
use crate::mesh::geometry::{TotalPartials, Totals};

/// The whole membrane resists changes of its area; patches of it do not.
pub struct SurfaceArea;

impl Potential for SurfaceArea {
    fn name(&self) -> &'static str {
        "SurfaceAreaForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"modulus", 1, -2, Domain::NonNegative),
                Parameter::new(c"target", 0, 2, Domain::Positive),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TOTALS
    }

    fn reference(&self, term: &Term) -> Option<Total> {
        Some(Total::Area(term.values[1]))
    }

    fn totals(
        &self,
        &Term { values: [modulus, target, ..], .. }: &Term,
        totals: &Totals,
        partials: &mut TotalPartials,
    ) -> Contribution {
        let (sums, slope) = relative_spring(modulus, target, totals.area);
        partials.area += slope;
        Contribution::from(sums)
    }
}
