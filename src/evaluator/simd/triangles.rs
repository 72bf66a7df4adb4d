//! The first pass: the geometry of triangles, and what their potentials make of it.

use super::arrays::Arrays;
use super::layout::Layout;
use crate::lanes::tiles::TILE;
use crate::lanes::tiles::{COUNTS, TriangleTile, load3};
use crate::lanes::{BLOCK, Records};
use crate::lanes::{Lane, WithLanes};
use crate::mesh::geometry::corner_angle;
use crate::real::{Real, cross, dot, minus, plus, plus_scaled, scaled};
use std::ops::AddAssign;

/// What the pass sums.
#[derive(Clone, Copy)]
pub struct TriangleSums {
    /// Twice the area.
    pub twice_area: f64,
    /// Six times the volume.
    pub six_volumes: f64,
    /// The smallest |N|.
    pub smallest: f64,
    /// Whether the tensions of these triangles are zero; what earlier evaluations left counts.
    pub silent: bool,
}

impl Default for TriangleSums {
    fn default() -> Self {
        Self { twice_area: 0.0, six_volumes: 0.0, smallest: f64::INFINITY, silent: true }
    }
}

impl AddAssign for TriangleSums {
    fn add_assign(&mut self, other: Self) {
        self.twice_area += other.twice_area;
        self.six_volumes += other.six_volumes;
        self.smallest = self.smallest.min(other.smallest);
        self.silent &= other.silent;
    }
}

/// Normals of a tile of triangles; with `POTENTIALS` also what their potentials want to know, with `ANGLES`
/// the angles of their corners.
///
/// Reads positions, writes the tile's normals and angles: whoever runs it must be the only one to write those, while
/// nobody writes positions or reads these normals.
pub struct Forward<'a, const POTENTIALS: bool, const ANGLES: bool> {
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub index: usize,
    pub tile: &'a mut TriangleTile,
}

impl<const POTENTIALS: bool, const ANGLES: bool> WithLanes for Forward<'_, POTENTIALS, ANGLES> {
    type Output = TriangleSums;

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) -> TriangleSums {
        let triangles = self.layout.triangle_tile(self.index);
        let zero = Lane::splat(simd, 0.0);
        let (mut twice_area, mut six_volumes) = (zero, zero);
        let mut smallest = zero.of(f64::INFINITY);
        for first in triangles.clone().step_by(Lane::<S>::COUNT) {
            let offsets = &self.layout.corners[first / BLOCK];
            // SAFETY: the layout's offsets are within the positions, and the normals have whole blocks.
            let (a, b, c) = unsafe {
                let (positions, lane) = (self.arrays.positions.at(0), first % BLOCK);
                (
                    Lane::gather3(simd, positions, offsets[0].as_ptr().add(lane)),
                    Lane::gather3(simd, positions, offsets[1].as_ptr().add(lane)),
                    Lane::gather3(simd, positions, offsets[2].as_ptr().add(lane)),
                )
            };
            let (ab, ca) = (minus(b, a), minus(a, c));
            let normal = cross(ca, ab);
            let twice = dot(normal, normal).sqrt();
            let inverse = zero.of(1.0) / twice;
            let [x, y, z] = scaled(normal, inverse);
            // SAFETY: as above.
            unsafe { Lane::store4(self.arrays.normals.at(4 * first), [x, y, z, twice]) };
            if POTENTIALS {
                let bc = minus(c, b);
                let index = first % TILE;
                self.tile.twice_area.store(index, twice);
                self.tile.dots[0].store(index, zero - dot(ca, ab));
                self.tile.dots[1].store(index, zero - dot(ab, bc));
                self.tile.dots[2].store(index, zero - dot(bc, ca));
                self.tile.by_area.store(index, zero);
                self.tile.by_length_squared[0].store(index, zero);
                self.tile.by_length_squared[1].store(index, zero);
                self.tile.by_length_squared[2].store(index, zero);
            }
            if ANGLES {
                let bc = minus(c, b);
                let angles = [
                    corner_angle(twice, zero - dot(ca, ab)),
                    corner_angle(twice, zero - dot(ab, bc)),
                    corner_angle(twice, zero - dot(bc, ca)),
                ];
                // SAFETY: there is a record of angles for each normal.
                unsafe {
                    let at = self.arrays.angles.at(4 * first);
                    Lane::store4(at, [angles[0], angles[1], angles[2], zero]);
                    let at = self.arrays.next_angles.at(4 * first);
                    Lane::store4(at, [angles[1], angles[2], angles[0], zero]);
                }
            }
            smallest = smallest.min(twice);
            let six = dot(a, normal);
            let count = triangles.end - first;
            if count >= Lane::<S>::COUNT {
                twice_area = twice_area + twice;
                six_volumes = six_volumes + six;
            } else {
                // SAFETY: as many ones as count, then zeros, are within the table.
                let counts = unsafe { Lane::load(simd, COUNTS.as_ptr().add(BLOCK - count)) };
                twice_area = twice_area + twice * counts;
                six_volumes = six_volumes + six * counts;
            }
        }
        TriangleSums {
            twice_area: twice_area.sum(),
            six_volumes: six_volumes.sum(),
            smallest: smallest.smallest(),
            silent: true,
        }
    }
}

/// The tensions along the sides of a tile of triangles, from the partials that its potentials found.
///
/// Writes the tile's tensions, under the same condition as [`Forward`] its normals.
pub struct Tensions<'a> {
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub index: usize,
    pub tile: &'a TriangleTile,
}

impl WithLanes for Tensions<'_> {
    type Output = ();

    /// A side's tension is 2 ∂E/∂l² + ½ (∂E/∂a) cot γ with γ the angle opposite it.
    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) {
        for first in self.layout.triangle_tile(self.index).step_by(Lane::<S>::COUNT) {
            let index = first % TILE;
            let tile = self.tile;
            let by_area = tile.by_area.load(simd, index);
            let stress = by_area * 0.5 / tile.twice_area.load(simd, index);
            let dots = load3(simd, &tile.dots, index);
            let by_length = load3(simd, &tile.by_length_squared, index);
            let [t0, t1, t2] =
                plus_scaled(plus(by_length, by_length), stress, [dots[2], dots[0], dots[1]]);
            // SAFETY: the tensions have whole blocks.
            unsafe { Lane::store4(self.arrays.tensions.at(4 * first), [t2, t0, t1, t2]) };
        }
    }
}
