//! The mesh as the fast evaluator wants it: renumbered for locality, in blocks of lanes.
//!
//! Vertices that are neighbours on the surface get numbers that are near each other, so that what a pass
//! needs is in the cache. Within a tile they are sorted by degree, so that the lanes of a block go round rings of the same length, and those
//! on borders come last. Triangles follow
//! the vertices. The user's order is kept outside: `particles`, `vertex_ids` and `triangle_ids` translate.

mod edges;
#[cfg(test)]
mod tests;

use super::ghosts::Ghosts;
use crate::lanes::BLOCK;
use crate::lanes::tiles::TILE;
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::{next, previous};
use crate::mesh::{NONE, Triangulation};
use std::ops::Range;
use std::sync::OnceLock;

/// The renumbered mesh. All offsets count numbers, not records.
///
/// The ring of a vertex i consists of its neighbours j₀, j₁ … counter-clockwise, and of the triangles
/// t_k = (i, j_k, j_k₊₁) between them. The rings of a block of vertices are stored step by step, a step having
/// an entry for each lane, and one closing step more than the longest of the rings. A ring that is
/// shorter goes on with its first neighbour and with a triangle that does not exist: the one after the last
/// of all, without area and normal, which adds nothing. So does the ring of a vertex on a border after its last
/// neighbour, with which no triangle begins; before its first neighbour come the vertex itself and its first triangle,
/// which make a dihedral angle of zero.
pub struct Layout {
    /// Number of vertices and of triangles, without those that fill the last blocks.
    pub num_vertices: usize,
    pub num_triangles: usize,
    /// The particle of each vertex; the last block is filled with repetitions of the first vertex.
    pub particles: Vec<u32>,
    /// Its index among the vertices in ascending order of particle.
    pub vertex_ids: Vec<u32>,
    /// The user's index of each triangle; the last block is filled with repetitions of the first.
    pub triangle_ids: Vec<u32>,
    /// For each block of triangles and each corner, the offsets of the lanes' positions.
    pub corners: Vec<[[u32; BLOCK]; 3]>,
    /// Where the steps of each block of vertices begin; one entry more than blocks.
    pub steps: Vec<u32>,
    /// For each step and lane, the offset of the neighbour's position.
    pub neighbours: Vec<[u32; BLOCK]>,
    /// For each step and lane, the offset of the triangle's record of four numbers, plus the vertex' place (0, 1
    /// or 2) in the triangle.
    pub places: Vec<[u32; BLOCK]>,
    /// The most steps that a block of vertices has.
    pub longest: usize,
    /// For each block of vertices and each lane, the triangle before the first: the last of the ring.
    pub before: Vec<[u32; BLOCK]>,
    /// The neighbour before the first.
    pub neighbours_before: Vec<[u32; BLOCK]>,
    /// How many vertices of a tile are on no border.
    pub inner: Vec<u32>,
    /// The sides of triangles that are borders: the number of the triangle, and which of its sides.
    pub border_sides: Vec<[u32; 2]>,
    /// How many triangles must be known before a tile of vertices can be handled.
    pub frontier: Vec<u32>,
    /// Images of vertices, whose places are behind those of the last block of vertices.
    pub ghosts: Ghosts,
    opposite: OnceLock<Vec<[u32; BLOCK]>>,
    edge_names: OnceLock<Vec<[u32; BLOCK]>>,
    /// The number of each vertex and triangle by its index in the mesh; kept for their memory.
    number: Vec<u32>,
    triangle_number: Vec<u32>,
}

impl Layout {
    /// Lay out a mesh, of fewer than 2³⁰ triangles, as [`Topology`](crate::mesh::Topology) sees to. `order` has
    /// its vertices so that neighbours are near each other, see [`crate::mesh::numbering`].
    pub fn new(mesh: &Triangulation, order: &[u32]) -> Self {
        let mut layout = Self {
            num_vertices: mesh.num_vertices(),
            num_triangles: mesh.triangles().len(),
            particles: Vec::new(),
            vertex_ids: Vec::new(),
            triangle_ids: Vec::new(),
            corners: Vec::new(),
            steps: Vec::new(),
            neighbours: Vec::new(),
            longest: 0,
            places: Vec::new(),
            before: Vec::new(),
            neighbours_before: Vec::new(),
            inner: Vec::new(),
            border_sides: Vec::new(),
            frontier: Vec::new(),
            ghosts: Ghosts::default(),
            opposite: OnceLock::new(),
            edge_names: OnceLock::new(),
            number: Vec::new(),
            triangle_number: Vec::new(),
        };
        layout.update(mesh, order);
        layout
    }

    /// Lay out the mesh anew after its connectivity has changed. The result depends on the mesh and the order only,
    /// not on what was there before.
    pub fn update(&mut self, mesh: &Triangulation, order: &[u32]) {
        debug_assert_eq!(order.len(), self.num_vertices);
        self.number_vertices(mesh, order);
        self.lay_rings(mesh);
        self.lay_corners(mesh);
        self.lay_borders(mesh);
        self.lay_ghosts(mesh);
        self.opposite = OnceLock::new();
        self.edge_names = OnceLock::new();
    }

    /// Number of places of vertices, with those that fill the last block and the ghosts.
    pub fn places_of_vertices(&self) -> usize {
        self.vertex_ids.len() + self.ghosts.len()
    }

    /// The vertices of a tile.
    pub fn vertex_tile(&self, tile: usize) -> Range<usize> {
        tile * TILE..((tile + 1) * TILE).min(self.num_vertices)
    }

    /// The triangles of a tile.
    pub fn triangle_tile(&self, tile: usize) -> Range<usize> {
        tile * TILE..((tile + 1) * TILE).min(self.num_triangles)
    }

    /// Number of tiles of vertices.
    pub fn vertex_tiles(&self) -> usize {
        self.num_vertices.div_ceil(TILE)
    }

    /// Number of tiles of triangles.
    pub fn triangle_tiles(&self) -> usize {
        self.num_triangles.div_ceil(TILE)
    }

    /// Sort the vertices of each tile by degree, those on borders last, and number them.
    fn number_vertices(&mut self, mesh: &Triangulation, order: &[u32]) {
        self.vertex_ids.resize(self.num_vertices, 0);
        self.inner.clear();
        for (tile, sorted) in order.chunks(TILE).zip(self.vertex_ids.chunks_mut(TILE)) {
            // By counting; the few vertices of more neighbours than that are not told apart.
            const MOST: usize = 31;
            let degree = |vertex: u32| match mesh.is_border(vertex) {
                false => (mesh.degrees()[vertex as usize] as usize).min(MOST),
                true => MOST + 1,
            };
            let mut starts = [0; MOST + 3];
            for &vertex in tile {
                starts[degree(vertex) + 1] += 1;
            }
            for degree in 0..=MOST {
                starts[degree + 1] += starts[degree];
            }
            self.inner.push(starts[MOST + 1]);
            for &vertex in tile {
                let place = &mut starts[degree(vertex)];
                sorted[*place as usize] = vertex;
                *place += 1;
            }
        }
        self.number.resize(self.num_vertices, 0);
        for (new, &old) in self.vertex_ids.iter().enumerate() {
            self.number[old as usize] = new as u32;
        }
        let first = self.vertex_ids[0];
        self.vertex_ids.resize(self.num_vertices.next_multiple_of(BLOCK), first);
        let particles = mesh.particles();
        self.particles.clear();
        self.particles.extend(self.vertex_ids.iter().map(|&v| particles[v as usize]));
    }

    /// Store the rings of all vertices, and number the triangles in the order in which they are met.
    fn lay_rings(&mut self, mesh: &Triangulation) {
        const UNKNOWN: u32 = u32::MAX;
        let filled = self.num_triangles.next_multiple_of(BLOCK);
        let nothing = 4 * filled as u32;
        self.triangle_number.clear();
        self.triangle_number.resize(self.num_triangles, UNKNOWN);
        // One more, for what is written there and not kept.
        self.triangle_ids.resize(self.num_triangles + 1, 0);
        let mut met = 0;
        for list in [&mut self.steps, &mut self.frontier] {
            list.clear();
        }
        for list in [&mut self.neighbours, &mut self.places] {
            list.clear();
        }
        for list in [&mut self.before, &mut self.neighbours_before] {
            list.clear();
        }
        self.longest = 0;
        self.steps.push(0);
        let triangles = mesh.triangles().as_flattened();
        for block in 0..self.vertex_ids.len() / BLOCK {
            let vertices = &self.vertex_ids[block * BLOCK..][..BLOCK];
            let degrees: [usize; BLOCK] =
                std::array::from_fn(|lane| mesh.degrees()[vertices[lane] as usize] as usize);
            let corners = match mesh.is_closed() {
                true => degrees,
                false => std::array::from_fn(|lane| mesh.num_corners(vertices[lane]) as usize),
            };
            let longest = degrees.into_iter().max().unwrap_or(0);
            let start = self.neighbours.len();
            self.neighbours.resize(start + longest + 1, [0; BLOCK]);
            self.places.resize(start + longest + 1, [nothing; BLOCK]);
            // All rings of the block go on together: to walk one, each step waits for the one before.
            let mut halves: [u32; BLOCK] = std::array::from_fn(|lane| mesh.leaving(vertices[lane]));
            let mut before = [0; BLOCK];
            let mut neighbours_before = [0; BLOCK];
            for step in 0..longest {
                let (neighbours, places) =
                    (&mut self.neighbours[start + step], &mut self.places[start + step]);
                for lane in 0..BLOCK {
                    if step >= corners[lane] {
                        continue;
                    }
                    let half = halves[lane];
                    let (triangle, place) = (half / 3, half % 3);
                    // Whether a triangle is new is up to chance, so there is no branch.
                    let number = &mut self.triangle_number[triangle as usize];
                    self.triangle_ids[met] = triangle;
                    let is_new = *number == UNKNOWN;
                    *number = if is_new { met as u32 } else { *number };
                    met += usize::from(is_new);
                    places[lane] = 4 * *number + place;
                    neighbours[lane] = 4 * self.number[triangles[next(half) as usize] as usize];
                    halves[lane] = mesh.after(half);
                    // After the last step these are the last triangle and neighbour of the ring.
                    (before[lane], neighbours_before[lane]) = (4 * *number, neighbours[lane]);
                }
            }
            for lane in 0..BLOCK {
                if corners[lane] < degrees[lane] {
                    let vertex = vertices[lane];
                    let last =
                        (1..corners[lane]).fold(mesh.leaving(vertex), |half, _| mesh.after(half));
                    let end = triangles[previous(last) as usize];
                    let number = |vertex: u32| 4 * self.number[vertex as usize];
                    self.neighbours[start + corners[lane]][lane] = number(end);
                    before[lane] = self.places[start][lane] & !3;
                    neighbours_before[lane] = number(vertex);
                }
            }
            let first = self.neighbours[start];
            for lane in 0..BLOCK {
                for lanes in &mut self.neighbours[start + degrees[lane]..] {
                    lanes[lane] = first[lane];
                }
            }
            self.before.push(before);
            self.neighbours_before.push(neighbours_before);
            self.steps.push(self.neighbours.len() as u32);
            self.longest = self.longest.max(longest + 1);
            if (block + 1).is_multiple_of(TILE / BLOCK) || (block + 1) * BLOCK >= self.num_vertices
            {
                // All triangles at this tile have a number now, and those of earlier tiles.
                self.frontier.push(met as u32);
            }
        }
        let first = self.triangle_ids[0];
        self.triangle_ids.truncate(self.num_triangles);
        self.triangle_ids.resize(filled, first);
    }

    fn lay_corners(&mut self, mesh: &Triangulation) {
        self.corners.clear();
        let (number, triangles) = (&self.number, mesh.triangles());
        self.corners.extend(self.triangle_ids.chunks(BLOCK).map(|block| {
            let mut corners = [[0; BLOCK]; 3];
            for (lane, &triangle) in block.iter().enumerate() {
                for (k, &vertex) in triangles[triangle as usize].iter().enumerate() {
                    corners[k][lane] = 4 * number[vertex as usize];
                }
            }
            corners
        }));
    }

    fn lay_borders(&mut self, mesh: &Triangulation) {
        self.border_sides.clear();
        if mesh.is_closed() {
            return;
        }
        for (half, &twin) in mesh.twins().as_flattened().iter().enumerate() {
            if twin == NONE {
                self.border_sides.push([self.triangle_number[half / 3], half as u32 % 3]);
            }
        }
    }

    /// The particle of a vertex or ghost.
    pub fn particle_at(&self, place: usize) -> u32 {
        let ghost = place.checked_sub(self.vertex_ids.len());
        self.particles[ghost.map_or(place, |ghost| self.ghosts.vertex_and_shift(ghost).0)]
    }

    /// The particles at the corners of each triangle, in the user's order, and how far the corners are from them.
    pub fn triangles(&self) -> Vec<[(u32, Vec3); 3]> {
        let mut triangles = vec![[(0, Vec3::zeros()); 3]; self.num_triangles];
        for (index, &id) in self.triangle_ids[..self.num_triangles].iter().enumerate() {
            let places = self.corners[index / BLOCK].map(|lanes| lanes[index % BLOCK] as usize / 4);
            triangles[id as usize] = places.map(|place| {
                let ghost = place.checked_sub(self.vertex_ids.len());
                let (vertex, shift) = ghost
                    .map_or((place, Vec3::zeros()), |ghost| self.ghosts.vertex_and_shift(ghost));
                (self.particles[vertex], shift)
            });
        }
        triangles
    }
}
