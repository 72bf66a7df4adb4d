//! A surface tension: E = σ A. With bending and a pressure it is the functional of H. J. Deuling and W. Helfrich,
//! doi:10.1051/jphys:0197600370110133500, whose λ is σ.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term, Total};
use crate::mesh::geometry::{TotalPartials, Totals};

/// Area costs energy, or gains it.
pub struct SurfaceTension;

impl Potential for SurfaceTension {
    fn name(&self) -> &'static str {
        "SurfaceTensionForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::new(c"tension", 1, -2, Domain::Real)] }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TOTALS
    }

    fn reference(&self, _: &Term) -> Option<Total> {
        Some(Total::Area(0.0))
    }

    fn totals(
        &self,
        &Term { values: [tension, ..], .. }: &Term,
        totals: &Totals,
        partials: &mut TotalPartials,
    ) -> Contribution {
        partials.area += tension;
        let by_parameter = [totals.area, 0.0, 0.0, 0.0];
        Contribution { energy: tension * totals.area, by_parameter }
    }
}
