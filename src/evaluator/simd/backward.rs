//! The last pass: round the rings again, from slopes to forces.

use super::arrays::Arrays;
use super::forward::CONSECUTIVE;
use super::lanes::{BLOCK, Lane, Records, WithLanes};
use super::layout::Layout;
use crate::mesh::geometry::TotalPartials;
use crate::mesh::vertex_vectors::COT_60;
use crate::real::{Real, dot, minus, plus_scaled};

/// Where the forces of all particles are, x y z of one after the other.
#[derive(Clone, Copy)]
pub struct Forces(pub *mut f64);

// SAFETY: each vertex has its own particle, and each pass its own vertices.
unsafe impl Sync for Forces {}

/// Forces on a tile of vertices: with `BENDS` those of Jülicher's curvature, with `MOMENTS` those of
/// dihedral angles, with `TENSIONS` those of triangles' areas and sides, with `VECTORS` those of Voronoi
/// areas and curvature vectors; those of the total area and volume and of vertex areas in any case.
///
/// The force on vertex i is Σ_k [ T_k (r_k − r_i) − p_k N_k ] over its ring, with tensions T along edges and
/// pressures p of triangles as in [`crate::mesh::geometry::corner_forces`], which is this formula by triangle.
///
/// Reads what the other passes have written; adds to the forces of the particles of its tile, as the only one.
pub struct Backward<
    'a,
    const BENDS: bool,
    const MOMENTS: bool,
    const TENSIONS: bool,
    const VECTORS: bool,
> {
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub totals: &'a TotalPartials,
    pub index: usize,
    pub forces: Forces,
}

/// One neighbour of a vertex, seen from there.
#[derive(Clone, Copy)]
struct Arm<S: Records> {
    /// r_j − r_i.
    e: [Lane<S>; 3],
    length_squared: Lane<S>,
    /// ∂E/∂J and ∂E/∂a_B of the neighbour.
    by_curvature: Lane<S>,
    by_area: Lane<S>,
    /// ∂E/∂S_i − ∂E/∂S_j.
    g: [Lane<S>; 3],
    /// ∂E/∂a_V of both, added.
    voronoi: Lane<S>,
    /// ∂E/∂U_j.
    umbrella: [Lane<S>; 3],
    /// ½ (g_i − g_j)·(r_i − r_j) + ⅛ (v_i + v_j) l², what the edge's cotangents are multiplied with.
    by_cotangent: Lane<S>,
}

/// What all arms of a vertex start from.
struct Centre<S: Records> {
    position: [Lane<S>; 3],
    slopes: [Lane<S>; 2],
    vector: [Lane<S>; 4],
    umbrella: [Lane<S>; 3],
}

impl<const BENDS: bool, const MOMENTS: bool, const TENSIONS: bool, const VECTORS: bool>
    Backward<'_, BENDS, MOMENTS, TENSIONS, VECTORS>
{
    /// # Safety
    /// `first` is the first lane of a register within the vertices.
    #[inline(always)]
    unsafe fn centre<S: Records>(&self, simd: S, first: usize) -> Centre<S> {
        let (arrays, zero) = (self.arrays, Lane::splat(simd, 0.0));
        let offsets = CONSECUTIVE.as_ptr();
        // SAFETY: positions and slopes have whole blocks; the vectors' slopes exist if they are wanted.
        unsafe {
            let mut centre = Centre {
                position: Lane::gather3(simd, arrays.positions.at(4 * first), offsets),
                slopes: Lane::gather2::<2>(simd, arrays.slopes.at(2 * first), offsets),
                vector: [zero; 4],
                umbrella: [zero; 3],
            };
            if VECTORS {
                centre.vector = Lane::gather4(simd, arrays.vector_slopes.at(4 * first), offsets);
                centre.umbrella = Lane::gather3(simd, arrays.umbrella_slopes.at(4 * first), offsets);
            }
            centre
        }
    }

    /// # Safety
    /// There are offsets for each lane, and within the vertices.
    #[inline(always)]
    unsafe fn arm<S: Records>(&self, simd: S, offsets: *const u32, centre: &Centre<S>) -> Arm<S> {
        let (arrays, zero) = (self.arrays, Lane::splat(simd, 0.0));
        // SAFETY: as in `centre`.
        unsafe {
            let e = minus(Lane::gather3(simd, arrays.positions.at(0), offsets), centre.position);
            let length_squared = dot(e, e);
            let [by_curvature, by_area] =
                Lane::gather2::<2>(simd, arrays.slopes.at(0), offsets);
            let mut arm = Arm {
                e,
                length_squared,
                by_curvature,
                by_area,
                g: [zero; 3],
                voronoi: zero,
                umbrella: [zero; 3],
                by_cotangent: zero,
            };
            if VECTORS {
                let [x, y, z, voronoi] = Lane::gather4(simd, arrays.vector_slopes.at(0), offsets);
                let [gx, gy, gz, own] = centre.vector;
                arm.g = minus([gx, gy, gz], [x, y, z]);
                arm.voronoi = own + voronoi;
                arm.umbrella = Lane::gather3(simd, arrays.umbrella_slopes.at(0), offsets);
                arm.by_cotangent =
                    (arm.voronoi * length_squared) * 0.125 - dot(arm.g, e) * 0.5;
            }
            arm
        }
    }
}

impl<const BENDS: bool, const MOMENTS: bool, const TENSIONS: bool, const VECTORS: bool> WithLanes
    for Backward<'_, BENDS, MOMENTS, TENSIONS, VECTORS>
{
    type Output = ();

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) {
        let (layout, arrays) = (self.layout, self.arrays);
        let zero = Lane::splat(simd, 0.0);
        let by_total_area = zero.of(self.totals.area);
        let by_volume = zero.of(self.totals.volume / 6.0);
        let vertices = layout.vertex_tile(self.index);
        for first in vertices.clone().step_by(Lane::<S>::COUNT) {
            let (block, lane) = (first / BLOCK, first % BLOCK);
            let steps = layout.steps[block] as usize..layout.steps[block + 1] as usize - 1;
            // SAFETY: here and below, all offsets of the layout are within the arrays that they are for.
            let centre = unsafe { self.centre(simd, first) };
            let neighbours = |step: usize| layout.neighbours[step].as_ptr().wrapping_add(lane);
            let [own_curvature, own_area] = centre.slopes;
            let constant_area = own_area.mul_add(zero.of(1.0 / 3.0), by_total_area);
            let mut force = [zero; 3];
            // The tension along the present arm from the triangle before it.
            let mut tension = zero;
            let mut arm = unsafe { self.arm(simd, neighbours(steps.start), &centre) };
            let moment = |arm: &Arm<S>, step: usize| {
                let own = unsafe { Lane::load(simd, arrays.moments.at(step * BLOCK + lane)) };
                (own_curvature + arm.by_curvature).mul_add(zero.of(0.5), own)
            };
            let mut own_moment = if MOMENTS { moment(&arm, steps.start) } else { zero };
            for step in steps {
                let next = unsafe { self.arm(simd, neighbours(step + 1), &centre) };
                let [nx, ny, nz, twice_area] = unsafe {
                    let offsets = layout.triangles[step].as_ptr().add(lane);
                    Lane::gather4(simd, arrays.normals.at(0), offsets)
                };
                let exists = twice_area.above(zero);
                let inverse = (zero.of(1.0) / twice_area).or_else(exists, zero);
                // Cotangents times |N| at this vertex, at the arm's end and at the next arm's.
                let at_centre = dot(arm.e, next.e);
                let at_end = arm.length_squared - at_centre;
                let at_next = next.length_squared - at_centre;

                // ∂E/∂(area of the triangle)
                let mut by_area =
                    (arm.by_area + next.by_area).mul_add(zero.of(1.0 / 3.0), constant_area);
                let (mut along, mut along_next) = (tension, zero);
                if TENSIONS {
                    let [before, after] = unsafe {
                        let offsets = layout.places[step].as_ptr().add(lane);
                        Lane::gather2::<1>(simd, arrays.tensions.at(0), offsets)
                    };
                    along = along + after;
                    along_next = before;
                }
                if VECTORS {
                    // The side opposite the vertex, from this arm's end to the next.
                    let apart = dot(minus(next.g, arm.g), minus(arm.e, next.e));
                    let side_squared = at_end + at_next;
                    let voronoi = arm.voronoi + next.voronoi - centre.vector[3] - centre.vector[3];
                    let facing = apart.mul_add(zero.of(0.5), voronoi * side_squared * 0.125);
                    let (cot_end, cot_next) = (at_end * inverse, at_next * inverse);
                    // The cotangents' own derivatives, with respect to the sides and to the area.
                    let (here, there) = (arm.by_cotangent, next.by_cotangent);
                    along = along + inverse * (facing + there - here);
                    along_next = along_next + inverse * (here + facing - there);
                    let weighted = here * at_next + there * at_end + facing * at_centre;
                    by_area = by_area - inverse * inverse * weighted * 2.0;
                    // The explicit squared sides of Voronoi's area.
                    along = along + arm.voronoi * cot_next * 0.25;
                    along_next = along_next + next.voronoi * cot_end * 0.25;
                    // The explicit r_i − r_j of the vectors.
                    let half = zero.of(-0.5);
                    force = plus_scaled(force, cot_next * half, arm.g);
                    force = plus_scaled(force, cot_end * half, next.g);
                    let share = zero.of(-0.5 * COT_60).or_else(exists, zero);
                    let umbrella = [0, 1, 2].map(|k| {
                        centre.umbrella[k] + centre.umbrella[k] - arm.umbrella[k] - next.umbrella[k]
                    });
                    force = plus_scaled(force, share, umbrella);
                }
                let stress = by_area * inverse * 0.5;
                along = stress.mul_add(at_next, along);
                along_next = stress.mul_add(at_end, along_next);

                let mut pressure = by_volume * twice_area;
                // Past the end of a ring the moments repeat the first.
                let next_moment = if MOMENTS { moment(&next, step + 1) } else { zero };
                if MOMENTS {
                    let facing = (arm.by_curvature + next.by_curvature) * 0.5
                        + unsafe {
                            let offsets = layout.opposite()[step].as_ptr().add(lane);
                            Lane::gather1(simd, arrays.moments.at(0), offsets)
                        };
                    let turn = at_end * (own_moment - facing) + at_next * (next_moment - facing);
                    pressure = inverse.mul_add(turn, pressure);
                } else if BENDS {
                    let turn = at_end * (own_curvature - next.by_curvature)
                        + at_next * (own_curvature - arm.by_curvature);
                    pressure = (inverse * 0.5).mul_add(turn, pressure);
                }
                if BENDS {
                    let bend = unsafe { Lane::load(simd, arrays.bends.at(step * BLOCK + lane)) };
                    let mean = (own_curvature + arm.by_curvature) * 0.5;
                    along = bend.mul_add(mean, along);
                }
                force = plus_scaled(force, along, arm.e);
                let normal = [nx, ny, nz];
                force = [0, 1, 2].map(|k| pressure.neg_mul_add(normal[k], force[k]));
                tension = along_next;
                arm = next;
                own_moment = next_moment;
            }
            force = plus_scaled(force, tension, arm.e);
            let last = vertices.end.min(first + Lane::<S>::COUNT);
            // SAFETY: the particles of a tile are no other tile's, and the caller runs it once.
            unsafe { self.forces.add(&layout.particles[first..last], force) };
        }
    }
}

impl Forces {
    /// Add the lanes to the particles.
    ///
    /// # Safety
    /// The particles exist, there are no more than lanes, and nobody else touches their forces.
    #[inline(always)]
    unsafe fn add<S: Records>(self, particles: &[u32], [x, y, z]: [Lane<S>; 3]) {
        let mut rows = [[0.0; 4]; BLOCK];
        // SAFETY: there is a row for each lane; the rest the caller promises.
        unsafe {
            Lane::store4(rows.as_mut_ptr().cast(), [x, y, z, z]);
            for (row, &particle) in rows.iter().zip(particles) {
                let force = self.0.add(3 * particle as usize);
                for k in 0..3 {
                    *force.add(k) += row[k];
                }
            }
        }
    }
}
