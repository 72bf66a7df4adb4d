//! Strains of triangles against their shape at rest: Green's tensor ε in the plane, by two of its invariants.
//!
//! With the corners' scalar products d at present and d⁰ at rest, e = d − d⁰, and |N⁰|² = d⁰₀d⁰₁ + d⁰₁d⁰₂ + d⁰₂d⁰₀,
//!
//! - tr ε = Σ_k e_k (d⁰_k₊₁ + d⁰_k₊₂) / 2|N⁰|², and det ε = (e₀e₁ + e₁e₂ + e₂e₀) / 4|N⁰|²,
//! - so that I₁ = λ₁² + λ₂² − 2 = 2 tr ε and I₂ = λ₁²λ₂² − 1 = 2 tr ε + 4 det ε, with λ the principal stretches, and
//!   J = λ₁ λ₂ = a/a⁰ is 1 + I₂ / (J + 1).
//!
//! Both vanish at rest, and near it they have all their digits: what is small is a difference of lengths from those at
//! rest, not of numbers near 1. Derivatives are ∂(tr ε)/∂l_k² = d⁰_k₊₂ / 2|N⁰|² and ∂(det ε)/∂l_k² = e_k₊₂ / 4|N⁰|².

use super::{
    CONSTANTS, Constants, Domain, MadeOf, Parameter, Place, Sums, Triangle, TriangleFormula,
};
use crate::mesh::geometry::{TriangleGeometry, TrianglePartials};
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
    /// J = λ₁ λ₂, the ratio of the areas.
    pub stretch: R,
}

/// An energy by area at rest, kJ/mol/nm², and its derivatives.
#[derive(Clone, Copy)]
pub(super) struct Density<R> {
    /// By the two moduli, in which it is linear.
    pub by_modulus: [R; 2],
    pub by_trace: R,
    pub by_determinant: R,
}

/// The scalars of all laws.
pub(super) const MODULI: &[Parameter] = &[
    Parameter::new(c"shearModulus", 1, -2, Domain::NonNegative),
    Parameter::new(c"areaModulus", 1, -2, Domain::NonNegative),
];

/// An energy of strain and two moduli.
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
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R> {
        let [r0, r1, r2, area, inverse, ..] = place.constants(triangle.twice_area);
        let rest = [r0, r1, r2];
        let excess = excess(triangle, rest);
        let [e0, e1, e2] = excess;
        let sum = e0.mul_add(r1 + r2, e1.mul_add(r2 + r0, e2 * (r0 + r1)));
        let products = e0.mul_add(e1, e1.mul_add(e2, e2 * e0));
        let strain = Strain {
            trace: sum * inverse,
            determinant: products * inverse * 0.5,
            stretch: triangle.area() / area,
        };
        let density = self.law.density(self.moduli, &strain);
        let scale = area * inverse;
        let (by_trace, by_determinant) =
            (density.by_trace * scale, density.by_determinant * scale * 0.5);
        for k in 0..3 {
            let opposite = (k + 2) % 3;
            let slope = by_trace.mul_add(rest[opposite], by_determinant * excess[opposite]);
            partials.length_squared[k] = partials.length_squared[k] + slope;
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

#[cfg(test)]
mod tests {
    use super::super::{Term, TriangleConstants, Triangles, find};
    use super::*;
    use crate::mesh::geometry::{EdgeTension, TrianglePartials, Vec3, corner_forces};
    use crate::test_meshes::noise;

    const LAWS: [&str; 3] = ["SkalakForce", "NeoHookeanForce", "LinearElasticForce"];

    /// The energy of a triangle, its derivatives with respect to the moduli, and the forces on its corners.
    fn evaluate(
        name: &str,
        moduli: [f64; 2],
        rest: &[Vec3; 3],
        corners: &[Vec3; 3],
    ) -> (f64, [f64; 2], [Vec3; 3]) {
        let geometry = |[a, b, c]: &[Vec3; 3]| TriangleGeometry::new(a, b, c);
        let values = vec![constants(&geometry(rest), [false; 3])];
        let mut term = Term::new(name, 0, &moduli).unwrap();
        let constants = TriangleConstants { values, ..TriangleConstants::default() };
        term.constants = &constants;
        let triangle = geometry(corners);
        let mut partials = [TrianglePartials::default()];
        let run = Triangles::Plain { first: 0, geometry: &[triangle], partials: &mut partials };
        let found = find(name).unwrap().triangles(&term, run);
        let [TrianglePartials { area, length_squared }] = partials;
        let edges = [EdgeTension::default(); 3];
        let forces =
            corner_forces(corners.each_ref(), &triangle, area, &length_squared, edges, 0.0);
        (found.energy, [found.by_parameter[0], found.by_parameter[1]], forces)
    }

    fn triangle() -> [Vec3; 3] {
        [Vec3::new(0.3, -0.2, 0.1), Vec3::new(2.1, 0.4, -0.3), Vec3::new(0.9, 1.7, 0.5)]
    }

    /// Stretched by `long` along some direction in its plane and by `wide` across it.
    fn stretched(rest: &[Vec3; 3], long: f64, wide: f64) -> [Vec3; 3] {
        let normal = (rest[1] - rest[0]).cross(&(rest[2] - rest[0])).normalize();
        let along = Vec3::new(0.6, 0.8, 0.0).cross(&normal).normalize();
        let across = normal.cross(&along);
        rest.map(|x| along * (long * along.dot(&x)) + across * (wide * across.dot(&x)))
    }

    #[test]
    fn energies_are_those_of_the_principal_stretches() {
        let rest = triangle();
        let area = TriangleGeometry::new(&rest[0], &rest[1], &rest[2]).area();
        let (shear, bulk) = (1.7, 2.9);
        for (long, wide) in [(1.3f64, 0.9f64), (0.7, 1.1), (1.2, 1.2), (1.5, 1.0 / 1.5), (0.4, 0.5)]
        {
            let (first, second) = (long * long + wide * wide - 2.0, (long * wide).powi(2) - 1.0);
            let ([e, f], stretch) = ([long, wide].map(|x| 0.5 * (x * x - 1.0)), long * wide);
            let expected = [
                shear / 4.0 * (0.5 * first * first + first - second) + bulk / 8.0 * second * second,
                shear * (0.5 * (long / wide + wide / long) - 1.0)
                    + 0.5 * bulk * (stretch - 1.0f64).powi(2),
                0.5 * bulk * (e + f) * (e + f) + 0.5 * shear * (e - f) * (e - f),
            ];
            for (name, expected) in LAWS.into_iter().zip(expected) {
                let now = stretched(&rest, long, wide);
                let found = evaluate(name, [shear, bulk], &rest, &now).0 / area;
                assert!((found / expected - 1.0).abs() < 1e-12, "{name}: {found} {expected}");
            }
        }
    }

    #[test]
    fn small_strains_have_the_moduli_and_lose_no_digits() {
        let rest = triangle();
        let area = TriangleGeometry::new(&rest[0], &rest[1], &rest[2]).area();
        let (shear, bulk) = (1.7, 2.9);
        for (name, [shear_modulus, area_modulus]) in
            LAWS.into_iter().zip([[0.5 * shear, bulk + 0.5 * shear], [shear, bulk], [shear, bulk]])
        {
            let e = 1e-5;
            let energy = |long: f64, wide: f64| {
                evaluate(name, [shear, bulk], &rest, &stretched(&rest, long, wide)).0 / area
            };
            // What is left are terms of third order in the first case, and rounding of 1e-16 / e in both.
            let sheared = 0.5 * (energy(1.0 + e, 1.0 - e) + energy(1.0 - e, 1.0 + e));
            assert!((sheared / (2.0 * shear_modulus * e * e) - 1.0).abs() < 1e-9, "{name}");
            let grown = 0.5 * (energy(1.0 + e, 1.0 + e) + energy(1.0 - e, 1.0 - e));
            assert!((grown / (2.0 * area_modulus * e * e) - 1.0).abs() < 1e-9, "{name}");
        }
    }

    #[test]
    fn forces_and_derivatives_match_finite_differences() {
        let mut noise = noise(3);
        let rest = triangle();
        let h = 1e-5;
        for name in LAWS {
            let mut corners = stretched(&rest, 1.2, 0.8);
            corners.iter_mut().for_each(|x| x.apply(|x| *x += 0.2 * noise()));
            let moduli = [1.7, 2.9];
            let (_, by_modulus, forces) = evaluate(name, moduli, &rest, &corners);
            for corner in 0..3 {
                for axis in 0..3 {
                    let energy = |step: f64| {
                        let mut moved = corners;
                        moved[corner][axis] += step;
                        evaluate(name, moduli, &rest, &moved).0
                    };
                    let expected = -(energy(h) - energy(-h)) / (2.0 * h);
                    assert!((forces[corner][axis] - expected).abs() < 1e-8, "{name}");
                }
            }
            for modulus in 0..2 {
                let energy = |step: f64| {
                    let mut changed = moduli;
                    changed[modulus] += step;
                    evaluate(name, changed, &rest, &corners).0
                };
                let expected = (energy(h) - energy(-h)) / (2.0 * h);
                assert!((by_modulus[modulus] - expected).abs() < 1e-9, "{name}");
            }
        }
    }

    #[test]
    fn forces_at_small_strains_have_their_digits() {
        let rest = triangle();
        for name in LAWS {
            let pull = |e: f64| {
                let forces = evaluate(name, [1.0, 1.0], &rest, &stretched(&rest, 1.0 + e, 1.0)).2;
                forces.map(|force| force / e)
            };
            let (one, other) = (pull(1e-7), pull(1e-8));
            let largest = one.iter().fold(0.0, |most: f64, force| most.max(force.norm()));
            for (one, other) in one.iter().zip(&other) {
                // 1e-16 / 1e-8 by rounding of the positions themselves.
                assert!((one - other).norm() < 1e-6 * largest, "{name}");
            }
            let at_rest = evaluate(name, [1.0, 1.0], &rest, &rest);
            assert!(at_rest.0 == 0.0 && at_rest.2.iter().all(|force| force.norm() == 0.0));
        }
    }
}
