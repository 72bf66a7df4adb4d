//! Gaussian curvature: E = κ_G Σ (2π − Σ θ) over the vertices that are on no border, with θ the angles of the triangles at
//! a vertex (M. Meyer et al., doi:10.1007/978-3-662-05105-4_2, equation (9) times the area). By the theorem of Gauss and
//! Bonnet this is κ_G [2π χ − Σ (π − Σ θ)] with the second sum over the vertices of borders, which is what is
//! computed: E depends on the shape of the borders' triangles only, and on a closed surface it is the constant 2π χ κ_G,
//! 4π κ_G on a sphere, without forces.

use super::{Contribution, Domain, Needs, Parameter, Potential, Sums, Term};
use crate::mesh::borders::{BorderPartials, BorderTotals};
use std::f64::consts::TAU;

/// The second half of curvature elasticity, which matters where topology or borders can change.
pub struct GaussianCurvature;

impl Potential for GaussianCurvature {
    fn name(&self) -> &'static str {
        "GaussianCurvatureForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::new(c"modulus", 1, 0, Domain::Real)] }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::BORDERS
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
