//! The simplest elasticity: E = Σ_t a⁰_t [ ½ K (tr ε)² + μ |dev ε|² ], with Green's strain ε of each triangle against the
//! reference, in which its area is a⁰, and its part without trace, |dev ε|² = ½ (ε₁ − ε₂)² of the principal strains. It is
//! the law of de Saint-Venant and Kirchhoff, for which the invariants of `strain.rs` are enough:
//! (ε₁ − ε₂)² = (tr ε)² − 4 det ε. At small strains μ is the shear and K the area modulus; at large compression the
//! law is too soft: a triangle without area has a finite energy.
//!
//! P. G. Ciarlet, Mathematical Elasticity I (North-Holland, 1988), section 3.9.

use super::strain::{Density, Elastic, LENGTHS, Law, MODULI, OF_STRAIN, Strain};
use super::{CONSTANTS, Contribution, MadeOf, Needs, Parameter, Potential, Term, Triangles};
use crate::real::Real;

/// De Saint-Venant's and Kirchhoff's law.
pub struct LinearElastic;

impl Potential for LinearElastic {
    fn name(&self) -> &'static str {
        "LinearElasticForce"
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

impl Law for LinearElastic {
    #[inline(always)]
    fn density<R: Real>(&self, [shear, area]: [f64; 2], strain: &Strain<R>) -> Density<R> {
        let &Strain { trace, determinant, .. } = strain;
        let square = trace * trace;
        Density {
            by_modulus: [square * 0.5 - determinant * 2.0, square * 0.5],
            by_trace: trace * (shear + area),
            by_determinant: trace.of(-2.0 * shear),
        }
    }
}
