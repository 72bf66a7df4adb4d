//! Bending energy of a fluid membrane with spontaneous curvature, discretised after Jülicher:
//! E = ½ κ Σ_i [ J_i² / a_i − 2 C₀ J_i + C₀² a_i ], equation (B13) of
//! doi:10.1103/PhysRevE.108.015301, with a_i the barycentric area (B12) and J_i = Σ_j l_ij φ_ij / 2
//! the integrated curvature (B11). κ multiplies ½ (C₁ + C₂ − C₀)², so a sphere has 8πκ at C₀ = 0.

use super::{Contribution, Domain, Parameter, Potential, Stages, Term};
use crate::mesh::geometry::{VertexGeometry, VertexPartials};
use std::ffi::CStr;

/// Curvature elasticity.
pub struct Bending;

impl Potential for Bending {
    fn name(&self) -> &'static str {
        "BendingForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"rigidity", 1, 0, Domain::NonNegative),
                Parameter::new(c"spontaneousCurvature", 0, -1, Domain::Real).or(0.0),
            ]
        }
    }

    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        Some((c"scheme", &[c"Julicher"]))
    }

    fn stages(&self, _: usize) -> Stages {
        Stages::VERTICES
    }

    fn vertices(
        &self,
        term: &Term,
        vertices: &[VertexGeometry],
        partials: &mut [VertexPartials],
    ) -> Contribution {
        let [rigidity, spontaneous, ..] = term.values;
        let mut squares = 0.0;
        let mut by_spontaneous = 0.0;
        for (vertex, partial) in vertices.iter().zip(partials) {
            let mean = vertex.curvature / vertex.area;
            let excess = mean - spontaneous;
            squares += excess * excess * vertex.area;
            by_spontaneous -= excess * vertex.area;
            partial.curvature += rigidity * excess;
            partial.area -= 0.5 * rigidity * excess * (mean + spontaneous);
        }
        Contribution {
            energy: 0.5 * rigidity * squares,
            by_parameter: [0.5 * squares, rigidity * by_spontaneous, 0.0, 0.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn partial_derivatives_match_finite_differences() {
        let at = |area, curvature, rigidity, spontaneous| {
            let term = Term::new("BendingForce", 0, &[rigidity, spontaneous]).unwrap();
            let mut partials = [VertexPartials::default()];
            let sum = Bending.vertices(&term, &[VertexGeometry { area, curvature }], &mut partials);
            (sum, partials[0])
        };
        let (a, j, k, c) = (2.0, -0.7, 1.3, 0.4);
        let (sum, partials) = at(a, j, k, c);
        assert!((sum.energy - 0.5 * k * (j * j / a - 2.0 * c * j + c * c * a)).abs() < 1e-15);
        let h = 1e-6;
        let central = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        for (found, expected) in [
            (partials.area, central(&|s| at(a + s, j, k, c).0.energy)),
            (partials.curvature, central(&|s| at(a, j + s, k, c).0.energy)),
            (sum.by_parameter[0], central(&|s| at(a, j, k + s, c).0.energy)),
            (sum.by_parameter[1], central(&|s| at(a, j, k, c + s).0.energy)),
        ] {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}
