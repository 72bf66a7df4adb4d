//! A pressure difference: E = −p V, p = p_inside − p_outside. With bending and a tension it is the functional of H. J.
//! Deuling and W. Helfrich, doi:10.1051/jphys:0197600370110133500, whose Δp is p_outside − p_inside.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term, Total};
use crate::mesh::geometry::{TotalPartials, Totals};

/// The membrane is blown up, or sucked in.
pub struct Pressure;

impl Potential for Pressure {
    fn name(&self) -> &'static str {
        "PressureForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::new(c"pressure", 1, -3, Domain::Real)] }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TOTALS
    }

    fn needs_outside(&self) -> bool {
        true
    }

    fn reference(&self, _: &Term) -> Option<Total> {
        Some(Total::Volume(0.0))
    }

    fn totals(
        &self,
        &Term { values: [pressure, ..], .. }: &Term,
        totals: &Totals,
        partials: &mut TotalPartials,
    ) -> Contribution {
        partials.volume -= pressure;
        let by_parameter = [-totals.volume, 0.0, 0.0, 0.0];
        Contribution { energy: -pressure * totals.volume, by_parameter }
    }
}
