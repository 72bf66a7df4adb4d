//! Local area: E = Σ_t ½ k_A (a_t − a₀)² / a₀, which makes a membrane resist changes of each triangle's
//! area, as the skeleton of a cell does.

use super::{Contribution, Domain, Element, Needs, Parameter, Potential, Term, relative_spring};
use crate::mesh::geometry::{TriangleGeometry, TrianglePartials};

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

    fn triangles(
        &self,
        term: &Term,
        first: usize,
        triangles: &[TriangleGeometry],
        partials: &mut [TrianglePartials],
    ) -> Contribution {
        let mut sum = Contribution::default();
        for (index, (triangle, partial)) in triangles.iter().zip(partials).enumerate() {
            let target = term.value(1, first + index);
            let (contribution, slope) = relative_spring(term.values[0], target, triangle.area());
            sum += contribution;
            partial.area += slope;
        }
        if !term.is_scalar(1) {
            sum.by_parameter[1] = 0.0;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::Vec3;

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
        let sum = TriangleArea.triangles(&term, 2, &[triangle(2.5), triangle(3.0)], &mut partials);
        assert!((sum.energy - 0.5 * 3.0 * (0.25 / 2.0 + 1.0 / 4.0)).abs() < 1e-15);
        assert!((partials[0].area - 3.0 * 0.5 / 2.0).abs() < 1e-15);
        assert!((partials[1].area + 3.0 * 1.0 / 4.0).abs() < 1e-15);
    }
}
