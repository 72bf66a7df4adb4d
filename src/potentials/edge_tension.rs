//! Line tension of borders: E = γ L with L the length of all borders, nothing on a closed surface. A disk of area A has
//! E = γ √(4π A); it closes to a vesicle where that is more than a sphere costs (W. Helfrich,
//! doi:10.1016/0375-9601(74)90899-8).

use super::{Contribution, Domain, Needs, Parameter, Potential, Sums, Term};
use crate::mesh::borders::{BorderPartials, BorderTotals};

/// Borders are expensive, since lipids have to bend round there, and shrink.
pub struct EdgeTension;

impl Potential for EdgeTension {
    fn name(&self) -> &'static str {
        "EdgeTensionForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::new(c"tension", 1, -1, Domain::Real)] }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::BORDERS
    }

    fn borders(
        &self,
        &Term { values: [tension, ..], .. }: &Term,
        totals: &BorderTotals,
        partials: &mut BorderPartials,
    ) -> Contribution {
        partials.length += tension;
        let by_parameter = [totals.length, 0.0];
        Contribution::from(Sums { energy: tension * totals.length, by_parameter })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_is_linear_in_length_and_tension() {
        let term = Term::new("EdgeTensionForce", 0, &[1.5]).unwrap();
        let totals = BorderTotals { length: 4.0, turning: 1.0, euler_characteristic: 1.0 };
        let mut partials = BorderPartials::default();
        let sum = EdgeTension.borders(&term, &totals, &mut partials);
        assert_eq!((sum.energy, sum.by_parameter[0]), (6.0, 4.0));
        assert_eq!(partials, BorderPartials { length: 1.5, turning: 0.0 });
    }
}
