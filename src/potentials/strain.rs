//! Strains of triangles against their shape at rest: Green's tensor ε in the plane, by two of its invariants.
//!
//! With the corners' scalar products d at present and d⁰ at rest, e = d − d⁰, and |N⁰|² = d⁰₀d⁰₁ + d⁰₁d⁰₂ + d⁰₂d⁰₀,
//!
//! - tr ε = Σ_k e_k (d⁰_k₊₁ + d⁰_k₊₂) / 2|N⁰|², and det ε = (e₀e₁ + e₁e₂ + e₂e₀) / 4|N⁰|²,
//! - so that I₁ = λ₁² + λ₂² − 2 = 2 tr ε and I₂ = λ₁²λ₂² − 1 = 2 tr ε + 4 det ε, with λ the principal stretches.
//!
//! Both vanish at rest, and near it they have all their digits: what is small is a difference of lengths from those at
//! rest, not of numbers near 1. Derivatives are ∂(tr ε)/∂l_k² = d⁰_k₊₂ / 2|N⁰|² and ∂(det ε)/∂l_k² = e_k₊₂ / 4|N⁰|².

use super::{CONSTANTS, Constants, MadeOf, Place, Sums, Triangle, TriangleFormula, TriangleSlopes};
use crate::mesh::geometry::TriangleGeometry;
use crate::real::Real;

/// Constants of a triangle: d⁰₀, d⁰₁, d⁰₂, its area at rest a⁰ and 1 / 2|N⁰|².
pub(super) const OF_STRAIN: MadeOf = MadeOf::Reference(constants);

/// Their units, as powers of nm.
pub(super) const LENGTHS: [i8; CONSTANTS] = [2, 2, 2, 2, -4, 0, 0, 0];

fn constants(rest: &TriangleGeometry, _: [bool; 3]) -> Constants {
    let [d0, d1, d2] = rest.dots;
    let inverse = 0.5 / (rest.twice_area * rest.twice_area);
    [d0, d1, d2, rest.area(), inverse, 0.0, 0.0, 0.0]
}

/// A strain.
#[derive(Clone, Copy)]
pub(super) struct Strain<R> {
    /// tr ε.
    pub trace: R,
    /// det ε.
    pub determinant: R,
}

/// An energy by area at rest, kJ/mol/nm², and its derivatives.
#[derive(Clone, Copy)]
pub(super) struct Density<R> {
    /// By the two moduli, in which it is linear.
    pub by_modulus: [R; 2],
    pub by_trace: R,
    pub by_determinant: R,
}

/// An energy that depends on the strain and on two moduli: `shearModulus` and `areaModulus`.
pub(super) trait Law {
    fn density<R: Real>(&self, moduli: [f64; 2], strain: &Strain<R>) -> Density<R>;
}

/// The energy of a law for each triangle.
pub(super) struct Elastic<L> {
    pub moduli: [f64; 2],
    pub law: L,
}

impl<L: Law> TriangleFormula for Elastic<L> {
    #[inline(always)]
    fn apply<R: Real>(
        &self,
        place: Place,
        triangle: &Triangle<R>,
        slopes: &mut TriangleSlopes<R>,
    ) -> Sums<R> {
        let [r0, r1, r2, area, inverse, ..] = place.constants(triangle.twice_area);
        let rest = [r0, r1, r2];
        let [e0, e1, e2] = excess(triangle, rest);
        let sum = e0.mul_add(r1 + r2, e1.mul_add(r2 + r0, e2 * (r0 + r1)));
        let products = e0.mul_add(e1, e1.mul_add(e2, e2 * e0));
        let strain = Strain { trace: sum * inverse, determinant: products * inverse * 0.5 };
        let density = self.law.density(self.moduli, &strain);
        let scale = area * inverse;
        let (by_trace, by_determinant) =
            (density.by_trace * scale, density.by_determinant * scale * 0.5);
        for (k, e) in [(0, e2), (1, e0), (2, e1)] {
            let slope = by_trace.mul_add(rest[(k + 2) % 3], by_determinant * e);
            slopes.length_squared[k] = slopes.length_squared[k] + slope;
        }
        let [by_shear, by_area] = density.by_modulus;
        let by_parameter = [by_shear * area, by_area * area];
        let energy = by_parameter[0] * self.moduli[0] + by_parameter[1] * self.moduli[1];
        Sums { energy, by_parameter }
    }
}

/// By how much the corners' scalar products exceed those at rest.
#[inline(always)]
pub(super) fn excess<R: Real>(triangle: &Triangle<R>, rest: [R; 3]) -> [R; 3] {
    let [d0, d1, d2] = triangle.dots;
    [d0 - rest[0], d1 - rest[1], d2 - rest[2]]
}
