//! Area-difference elasticity: E = ½ m (M − M₀)² with M the integral of the mean curvature.
//!
//! Two monolayers at a distance D have areas that differ by ΔA = 2 D M. L. Miao, U. Seifert, M. Wortis and H.-G. Döbereiner
//! (doi:10.1103/PhysRevE.49.5389), and U. Seifert (doi:10.1080/00018739700101488), write E = α κ π (ΔA − ΔA₀)² / (2 A D²);
//! so m = 4 π α κ / A and M₀ = ΔA₀ / 2 D. A in m is a number here, that of the relaxed membrane.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term, Total};
use crate::mesh::geometry::{TotalPartials, Totals};

/// The two monolayers of a membrane resist changes of their difference in area.
pub struct AreaDifference;

impl Potential for AreaDifference {
    fn name(&self) -> &'static str {
        "AreaDifferenceForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"modulus", 1, -2, Domain::NonNegative),
                Parameter::new(c"target", 0, 1, Domain::Real),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TOTALS | Needs::CURVATURES | Needs::MEAN_CURVATURE
    }

    fn reference(&self, term: &Term) -> Option<Total> {
        Some(Total::MeanCurvature(term.values[1]))
    }

    fn totals(
        &self,
        &Term { values: [modulus, target, ..], .. }: &Term,
        totals: &Totals,
        partials: &mut TotalPartials,
    ) -> Contribution {
        let excess = totals.mean_curvature - target;
        let (by_modulus, slope) = (0.5 * excess * excess, modulus * excess);
        partials.mean_curvature += slope;
        Contribution { energy: modulus * by_modulus, by_parameter: [by_modulus, -slope, 0.0, 0.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_exact() {
        let at = |modulus: f64, target: f64, mean_curvature: f64| {
            let term = Term::new("AreaDifferenceForce", 0, &[modulus, target]).unwrap();
            let (totals, mut partials) =
                (Totals { mean_curvature, ..Totals::default() }, TotalPartials::default());
            (AreaDifference.totals(&term, &totals, &mut partials), partials.mean_curvature)
        };
        let (m, m0, value) = (0.7, -30.0, 110.0);
        let (found, slope) = at(m, m0, value);
        let central = |f: &dyn Fn(f64) -> f64| (f(1e-3) - f(-1e-3)) / 2e-3;
        assert!((slope - central(&|h| at(m, m0, value + h).0.energy)).abs() < 1e-6);
        assert!((found.by_parameter[0] - central(&|h| at(m + h, m0, value).0.energy)).abs() < 1e-6);
        assert!((found.by_parameter[1] - central(&|h| at(m, m0 + h, value).0.energy)).abs() < 1e-6);
    }
}
