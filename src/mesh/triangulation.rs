//! Connectivity as state: a triangulated surface whose edges can be flipped in place.
//!
//! Half-edge h = 3 t + k is the passage of triangle t along its side k, from its corner k to its corner k + 1. Its
//! **twin** is the passage of the neighbour along the same edge, the other way, or [`NONE`] at a border. Rings, edges and degrees are
//! walked or counted from triangles and twins; nothing else is stored, so a flip rewrites two triangles and
//! six twins and costs the same however large the mesh is.

use super::cell::{Image, minus, plus};
use super::topology::{NONE, Topology};
use crate::error::{Error, Result};

/// An oriented 2-manifold triangulation, closed or with borders, whose connectivity may change.
///
/// Vertices are numbered locally as in [`Topology`], from which one is made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Triangulation {
    /// The user's index of each local vertex, ascending.
    particles: Vec<u32>,
    /// The corners of each triangle, counter-clockwise seen from outside.
    triangles: Vec<[u32; 3]>,
    /// The twins of the half-edges of each triangle.
    twins: Vec<[u32; 3]>,
    /// How many edges end at each vertex.
    degrees: Vec<u32>,
    /// Of the half-edges that begin at each vertex the one of the lowest number, or the one along the border.
    leaving: Vec<u32>,
    /// The images of the corners of each triangle, where the surface spans a periodic box; otherwise empty.
    images: Vec<[Image; 3]>,
    /// How many edges are borders; there are as many vertices on borders.
    num_border_edges: usize,
    /// The sum of numbers that look random, one for each triangle with its corners; so it tells any two sets of
    /// triangles apart, and a flip changes two of its terms.
    fingerprint: u64,
}

/// A number that looks random, of a triangle's index and corners (the mixing of SplitMix64,
/// doi:10.1145/2660193.2660195).
#[inline]
fn mixed(triangle: usize, corners: &[u32; 3]) -> u64 {
    let mut mixed = triangle as u64;
    for &corner in corners {
        mixed = (mixed ^ u64::from(corner)).wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
    }
    mixed
}

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

/// The half-edge after one in its triangle.
#[inline(always)]
pub fn next(half: u32) -> u32 {
    if half % 3 == 2 { half - 2 } else { half + 1 }
}

/// The half-edge before one in its triangle.
#[inline(always)]
pub fn previous(half: u32) -> u32 {
    if half.is_multiple_of(3) { half + 2 } else { half - 1 }
}

impl Triangulation {
    /// The connectivity that a validated mesh starts with.
    pub fn new(topology: &Topology) -> Self {
        let mut twins = vec![[NONE; 3]; topology.triangles.len()];
        for (index, edge) in topology.edges.iter().enumerate() {
            if edge.triangles[1] == NONE {
                continue;
            }
            let [a, b] = edge.triangles.map(|triangle| {
                let sides = &topology.triangle_edges[triangle as usize];
                let side = sides.iter().position(|side| *side as usize == index);
                3 * triangle + side.expect("an edge is a side of its triangles") as u32
            });
            twins.as_flattened_mut()[a as usize] = b;
            twins.as_flattened_mut()[b as usize] = a;
        }
        let along_border = |half: &&u32| twins.as_flattened()[**half as usize] == NONE;
        let leaving = (0..topology.num_vertices()).map(|vertex| {
            let halves = &topology.corners[topology.ring(vertex)];
            *halves.iter().find(along_border).unwrap_or(&halves[0])
        });
        let degree = |vertex: usize| topology.edges_at(vertex).len() as u32;
        let terms = topology.triangles.iter().enumerate().map(|(t, corners)| mixed(t, corners));
        Self {
            fingerprint: terms.fold(0, u64::wrapping_add),
            images: Vec::new(),
            particles: topology.particles.clone(),
            triangles: topology.triangles.clone(),
            degrees: (0..topology.num_vertices()).map(degree).collect(),
            leaving: leaving.collect(),
            num_border_edges: twins.as_flattened().iter().filter(|twin| **twin == NONE).count(),
            twins,
        }
    }

    /// The same surface with other connectivity: triangles of particles, as [`Topology::new`] takes them.
    ///
    /// # Errors
    /// Those of [`Topology::new`]; another number of triangles, or other particles; another topology, which no flips
    /// lead to.
    pub fn with_triangles(&self, triangles: &[[i64; 3]]) -> Result<Self> {
        if triangles.len() != self.triangles.len() {
            return Err(Error::Contract(format!(
                "has {} triangles, got {}; connectivity changes, but not how many triangles there are",
                self.triangles.len(),
                triangles.len()
            )));
        }
        let last = self.particles.last().map_or(0, |last| *last as usize + 1);
        let topology = Topology::new(triangles, last)?;
        if topology.particles != self.particles {
            let missing = self.particles.iter().find(|p| !topology.particles.contains(p));
            return Err(Error::Contract(match missing {
                Some(particle) => format!(
                    "the new triangles leave out particle {particle}; they must have the same particles as before"
                ),
                None => "the new triangles have other particles than before".to_owned(),
            }));
        }
        let other = Self::new(&topology);
        self.compare_parts(&other)?;
        Ok(other)
    }

    /// The user's index of each vertex, ascending.
    pub fn particles(&self) -> &[u32] {
        &self.particles
    }

    /// The corners of all triangles, in local numbers.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The twins of the half-edges of all triangles.
    pub fn twins(&self) -> &[[u32; 3]] {
        &self.twins
    }

    /// How many box vectors to add to the positions of the corners of each triangle so that they are neighbours, none to
    /// the first; empty if the surface is in one piece as it is, which it can be unless it spans a periodic box.
    pub fn images(&self) -> &[[Image; 3]] {
        &self.images
    }

    /// Give the corners of all triangles their images, or none. Returns whether that makes a difference.
    pub fn set_images(&mut self, images: Vec<[Image; 3]>) -> bool {
        debug_assert!(images.is_empty() || images.len() == self.triangles.len());
        let changes = self.images != images;
        self.images = images;
        changes
    }

    /// How many edges end at each vertex.
    pub fn degrees(&self) -> &[u32] {
        &self.degrees
    }

    /// A number that tells these triangles from any others of the same vertices.
    pub fn fingerprint(&self) -> u64 {
        self.fingerprint
    }

    /// The user's indices of the corners of a triangle.
    pub fn particles_of(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle].map(|vertex| self.particles[vertex as usize])
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.particles.len()
    }

    /// Number of edges; flips keep it.
    pub fn num_edges(&self) -> usize {
        (3 * self.triangles.len() + self.num_border_edges) / 2
    }

    /// Number of edges that are borders; flips keep them.
    pub fn num_border_edges(&self) -> usize {
        self.num_border_edges
    }

    /// Whether there are no borders.
    #[inline(always)]
    pub fn is_closed(&self) -> bool {
        self.num_border_edges == 0
    }

    /// Whether a vertex is on a border.
    #[inline(always)]
    pub fn is_border(&self, vertex: u32) -> bool {
        !self.is_closed() && self.twin(self.leaving(vertex)) == NONE
    }

    /// How many triangles there are at a vertex: as many as edges, or one fewer on a border.
    #[inline(always)]
    pub fn num_corners(&self, vertex: u32) -> u32 {
        self.degrees[vertex as usize] - u32::from(self.is_border(vertex))
    }

    /// The vertices of each border, with the surface on the left, from the lowest one.
    pub fn border_loops(&self) -> Vec<Vec<u32>> {
        let mut loops: Vec<Vec<u32>> = Vec::new();
        let mut met = vec![false; self.num_vertices()];
        for first in 0..self.num_vertices() as u32 {
            let mut vertex = first;
            let mut border = Vec::new();
            while self.is_border(vertex) && !met[vertex as usize] {
                met[vertex as usize] = true;
                border.push(vertex);
                vertex = self.origin(next(self.leaving(vertex)));
            }
            if !border.is_empty() {
                loops.push(border);
            }
        }
        loops
    }

    /// The vertex that a half-edge begins at.
    #[inline(always)]
    pub fn origin(&self, half: u32) -> u32 {
        self.triangles.as_flattened()[half as usize]
    }

    /// The same edge in the neighbour, [`NONE`] at a border.
    #[inline(always)]
    pub fn twin(&self, half: u32) -> u32 {
        self.twins.as_flattened()[half as usize]
    }

    /// The half-edges that leave a vertex, one for each triangle, counter-clockwise from the one along the border, or
    /// from the one of the lowest number, so that the order depends on the triangles only and not on how they came
    /// about. They replace what is in `ring`.
    #[inline]
    pub fn ring(&self, vertex: u32, ring: &mut Vec<u32>) {
        let mut half = self.leaving[vertex as usize];
        ring.resize(self.num_corners(vertex) as usize, 0);
        for slot in ring {
            *slot = half;
            half = self.after(half);
        }
    }

    /// The vertices that a vertex is joined to, in the order of its ring. They replace what is in `neighbours`.
    #[inline]
    pub fn neighbours(&self, vertex: u32, neighbours: &mut Vec<u32>) {
        self.ring(vertex, neighbours);
        let last = neighbours[neighbours.len() - 1];
        for slot in neighbours.iter_mut() {
            *slot = self.origin(next(*slot));
        }
        if self.is_border(vertex) {
            neighbours.push(self.origin(previous(last)));
        }
    }

    /// Where rings begin: of the half-edges that leave a vertex the one along the border, or the one of the lowest
    /// number.
    #[inline(always)]
    pub fn leaving(&self, vertex: u32) -> u32 {
        self.leaving[vertex as usize]
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

    /// The next half-edge counter-clockwise that leaves the same vertex; [`NONE`] at the end of a border vertex' ring.
    #[inline(always)]
    pub fn after(&self, half: u32) -> u32 {
        self.twin(previous(half))
    }

    /// Each edge once, by the lower of its half-edges, in ascending order.
    pub fn edges(&self) -> impl Iterator<Item = u32> {
        let twins = self.twins.as_flattened().iter().enumerate();
        twins.filter(|(half, twin)| *half < **twin as usize).map(|(half, _)| half as u32)
    }

    /// Whether two vertices are the ends of an edge.
    #[inline]
    pub fn are_joined(&self, a: u32, b: u32) -> bool {
        let (here, there) =
            if self.degrees[a as usize] <= self.degrees[b as usize] { (a, b) } else { (b, a) };
        let start = self.leaving[here as usize];
        let mut half = start;
        loop {
            if self.origin(next(half)) == there {
                return true;
            }
            let after = self.after(half);
            if after == NONE {
                return self.origin(previous(half)) == there;
            }
            half = after;
            if half == start {
                return false;
            }
        }
    }

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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{icosahedron, noise};

    fn start() -> Triangulation {
        Triangulation::new(&Topology::new(&icosahedron().1, 12).unwrap())
    }

    /// What a validation from nothing says of the same triangles.
    fn rebuilt(mesh: &Triangulation) -> Triangulation {
        let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
        Triangulation::new(&Topology::new(&triangles, mesh.num_vertices()).unwrap())
    }

    /// The same with a hole; with two, one of them of several triangles; and as few triangles as have an edge to flip.
    fn starts() -> Vec<Triangulation> {
        let whole = icosahedron().1;
        let mut one = whole.clone();
        one.remove(7);
        let two = whole.iter().copied().filter(|t| !t.contains(&0) && *t != [3, 2, 6]).collect();
        let few = whole[..5].to_vec();
        [whole, one, two, few]
            .into_iter()
            .map(|triangles| rebuilt(&Triangulation::new(&Topology::new(&triangles, 12).unwrap())))
            .collect()
    }

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
    fn twins_are_the_same_edge_the_other_way() {
        for mesh in starts() {
            for half in 0..3 * mesh.triangles().len() as u32 {
                let twin = mesh.twin(half);
                if twin != NONE {
                    assert_eq!(mesh.twin(twin), half);
                    assert_eq!(mesh.origin(twin), mesh.origin(next(half)));
                }
            }
            assert_eq!(mesh.edges().count(), mesh.num_edges());
        }
    }

    #[test]
    fn borders_are_loops_with_the_surface_on_the_left() {
        let lengths = starts().into_iter().map(|mesh| {
            let loops = mesh.border_loops();
            for border in &loops {
                for (n, &vertex) in border.iter().enumerate() {
                    let half = mesh.leaving(vertex);
                    assert_eq!((mesh.origin(half), mesh.twin(half)), (vertex, NONE));
                    assert_eq!(mesh.origin(next(half)), border[(n + 1) % border.len()]);
                }
            }
            loops.iter().map(Vec::len).collect::<Vec<_>>()
        });
        assert_eq!(lengths.collect::<Vec<_>>(), [vec![], vec![3], vec![5, 3], vec![5]]);
    }

    #[test]
    fn many_flips_leave_a_valid_surface() {
        for (mut mesh, least) in starts().into_iter().zip([1000, 1000, 500, 0]) {
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
        for mut mesh in starts() {
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

    #[test]
    fn other_triangles_must_be_of_the_same_surface() {
        let mesh = start();
        let good = icosahedron().1;
        assert_eq!(mesh.with_triangles(&good).unwrap().triangles(), mesh.triangles());
        assert!(mesh.with_triangles(&good[1..]).is_err());
        let mut moved = mesh.clone();
        let quad = moved.quad(0);
        moved.flip(&quad, Turn::Left);
        let triangles: Vec<_> = moved.triangles().iter().map(|t| t.map(i64::from)).collect();
        assert_eq!(mesh.with_triangles(&triangles).unwrap().twins(), moved.twins());
    }
}
