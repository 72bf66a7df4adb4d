//! Elasticity of a red cell's skeleton that hardens: E = Σ_t a⁰_t [ ½ K (α² + a₃α³ + a₄α⁴) + μ (β + b₁αβ + b₂β²) ], with
//! α = λ₁λ₂ − 1 and β = (λ₁ − λ₂)² / 2λ₁λ₂ of the principal stretches λ of each triangle against the reference, in which its
//! area is a⁰. At small strains the shear modulus is μ and the area modulus K.
//!
//! G. Lim H. W., M. Wortis, R. Mukhopadhyay, in Soft Matter 4 (Wiley, 2008), doi:10.1002/9783527623372.ch2a, and PNAS 99,
//! 16766 (2002), doi:10.1073/pnas.202617299, with a₃ = −2, a₄ = 8, b₁ = 0.7 and b₂ = 0.75: `Lim2002`. L. Amoudruz et al.,
//! Biophys. J. 122, 1517 (2023), doi:10.1016/j.bpj.2023.03.019, found b₂ = 1.84 from experiments: `Amoudruz2023`.
//!
//! In the invariants of `strain.rs`, λ₁λ₂ = J = √(1 + 2 tr ε + 4 det ε), α = (2 tr ε + 4 det ε) / (J + 1) and
//! β = ((tr ε)² − 4 det ε) / J (1 + tr ε + J), in which nothing cancels at small strains.

use super::codes::Coefficients;
use super::strain::{Density, Elastic, LENGTHS, Law, OF_STRAIN, Strain};
use super::{
    CONSTANTS, Contribution, Domain, MadeOf, Needs, Parameter, Potential, Term, Triangles,
};
use crate::real::Real;
use std::ffi::CStr;

/// Lim's law.
pub struct Lim;

const A3: f64 = -2.0;
const A4: f64 = 8.0;
const B1: f64 = 0.7;

struct Hardening {
    b2: f64,
}

impl Hardening {
    fn of(coefficients: Coefficients) -> Self {
        Self {
            b2: match coefficients {
                Coefficients::Lim2002 => 0.75,
                Coefficients::Amoudruz2023 => 1.84,
            },
        }
    }
}

impl Potential for Lim {
    fn name(&self) -> &'static str {
        "LimForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"shearModulus", 1, -2, Domain::NonNegative),
                Parameter::new(c"areaModulus", 1, -2, Domain::NonNegative),
            ]
        }
    }

    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        Some((c"coefficients", Coefficients::NAMES))
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TRIANGLES
    }

    fn constants(&self, _: &Term) -> Option<MadeOf> {
        Some(OF_STRAIN)
    }

    fn constant_lengths(&self) -> [i8; CONSTANTS] {
        LENGTHS
    }

    fn triangles(&self, term: &Term, run: Triangles) -> Contribution {
        let [shear, area, ..] = term.values;
        let law = Hardening::of(Coefficients::ALL[term.form]);
        run.apply(term, &Elastic { moduli: [shear, area], law })
    }
}

impl Law for Hardening {
    #[inline(always)]
    fn density<R: Real>(&self, [shear, area]: [f64; 2], strain: &Strain<R>) -> Density<R> {
        let &Strain { trace, determinant, .. } = strain;
        let &Self { b2 } = self;
        let one = trace.of(1.0);
        let growth = (trace + determinant * 2.0) * 2.0;
        let ratio = (growth + one).sqrt();
        let inverse = one / ratio;
        let alpha = growth / (ratio + one);
        let beta = (trace * trace - determinant * 4.0) * inverse / (trace + one + ratio);
        let polynomial = alpha * (alpha * A4 + one.of(A3)) + one;
        let by_shear = beta * (alpha * B1 + beta * b2 + one);
        let by_alpha = alpha * (alpha * (alpha * (2.0 * A4) + one.of(1.5 * A3)) + one) * area
            + beta * (B1 * shear);
        let by_beta = (alpha * B1 + beta * (2.0 * b2) + one) * shear;
        let by_trace_of_beta = (trace + determinant * 4.0) * inverse * inverse * inverse;
        let by_determinant_of_beta = (trace + one) * inverse * inverse * inverse * -2.0;
        Density {
            by_modulus: [by_shear, alpha * alpha * polynomial * 0.5],
            by_trace: by_alpha * inverse + by_beta * by_trace_of_beta,
            by_determinant: by_alpha * inverse * 2.0 + by_beta * by_determinant_of_beta,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the principal stretches.
    fn strain(first: f64, second: f64) -> Strain<f64> {
        let [e, f] = [first, second].map(|stretch| 0.5 * (stretch * stretch - 1.0));
        Strain { trace: e + f, determinant: e * f, stretch: first * second }
    }

    #[test]
    fn energy_is_that_of_the_formula() {
        for (coefficients, b2) in
            [(Coefficients::Lim2002, 0.75), (Coefficients::Amoudruz2023, 1.84)]
        {
            for (first, second) in [(1.3, 0.9), (0.7, 1.8), (1.1, 1.2), (2.5, 0.5)] {
                let (alpha, beta): (f64, f64) = (
                    first * second - 1.0,
                    (first - second) * (first - second) / (2.0 * first * second),
                );
                let density =
                    Hardening::of(coefficients).density([1.0, 1.0], &strain(first, second));
                let shear = beta + 0.7 * alpha * beta + b2 * beta * beta;
                let area = 0.5 * (alpha.powi(2) - 2.0 * alpha.powi(3) + 8.0 * alpha.powi(4));
                assert!((density.by_modulus[0] - shear).abs() < 1e-13 * shear);
                assert!((density.by_modulus[1] - area).abs() < 1e-12 * area);
            }
        }
    }

    #[test]
    fn derivatives_match_finite_differences() {
        let law = Hardening::of(Coefficients::Lim2002);
        let moduli = [1.3, 0.7];
        let Strain { trace, determinant, stretch } = strain(1.4, 0.8);
        let energy = |trace, determinant| {
            let density = law.density(moduli, &Strain { trace, determinant, stretch });
            moduli[0] * density.by_modulus[0] + moduli[1] * density.by_modulus[1]
        };
        let h = 1e-6;
        let by_trace =
            (energy(trace + h, determinant) - energy(trace - h, determinant)) / (2.0 * h);
        let by_determinant =
            (energy(trace, determinant + h) - energy(trace, determinant - h)) / (2.0 * h);
        let found = law.density(moduli, &Strain { trace, determinant, stretch });
        assert!((found.by_trace - by_trace).abs() < 1e-8);
        assert!((found.by_determinant - by_determinant).abs() < 1e-8);
    }

    #[test]
    fn small_strains_lose_no_digits() {
        let small = 1e-7;
        let density = Hardening::of(Coefficients::Lim2002)
            .density([1.0, 1.0], &strain(1.0 + small, 1.0 - small));
        assert!((density.by_modulus[0] / (2.0 * small * small) - 1.0).abs() < 1e-6);
    }
}
