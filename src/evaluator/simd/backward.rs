//! The last pass: round the rings again, from partials to forces.

use super::arrays::Arrays;
use super::forward::{CONSECUTIVE, COTANGENTS, NORMALS, UMBRELLAS, VORONOI};
use super::layout::Layout;
use crate::lanes::{BLOCK, Records};
use crate::lanes::{Lane, WithLanes};
use crate::mesh::geometry::TotalPartials;
use crate::mesh::vertex_vectors::COT_60;
use crate::real::{Real, cross, dot, minus, minus_scaled, plus, plus_scaled, scaled};
use std::ptr::null;

/// Where the forces of all particles are, x y z of one after the other.
#[derive(Clone, Copy)]
pub struct Forces(pub *mut f64);

// SAFETY: each vertex has its own particle, and each pass its own vertices.
unsafe impl Sync for Forces {}

/// Forces on a tile of vertices: with `BENDS` those of Jülicher's curvature, with `MOMENTS` those of
/// dihedral angles, with `TENSIONS` those of triangles' areas and sides, with `VECTORS` the sum of those of
/// [`VORONOI`] areas, [`COTANGENTS`], [`UMBRELLAS`] and [`NORMALS`]; those of the total area and volume and of
/// vertex areas in any case.
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
    const VECTORS: u8,
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
    /// ½ ∂E/∂J and ⅙ ∂E/∂a_B of the neighbour.
    by_curvature: Lane<S>,
    by_area: Lane<S>,
    /// ½ (∂E/∂S_i − ∂E/∂S_j).
    g: [Lane<S>; 3],
    /// ⅛ ∂E/∂a_V of both, added.
    voronoi: Lane<S>,
    /// ∂E/∂U_j.
    umbrella: [Lane<S>; 3],
    /// ∂E/∂(sum of normals) of the neighbour.
    normal: [Lane<S>; 3],
    /// g·(r_i − r_j) + ⅛ (v_i + v_j) l², what the edge's cotangents are multiplied with.
    by_cotangent: Lane<S>,
}

/// What all arms of a vertex start from.
struct Centre<S: Records> {
    position: [Lane<S>; 3],
    partials: [Lane<S>; 2],
    vector: [Lane<S>; 4],
    umbrella: [Lane<S>; 3],
    normal: [Lane<S>; 3],
}

impl<const BENDS: bool, const MOMENTS: bool, const TENSIONS: bool, const VECTORS: u8>
    Backward<'_, BENDS, MOMENTS, TENSIONS, VECTORS>
{
    /// # Safety
    /// `first` is the first lane of a register within the vertices.
    #[inline(always)]
    unsafe fn centre<S: Records>(&self, simd: S, first: usize) -> Centre<S> {
        let (arrays, zero) = (self.arrays, Lane::splat(simd, 0.0));
        let offsets = CONSECUTIVE.as_ptr();
        // SAFETY: positions and partials have whole blocks; the vectors' partials exist if they are wanted.
        unsafe {
            let mut centre = Centre {
                position: Lane::gather3(simd, arrays.positions.at(4 * first), offsets),
                partials: Lane::gather2::<2>(simd, arrays.partials.at(2 * first), offsets),
                vector: [zero; 4],
                umbrella: [zero; 3],
                normal: [zero; 3],
            };
            if VECTORS & (VORONOI | COTANGENTS) != 0 {
                centre.vector = Lane::gather4(simd, arrays.vector_partials.at(4 * first), offsets);
            }
            if VECTORS & UMBRELLAS != 0 {
                centre.umbrella =
                    Lane::gather3(simd, arrays.umbrella_partials.at(4 * first), offsets);
            }
            if VECTORS & NORMALS != 0 {
                centre.normal = Lane::gather3(simd, arrays.normal_partials.at(4 * first), offsets);
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
            let [by_curvature, by_area] = Lane::gather2::<2>(simd, arrays.partials.at(0), offsets);
            let mut arm = Arm {
                e,
                length_squared,
                by_curvature,
                by_area,
                g: [zero; 3],
                voronoi: zero,
                umbrella: [zero; 3],
                normal: [zero; 3],
                by_cotangent: zero,
            };
            if VECTORS & (VORONOI | COTANGENTS) != 0 {
                let [x, y, z, voronoi] = Lane::gather4(simd, arrays.vector_partials.at(0), offsets);
                let [gx, gy, gz, own] = centre.vector;
                if VECTORS & VORONOI != 0 {
                    arm.voronoi = own + voronoi;
                    arm.by_cotangent = arm.voronoi * length_squared;
                }
                if VECTORS & COTANGENTS != 0 {
                    arm.g = minus([gx, gy, gz], [x, y, z]);
                    for k in 0..3 {
                        arm.by_cotangent = arm.g[k].neg_mul_add(e[k], arm.by_cotangent);
                    }
                }
            }
            if VECTORS & UMBRELLAS != 0 {
                arm.umbrella = Lane::gather3(simd, arrays.umbrella_partials.at(0), offsets);
            }
            if VECTORS & NORMALS != 0 {
                arm.normal = Lane::gather3(simd, arrays.normal_partials.at(0), offsets);
            }
            arm
        }
    }

    /// The bending moment per length of an arm.
    ///
    /// # Safety
    /// `index` is that of a step and lane.
    #[inline(always)]
    unsafe fn moment<S: Records>(&self, centre: &Centre<S>, arm: &Arm<S>, index: usize) -> Lane<S> {
        // SAFETY: there are moments for each step and lane.
        let own = unsafe { Lane::load(centre.position[0].simd(), self.arrays.moments.at(index)) };
        centre.partials[0] + arm.by_curvature + own
    }
}

impl<const BENDS: bool, const MOMENTS: bool, const TENSIONS: bool, const VECTORS: u8> WithLanes
    for Backward<'_, BENDS, MOMENTS, TENSIONS, VECTORS>
{
    type Output = ();

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) {
        let (layout, arrays) = (self.layout, self.arrays);
        let zero = Lane::splat(simd, 0.0);
        let by_total_area = zero.of(0.5 * self.totals.area);
        let by_volume = zero.of(self.totals.volume / 6.0);
        let vertices = layout.vertex_tile(self.index);
        let opposite = if MOMENTS { layout.opposite().as_ptr().cast::<u32>() } else { null() };
        for first in vertices.clone().step_by(Lane::<S>::COUNT) {
            let (block, lane) = (first / BLOCK, first % BLOCK);
            let steps = layout.steps[block] as usize..layout.steps[block + 1] as usize - 1;
            // SAFETY: here and below, all offsets of the layout are within the arrays that they are for.
            let centre = unsafe { self.centre(simd, first) };
            let neighbours = layout.neighbours.as_ptr().cast::<u32>().wrapping_add(lane);
            let places = layout.places.as_ptr().cast::<u32>().wrapping_add(lane);
            let [own_curvature, own_area] = centre.partials;
            let constant_area = own_area + by_total_area;
            let mut force = [zero; 3];
            // The tension along the present arm from the triangle before it, and the cotangent there.
            let (mut tension, mut cotangent) = (zero, zero);
            let mut arm = unsafe { self.arm(simd, neighbours.add(BLOCK * steps.start), &centre) };
            let mut own_moment = if MOMENTS {
                unsafe { self.moment(&centre, &arm, steps.start * BLOCK + lane) }
            } else {
                zero
            };
            for step in steps {
                let next = unsafe { self.arm(simd, neighbours.add(BLOCK * (step + 1)), &centre) };
                let [nx, ny, nz, twice_area] = unsafe {
                    let offsets = places.add(BLOCK * step);
                    Lane::gather4_within(simd, arrays.normals.at(0), offsets)
                };
                let exists = twice_area.above(zero);
                let inverse = (zero.of(1.0) / twice_area).or_else(exists, zero);
                // Cotangents times |N| at this vertex, at the arm's end and at the next arm's.
                let at_centre = dot(arm.e, next.e);
                let at_end = arm.length_squared - at_centre;
                let at_next = next.length_squared - at_centre;

                // ½ ∂E/∂(area of the triangle)
                let mut by_area = arm.by_area + next.by_area + constant_area;
                let (mut along, mut along_next) = (tension, zero);
                if TENSIONS {
                    let [before, after] = unsafe {
                        let offsets = places.add(BLOCK * step);
                        Lane::gather2::<1>(simd, arrays.tensions.at(0), offsets)
                    };
                    along = along + after;
                    along_next = before;
                }
                let mut pressure = by_volume * twice_area;
                if VECTORS & (VORONOI | COTANGENTS) != 0 {
                    // Of the side opposite the vertex, from this arm's end to the next.
                    let mut facing = zero;
                    if VECTORS & VORONOI != 0 {
                        let own = centre.vector[3];
                        let ends = (arm.voronoi - own) + (next.voronoi - own);
                        facing = ends * (at_end + at_next);
                    }
                    if VECTORS & COTANGENTS != 0 {
                        let (apart, side) = (minus(next.g, arm.g), minus(arm.e, next.e));
                        for k in 0..3 {
                            facing = apart[k].mul_add(side[k], facing);
                        }
                    }
                    // The cotangents' own derivatives, with respect to the sides and to the area.
                    let (here, there) = (arm.by_cotangent, next.by_cotangent);
                    let weighted = here.mul_add(at_next, there.mul_add(at_end, facing * at_centre));
                    by_area = (inverse * inverse).neg_mul_add(weighted, by_area);
                    let mut sides = [facing + there - here, here + facing - there];
                    if VECTORS & VORONOI != 0 {
                        // The explicit squared sides of Voronoi's area.
                        sides[0] = (arm.voronoi + arm.voronoi).mul_add(at_next, sides[0]);
                        sides[1] = (next.voronoi + next.voronoi).mul_add(at_end, sides[1]);
                    }
                    along = inverse.mul_add(sides[0], along);
                    along_next = inverse.mul_add(sides[1], along_next);
                    if VECTORS & COTANGENTS != 0 {
                        // The explicit r_i − r_j of the vectors.
                        cotangent = at_next.mul_add(inverse, cotangent);
                        force = minus_scaled(force, cotangent, arm.g);
                        cotangent = at_end * inverse;
                    }
                }
                if VECTORS & UMBRELLAS != 0 {
                    let share = zero.of(-0.5 * COT_60).or_else(exists, zero);
                    let umbrella = plus(
                        minus(centre.umbrella, arm.umbrella),
                        minus(centre.umbrella, next.umbrella),
                    );
                    force = plus_scaled(force, share, umbrella);
                }
                if VECTORS & NORMALS != 0 {
                    let n = [nx, ny, nz];
                    // From the side itself, for it may be much shorter than the arms.
                    let side = minus(next.e, arm.e);
                    let side_squared = dot(side, side);
                    let (own_angle, end_angle) = unsafe {
                        let offsets = places.add(BLOCK * step);
                        (
                            Lane::gather1(simd, arrays.angles.at(0), offsets),
                            Lane::gather1(simd, arrays.next_angles.at(0), offsets),
                        )
                    };
                    let next_angle = zero.of(std::f64::consts::PI) - own_angle - end_angle;
                    // The angle at a corner is that of (d, |N|), and d² + |N|² is the product of the squared
                    // sides at it.
                    let own = dot(centre.normal, n) / (arm.length_squared * next.length_squared);
                    // Past the end of a ring that side has no length.
                    let inverse_side = (zero.of(1.0) / side_squared).or_else(exists, zero);
                    let end = dot(arm.normal, n) * inverse_side / arm.length_squared;
                    let far = dot(next.normal, n) * inverse_side / next.length_squared;
                    along = twice_area.mul_add(far - own - end, along);
                    along_next = twice_area.mul_add(end - own - far, along_next);
                    let turned = own.mul_add(at_centre, end.mul_add(at_end, far * at_next));
                    by_area = by_area + turned;
                    // A unit normal turns only: its gradient at a corner, times a constant vector, is along it.
                    let weighted = plus_scaled(
                        plus_scaled(scaled(centre.normal, own_angle), end_angle, arm.normal),
                        next_angle,
                        next.normal,
                    );
                    let torque = dot(n, cross(minus(arm.e, next.e), weighted));
                    pressure = inverse.mul_add(torque, pressure);
                }
                let stress = by_area * inverse;
                along = stress.mul_add(at_next, along);
                along_next = stress.mul_add(at_end, along_next);

                // Past the end of a ring the moments repeat the first.
                let next_moment = if MOMENTS {
                    unsafe { self.moment(&centre, &next, (step + 1) * BLOCK + lane) }
                } else {
                    zero
                };
                if MOMENTS {
                    let facing = arm.by_curvature
                        + next.by_curvature
                        + unsafe {
                            let offsets = opposite.add(BLOCK * step + lane);
                            Lane::gather1(simd, arrays.moments.at(0), offsets)
                        };
                    let turn = at_end * (own_moment - facing) + at_next * (next_moment - facing);
                    pressure = inverse.mul_add(turn, pressure);
                } else if BENDS {
                    let turn = at_next.mul_add(
                        own_curvature - arm.by_curvature,
                        at_end * (own_curvature - next.by_curvature),
                    );
                    pressure = inverse.mul_add(turn, pressure);
                }
                if BENDS {
                    let bend = unsafe { Lane::load(simd, arrays.bends.at(step * BLOCK + lane)) };
                    along = bend.mul_add(own_curvature + arm.by_curvature, along);
                }
                force = plus_scaled(force, along, arm.e);
                force = minus_scaled(force, pressure, [nx, ny, nz]);
                tension = along_next;
                arm = next;
                own_moment = next_moment;
            }
            force = plus_scaled(force, tension, arm.e);
            if VECTORS & COTANGENTS != 0 {
                force = minus_scaled(force, cotangent, arm.g);
            }
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
