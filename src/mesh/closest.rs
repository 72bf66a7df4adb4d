//! The point of a triangle that is nearest to another point.

use crate::mesh::Cell;
use crate::mesh::geometry::Vec3;

/// Pairs that are looked at together, in lanes.
pub const BLOCK: usize = 16;

/// The way from a triangle's first corner a to a point, to b and to c, nm.
#[derive(Debug, Clone, Copy)]
pub struct Arms {
    /// To the point.
    pub point: Vec3,
    /// b − a and c − a.
    pub sides: [Vec3; 2],
}

/// Where a triangle is nearest to a point: at a + s (b − a) + t (c − a).
#[derive(Debug, Clone, Copy, Default)]
pub struct Nearest {
    /// The square of the distance, nm².
    pub squared: f64,
    /// s.
    pub s: f64,
    /// t.
    pub t: f64,
}

/// `to` − `from`, of the nearest image in a periodic box.
#[inline(always)]
pub fn difference(cell: Option<&Cell>, to: &Vec3, from: &Vec3) -> Vec3 {
    let plain = to - from;
    match cell {
        None => plain,
        Some(cell) => plain + cell.shift(cell.nearest(&plain)),
    }
}

/// The corners of a triangle, of its image whose first corner is where it is.
#[inline]
pub fn in_one_piece(cell: Option<&Cell>, [a, b, c]: [&Vec3; 3]) -> [Vec3; 3] {
    [*a, a + difference(cell, b, a), a + difference(cell, c, a)]
}

impl Arms {
    /// Of a point and the corners of a triangle.
    #[inline(always)]
    pub fn new(cell: Option<&Cell>, point: &Vec3, [a, b, c]: [&Vec3; 3]) -> Self {
        let Some(cell) = cell else { return Self { point: point - a, sides: [b - a, c - a] } };
        let [u, v] = [b, c].map(|end| difference(Some(cell), end, a));
        // The corner of a large triangle may be far; its middle tells which image is near.
        let away = point - a;
        let image = cell.nearest(&(away - (u + v) / 3.0));
        Self { point: away + cell.shift(image), sides: [u, v] }
    }

    /// From the nearest point of the triangle to the point.
    #[inline]
    pub fn separation(&self, nearest: &Nearest) -> Vec3 {
        self.point - self.sides[0] * nearest.s - self.sides[1] * nearest.t
    }

    /// The nearest point.
    #[inline]
    pub fn nearest(&self) -> Nearest {
        let [r, u, v] =
            [&self.point, &self.sides[0], &self.sides[1]].map(|arm| [arm.x, arm.y, arm.z]);
        nearest(r, u, v)
    }
}

/// Between 0 and 1; 0 for what is no number.
#[inline(always)]
fn within_one(x: f64) -> f64 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < 1.0 { x } else { 1.0 }
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The nearest of the three sides, or the foot of the perpendicular where that is inside: all regions of the plane at
/// once, without a branch, so that lanes can share it.
#[inline(always)]
pub fn nearest(r: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Nearest {
    let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
    let (ru, rv) = (dot(r, u), dot(r, v));
    let at = |s: f64, t: f64| {
        let x = r[0] - s * u[0] - t * v[0];
        let y = r[1] - s * u[1] - t * v[1];
        let z = r[2] - s * u[2] - t * v[2];
        Nearest { squared: x * x + y * y + z * z, s, t }
    };
    let ab = at(within_one(ru / uu), 0.0);
    let ac = at(0.0, within_one(rv / vv));
    let along = within_one((rv - ru - uv + uu) / (uu - 2.0 * uv + vv));
    let bc = at(1.0 - along, along);
    let side = if ac.squared < ab.squared { ac } else { ab };
    let side = if bc.squared < side.squared { bc } else { side };
    let (s, t, all) = (ru * vv - rv * uv, rv * uu - ru * uv, uu * vv - uv * uv);
    let foot = at(s / all, t / all);
    let inside = (s > 0.0) & (t > 0.0) & (s + t < all);
    if inside { foot } else { side }
}

/// Where two edges are nearest: at p + s u and q + t v.
#[derive(Debug, Clone, Copy, Default)]
pub struct Crossing {
    /// The square of the distance, nm².
    pub squared: f64,
    /// s.
    pub s: f64,
    /// t.
    pub t: f64,
}

/// From the beginning of the second edge to that of the first, and along both.
#[inline(always)]
pub fn edge_arms(cell: Option<&Cell>, [p, p_end]: [&Vec3; 2], [q, q_end]: [&Vec3; 2]) -> [Vec3; 3] {
    let [u, v] = [difference(cell, p_end, p), difference(cell, q_end, q)];
    let mut away = p - q;
    if let Some(cell) = cell {
        // Beginnings of long edges may be far apart; the middles tell which image is near.
        away += cell.shift(cell.nearest(&(away + (u - v) * 0.5)));
    }
    [away, u, v]
}

/// The nearest points of two edges.
#[inline]
pub fn crossing(cell: Option<&Cell>, first: [&Vec3; 2], second: [&Vec3; 2]) -> Crossing {
    let [r, u, v] = edge_arms(cell, first, second).map(|arm| [arm.x, arm.y, arm.z]);
    nearest_of_edges(r, u, v)
}

/// The nearest points of p + s u and q + t v with r = p − q: where the lines are nearest if that is on both edges, or else
/// the nearest of the four ends and the other edge.
#[inline(always)]
pub fn nearest_of_edges(r: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Crossing {
    let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
    let (ru, rv) = (dot(r, u), dot(r, v));
    let at = |s: f64, t: f64| {
        let x = r[0] + s * u[0] - t * v[0];
        let y = r[1] + s * u[1] - t * v[1];
        let z = r[2] + s * u[2] - t * v[2];
        Crossing { squared: x * x + y * y + z * z, s, t }
    };
    let least =
        |one: Crossing, other: Crossing| if other.squared < one.squared { other } else { one };
    let ends = least(at(0.0, within_one(rv / vv)), at(1.0, within_one((rv + uv) / vv)));
    let others = least(at(within_one(-ru / uu), 0.0), at(within_one((uv - ru) / uu), 1.0));
    let side = least(ends, others);
    let all = uu * vv - uv * uv;
    let (s, t) = ((uv * rv - ru * vv) / all, (uu * rv - uv * ru) / all);
    let inside = (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0);
    let middle = at(s, t);
    if inside & (middle.squared < side.squared) { middle } else { side }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_point_of_the_triangle_is_nearer(
            corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
            point in prop::array::uniform3(-2.0..2.0f64),
            others in prop::collection::vec(prop::array::uniform2(0.0..1.0f64), 60),
        ) {
            let [a, b, c] = corners.map(Vec3::from);
            let arms = Arms::new(None, &Vec3::from(point), [&a, &b, &c]);
            let nearest = arms.nearest();
            prop_assert!(nearest.s >= 0.0 && nearest.t >= 0.0 && nearest.s + nearest.t <= 1.0 + 1e-12);
            let found = arms.separation(&nearest).norm_squared();
            prop_assert!((found - nearest.squared).abs() < 1e-12);
            for [s, t] in others {
                let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
                let other = arms.separation(&Nearest { squared: 0.0, s, t }).norm_squared();
                prop_assert!(found <= other + 1e-12);
            }
        }
    }

    proptest! {
        #[test]
        fn no_points_of_two_edges_are_nearer(
            ends in prop::array::uniform4(prop::array::uniform3(-1.0..1.0f64)),
            others in prop::collection::vec(prop::array::uniform2(0.0..1.0f64), 60),
        ) {
            let [p, p_end, q, q_end] = ends.map(Vec3::from);
            let found = crossing(None, [&p, &p_end], [&q, &q_end]);
            let at = |s: f64, t: f64| (p + (p_end - p) * s - q - (q_end - q) * t).norm_squared();
            prop_assert!((at(found.s, found.t) - found.squared).abs() < 1e-12);
            for [s, t] in others {
                prop_assert!(found.squared <= at(s, t) + 1e-12);
            }
        }
    }

    #[test]
    fn images_are_the_nearest() {
        let cell = Cell::new([[5.0, 0.0, 0.0], [1.5, 6.0, 0.0], [-2.0, 2.5, 7.0]]).unwrap();
        let corners = [[0.1, 0.2, 0.3], [0.9, 0.1, 0.2], [0.3, 1.0, 0.1]].map(Vec3::from);
        let point = Vec3::new(0.5, 0.4, 1.0);
        let there = Arms::new(None, &point, corners.each_ref()).nearest();
        let moved =
            [corners[0], corners[1] + cell.shift([1, 0, -1]), corners[2] + cell.shift([0, 2, 0])];
        let far = point + cell.shift([-1, 1, 3]);
        let found = Arms::new(Some(&cell), &far, moved.each_ref()).nearest();
        assert!((found.squared - there.squared).abs() < 1e-12);
    }
}
