//! What an energy of the total mean curvature does, between and after the passes.
//!
//! The total is half the sum of the vertices' curvatures, so that its derivative is a part of theirs. Along the edges that is
//! all: moments that are the same at all sides of a triangle have no force (L. Schläfli's formula, Σ l dφ = 0).

use super::arrays::Arrays;
use super::layout::Layout;
use crate::lanes::BLOCK;
use crate::mesh::geometry::{EdgeTension, TotalPartials, TriangleGeometry, Vec3, corner_forces};
use std::ops::Range;

/// Add it to the partials of some vertices and ghosts.
///
/// # Safety
/// Nobody else reads or writes these partials meanwhile.
pub unsafe fn add_mean_curvature(arrays: &Arrays, places: Range<usize>, totals: &TotalPartials) {
    // Partials are kept as ½ ∂E/∂J, and ∂M/∂J = ½.
    let part = 0.25 * totals.mean_curvature;
    for place in places {
        // SAFETY: there are partials for all places; the rest the caller promises.
        unsafe { *arrays.partials.at(2 * place) += part };
    }
}

/// Take the moment from sides at borders, which have no angle; the passes do not tell them from others.
pub fn release_borders(
    layout: &Layout,
    arrays: &Arrays,
    totals: &TotalPartials,
    forces: &mut [f64],
) {
    let moment = -0.5 * totals.mean_curvature;
    for &[triangle, side] in &layout.border_sides {
        let (block, lane) = (triangle as usize / BLOCK, triangle as usize % BLOCK);
        let offsets = layout.corners[block].map(|lanes| lanes[lane] as usize);
        let [a, b, c] = offsets.map(|offset| {
            // SAFETY: offsets of the layout are within their arrays, and no pass is running.
            let [x, y, z] = unsafe { *arrays.positions.at(offset).cast::<[f64; 3]>() };
            Vec3::new(x, y, z)
        });
        let geometry = TriangleGeometry::new(&a, &b, &c);
        let mut sides = [EdgeTension::default(); 3];
        sides[side as usize].moment = moment;
        let found = corner_forces([&a, &b, &c], &geometry, 0.0, &[0.0; 3], sides, 0.0);
        for (offset, force) in offsets.into_iter().zip(found) {
            let particle = layout.particle_at(offset / 4) as usize;
            for (sum, part) in forces[3 * particle..][..3].iter_mut().zip(&force) {
                *sum += part;
            }
        }
    }
}
