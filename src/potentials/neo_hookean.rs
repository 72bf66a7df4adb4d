//! A rubber-like membrane: E = Σ_t a⁰_t [ μ/2 (λ₁/λ₂ + λ₂/λ₁ − 2) + K/2 (λ₁λ₂ − 1)² ], with the principal stretches λ of
//! each triangle against the reference, in which its area is a⁰. At all strains pure shear costs μ and growth K only; at
//! small ones these are the shear and the area modulus. A triangle that shrinks to nothing by shear has an infinite
//! energy.
//!
//! E. A. Evans, R. Skalak, Mechanics and Thermodynamics of Biomembranes (CRC Press, 1980): the first-order material, in
//! α = λ₁λ₂ − 1 and β = (λ₁² + λ₂²)/2λ₁λ₂ − 1, E = a⁰ (μ β + ½ K α²), of which G. Lim, M. Wortis and R. Mukhopadhyay
//! (doi:10.1073/pnas.202617299) have the next orders. With J = λ₁λ₂, β = (1 + tr ε)/J − 1 =
//! [tr ε (J − 1) − 4 det ε] / J(J + 1).

use super::strain::{Density, Elastic, LENGTHS, Law, MODULI, OF_STRAIN, Strain};
use super::{CONSTANTS, Contribution, MadeOf, Needs, Parameter, Potential, Term, Triangles};
use crate::real::Real;

/// Evans' first-order law.
pub struct NeoHookean;

impl Potential for NeoHookean {
    fn name(&self) -> &'static str {
        "NeoHookeanForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        MODULI
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
        run.apply(term, &Elastic { moduli: [shear, area], law: Self })
    }
}

impl Law for NeoHookean {
    #[inline(always)]
    fn density<R: Real>(&self, [shear, area]: [f64; 2], strain: &Strain<R>) -> Density<R> {
        let &Strain { trace, determinant, stretch } = strain;
        let inverse = stretch.of(1.0) / stretch;
        let growth = (trace + determinant * 2.0) * 2.0 / (stretch + 1.0);
        let shape = (trace * growth - determinant * 4.0) * inverse / (stretch + 1.0);
        // dJ = (d tr ε + 2 d det ε) / J.
        let by_stretch = growth * area * inverse;
        let cube = inverse * inverse * inverse * shear;
        Density {
            by_modulus: [shape, (growth * growth) * 0.5],
            by_trace: by_stretch + cube * (trace + determinant * 4.0),
            by_determinant: by_stretch * 2.0 - cube * (trace + 1.0) * 2.0,
        }
    }
}
