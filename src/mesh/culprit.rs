//! Which element of a mesh is at fault.

use super::geometry::{TriangleGeometry, Vec3};
use crate::error::Error;

/// Why a mesh has no usable geometry: a position that is not finite, or a triangle without area. The mesh is given
/// by its particles and by those of each triangle, with how far the corners are from them.
pub fn culprit(
    particles: &[u32],
    triangles: impl Iterator<Item = [(u32, Vec3); 3]>,
    positions: &[f64],
) -> Error {
    let position =
        |particle: u32| std::array::from_fn(|axis| positions[3 * particle as usize + axis]);
    for &particle in particles {
        let position = position(particle);
        if !position.iter().all(|x: &f64| x.is_finite()) {
            return Error::NonFinitePosition { particle, position };
        }
    }
    // Relative to a vertex, as evaluators have it.
    let origin = Vec3::from(position(particles[0]));
    let (mut smallest, mut thinnest) = (f64::INFINITY, (0, [0; 3]));
    let mut sum = 0.0;
    for (triangle, places) in triangles.enumerate() {
        let corners = places.map(|(particle, _)| particle);
        let [a, b, c] =
            places.map(|(particle, shift)| Vec3::from(position(particle)) - origin + shift);
        let twice_area = TriangleGeometry::new(&a, &b, &c).twice_area;
        if !twice_area.is_finite() {
            return Error::OverflownTriangle { triangle, corners };
        }
        sum += twice_area;
        if twice_area < smallest {
            (smallest, thinnest) = (twice_area, (triangle, corners));
        }
    }
    let (triangle, corners) = thinnest;
    if sum.is_finite() {
        return Error::DegenerateTriangle { triangle, corners };
    }
    // Each triangle is fine, so it is their sum that overflows.
    Error::OverflownTriangle { triangle, corners }
}
