//! Least distances of pairs in single precision, in lanes: quick, and never too large.
//!
//! Where edges are nearly parallel, or triangles nearly lines, at an angle θ, the points at s and t are off by
//! δ = e |r| / sin² θ, with e about 5e-7. The formulas here make a distance too large by δ sin θ at most, and also by L sin θ
//! at most, which is by how much the ends or sides, of length L, are farther away; so by √(e |r| L) at most. [`MARGIN`] is
//! subtracted for that.

use crate::lanes::{Arithmetic, Kernel, run};
use std::cmp::Ordering;

/// Pairs that are looked at together.
const LANES: usize = 32;

/// By how much a distance may be too large, as a share of the longest of r, u and v.
const MARGIN: f32 = 1e-3;

/// Some pairs of edges, or of vertices and triangles.
pub struct Rough<T, const EDGES: bool> {
    pairs: [T; LANES],
    arms: [[f32; LANES]; 9],
    most: [f32; LANES],
    least: [f32; LANES],
    count: usize,
}

impl<T: Copy, const EDGES: bool> Rough<T, EDGES> {
    /// None yet.
    pub fn new(nothing: T) -> Self {
        let (arms, zeros) = ([[0.0; LANES]; 9], [0.0; LANES]);
        Self { pairs: [nothing; LANES], arms, most: zeros, least: zeros, count: 0 }
    }

    /// Add a pair by its arms, as `closest.rs` has them, and the distance up to which it counts; when there is no more room,
    /// visit all as [`Self::find`] does.
    #[inline(always)]
    pub fn push(&mut self, pair: T, arms: [[f32; 3]; 3], most: f32, visit: impl FnMut(T, f32)) {
        self.pairs[self.count] = pair;
        self.most[self.count] = most;
        for (k, x) in arms.as_flattened().iter().enumerate() {
            self.arms[k][self.count] = *x;
        }
        self.count += 1;
        if self.count == LANES {
            self.find(visit);
        }
    }

    /// Visit the pairs that may be nearer than the distance up to which they count, with their least distance, and forget all.
    #[inline]
    pub fn find(&mut self, mut visit: impl FnMut(T, f32)) {
        run(Together(self));
        for ((pair, least), most) in
            self.pairs[..self.count].iter().zip(&self.least).zip(&self.most)
        {
            // A NaN counts as near.
            if least.partial_cmp(most).is_none_or(Ordering::is_lt) {
                visit(*pair, *least);
            }
        }
        self.count = 0;
    }
}

struct Together<'a, T, const EDGES: bool>(&'a mut Rough<T, EDGES>);

impl<T, const EDGES: bool> Kernel for Together<'_, T, EDGES> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let Rough { arms: [rx, ry, rz, ux, uy, uz, vx, vy, vz], least, .. } = self.0;
        for n in 0..LANES {
            let (r, u, v) = ([rx[n], ry[n], rz[n]], [ux[n], uy[n], uz[n]], [vx[n], vy[n], vz[n]]);
            least[n] = if EDGES { of_edges(r, u, v) } else { of_triangle(r, u, v) };
        }
    }
}

#[inline(always)]
fn within_one(x: f32) -> f32 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < 1.0 { x } else { 1.0 }
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// r + s u − t v.
#[inline(always)]
fn squared(r: [f32; 3], s: f32, u: [f32; 3], t: f32, v: [f32; 3]) -> f32 {
    let way: [f32; 3] = [0, 1, 2].map(|k| r[k] + s * u[k] - t * v[k]);
    dot(way, way)
}

/// s and t in turn, each the best one for the value of the other.
#[inline(always)]
fn of_edges(r: [f32; 3], u: [f32; 3], v: [f32; 3]) -> f32 {
    let (rr, uu, uv, vv) = (dot(r, r), dot(u, u), dot(u, v), dot(v, v));
    let (ru, rv) = (dot(r, u), dot(r, v));
    let s = within_one((uv * rv - ru * vv) / (uu * vv - uv * uv));
    let t = within_one((rv + s * uv) / vv);
    let s = within_one((t * uv - ru) / uu);
    squared(r, s, u, t, v).sqrt() - MARGIN * larger(rr, larger(uu, vv)).sqrt()
}

/// The nearest of the sides, or the plane if that is nearer and the foot of the perpendicular is within.
#[inline(always)]
fn of_triangle(r: [f32; 3], u: [f32; 3], v: [f32; 3]) -> f32 {
    let (rr, uu, uv, vv) = (dot(r, r), dot(u, u), dot(u, v), dot(v, v));
    let (ru, rv) = (dot(r, u), dot(r, v));
    let at = |s: f32, t: f32| squared(r, -s, u, t, v);
    let along = within_one((rv - ru - uv + uu) / (uu - 2.0 * uv + vv));
    let (ab, ac) = (at(within_one(ru / uu), 0.0), at(0.0, within_one(rv / vv)));
    let side = smaller(at(1.0 - along, along), smaller(ab, ac));
    let (s, t, all) = (ru * vv - rv * uv, rv * uu - ru * uv, uu * vv - uv * uv);
    let inside = (s > 0.0) & (t > 0.0) & (s + t < all);
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let height = dot(r, normal);
    let plane = height * height / dot(normal, normal);
    let least = if inside { smaller(plane, side) } else { side };
    least.sqrt() - MARGIN * larger(rr, larger(uu, vv)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::closest::{nearest, nearest_of_edges};
    use proptest::prelude::*;

    proptest! {
        /// Also for edges that are nearly parallel and triangles that are nearly lines.
        #[test]
        fn distances_are_never_too_large(
            arms in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
            (slip, tilt, along, length) in (-2.0..2.0f64, -6.0..0.0f64, -2.0..2.0f64, -3.0..3.0f64),
            flat in any::<bool>(),
        ) {
            let [mut r, u, other] = arms;
            let (tilt, length) = (10f64.powf(tilt), 10f64.powf(length));
            let v: [f64; 3] = std::array::from_fn(|k| length * (u[k] + tilt * other[k]));
            if flat {
                r = std::array::from_fn(|k| slip * u[k] + along * v[k] + tilt * r[k]);
            }
            let single = |arm: [f64; 3]| arm.map(|x| x as f32);
            let size = [r, u, v].map(|a| a.iter().map(|x| x * x).sum::<f64>().sqrt());
            let size = size.into_iter().fold(0.0, f64::max);
            let edges = nearest_of_edges(r, u, v).squared.sqrt();
            let found = f64::from(of_edges(single(r), single(u), single(v)));
            prop_assert!(found <= edges, "{found} {edges}");
            prop_assert!(found >= edges - 2.0 * size * f64::from(MARGIN));
            let triangle = nearest(r, u, v).squared.sqrt();
            let found = f64::from(of_triangle(single(r), single(u), single(v)));
            prop_assert!(found <= triangle, "{found} {triangle}");
        }
    }
}
