//! Connectivity as state: a triangulated surface whose edges can be flipped in place.
//!
//! Half-edge h = 3 t + k is the passage of triangle t along its side k, from its corner k to its corner k + 1. Its
//! **twin** is the passage of the neighbour along the same edge, the other way, or [`NONE`] at a border. Rings, edges and degrees are
//! walked or counted from triangles and twins; nothing else is stored, so a flip rewrites two triangles and
//! six twins and costs the same however large the mesh is.

use super::cell::Image;
use super::topology::{NONE, Topology};
use crate::error::{Error, Result};

pub use super::flip::{Quad, Turn};

/// An oriented 2-manifold triangulation, closed or with borders, whose connectivity may change.
///
/// Vertices are numbered locally as in [`Topology`], from which one is made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Triangulation {
    /// The user's index of each local vertex, ascending.
    particles: Vec<u32>,
    /// The corners of each triangle, counter-clockwise seen from outside.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The twins of the half-edges of each triangle.
    pub(super) twins: Vec<[u32; 3]>,
    /// How many edges end at each vertex.
    pub(super) degrees: Vec<u32>,
    /// Of the half-edges that begin at each vertex the one of the lowest number, or the one along the border.
    pub(super) leaving: Vec<u32>,
    /// The images of the corners of each triangle, where the surface spans a periodic box; otherwise empty.
    pub(super) images: Vec<[Image; 3]>,
    /// How many edges are borders; there are as many vertices on borders.
    num_border_edges: usize,
    /// The sum of numbers that look random, one for each triangle with its corners; so it tells any two sets of
    /// triangles apart, and a flip changes two of its terms.
    pub(super) fingerprint: u64,
}

/// A number that looks random, of a triangle's index and corners (the mixing of SplitMix64,
/// doi:10.1145/2660193.2660195).
#[inline]
pub(super) fn mixed(triangle: usize, corners: &[u32; 3]) -> u64 {
    let mut mixed = triangle as u64;
    for &corner in corners {
        mixed = (mixed ^ u64::from(corner)).wrapping_add(0x9e37_79b9_7f4a_7c15);
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^= mixed >> 31;
    }
    mixed
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{icosahedron, with_holes};

    #[test]
    fn twins_are_the_same_edge_the_other_way() {
        for mesh in with_holes() {
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
    fn other_triangles_must_be_of_the_same_surface() {
        let good = icosahedron().1;
        let mesh = Triangulation::new(&Topology::new(&good, 12).unwrap());
        assert_eq!(mesh.with_triangles(&good).unwrap().triangles(), mesh.triangles());
        assert!(mesh.with_triangles(&good[1..]).is_err());
        let mut moved = mesh.clone();
        let quad = moved.quad(0);
        moved.flip(&quad, Turn::Left);
        let triangles: Vec<_> = moved.triangles().iter().map(|t| t.map(i64::from)).collect();
        assert_eq!(mesh.with_triangles(&triangles).unwrap().twins(), moved.twins());
    }
}
