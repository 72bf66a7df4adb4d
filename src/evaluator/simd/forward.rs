//! The second pass: round the rings of the vertices, from normals to areas and curvatures; and what the
//! potentials of vertices make of them.

use super::arrays::Arrays;
use super::lanes::{BLOCK, Lane, Records, WithLanes};
use super::layout::{Layout, TILE};
use super::tiles::{Column, VertexTile};
use crate::mesh::geometry::arctan_over_argument;
use crate::mesh::vertex_vectors::COT_60;
use crate::real::{Real, cross, dot, minus, plus_scaled};

/// Areas and curvatures of a tile of vertices: with `BENDS` the dihedral angles of the edges and
/// Jülicher's curvature, with `LENGTHS` also the edges' lengths, with `VECTORS` Voronoi areas and the
/// vectors of Gompper and Kroll and of Espriu.
///
/// Reads positions and normals; writes bends and lengths of the tile's steps, as the only one.
pub struct Forward<'a, const BENDS: bool, const LENGTHS: bool, const VECTORS: bool> {
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub index: usize,
    pub tile: &'a mut VertexTile,
}

/// Offsets of records that follow each other.
pub static CONSECUTIVE: [u32; BLOCK] = [0, 4, 8, 12, 16, 20, 24, 28];

/// φ / l of an edge from its vector e and the unit normals n, m on its left and right.
///
/// With sin φ = e·(n × m) / l and cos φ = n·m, tan(φ/2) = sin φ / (1 + cos φ), and up to 45° the angle is a
/// polynomial in it. Beyond, where edges of membranes rarely are, each lane asks atan2. Beyond the end of a
/// ring, where `twice_area` is zero, so are the normals and the angle.
#[inline(always)]
fn bend<S: Records>(
    e: [Lane<S>; 3],
    length_squared: Lane<S>,
    n: [Lane<S>; 3],
    m: [Lane<S>; 3],
    twice_area: Lane<S>,
) -> Lane<S> {
    let determinant = dot(e, cross(n, m));
    let cosine = dot(n, m);
    // tan(φ/2) / l
    let slope = determinant / (length_squared * (cosine + 1.0));
    let z = length_squared * (slope * slope);
    let small = (slope + slope) * arctan_over_argument(z);
    let limit = cosine.of(std::f64::consts::FRAC_1_SQRT_2);
    if !cosine.any(limit.above(cosine)) {
        return small;
    }
    let large = limit.above(cosine.or_else(twice_area.above(cosine.zero()), cosine.of(1.0)));
    if !cosine.any(large) {
        return small;
    }
    let exact = determinant.map3(cosine, length_squared, |determinant, cosine, length_squared| {
        let length = length_squared.sqrt();
        (determinant / length).atan2(cosine) / length
    });
    exact.or_else(large, small)
}

impl<const BENDS: bool, const LENGTHS: bool, const VECTORS: bool> WithLanes
    for Forward<'_, BENDS, LENGTHS, VECTORS>
{
    type Output = ();

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) {
        let Self { layout, arrays, index: tile_index, tile } = self;
        let zero = Lane::splat(simd, 0.0);
        let (positions, normals) = (arrays.positions.at(0), arrays.normals.at(0));
        for first in layout.vertex_tile(tile_index).step_by(Lane::<S>::COUNT) {
            let (block, lane) = (first / BLOCK, first % BLOCK);
            let steps = layout.steps[block] as usize..layout.steps[block + 1] as usize - 1;
            // SAFETY: all offsets of the layout are within positions and normals, and the positions have whole
            // blocks of vertices.
            let here = unsafe {
                Lane::gather3(simd, arrays.positions.at(4 * first), CONSECUTIVE.as_ptr())
            };
            let arm = |step: usize| unsafe {
                let offsets = layout.neighbours[step].as_ptr().add(lane);
                minus(Lane::gather3(simd, positions, offsets), here)
            };
            let [nx, ny, nz] =
                unsafe { Lane::gather3(simd, normals, layout.before[block].as_ptr().add(lane)) };
            let mut last = [nx, ny, nz];
            let (mut area, mut voronoi, mut curvature) = (zero, zero, zero);
            let (mut cotangent, mut umbrella) = ([zero; 3], [zero; 3]);
            let mut e = arm(steps.start);
            let mut length_squared = dot(e, e);
            for step in steps {
                // SAFETY: as above.
                let [nx, ny, nz, twice_area] = unsafe {
                    Lane::gather4(simd, normals, layout.triangles[step].as_ptr().add(lane))
                };
                let n = [nx, ny, nz];
                area = area + twice_area;
                if BENDS {
                    let bend = bend(e, length_squared, n, last, twice_area);
                    curvature = length_squared.mul_add(bend, curvature);
                    last = n;
                    // SAFETY: bends and lengths have a place for each step and lane.
                    unsafe {
                        bend.store(arrays.bends.at(step * BLOCK + lane));
                        if LENGTHS {
                            length_squared.store(arrays.lengths_squared.at(step * BLOCK + lane));
                        }
                    }
                }
                let next = arm(step + 1);
                let next_squared = dot(next, next);
                if VECTORS {
                    let exists = twice_area.above(zero);
                    let inverse = (zero.of(1.0) / twice_area).or_else(exists, zero);
                    let product = dot(e, next);
                    // Each side's square times the scalar product at the far end of the other.
                    let weighted = length_squared * (next_squared - product)
                        + next_squared * (length_squared - product);
                    voronoi = inverse.mul_add(weighted, voronoi);
                    let facing = minus(next, e);
                    let turned = cross(n, facing);
                    cotangent = [0, 1, 2].map(|k| cotangent[k] + turned[k]);
                    let share = zero.of(-0.5 * COT_60).or_else(exists, zero);
                    umbrella = plus_scaled(umbrella, share, [0, 1, 2].map(|k| e[k] + next[k]));
                }
                e = next;
                length_squared = next_squared;
            }
            let index = first % TILE;
            let known = &mut tile.known;
            known.area.store(index, area * (1.0 / 6.0));
            if BENDS {
                known.curvature.store(index, curvature * 0.5);
            }
            if VECTORS {
                known.voronoi_area.store(index, voronoi * 0.125);
                for k in 0..3 {
                    known.cotangent[k].store(index, cotangent[k] * 0.5);
                    known.umbrella[k].store(index, umbrella[k]);
                }
            }
        }
    }
}

/// The slopes of a tile of vertices, from its columns to records that the neighbours will gather.
///
/// Writes the records of the tile, as the only one, while nobody reads them.
pub struct Slopes<'a, const VECTORS: bool> {
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub index: usize,
    pub tile: &'a VertexTile,
}

impl<const VECTORS: bool> WithLanes for Slopes<'_, VECTORS> {
    type Output = ();

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) {
        let slopes = &self.tile.slopes;
        for first in self.layout.vertex_tile(self.index).step_by(Lane::<S>::COUNT) {
            let load = |column: &Column| column.load(simd, first % TILE);
            // SAFETY: the records of vertices have whole blocks.
            unsafe {
                let pair = [load(&slopes.curvature), load(&slopes.area)];
                Lane::store2(self.arrays.slopes.at(2 * first), pair);
                if VECTORS {
                    let [x, y, z] = slopes.cotangent.each_ref().map(load);
                    let voronoi = load(&slopes.voronoi_area);
                    Lane::store4(self.arrays.vector_slopes.at(4 * first), [x, y, z, voronoi]);
                    let [x, y, z] = slopes.umbrella.each_ref().map(load);
                    Lane::store4(self.arrays.umbrella_slopes.at(4 * first), [x, y, z, voronoi]);
                }
            }
        }
    }
}
