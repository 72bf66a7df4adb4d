//! Repulsion of vertices and triangles that are not neighbours: E = Σ ε [ (D/d)⁶ − 1 ]² over pairs at a distance
//! d < D, of a vertex to the nearest point of a triangle; of the kind of Weeks, Chandler and Andersen
//! (doi:10.1063/1.1674820), cut off at its minimum. Pairs in which the vertex is a corner of the triangle, or joined to a
//! corner, do not count. `src/contact/` finds the pairs.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term};
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

#[cfg(test)]
mod tests {
    use super::*;

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
            assert!((found - expected).abs() < 1e-7 * expected.abs(), "{place}: {found} {expected}");
        }
        assert_eq!(at([1.3, 2.0, 1.69]), (Contribution::default(), 0.0));
    }
}
