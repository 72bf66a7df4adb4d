//! Springs along the edges, of which each has the length l₀ at rest that it has in the reference: a network such as the
//! spectrin skeleton of a red blood cell. E = Σ_edges f(l), with f = f′ = 0 and f″ = k, the stiffness, at l = l₀:
//!
//! | form | f | |
//! | --- | --- | --- |
//! | `Harmonic` | ½ k (l − l₀)² | |
//! | `WLCPower` | A [g(x) − g(x₀)] + p (1/l − 1/l₀) | a worm-like chain, g = (3x² − 2x³)/(1 − x), and a repulsion |
//!
//! with x = l/l_max, and x₀ = l₀/l_max the `ratio`, for all edges the same. A and p follow from k and l₀: D. A. Fedosov, B.
//! Caswell, G. E. Karniadakis, Biophys. J. 98, 2215 (2010), doi:10.1016/j.bpj.2010.02.002, with A = k_B T l_max/4p and
//! m = 2, k_p = p there. As g = 1/(1 − x) + 2x² − x − 1, with u = 1 − x₀ it is, without differences of large numbers,
//!
//! - f = k (l − l₀)² B / D, B = 1/(1 − x)u² + 2 + g₀′/x, D = 2/u³ + 4 + 2 g₀′/x₀, and g₀′ = 1/u² − 1 + 4 x₀.
//!
//! At l_max it is infinite, and nothing is defined beyond.
//!
//! A net of equilateral triangles has the shear modulus √3/4 k and the area modulus √3/2 k (D. H. Boal, Mechanics of the
//! Cell, Cambridge University Press, 2nd ed. 2012, section 3.3).

use super::codes::SpringForm;
use super::strain::excess;
use super::{
    CONSTANTS, Constants, Contribution, Domain, MadeOf, Needs, Parameter, Place, Potential, Sums,
    Term, Triangle, TriangleFormula, Triangles,
};
use crate::mesh::geometry::{TriangleGeometry, TrianglePartials};
use crate::real::Real;
use std::ffi::CStr;

/// Springs along edges.
pub struct Spring;

impl Potential for Spring {
    fn name(&self) -> &'static str {
        "SpringForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"stiffness", 1, -2, Domain::NonNegative),
                Parameter::new(c"ratio", 0, 0, Domain::Share).or(1.0 / 2.2),
            ]
        }
    }

    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        Some((c"form", SpringForm::NAMES))
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TRIANGLES
    }

    fn constants(&self, _: &Term) -> Option<MadeOf> {
        Some(MadeOf::Reference(constants))
    }

    fn constant_lengths(&self) -> [i8; CONSTANTS] {
        [2, 2, 2, 0, 0, 0, 0, 0]
    }

    fn limits_sides(&self, term: &Term) -> bool {
        SpringForm::ALL[term.form] == SpringForm::WLCPower
    }

    fn longest_sides(&self, term: &Term, constants: &Constants) -> [f64; 3] {
        let of = |k: usize| (constants[k] + constants[(k + 1) % 3]).sqrt() / term.values[1];
        [of(0), of(1), of(2)]
    }

    fn triangles(&self, term: &Term, run: Triangles) -> Contribution {
        let [stiffness, ratio, ..] = term.values;
        match SpringForm::ALL[term.form] {
            SpringForm::Harmonic => run.apply(term, &Sides { stiffness, law: Harmonic }),
            SpringForm::WLCPower => run.apply(term, &Sides { stiffness, law: Chain::new(ratio) }),
        }
    }
}

/// Of a triangle: the corners' scalar products at rest, and the shares of the sides that are its own, half where there is
/// another triangle.
fn constants(rest: &TriangleGeometry, on_border: [bool; 3]) -> Constants {
    let [d0, d1, d2] = rest.dots;
    let [w0, w1, w2] = on_border.map(|is_border| if is_border { 1.0 } else { 0.5 });
    [d0, d1, d2, w0, w1, w2, 0.0, 0.0]
}

/// A spring of stiffness 1.
trait Law {
    /// f / (l − l₀)²; f′ / (l − l₀); and the derivative of the former with respect to the ratio.
    fn factors<R: Real>(&self, length: R, at_rest: R) -> [R; 3];
}

struct Harmonic;

impl Law for Harmonic {
    #[inline(always)]
    fn factors<R: Real>(&self, length: R, _: R) -> [R; 3] {
        [length.of(0.5), length.of(1.0), length.zero()]
    }
}

/// What depends on the ratio x₀ only.
struct Chain {
    ratio: f64,
    /// 1/u.
    inverse: f64,
    /// g₀′ and g₀″.
    slope: f64,
    bend: f64,
    /// D and its derivative.
    scale: f64,
    by_ratio: f64,
}

impl Chain {
    fn new(ratio: f64) -> Self {
        let inverse = 1.0 / (1.0 - ratio);
        let slope = inverse * inverse - 1.0 + 4.0 * ratio;
        let bend = 2.0 * inverse.powi(3) + 4.0;
        Self {
            ratio,
            inverse,
            slope,
            bend,
            scale: bend + 2.0 * slope / ratio,
            by_ratio: 6.0 * inverse.powi(4) + 2.0 * (bend - slope / ratio) / ratio,
        }
    }
}

impl Law for Chain {
    #[inline(always)]
    fn factors<R: Real>(&self, length: R, at_rest: R) -> [R; 3] {
        let one = length.of(1.0);
        let growth = one / at_rest;
        let x = length * growth * self.ratio;
        let inverse = one / x;
        let left = one / (one - x) * (self.inverse * self.inverse);
        let far = x.above(one);
        let bracket = left + 2.0 + inverse * self.slope;
        let bracket = one.of(f64::INFINITY).or_else(far, bracket);
        // B′, by x.
        let slope = left / (one - x) - inverse * inverse * self.slope;
        let by_length = slope * growth * self.ratio;
        let by_ratio = slope * length * growth + left * (2.0 * self.inverse) + inverse * self.bend
            - bracket * (self.by_ratio / self.scale);
        let inverse_scale = 1.0 / self.scale;
        [
            bracket * inverse_scale,
            (bracket * 2.0 + (length - at_rest) * by_length) * inverse_scale,
            by_ratio * inverse_scale,
        ]
    }
}

struct Sides<L> {
    stiffness: f64,
    law: L,
}

impl<L: Law> TriangleFormula for Sides<L> {
    #[inline(always)]
    fn apply<R: Real>(
        &self,
        place: Place,
        triangle: &Triangle<R>,
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R> {
        let [d0, d1, d2, w0, w1, w2, ..] = place.constants(triangle.twice_area);
        let (rest, shares) = ([d0, d1, d2], [w0, w1, w2]);
        let excess = excess(triangle, rest);
        let zero = d0.zero();
        let (mut by_stiffness, mut by_ratio) = (zero, zero);
        for k in 0..3 {
            let next = (k + 1) % 3;
            let length = triangle.length_squared(k).sqrt();
            let at_rest = (rest[k] + rest[next]).sqrt();
            // l − l₀ by the difference of the squares, which has all its digits.
            let stretch = (excess[k] + excess[next]) / (length + at_rest);
            let [energy, slope, ratio] = self.law.factors(length, at_rest);
            let squared = stretch * stretch * shares[k];
            by_stiffness = squared.mul_add(energy, by_stiffness);
            by_ratio = squared.mul_add(ratio, by_ratio);
            let by_length = slope * stretch * shares[k] * (0.5 * self.stiffness) / length;
            partials.length_squared[k] = partials.length_squared[k] + by_length;
        }
        let by_parameter = [by_stiffness, by_ratio * self.stiffness];
        Sums { energy: by_stiffness * self.stiffness, by_parameter }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f and f′ as Fedosov et al. write them.
    fn by_the_book(length: f64, at_rest: f64, ratio: f64) -> f64 {
        let longest = at_rest / ratio;
        let g = |x: f64| (3.0 * x * x - 2.0 * x * x * x) / (1.0 - x);
        let slope = |x: f64| 1.0 / (1.0 - x).powi(2) - 1.0 + 4.0 * x;
        let bend = |x: f64| 2.0 / (1.0 - x).powi(3) + 4.0;
        let strength = longest * longest / (bend(ratio) + 2.0 * slope(ratio) / ratio);
        let push = strength * slope(ratio) * at_rest * at_rest / longest;
        strength * (g(length / longest) - g(ratio)) + push * (1.0 / length - 1.0 / at_rest)
    }

    #[test]
    fn chains_are_those_of_the_book() {
        let (at_rest, h) = (1.7, 1e-6);
        for ratio in [0.2, 1.0 / 2.2, 0.8] {
            let chain = Chain::new(ratio);
            let longest = at_rest / ratio;
            for length in [0.4 * at_rest, 0.9 * at_rest, 1.1 * at_rest, 0.97 * longest] {
                let [energy, slope, by_ratio] = chain.factors(length, at_rest);
                let stretch = length - at_rest;
                let book = |length: f64, ratio: f64| by_the_book(length, at_rest, ratio);
                let expected = book(length, ratio);
                assert!((energy * stretch * stretch / expected - 1.0).abs() < 1e-9);
                let expected = (book(length + h, ratio) - book(length - h, ratio)) / (2.0 * h);
                assert!((slope * stretch / expected - 1.0).abs() < 1e-6);
                let expected = (book(length, ratio + h) - book(length, ratio - h)) / (2.0 * h);
                assert!(
                    (by_ratio * stretch * stretch - expected).abs()
                        < 1e-6 * expected.abs().max(0.1)
                );
            }
        }
    }

    #[test]
    fn stiffness_is_the_second_derivative_at_rest() {
        for ratio in [0.1, 0.5, 0.9] {
            let [energy, slope, by_ratio] = Chain::new(ratio).factors(2.3, 2.3);
            assert!(
                (energy - 0.5).abs() < 1e-15 && (slope - 1.0).abs() < 1e-15,
                "{energy} {slope}"
            );
            assert!(by_ratio.abs() < 1e-13);
        }
    }

    #[test]
    fn nothing_is_finite_beyond_the_longest() {
        let chain = Chain::new(0.5);
        for length in [2.0, 2.001, 5.0] {
            assert!(!chain.factors(length, 1.0)[0].is_finite());
        }
        assert!(chain.factors(1.999, 1.0)[0].is_finite());
    }
}
