//! Gaussian curvature: E = κ_G Σ (2π − Σ θ) over the vertices that are on no border, with θ the angles of the triangles at
//! a vertex (M. Meyer et al., doi:10.1007/978-3-662-05105-4_2, equation (9) times the area). By the theorem of Gauss and
//! Bonnet this is κ_G [2π χ − Σ (π − Σ θ)] with the second sum over the vertices of borders, which is what is
//! computed: E depends on the shape of the borders' triangles only, and on a closed surface it is the constant 2π χ κ_G,
//! 4π κ_G on a sphere, without forces.
//!
//! With a modulus for each vertex, E = Σ κ_i (2π − Σ θ) over the vertices on no border, and all triangles matter at
//! whose corners moduli differ: where domains meet, E is that of the geodesic curvature of the line between them (F.
//! Jülicher, R. Lipowsky, doi:10.1103/PhysRevLett.70.2964). A triangle has −Σ κ θ of its corners, and its share of 2π Σ κ_i.

use super::{
    Constants, Contribution, Domain, Element, MadeOf, Needs, Parameter, Place, Potential, Sums,
    Term, Triangle, TriangleFormula, Triangles,
};
use crate::mesh::borders::{BorderPartials, BorderTotals};
use crate::mesh::geometry::{TrianglePartials, corner_angle};
use crate::real::Real;
use std::f64::consts::TAU;

/// The second half of curvature elasticity, which matters where topology or borders can change.
pub struct GaussianCurvature;

impl Potential for GaussianCurvature {
    fn name(&self) -> &'static str {
        "GaussianCurvatureForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::new(c"modulus", 1, 0, Domain::Real).per(Element::Vertex)] }
    }

    fn needs(&self, term: &Term) -> Needs {
        if term.is_scalar(0) { Needs::BORDERS } else { Needs::TRIANGLES }
    }

    fn constants(&self, term: &Term) -> Option<MadeOf> {
        (!term.is_scalar(0)).then_some(MadeOf::Values(constants))
    }

    fn triangles(&self, term: &Term, run: Triangles) -> Contribution {
        run.apply(term, &Angles)
    }

    fn borders(
        &self,
        &Term { values: [modulus, ..], .. }: &Term,
        totals: &BorderTotals,
        partials: &mut BorderPartials,
    ) -> Contribution {
        let curvature = TAU * totals.euler_characteristic - totals.turning;
        partials.turning -= modulus;
        Contribution::from(Sums { energy: modulus * curvature, by_parameter: [curvature, 0.0] })
    }
}

/// The moduli at the corners, and the share of the whole.
fn constants([a, b, c]: [f64; 3], share: f64) -> Constants {
    [a, b, c, share, 0.0, 0.0, 0.0, 0.0]
}

struct Angles;

impl TriangleFormula for Angles {
    /// With θ = atan2(|N|, d), ∂θ/∂|N| = d / l² l'² and ∂θ/∂d = −|N| / l² l'², with the sides l and l' at the corner.
    #[inline(always)]
    fn apply<R: Real>(
        &self,
        place: Place,
        triangle: &Triangle<R>,
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R> {
        let [k0, k1, k2, share, ..] = place.constants(triangle.twice_area);
        let moduli = [k0, k1, k2];
        let mut energy = share;
        for k in 0..3 {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            energy = energy - moduli[k] * corner_angle(triangle.twice_area, triangle.dots[k]);
            let product = triangle.length_squared(k) * triangle.length_squared(last);
            let by_angle = moduli[k] / product;
            partials.area = partials.area - by_angle * triangle.dots[k] * 2.0;
            let by_length = by_angle * triangle.twice_area * 0.5;
            let partials = &mut partials.length_squared;
            partials[k] = partials[k] + by_length;
            partials[last] = partials[last] + by_length;
            partials[next] = partials[next] - by_length;
        }
        Sums { energy, by_parameter: [energy.zero(); 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_disk_has_none_and_a_sphere_four_pi() {
        let term = Term::new("GaussianCurvatureForce", 0, &[-2.0]).unwrap();
        let energy = |turning, euler_characteristic| {
            let totals = BorderTotals { length: 9.0, turning, euler_characteristic };
            let mut partials = BorderPartials::default();
            let sum = GaussianCurvature.borders(&term, &totals, &mut partials);
            assert_eq!(partials, BorderPartials { length: 0.0, turning: 2.0 });
            assert_eq!(sum.energy, -2.0 * sum.by_parameter[0]);
            sum.energy
        };
        assert_eq!(energy(TAU, 1.0), 0.0);
        assert_eq!(energy(0.0, 2.0), -4.0 * TAU);
    }
}
