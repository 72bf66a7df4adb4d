//! Minimal triangle areas: E = Σ_t ε [ (a_m/a)⁸ − (a_m/a)⁴ + ¼ ] over the triangles with a < 2^¼ a_m,
//! else 0: the purely repulsive potential of Weeks, Chandler and Andersen's kind that VCM offers for
//! areas (`WCA`, `GWCA`) as it does for heights. Unlike VCM's it is continuous at the cutoff.

use super::{
    Contribution, Domain, Needs, Parameter, Place, Potential, Sums, Term, Triangle,
    TriangleFormula, Triangles, repulsion,
};
use crate::mesh::geometry::TrianglePartials;
use crate::real::Real;

/// A repulsion between the sides of a triangle that shrinks.
pub struct TriangleAreaRepulsion;

impl Potential for TriangleAreaRepulsion {
    fn name(&self) -> &'static str {
        "TriangleAreaRepulsionForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"minArea", 0, 2, Domain::NonNegative),
                Parameter::new(c"epsilon", 1, 0, Domain::NonNegative),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TRIANGLES
    }

    fn triangles(&self, term: &Term, run: Triangles) -> Contribution {
        let [min_area, epsilon, ..] = term.values;
        run.apply(term, &Repulsion { min_area, epsilon })
    }
}

struct Repulsion {
    min_area: f64,
    epsilon: f64,
}

impl TriangleFormula for Repulsion {
    #[inline(always)]
    fn apply<R: Real>(
        &self,
        _: Place,
        triangle: &Triangle<R>,
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R> {
        let area = triangle.area();
        let ratio = area.of(self.min_area) / area;
        let x = (ratio * ratio) * (ratio * ratio);
        let (square, by_x) = repulsion(x);
        let slope = by_x * x * (4.0 * self.epsilon);
        partials.area = partials.area - slope / area;
        // With a_m = 0 there is no repulsion, and x is 0.
        let by_min_area = if self.min_area > 0.0 { slope * (1.0 / self.min_area) } else { x };
        Sums { energy: square * self.epsilon, by_parameter: [by_min_area, square] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::{TriangleGeometry, TrianglePartials, Vec3};

    #[test]
    fn energy_and_derivatives_are_those_of_the_formula() {
        let at = |area: f64, min_area: f64, epsilon: f64| {
            let triangle =
                TriangleGeometry { normal: Vec3::zeros(), twice_area: 2.0 * area, dots: [1.0; 3] };
            let term = Term::new("TriangleAreaRepulsionForce", 0, &[min_area, epsilon]).unwrap();
            let mut partials = [TrianglePartials::default()];
            let run = Triangles::Plain { first: 0, geometry: &[triangle], partials: &mut partials };
            (TriangleAreaRepulsion.triangles(&term, run), partials[0].area)
        };
        let (a, m, e): (f64, f64, f64) = (1.1, 1.0, 2.0);
        let (sum, slope) = at(a, m, e);
        let expected = e * ((m / a).powi(8) - (m / a).powi(4) + 0.25);
        assert!((sum.energy / expected - 1.0).abs() < 1e-13);
        assert_eq!(at(2f64.powf(0.25) * 1.0001, m, e).0.energy, 0.0);
        let h = 1e-6;
        let central = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        for (found, expected) in [
            (slope, central(&|s| at(a + s, m, e).0.energy)),
            (sum.by_parameter[0], central(&|s| at(a, m + s, e).0.energy)),
            (sum.by_parameter[1], central(&|s| at(a, m, e + s).0.energy)),
        ] {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
