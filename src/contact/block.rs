//! Pairs whose nearest points are found together, in lanes.

use crate::lanes::{Arithmetic, Kernel, run};
use crate::mesh::closest::{BLOCK, nearest, nearest_of_edges};
use crate::mesh::geometry::Vec3;

/// Some pairs of edges, or of vertices and triangles.
pub struct Block<T, const EDGES: bool> {
    /// What the pairs are.
    pub pairs: [T; BLOCK],
    arms: [[f64; BLOCK]; 9],
    nearest: [[f64; BLOCK]; 3],
    count: usize,
}

impl<T: Copy, const EDGES: bool> Block<T, EDGES> {
    /// None yet.
    pub fn new(nothing: T) -> Self {
        let (arms, nearest) = ([[0.0; BLOCK]; 9], [[0.0; BLOCK]; 3]);
        Self { pairs: [nothing; BLOCK], arms, nearest, count: 0 }
    }

    /// Add a pair; when there is no more room, or at the end, [`Self::find`] looks at all.
    #[inline]
    pub fn push(&mut self, pair: T, arms: &[Vec3; 3]) {
        self.pairs[self.count] = pair;
        for (k, x) in arms.iter().flatten().enumerate() {
            self.arms[k][self.count] = *x;
        }
        self.count += 1;
    }

    /// Whether there is no more room.
    #[inline]
    pub fn is_full(&self) -> bool {
        self.count == BLOCK
    }

    /// Visit the pairs that are nearer than some distance, with its square, s and t and the arms, and forget all.
    #[inline]
    pub fn find(&mut self, most: f64, mut visit: impl FnMut(T, [f64; 3], [Vec3; 3])) {
        run(Together(self));
        let arm = |k: usize, n: usize| {
            Vec3::new(self.arms[k][n], self.arms[k + 1][n], self.arms[k + 2][n])
        };
        for n in 0..self.count {
            let found = self.nearest.map(|values| values[n]);
            // A NaN counts as near, and will be refused.
            if found[0] >= most {
                continue;
            }
            visit(self.pairs[n], found, [arm(0, n), arm(3, n), arm(6, n)]);
        }
        self.count = 0;
    }
}

struct Together<'a, T, const EDGES: bool>(&'a mut Block<T, EDGES>);

impl<T, const EDGES: bool> Kernel for Together<'_, T, EDGES> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let Block { arms: [rx, ry, rz, ux, uy, uz, vx, vy, vz], nearest: out, .. } = self.0;
        for n in 0..BLOCK {
            let (r, u, v) = ([rx[n], ry[n], rz[n]], [ux[n], uy[n], uz[n]], [vx[n], vy[n], vz[n]]);
            let (squared, s, t) = if EDGES {
                let found = nearest_of_edges(r, u, v);
                (found.squared, found.s, found.t)
            } else {
                let found = nearest(r, u, v);
                (found.squared, found.s, found.t)
            };
            out[0][n] = squared;
            out[1][n] = s;
            out[2][n] = t;
        }
    }
}
