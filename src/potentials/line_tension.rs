//! Line tension between domains: E = γ L, with L the length of the line that separates vertices of different domains.
//!
//! Where two corners of a triangle are of one domain and one of another, the line joins the middles of the two mixed sides,
//! half as long as the third. Where all three differ, it leads from the middles of all sides to the centroid, a third of
//! each median. Such a line goes in zigzag and is longer than a smooth one, however fine the mesh is: on equilateral
//! triangles by 1 along their edges, 2/√3 at 30° to these and 2√3/π = 1.103 on average.
//!
//! The smooth counterpart is F. Jülicher, R. Lipowsky, Phys. Rev. Lett. 70, 2964 (1993),
//! doi:10.1103/PhysRevLett.70.2964.

use super::{
    CONSTANTS, Constants, Contribution, Domain, MadeOf, Needs, Parameter, Place, Potential, Sums,
    Term, Triangle, TriangleFormula, Triangles,
};
use crate::mesh::geometry::TrianglePartials;
use crate::real::Real;

/// Tension of the line between domains.
pub struct LineTension;

impl Potential for LineTension {
    fn name(&self) -> &'static str {
        "LineTensionForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::new(c"tension", 1, -1, Domain::Real)] }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TRIANGLES
    }

    fn constants(&self, _: &Term) -> Option<MadeOf> {
        Some(MadeOf::Domains(shares))
    }

    fn triangles(&self, term: &Term, run: Triangles) -> Contribution {
        run.apply(term, &Line { tension: term.values[0] })
    }
}

/// The shares of the three sides, and of all medians, that the line in a triangle is as long as.
fn shares([a, b, c]: [f64; 3], _: [bool; 3]) -> Constants {
    let mut shares = [0.0; CONSTANTS];
    match (a == b, b == c, c == a) {
        (true, true, _) => {}
        (true, ..) => shares[0] = 0.5,
        (_, true, _) => shares[1] = 0.5,
        (_, _, true) => shares[2] = 0.5,
        _ => shares[3] = 1.0 / 3.0,
    }
    shares
}

struct Line {
    tension: f64,
}

impl TriangleFormula for Line {
    #[inline(always)]
    fn apply<R: Real>(
        &self,
        place: Place,
        triangle: &Triangle<R>,
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R> {
        let [s0, s1, s2, of_medians, ..] = place.constants(triangle.twice_area);
        let shares = [s0, s1, s2];
        let mut sum = s0.zero();
        for k in 0..3 {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            let squared = triangle.length_squared(k);
            let length = squared.sqrt();
            sum = shares[k].mul_add(length, sum);
            let by_length = shares[k] * (0.5 * self.tension) / length;
            // From corner k to the middle of the side opposite it: m² = ¼ (2 l_k² + 2 l_k₊₂² − l_k₊₁²).
            let median = squared + triangle.length_squared(last) + triangle.dots[k] * 2.0;
            let median = (median * 0.25).sqrt();
            sum = of_medians.mul_add(median, sum);
            let by_median = of_medians * (0.125 * self.tension) / median;
            let partials = &mut partials.length_squared;
            partials[k] = partials[k] + by_length + by_median * 2.0;
            partials[last] = partials[last] + by_median * 2.0;
            partials[next] = partials[next] - by_median;
        }
        Sums { energy: sum * self.tension, by_parameter: [sum, sum.zero()] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::{
        EdgeTension, TriangleGeometry, TrianglePartials, Vec3, corner_forces,
    };
    use crate::potentials::TriangleConstants;

    const CORNERS: [Vec3; 3] =
        [Vec3::new(0.3, -0.2, 0.1), Vec3::new(2.1, 0.4, -0.3), Vec3::new(0.9, 1.7, 0.5)];

    fn line(domains: [f64; 3], [a, b, c]: [Vec3; 3]) -> (f64, [Vec3; 3]) {
        let triangle = TriangleGeometry::new(&a, &b, &c);
        let values = vec![shares(domains, [false; 3])];
        let mut term = Term::new("LineTensionForce", 0, &[2.0]).unwrap();
        let constants = TriangleConstants { values, ..TriangleConstants::default() };
        term.constants = &constants;
        let mut partials = [TrianglePartials::default()];
        let run = Triangles::Plain { first: 0, geometry: &[triangle], partials: &mut partials };
        let found = LineTension.triangles(&term, run);
        assert_eq!(found.energy, 2.0 * found.by_parameter[0]);
        let [TrianglePartials { area, length_squared }] = partials;
        let edges = [EdgeTension::default(); 3];
        (found.energy, corner_forces([&a, &b, &c], &triangle, area, &length_squared, edges, 0.0))
    }

    #[test]
    fn lengths_are_those_of_the_line() {
        let [a, b, c] = CORNERS;
        let (ab, bc, ca) = ((a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0);
        let middle = (a + b + c) / 3.0;
        for (domains, expected) in [
            ([4.0, 4.0, 4.0], 0.0),
            ([1.0, 1.0, 5.0], (bc - ca).norm()),
            ([7.0, 1.0, 1.0], (ab - ca).norm()),
            ([1.0, -2.0, 1.0], (ab - bc).norm()),
            ([1.0, 2.0, 3.0], [ab, bc, ca].map(|x| (x - middle).norm()).iter().sum()),
        ] {
            let found = line(domains, CORNERS).0;
            assert!((found - 2.0 * expected).abs() < 1e-14, "{domains:?}: {found}");
        }
    }

    #[test]
    fn forces_are_the_gradient() {
        let h = 1e-5;
        for domains in [[1.0, 1.0, 5.0], [1.0, 2.0, 3.0]] {
            let forces = line(domains, CORNERS).1;
            for corner in 0..3 {
                for axis in 0..3 {
                    let energy = |step: f64| {
                        let mut moved = CORNERS;
                        moved[corner][axis] += step;
                        line(domains, moved).0
                    };
                    let expected = -(energy(h) - energy(-h)) / (2.0 * h);
                    assert!((forces[corner][axis] - expected).abs() < 1e-9);
                }
            }
        }
    }
}
