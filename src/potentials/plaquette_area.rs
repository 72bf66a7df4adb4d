//! Plaquette homogenising: E = ½ k Σ_i (N a_i / A₀ − 1)² over the N vertices, with a_i the barycentric
//! area of a vertex (its plaquette) and A₀ the target of the total area. Equation (20) of
//! doi:10.1103/PhysRevE.108.015301 with k = (3/2) k_B T.

use super::{
    Contribution, Domain, Needs, Parameter, Place, Potential, Sums, Term, Vertex, VertexFormula,
    Vertices,
};
use crate::real::Real;

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

    fn is_never_negative(&self, _: &Term) -> bool {
        true
    }

    fn vertices(&self, term: &Term, run: Vertices) -> Contribution {
        let [stiffness, target, ..] = term.values;
        let scale = run.total() as f64 / target;
        run.apply(term, &Plaquette { stiffness, target, scale })
    }
}

struct Plaquette {
    stiffness: f64,
    target: f64,
    /// N / A₀
    scale: f64,
}

impl VertexFormula for Plaquette {
    const USES: Needs = Needs::empty();

    #[inline(always)]
    fn apply<R: Real>(&self, _: Place, vertex: &Vertex<R>, partials: &mut Vertex<R>) -> Sums<R> {
        let strain = vertex.area * self.scale - 1.0;
        partials.area = partials.area + strain * (self.stiffness * self.scale);
        let half_square = strain * strain * 0.5;
        let by_target = strain * (strain + 1.0) * (-self.stiffness / self.target);
        Sums { energy: half_square * self.stiffness, by_parameter: [half_square, by_target] }
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
            let run = Vertices::Plain {
                first: 0,
                total: 5,
                left_out: &[],
                scalars: &scalars,
                vectors: &[],
                scalar_partials: &mut partials,
                vector_partials: &mut [],
            };
            (PlaquetteArea.vertices(&term, run), partials[0].area)
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
