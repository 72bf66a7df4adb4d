//! Triangle heights: E = Σ_t Σ_h ε [ (d/h)⁸ − (d/h)⁴ + ¼ ] over the three heights h of each triangle
//! where h < 2^¼ d, else 0: the auxiliary potential of doi:10.1103/PhysRevE.108.015301. It keeps a
//! fluid mesh from degenerating: no vertex can cross the side opposite it.

use super::{
    Contribution, Domain, Needs, Parameter, Place, Potential, Sums, Term, Triangle,
    TriangleFormula, Triangles, repulsion,
};
use crate::mesh::geometry::TrianglePartials;
use crate::real::Real;

/// A purely repulsive potential on the heights of triangles, of Weeks, Chandler and Andersen's kind.
pub struct TriangleHeight;

impl Potential for TriangleHeight {
    fn name(&self) -> &'static str {
        "TriangleHeightForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"minHeight", 0, 1, Domain::NonNegative),
                Parameter::new(c"epsilon", 1, 0, Domain::NonNegative),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TRIANGLES
    }

    fn triangles(&self, term: &Term, run: Triangles) -> Contribution {
        let [min_height, epsilon, ..] = term.values;
        run.apply(term, &Heights { min_height, epsilon })
    }
}

struct Heights {
    min_height: f64,
    epsilon: f64,
}

impl TriangleFormula for Heights {
    /// Most triangles are far from any repulsion; to see that takes no division.
    #[inline(always)]
    fn vanishes<R: Real>(&self, triangle: &Triangle<R>) -> bool {
        let four_areas = triangle.twice_area * triangle.twice_area;
        let [a, b, c] = sides(triangle);
        let reach = a.max(b).max(c) * (self.min_height * self.min_height);
        !reach.any(reach.above(four_areas * std::f64::consts::FRAC_1_SQRT_2))
    }

    /// With h = 2a/l and x = (d/h)⁴ = (d l / 2a)⁴ the energy of a height is ε (x − ½)², for x > ½.
    #[inline(always)]
    fn apply<R: Real>(
        &self,
        _: Place,
        triangle: &Triangle<R>,
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R> {
        let &Self { min_height, epsilon } = self;
        let four_areas = triangle.twice_area * triangle.twice_area;
        let zero = four_areas.zero();
        let sides = sides(triangle);
        let squared = min_height * min_height;
        let scale = zero.of(squared) / four_areas;
        let (mut squares, mut slope_sum) = (zero, zero);
        for side in 0..3 {
            let length_squared = sides[side];
            let ratio_squared = scale * length_squared;
            let x = ratio_squared * ratio_squared;
            let (square, by_x) = repulsion(x);
            let slope = by_x * x;
            squares = squares + square;
            slope_sum = slope_sum + slope;
            let by_length = slope * (2.0 * epsilon) / length_squared;
            partials.length_squared[side] = partials.length_squared[side] + by_length;
        }
        partials.area = partials.area - slope_sum * (8.0 * epsilon) / triangle.twice_area;
        let by_height = slope_sum * (4.0 * epsilon / min_height);
        Sums { energy: squares * epsilon, by_parameter: [by_height, squares] }
    }
}

/// The squares of the sides.
#[inline(always)]
fn sides<R: Real>(triangle: &Triangle<R>) -> [R; 3] {
    [triangle.length_squared(0), triangle.length_squared(1), triangle.length_squared(2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::{TriangleGeometry, TrianglePartials, Vec3};

    fn one(
        term: &Term,
        triangle: TriangleGeometry,
        partials: &mut [TrianglePartials; 1],
    ) -> Contribution {
        TriangleHeight
            .triangles(term, Triangles::Plain { first: 0, geometry: &[triangle], partials })
    }

    #[test]
    fn energy_is_that_of_the_formula() {
        let (d, epsilon) = (1.0, 2.5);
        let triangle = TriangleGeometry::new(
            &Vec3::new(0.0, 0.0, 0.0),
            &Vec3::new(2.0, 0.1, 0.0),
            &Vec3::new(0.7, 1.1, 0.4),
        );
        let mut partials = [TrianglePartials::default()];
        let term = Term::new("TriangleHeightForce", 0, &[d, epsilon]).unwrap();
        let found = one(&term, triangle, &mut partials);
        let expected: f64 = (0..3)
            .map(|k| triangle.twice_area / triangle.length_squared(k).sqrt())
            .filter(|h| *h < 2f64.powf(0.25) * d)
            .map(|h| epsilon * ((d / h).powi(8) - (d / h).powi(4) + 0.25))
            .sum();
        assert!(expected > 0.0 && (found.energy / expected - 1.0).abs() < 1e-14);
    }

    #[test]
    fn partial_derivatives_match_finite_differences() {
        // A triangle by twice its area and its corners' products; two of its heights are active.
        let at = |area: f64, sides: [f64; 3], d: f64, epsilon: f64| {
            let half = 0.5 * (sides[0] + sides[1] + sides[2]);
            let dots = [half - sides[1], half - sides[2], half - sides[0]];
            let triangle = TriangleGeometry { normal: Vec3::zeros(), twice_area: 2.0 * area, dots };
            let mut partials = [TrianglePartials::default()];
            let term = Term::new("TriangleHeightForce", 0, &[d, epsilon]).unwrap();
            (one(&term, triangle, &mut partials), partials[0])
        };
        let (area, sides, d, epsilon) = (0.7, [2.0, 1.0, 1.7], 1.0, 1.5);
        let (sum, partials) = at(area, sides, d, epsilon);
        let h = 1e-6;
        let central = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        let mut checks = vec![
            (partials.area, central(&|s| at(area + s, sides, d, epsilon).0.energy)),
            (sum.by_parameter[0], central(&|s| at(area, sides, d + s, epsilon).0.energy)),
            (sum.by_parameter[1], central(&|s| at(area, sides, d, epsilon + s).0.energy)),
        ];
        for k in 0..3 {
            let moved = |s: f64| {
                let mut moved = sides;
                moved[k] += s;
                moved
            };
            let slope = central(&|s| at(area, moved(s), d, epsilon).0.energy);
            checks.push((partials.length_squared[k], slope));
        }
        assert_eq!(partials.length_squared.iter().filter(|x| **x != 0.0).count(), 2);
        for (found, expected) in checks {
            assert!(
                (found - expected).abs() < 1e-7 * expected.abs().max(1.0),
                "{found} {expected}"
            );
        }
    }
}
