//! Flips: the two triangles at an edge, and the edge that may take its place.

use super::cell::{Image, minus, plus};
use super::topology::NONE;
use super::triangulation::{Triangulation, mixed, next, previous};

/// Which way the edge of a quadrilateral turns in a flip. Each undoes the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// Counter-clockwise seen from outside.
    Left,
    /// Clockwise.
    Right,
}

impl Turn {
    /// The turn that undoes it.
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// The two triangles at an edge:
///
/// ```text
///            k
///          /   \
///        /   A   \          A, of half-edge h, runs from i to j;
///      i ────────▶ j        B, of its twin, from j to i
///        \   B   /
///          \   /
///            l
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quad {
    /// The half-edge h and its twin.
    pub halves: [u32; 2],
    /// i, j, k, l.
    pub vertices: [u32; 4],
}

impl Quad {
    /// A and B.
    #[inline]
    pub fn triangles(&self) -> [usize; 2] {
        self.halves.map(|half| half as usize / 3)
    }
}

impl Triangulation {
    /// The two triangles at the edge of a half-edge, which must not be at a border.
    #[inline(always)]
    pub fn quad(&self, half: u32) -> Quad {
        let twin = self.twin(half);
        let vertices = [
            self.origin(half),
            self.origin(twin),
            self.origin(previous(half)),
            self.origin(previous(twin)),
        ];
        Quad { halves: [half, twin], vertices }
    }

    /// Replace the edge ij of a quadrilateral by kl. The caller has made sure that k and l are not joined, and that
    /// i and j have four neighbours or more, or three on a border.
    ///
    /// Turned left, A keeps i and k and takes l for j; B keeps j and l and takes k for i. Turned right, A keeps j
    /// and k and takes l for i; B keeps i and l and takes k for j. The other corners stay at their places in the
    /// triangle, and kl is the side after or before the one that ij was, the half-edge that [`Self::flipped`]
    /// names. So triangles keep their indices, and a flip there with the other turn restores every number.
    pub fn flip(&mut self, quad: &Quad, turn: Turn) {
        let [a, b] = quad.halves;
        let [i, j, k, l] = quad.vertices;
        // The sides that A and B give to each other, and the corners at which they take another vertex.
        let (lost, taking) = match turn {
            Turn::Left => ([next(a), next(b)], [next(a), next(b)]),
            Turn::Right => ([previous(a), previous(b)], [a, b]),
        };
        let outside = lost.map(|half| self.twin(half));
        if !self.images.is_empty() {
            self.flip_images(quad, taking);
        }
        let on_border = quad.vertices.map(|vertex| self.is_border(vertex));
        let changing = quad.triangles();
        for triangle in changing {
            let term = mixed(triangle, &self.triangles[triangle]);
            self.fingerprint = self.fingerprint.wrapping_sub(term);
        }
        let corners = self.triangles.as_flattened_mut();
        let left_behind = taking.map(|half| corners[half as usize]);
        corners[taking[0] as usize] = l;
        corners[taking[1] as usize] = k;
        for triangle in changing {
            let term = mixed(triangle, &self.triangles[triangle]);
            self.fingerprint = self.fingerprint.wrapping_add(term);
        }
        // Where ij was is now the side that the other triangle has given, and kl is where that side has been.
        let twins = self.twins.as_flattened_mut();
        for (one, other) in [(lost[0], lost[1]), (b, outside[0]), (a, outside[1])] {
            twins[one as usize] = other;
            if other != NONE {
                twins[other as usize] = one;
            }
        }
        // Half-edges along borders have gone over to the other triangle.
        for (half, outside) in [(b, outside[0]), (a, outside[1])] {
            if outside == NONE {
                let vertex = self.origin(half);
                self.leaving[vertex as usize] = half;
            }
        }
        // The half-edges of two corners leave other vertices now.
        for (vertex, gone, another) in [
            (left_behind[0], taking[0], if turn == Turn::Left { b } else { next(b) }),
            (left_behind[1], taking[1], if turn == Turn::Left { a } else { next(a) }),
        ] {
            let on_border = on_border[usize::from(vertex == j)];
            if self.leaving[vertex as usize] == gone && !on_border {
                self.leaving[vertex as usize] = self.lowest(another);
            }
        }
        for (vertex, come, on_border) in
            [(l, taking[0], on_border[3]), (k, taking[1], on_border[2])]
        {
            if !on_border {
                let leaving = &mut self.leaving[vertex as usize];
                *leaving = come.min(*leaving);
            }
        }
        self.degrees[i as usize] -= 1;
        self.degrees[j as usize] -= 1;
        self.degrees[k as usize] += 1;
        self.degrees[l as usize] += 1;
    }

    /// The images of i, j, k and l beside each other, if corners have images.
    #[inline]
    pub fn images_of(&self, quad: &Quad) -> Option<[Image; 4]> {
        if self.images.is_empty() {
            return None;
        }
        let [a, b] = quad.halves;
        let image = |half: u32| self.images.as_flattened()[half as usize];
        // B is moved so that it has its corner i where A has it.
        let step = minus(image(a), image(next(b)));
        let l = plus(image(previous(b)), step);
        Some([image(a), image(next(a)), image(previous(a)), l])
    }

    /// The images of the corners that A and B will have.
    // Apart, so that attempts without it stay short.
    #[inline(never)]
    fn flip_images(&mut self, quad: &Quad, taking: [u32; 2]) {
        let Some([i, _, k, l]) = self.images_of(quad) else { return };
        let [a, b] = quad.halves;
        let images = self.images.as_flattened_mut();
        let step = minus(i, images[next(b) as usize]);
        images[taking[0] as usize] = l;
        images[taking[1] as usize] = minus(k, step);
        for triangle in [a, b].map(|half| half as usize / 3) {
            let first = self.images[triangle][0];
            self.images[triangle] = self.images[triangle].map(|image| minus(image, first));
        }
    }

    /// The half-edge of the new edge in triangle A after a flip of a half-edge.
    pub fn flipped(half: u32, turn: Turn) -> u32 {
        match turn {
            Turn::Left => next(half),
            Turn::Right => previous(half),
        }
    }

    /// The lowest of the half-edges that leave the same vertex as this one, which is not on a border.
    fn lowest(&self, half: u32) -> u32 {
        let (mut lowest, mut other) = (half, self.after(half));
        while other != half {
            lowest = lowest.min(other);
            other = self.after(other);
        }
        lowest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{noise, rebuilt, with_holes};

    fn may_flip(mesh: &Triangulation, half: u32) -> Option<Quad> {
        if mesh.twin(half) == NONE {
            return None;
        }
        let quad = mesh.quad(half);
        let [i, j, k, l] = quad.vertices;
        let spare = |vertex: u32| {
            let least = if mesh.is_border(vertex) { 2 } else { 3 };
            mesh.degrees()[vertex as usize] > least
        };
        (spare(i) && spare(j) && !mesh.are_joined(k, l)).then_some(quad)
    }

    #[test]
    fn many_flips_leave_a_valid_surface() {
        for (mut mesh, least) in with_holes().into_iter().zip([1000, 1000, 500, 0]) {
            let (mut random, loops) = (noise(3), mesh.border_loops());
            let (mut flips, mut ring, mut neighbours) = (0, Vec::new(), Vec::new());
            let half_edges = 3.0 * mesh.triangles().len() as f64;
            for _ in 0..5000 {
                let half = ((random() + 1.0) * 0.5 * half_edges) as u32;
                let turn = if random() > 0.0 { Turn::Left } else { Turn::Right };
                let Some(quad) = may_flip(&mesh, half) else { continue };
                mesh.flip(&quad, turn);
                flips += 1;
                let [_, _, k, l] = quad.vertices;
                assert!(mesh.are_joined(k, l));
                assert_eq!(mesh, rebuilt(&mesh));
                assert_eq!(mesh.border_loops(), loops);
                for vertex in 0..mesh.num_vertices() as u32 {
                    mesh.ring(vertex, &mut ring);
                    mesh.neighbours(vertex, &mut neighbours);
                    assert!(ring.iter().all(|&half| mesh.origin(half) == vertex));
                    let along_border = mesh.twin(ring[0]) == NONE;
                    assert_eq!(along_border, mesh.is_border(vertex));
                    assert!(along_border || ring.iter().all(|half| *half >= ring[0]));
                    assert_eq!(neighbours.len(), mesh.degrees()[vertex as usize] as usize);
                    for (n, &half) in ring.iter().enumerate() {
                        let around = [next(half), previous(half)].map(|half| mesh.origin(half));
                        assert_eq!(around[0], neighbours[n]);
                        assert_eq!(around[1], neighbours[(n + 1) % neighbours.len()]);
                    }
                    for other in 0..mesh.num_vertices() as u32 {
                        assert_eq!(mesh.are_joined(vertex, other), neighbours.contains(&other));
                    }
                }
            }
            assert!(flips > least, "{flips}");
        }
    }

    #[test]
    fn a_flip_and_its_reverse_restore_every_number() {
        for mut mesh in with_holes() {
            let mut random = noise(4);
            let half_edges = 3.0 * mesh.triangles().len() as f64;
            for _ in 0..2000 {
                let half = ((random() + 1.0) * 0.5 * half_edges) as u32;
                let Some(quad) = may_flip(&mesh, half) else { continue };
                for (turn, back) in [(Turn::Left, Turn::Right), (Turn::Right, Turn::Left)] {
                    let mut moved = mesh.clone();
                    moved.flip(&quad, turn);
                    assert_ne!(moved.fingerprint(), mesh.fingerprint());
                    let reverse = moved.quad(Triangulation::flipped(half, turn));
                    let mut ends = [reverse.vertices[0], reverse.vertices[1]];
                    ends.sort_unstable();
                    let mut tips = [quad.vertices[2], quad.vertices[3]];
                    tips.sort_unstable();
                    assert_eq!(ends, tips);
                    moved.flip(&reverse, back);
                    assert_eq!(moved, mesh);
                    // From the other side the move is the same.
                    let (mut one, mut other) = (mesh.clone(), mesh.clone());
                    one.flip(&quad, turn);
                    other.flip(&mesh.quad(quad.halves[1]), turn);
                    assert_eq!(one, other);
                }
                mesh.flip(&quad, if random() > 0.0 { Turn::Left } else { Turn::Right });
            }
        }
    }
}
