//! The second pass: round the rings of the vertices, from normals to areas and curvatures; and what the
//! potentials of vertices make of them.

use super::arrays::Arrays;
use super::layout::Layout;
use crate::lanes::tiles::TILE;
use crate::lanes::tiles::{VertexTile, load3};
use crate::lanes::{BLOCK, Records};
use crate::lanes::{Lane, WithLanes};
use crate::mesh::geometry::{Vec3, arctan_over_argument};
use crate::mesh::vertex_vectors::COT_60;
use crate::real::{Real, cross, dot, minus, plus, plus_scaled, scaled};

/// Voronoi areas.
pub const VORONOI: u8 = 1;
/// The curvature vectors of Gompper and Kroll.
pub const COTANGENTS: u8 = 2;
/// Those of Espriu.
pub const UMBRELLAS: u8 = 4;
/// Normals.
pub const NORMALS: u8 = 8;

/// Areas and curvatures of a tile of vertices: with `BENDS` the dihedral angles of the edges and Jülicher's
/// curvature, with `VECTORS` the sum of those of [`VORONOI`], [`COTANGENTS`], [`UMBRELLAS`] and [`NORMALS`].
///
/// Reads positions, normals and angles; writes bends and lengths of the tile's steps, as the only one.
pub struct Forward<'a, const BENDS: bool, const VECTORS: u8> {
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub index: usize,
    /// Whether the edges' lengths are wanted.
    pub lengths: bool,
    pub tile: &'a mut VertexTile,
}

/// Offsets of records that follow each other.
pub static CONSECUTIVE: [u32; BLOCK] = [0, 4, 8, 12, 16, 20, 24, 28];

/// cos 45°: up to there the angle is a polynomial in the tangent of its half.
const POLYNOMIAL_LIMIT: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl<const BENDS: bool, const VECTORS: u8> WithLanes for Forward<'_, BENDS, VECTORS> {
    type Output = ();

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) {
        let Self { layout, arrays, index: tile_index, lengths: lengths_wanted, tile } = self;
        // A row for each step of the longest ring, used up before the next ring begins.
        let ring = tile.ring.as_mut_ptr();
        let zero = Lane::splat(simd, 0.0);
        let (positions, normals) = (arrays.positions.at(0), arrays.normals.at(0));
        for first in layout.vertex_tile(tile_index).step_by(Lane::<S>::COUNT) {
            let (block, lane) = (first / BLOCK, first % BLOCK);
            let steps = layout.steps[block] as usize..layout.steps[block + 1] as usize - 1;
            let neighbours = layout.neighbours.as_ptr().cast::<u32>().wrapping_add(lane);
            let places = layout.places.as_ptr().cast::<u32>().wrapping_add(lane);
            // SAFETY: here and below, all offsets of the layout are within the arrays that they are for, and those
            // of vertices have whole blocks.
            let here = unsafe {
                Lane::gather3(simd, arrays.positions.at(4 * first), CONSECUTIVE.as_ptr())
            };
            let (last, last_arm, mut e) = unsafe {
                let before = layout.neighbours_before[block].as_ptr().add(lane);
                (
                    Lane::gather4(simd, normals, layout.before[block].as_ptr().add(lane)),
                    minus(Lane::gather3(simd, positions, before), here),
                    minus(
                        Lane::gather3(simd, positions, neighbours.add(BLOCK * steps.start)),
                        here,
                    ),
                )
            };
            let (mut last_normal, mut last_twice, mut last_arm) =
                ([last[0], last[1], last[2]], last[3], last_arm);
            let mut length_squared = dot(e, e);
            let (mut area, mut voronoi) = (zero, zero);
            let (mut cotangent, mut umbrella, mut normal_sum) = ([zero; 3], [zero; 3], [zero; 3]);
            let mut flattest = zero.of(1.0);
            for step in steps.clone() {
                let [nx, ny, nz, twice_area] =
                    unsafe { Lane::gather4_within(simd, normals, places.add(BLOCK * step)) };
                let n = [nx, ny, nz];
                area = area + twice_area;
                let exists = twice_area.above(zero);
                if BENDS {
                    // With the triangles on the left and right, tan(φ/2) / l = −N·d / (N·M + |N||M|), where d leads
                    // from this vertex to the neighbour before; both sides are divided by |N||M| here.
                    let cosine = dot(n, last_normal);
                    let depth = dot(n, last_arm);
                    let tangent = (zero - depth) / last_twice.mul_add(cosine, last_twice);
                    flattest = flattest.min(cosine.or_else(exists, zero.of(1.0)));
                    unsafe {
                        let [tangents, lengths] = &mut *ring.add(step - steps.start);
                        tangent.store(tangents.as_mut_ptr());
                        length_squared.store(lengths.as_mut_ptr());
                    }
                    last_normal = n;
                    last_twice = twice_area.or_else(exists, zero.of(1.0));
                    last_arm = e;
                }
                let next = unsafe {
                    minus(Lane::gather3(simd, positions, neighbours.add(BLOCK * (step + 1))), here)
                };
                let next_squared = dot(next, next);
                if VECTORS & VORONOI != 0 {
                    let inverse = (zero.of(1.0) / twice_area).or_else(exists, zero);
                    let product = dot(e, next);
                    // Each side's square times the scalar product at the far end of the other.
                    let weighted = length_squared * (next_squared - product)
                        + next_squared * (length_squared - product);
                    voronoi = inverse.mul_add(weighted, voronoi);
                }
                if VECTORS & COTANGENTS != 0 {
                    cotangent = plus(cotangent, cross(n, minus(next, e)));
                }
                if VECTORS & UMBRELLAS != 0 {
                    let share = zero.of(-0.5 * COT_60).or_else(exists, zero);
                    umbrella = plus_scaled(umbrella, share, plus(e, next));
                }
                if VECTORS & NORMALS != 0 {
                    let angle = unsafe {
                        Lane::gather1(simd, arrays.angles.at(0), places.add(BLOCK * step))
                    };
                    normal_sum = plus_scaled(normal_sum, angle, n);
                }
                e = next;
                length_squared = next_squared;
            }
            let known = &mut tile.known;
            let index = first % TILE;
            known.area.store(index, area * (1.0 / 6.0));
            if BENDS {
                // A loop of its own, since the processor then works at many steps at once.
                let mut curvature = zero;
                for step in steps.clone() {
                    let at = step * BLOCK + lane;
                    unsafe {
                        let [tangents, lengths] = &*ring.add(step - steps.start);
                        let tangent = Lane::load(simd, tangents.as_ptr());
                        let length_squared = Lane::load(simd, lengths.as_ptr());
                        if lengths_wanted {
                            length_squared.store(arrays.lengths_squared.at(at));
                        }
                        let angle_part = arctan_over_argument(length_squared * (tangent * tangent));
                        let bend = (tangent + tangent) * angle_part;
                        bend.store(arrays.bends.at(at));
                        curvature = length_squared.mul_add(bend, curvature);
                    }
                }
                if zero.any(zero.of(POLYNOMIAL_LIMIT).above(flattest)) {
                    let ring = Ring { layout, arrays, block, lane };
                    curvature = unsafe { ring.careful(simd) };
                }
                known.curvature.store(index, curvature * 0.5);
            }
            if VECTORS & VORONOI != 0 {
                known.voronoi_area.store(index, voronoi * 0.125);
            }
            for k in 0..3 {
                if VECTORS & COTANGENTS != 0 {
                    known.cotangent[k].store(index, cotangent[k] * 0.5);
                }
                if VECTORS & UMBRELLAS != 0 {
                    known.umbrella[k].store(index, umbrella[k]);
                }
                if VECTORS & NORMALS != 0 {
                    known.normal_sum[k].store(index, normal_sum[k]);
                }
            }
        }
    }
}

/// The rings of some lanes, of which at least one has an edge that is bent by more than 45°, as edges of
/// membranes rarely are.
struct Ring<'a> {
    layout: &'a Layout,
    arrays: &'a Arrays,
    block: usize,
    lane: usize,
}

impl Ring<'_> {
    /// Correct the bends of such edges, lane by lane with atan2; returns the sums of l φ.
    ///
    /// # Safety
    /// The pass before has filled positions, normals and bends.
    #[cold]
    #[inline(never)]
    unsafe fn careful<S: Records>(&self, simd: S) -> Lane<S> {
        let (layout, arrays, lane) = (self.layout, self.arrays, self.lane);
        let vertex = self.block * BLOCK + lane;
        let steps = layout.steps[self.block] as usize..layout.steps[self.block + 1] as usize - 1;
        let record = |numbers: &super::arrays::Numbers, offset: u32| {
            // SAFETY: offsets of the layout are within their arrays.
            let at = |k: usize| unsafe { *numbers.at(offset as usize + k) };
            Vec3::new(at(0), at(1), at(2))
        };
        let mut sums = [0.0; BLOCK];
        for other in 0..Lane::<S>::COUNT {
            let here = record(&arrays.positions, 4 * (vertex + other) as u32);
            let mut last = record(&arrays.normals, layout.before[self.block][lane + other]);
            for step in steps.clone() {
                let e = record(&arrays.positions, layout.neighbours[step][lane + other]) - here;
                let n = record(&arrays.normals, layout.places[step][lane + other] & !3);
                let length_squared = e.norm_squared();
                // SAFETY: there are bends for each step and lane.
                let bend = unsafe { &mut *arrays.bends.at(step * BLOCK + lane + other) };
                let cosine = n.dot(&last);
                // Where a ring has ended, the normals are zero, and so is the bend.
                if cosine < POLYNOMIAL_LIMIT && n.norm_squared() > 0.0 {
                    let length = length_squared.sqrt();
                    *bend = (e.dot(&n.cross(&last)) / length).atan2(cosine) / length;
                }
                sums[other] += length_squared * *bend;
                last = n;
            }
        }
        // SAFETY: no instruction set has more lanes than a block.
        unsafe { Lane::load(simd, sums.as_ptr()) }
    }
}

/// The partials of a tile of vertices, from its columns to records that the neighbours will gather.
///
/// Writes the records of the tile, as the only one, while nobody reads them.
pub struct Partials<'a, const VECTORS: u8> {
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub index: usize,
    pub tile: &'a VertexTile,
}

impl<const VECTORS: u8> WithLanes for Partials<'_, VECTORS> {
    type Output = ();

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) {
        let partials = &self.tile.partials;
        for first in self.layout.vertex_tile(self.index).step_by(Lane::<S>::COUNT) {
            let index = first % TILE;
            // SAFETY: the records of vertices have whole blocks.
            unsafe {
                let curvature = partials.curvature.load(simd, index) * 0.5;
                let pair = [curvature, partials.area.load(simd, index) * (1.0 / 6.0)];
                Lane::store2(self.arrays.partials.at(2 * first), pair);
                if VECTORS & (VORONOI | COTANGENTS) != 0 {
                    let zero = Lane::splat(simd, 0.0);
                    let (mut voronoi, mut vector) = (zero, [zero; 3]);
                    if VECTORS & VORONOI != 0 {
                        voronoi = partials.voronoi_area.load(simd, index) * 0.125;
                    }
                    if VECTORS & COTANGENTS != 0 {
                        vector = scaled(load3(simd, &partials.cotangent, index), voronoi.of(0.5));
                    }
                    let [x, y, z] = vector;
                    Lane::store4(self.arrays.vector_partials.at(4 * first), [x, y, z, voronoi]);
                }
                if VECTORS & UMBRELLAS != 0 {
                    let [x, y, z] = load3(simd, &partials.umbrella, index);
                    Lane::store4(self.arrays.umbrella_partials.at(4 * first), [x, y, z, z]);
                }
                if VECTORS & NORMALS != 0 {
                    let [x, y, z] = load3(simd, &partials.normal_sum, index);
                    Lane::store4(self.arrays.normal_partials.at(4 * first), [x, y, z, z]);
                }
            }
        }
    }
}
