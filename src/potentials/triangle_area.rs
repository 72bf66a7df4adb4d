//! Local area: E = Σ_t ½ k_A (a_t − a₀)² / a₀, which makes a membrane resist changes of each triangle's
//! area, as the skeleton of a cell does.

use super::{
    Contribution, Domain, Element, Needs, Parameter, Place, Potential, Sums, Term, Triangle,
    TriangleFormula, Triangles, relative_spring,
};
use crate::mesh::geometry::TrianglePartials;
use crate::real::Real;

/// A spring on each triangle's area.
pub struct TriangleArea;

impl Potential for TriangleArea {
    fn name(&self) -> &'static str {
        "TriangleAreaForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"modulus", 1, -2, Domain::NonNegative),
                Parameter::new(c"target", 0, 2, Domain::Positive).per(Element::Triangle),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TRIANGLES
    }

    fn triangles(&self, term: &Term, run: Triangles) -> Contribution {
        run.apply(term, &Spring)
    }
}

struct Spring;

impl TriangleFormula for Spring {
    #[inline(always)]
    fn apply<R: Real>(
        &self,
        place: Place,
        triangle: &Triangle<R>,
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R> {
        let area = triangle.area();
        let (modulus, target) = (place.value(0, area), place.value(1, area));
        let (sums, slope) = relative_spring(modulus, target, area);
        partials.area = partials.area + slope;
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::{TriangleGeometry, TrianglePartials, Vec3};

    #[test]
    fn each_triangle_can_have_its_own_target() {
        let triangle = |area: f64| TriangleGeometry {
            normal: Vec3::zeros(),
            twice_area: 2.0 * area,
            dots: [1.0; 3],
        };
        let mut term = Term::new("TriangleAreaForce", 0, &[3.0, 1.0]).unwrap();
        let targets = [9.0, 9.0, 2.0, 4.0];
        term.fields[1] = &targets;
        let mut partials = [TrianglePartials::default(); 2];
        let geometry = &[triangle(2.5), triangle(3.0)];
        let run = Triangles::Plain { first: 2, geometry, partials: &mut partials };
        let sum = TriangleArea.triangles(&term, run);
        assert!((sum.energy - 0.5 * 3.0 * (0.25 / 2.0 + 1.0 / 4.0)).abs() < 1e-15);
        assert!((partials[0].area - 3.0 * 0.5 / 2.0).abs() < 1e-15);
        assert!((partials[1].area + 3.0 * 1.0 / 4.0).abs() < 1e-15);
    }
}
