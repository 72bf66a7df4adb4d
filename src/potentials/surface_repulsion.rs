//! Repulsion of what could pass through each other, vertices and triangles, edges and edges: E = Σ m ε [ (D/d)⁶ − 1 ]² over
//! pairs at a distance d < D of their nearest points, of the kind of Weeks, Chandler and Andersen
//! (doi:10.1063/1.1674820), cut off at its minimum. Pairs that share a vertex do not count. m is 1 for vertices and
//! triangles. For edges at an angle θ it is q (2 − q) with q = sin²θ / sin²θ₀ up to θ₀, and 1 beyond: where edges become parallel, their nearest
//! points jump from end to end, and the ends, which are vertices, repel each other's triangles as well (as in M. Li et
//! al., doi:10.1145/3386569.3392425). `src/contact/` finds the pairs.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term};
use crate::mesh::geometry::Vec3;
use std::ffi::CStr;

/// Keeps a surface from passing through itself.
pub struct SurfaceRepulsion;

/// The name of its class.
pub const NAME: &str = "SurfaceRepulsionForce";

/// The first switch: pairs within one connected part of the surface do not count.
pub const ONLY_BETWEEN_PARTS: u32 = 1 << 0;

impl Potential for SurfaceRepulsion {
    fn name(&self) -> &'static str {
        NAME
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"distance", 0, 1, Domain::Positive),
                Parameter::new(c"epsilon", 1, 0, Domain::NonNegative),
            ]
        }
    }

    fn switches(&self) -> &'static [&'static CStr] {
        &[c"onlyBetweenParts"]
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::CONTACTS
    }
}

/// The energy of a pair by the square of its distance, and its derivative with respect to that, kJ/mol/nm².
#[inline]
pub fn pair(term: &Term, squared: f64) -> (Contribution, f64) {
    let [distance, epsilon, ..] = term.values;
    core(distance, epsilon, distance * distance / squared, squared)
}

/// With `ratio` = (D/d)².
#[inline]
pub(super) fn core(distance: f64, epsilon: f64, ratio: f64, squared: f64) -> (Contribution, f64) {
    if ratio <= 1.0 {
        return (Contribution::default(), 0.0);
    }
    let power = ratio * ratio * ratio;
    let excess = power - 1.0;
    let by_epsilon = excess * excess;
    // d(power)/dD = 6 power/D, d(power)/d(d²) = −3 power/d².
    let slope = 2.0 * epsilon * excess * power;
    let by_parameter = [6.0 * slope / distance, by_epsilon, 0.0, 0.0];
    (Contribution { energy: epsilon * by_epsilon, by_parameter }, -3.0 * slope / squared)
}

/// sin²θ₀, of edges that are nearly parallel.
const PARALLEL: f64 = 1e-2;

/// m of two edges along u and v, and its derivatives with respect to them, 1/nm.
#[inline]
pub fn edge_weight(u: &Vec3, v: &Vec3) -> (f64, [Vec3; 2]) {
    let (uu, uv, vv) = (u.norm_squared(), u.dot(v), v.norm_squared());
    let q = u.cross(v).norm_squared() / (uu * vv * PARALLEL);
    if q >= 1.0 {
        return (1.0, [Vec3::zeros(); 2]);
    }
    // sin² = 1 − (u v)² / (u² v²).
    let by_sine = (2.0 - 2.0 * q) / PARALLEL * 2.0 * uv / (uu * vv);
    (q * (2.0 - q), [(u * (uv / uu) - v) * by_sine, (v * (uv / vv) - u) * by_sine])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_of_edges_has_exact_derivatives() {
        for tilt in [0.02, 0.07, 0.3] {
            let arms = [Vec3::new(1.0, 0.2, 0.1), Vec3::new(1.5, 0.3 + tilt, 0.15 - tilt)];
            let (weight, partials) = edge_weight(&arms[0], &arms[1]);
            assert_eq!(weight == 1.0, tilt == 0.3);
            for (place, slope) in partials.iter().enumerate() {
                for axis in 0..3 {
                    let at = |h: f64| {
                        let mut moved = arms;
                        moved[place][axis] += h;
                        edge_weight(&moved[0], &moved[1]).0
                    };
                    let expected = (at(1e-6) - at(-1e-6)) / 2e-6;
                    assert!((slope[axis] - expected).abs() < 1e-7, "{slope} {expected}");
                }
            }
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_energy() {
        let values = [1.3, 2.0, 0.8];
        let at = |[d, epsilon, squared]: [f64; 3]| {
            pair(&Term::new("SurfaceRepulsionForce", 0, &[d, epsilon]).unwrap(), squared)
        };
        let (contribution, slope) = at(values);
        let [by_distance, by_epsilon, ..] = contribution.by_parameter;
        for (place, found) in [by_distance, by_epsilon, slope].into_iter().enumerate() {
            let shifted = |h: f64| {
                let mut moved = values;
                moved[place] += h;
                at(moved).0.energy
            };
            let expected = (shifted(1e-6) - shifted(-1e-6)) / 2e-6;
            assert!(
                (found - expected).abs() < 1e-7 * expected.abs(),
                "{place}: {found} {expected}"
            );
        }
        assert_eq!(at([1.3, 2.0, 1.7]), (Contribution::default(), 0.0));
    }
}
