//! Plaquette homogenising: E = ½ k Σ_i (N a_i / A₀ − 1)² over the N vertices, with a_i the barycentric
//! area of a vertex (its plaquette) and A₀ the target of the total area. Equation (20) of
//! doi:10.1103/PhysRevE.108.015301 with k = (3/2) k_B T.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term, VertexSlopes, Vertices};

/// Keeps the areas of all vertices alike.
pub struct PlaquetteArea;

impl Potential for PlaquetteArea {
    fn name(&self) -> &'static str {
        "PlaquetteAreaForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"stiffness", 1, 0, Domain::NonNegative),
                Parameter::new(c"target", 0, 2, Domain::Positive),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::VERTICES
    }

    fn vertices(&self, term: &Term, vertices: Vertices, slopes: VertexSlopes) -> Contribution {
        let [stiffness, target, ..] = term.values;
        let scale = vertices.total as f64 / target;
        let mut squares = 0.0;
        let mut by_target = 0.0;
        for (vertex, partial) in vertices.scalars.iter().zip(slopes.scalars) {
            let strain = scale * vertex.area - 1.0;
            squares += strain * strain;
            by_target -= strain * (strain + 1.0);
            partial.area += stiffness * scale * strain;
        }
        Contribution {
            energy: 0.5 * stiffness * squares,
            by_parameter: [0.5 * squares, stiffness * by_target / target, 0.0, 0.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::{VertexGeometry, VertexPartials};

    #[test]
    fn derivatives_match_finite_differences() {
        let at = |area: f64, stiffness: f64, target: f64| {
            let term = Term::new("PlaquetteAreaForce", 0, &[stiffness, target]).unwrap();
            let scalars = [VertexGeometry { area, ..Default::default() }];
            let mut partials = [VertexPartials::default()];
            let vertices = Vertices { first: 0, total: 5, scalars: &scalars, vectors: &[] };
            let slopes = VertexSlopes { scalars: &mut partials, vectors: &mut [] };
            (PlaquetteArea.vertices(&term, vertices, slopes), partials[0].area)
        };
        let (a, k, t) = (1.3, 0.7, 6.0);
        let (sum, slope) = at(a, k, t);
        assert!((sum.energy - 0.5 * k * (5.0 * a / t - 1.0).powi(2)).abs() < 1e-15);
        let h = 1e-6;
        let central = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        for (found, expected) in [
            (slope, central(&|s| at(a + s, k, t).0.energy)),
            (sum.by_parameter[0], central(&|s| at(a, k + s, t).0.energy)),
            (sum.by_parameter[1], central(&|s| at(a, k, t + s).0.energy)),
        ] {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}
