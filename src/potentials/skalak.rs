//! Elasticity of a membrane with a skeleton, as that of a red blood cell:
//! E = Σ_t a⁰_t [ μ/4 (½ I₁² + I₁ − I₂) + K/8 I₂² ], with I₁ = λ₁² + λ₂² − 2 and I₂ = λ₁²λ₂² − 1 of the principal
//! stretches λ of each triangle against the reference, in which its area is a⁰.
//!
//! R. Skalak, A. Tozeren, R. P. Zarda, S. Chien, Biophys. J. 13, 245 (1973), doi:10.1016/S0006-3495(73)85983-1, with μ = B
//! and K = C there. At small strains the shear modulus is μ/2 and the area modulus K + μ/2. In the invariants of
//! `strain.rs` it is μ (½ (tr ε)² − det ε) + ½ K (tr ε + 2 det ε)² by area.

use super::strain::{Density, Elastic, LENGTHS, Law, MODULI, OF_STRAIN, Strain};
use super::{CONSTANTS, Contribution, MadeOf, Needs, Parameter, Potential, Term, Triangles};
use crate::real::Real;

/// Skalak's law.
pub struct Skalak;

impl Potential for Skalak {
    fn name(&self) -> &'static str {
        "SkalakForce"
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

impl Law for Skalak {
    #[inline(always)]
    fn density<R: Real>(&self, [shear, area]: [f64; 2], strain: &Strain<R>) -> Density<R> {
        let &Strain { trace, determinant, .. } = strain;
        // ½ I₂
        let growth = trace + determinant * 2.0;
        let by_growth = growth * area;
        Density {
            by_modulus: [(trace * trace) * 0.5 - determinant, (growth * growth) * 0.5],
            by_trace: trace * shear + by_growth,
            by_determinant: by_growth * 2.0 - shear,
        }
    }
}
