//! The mesh as the fast evaluator wants it: renumbered for locality, in blocks of lanes.
//!
//! Vertices that are neighbours on the surface get numbers that are near each other (breadth first from
//! a vertex at the rim), so that what a pass needs is in the cache. Within a tile they are
//! sorted by degree, so that the lanes of a block go round rings of the same length. Triangles follow
//! the vertices. The user's order is kept outside: `particles`, `vertex_ids` and `triangle_ids` translate.

use super::records::BLOCK;
use crate::mesh::Topology;
use std::ops::Range;
use std::sync::OnceLock;

/// Elements that are handled together: what a tile needs between passes stays in the nearest cache. Sums
/// are formed within tiles and then over tiles in order, whatever the number of threads, so this number is
/// part of what decides the last bits.
pub const TILE: usize = 128;

/// The renumbered mesh. All offsets count numbers, not records.
///
/// The ring of a vertex i consists of its neighbours j₀, j₁ … counter-clockwise, and of the triangles
/// t_k = (i, j_k, j_k₊₁) between them. The rings of a block of vertices are stored step by step, a step having
/// an entry for each lane, and one closing step more than the longest of the rings. A ring that is
/// shorter goes on with its first neighbour and with a triangle that does not exist: the one after the last
/// of all, without area and normal, which adds nothing.
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
    /// How many triangles must be known before a tile of vertices can be handled.
    pub frontier: Vec<u32>,
    opposite: OnceLock<Vec<[u32; BLOCK]>>,
}

/// A ring walk: corners around a vertex counter-clockwise.
fn next_corner(topology: &Topology, corner: usize) -> usize {
    let (triangle, k) = (corner / 3, corner % 3);
    let vertex = topology.triangles[triangle][k];
    let edge = &topology.edges[topology.triangle_edges[triangle][(k + 2) % 3] as usize];
    let other = if edge.triangles[0] as usize == triangle { 1 } else { 0 };
    let next = edge.triangles[other] as usize;
    let place = |&v: &u32| v == vertex;
    3 * next + topology.triangles[next].iter().position(place).unwrap_or(0)
}

/// The corners at a vertex, counter-clockwise, from the first on.
fn ring(topology: &Topology, vertex: usize) -> impl Iterator<Item = usize> {
    let range = topology.ring(vertex);
    let mut corner = topology.corners[range.start] as usize;
    range.map(move |_| {
        let here = corner;
        corner = next_corner(topology, here);
        here
    })
}

/// The neighbour that a corner's triangle starts with, counter-clockwise.
fn neighbour(topology: &Topology, corner: usize) -> u32 {
    topology.triangles[corner / 3][(corner % 3 + 1) % 3]
}

/// All vertices, breadth first, component by component, each from a vertex that is far from another.
fn breadth_first(topology: &Topology) -> Vec<u32> {
    let count = topology.num_vertices();
    let mut order: Vec<u32> = Vec::with_capacity(count);
    // 0: unseen; 1: seen by the walk that looks for the rim; 2: numbered.
    let mut seen = vec![0u8; count];
    let walk = |start: u32, mark: u8, seen: &mut [u8], order: &mut Vec<u32>| {
        let mut head = order.len();
        order.push(start);
        seen[start as usize] = mark;
        while head < order.len() {
            let vertex = order[head] as usize;
            head += 1;
            for corner in ring(topology, vertex) {
                let other = neighbour(topology, corner);
                if seen[other as usize] < mark {
                    seen[other as usize] = mark;
                    order.push(other);
                }
            }
        }
    };
    for vertex in 0..count {
        if seen[vertex] == 0 {
            let start = order.len();
            walk(vertex as u32, 1, &mut seen, &mut order);
            let rim = order[order.len() - 1];
            order.truncate(start);
            walk(rim, 2, &mut seen, &mut order);
        }
    }
    order
}

impl Layout {
    /// Renumber a mesh, of fewer than 2³⁰ triangles, as [`Topology`] sees to.
    pub fn new(topology: &Topology) -> Self {
        let degree = |vertex: u32| topology.ring(vertex as usize).len();
        let mut vertex_ids = breadth_first(topology);
        for tile in vertex_ids.chunks_mut(TILE) {
            tile.sort_by_key(|&vertex| degree(vertex));
        }
        let num_vertices = vertex_ids.len();
        let first = vertex_ids[0];
        vertex_ids.resize(num_vertices.next_multiple_of(BLOCK), first);
        let mut number = vec![0u32; num_vertices];
        for (new, &old) in vertex_ids[..num_vertices].iter().enumerate() {
            number[old as usize] = new as u32;
        }
        let mut layout = Self {
            num_vertices,
            num_triangles: topology.triangles.len(),
            particles: vertex_ids.iter().map(|&v| topology.particles[v as usize]).collect(),
            vertex_ids,
            triangle_ids: Vec::new(),
            corners: Vec::new(),
            steps: Vec::new(),
            neighbours: Vec::new(),
            longest: 0,
            places: Vec::new(),
            before: Vec::new(),
            neighbours_before: Vec::new(),
            frontier: Vec::new(),
            opposite: OnceLock::new(),
        };
        let triangle_number = layout.number_triangles(topology, &number);
        layout.lay_rings(topology, &number, &triangle_number);
        layout
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

    /// Number the triangles in the order in which the vertices meet them; returns the new numbers.
    fn number_triangles(&mut self, topology: &Topology, number: &[u32]) -> Vec<u32> {
        let unknown = u32::MAX;
        let mut triangle_number = vec![unknown; self.num_triangles];
        self.triangle_ids.reserve(self.num_triangles.next_multiple_of(BLOCK));
        for tile in self.vertex_ids[..self.num_vertices].chunks(TILE) {
            for &vertex in tile {
                for corner in ring(topology, vertex as usize) {
                    let slot = &mut triangle_number[corner / 3];
                    if *slot == unknown {
                        *slot = self.triangle_ids.len() as u32;
                        self.triangle_ids.push((corner / 3) as u32);
                    }
                }
            }
            // All triangles at this tile have a number now, and those of earlier tiles.
            self.frontier.push(self.triangle_ids.len() as u32);
        }
        let filled = self.num_triangles.next_multiple_of(BLOCK);
        self.triangle_ids.resize(filled, self.triangle_ids[0]);
        self.corners = self
            .triangle_ids
            .chunks(BLOCK)
            .map(|block| {
                std::array::from_fn(|k| {
                    std::array::from_fn(|lane| {
                        let vertex = topology.triangles[block[lane] as usize][k];
                        4 * number[vertex as usize]
                    })
                })
            })
            .collect();
        triangle_number
    }

    fn lay_rings(&mut self, topology: &Topology, number: &[u32], triangle_number: &[u32]) {
        let nothing = 4 * self.triangle_ids.len() as u32;
        let mut rings: Vec<Vec<usize>> = vec![Vec::new(); BLOCK];
        let blocks = self.vertex_ids.len() / BLOCK;
        self.steps.push(0);
        for block in 0..blocks {
            let vertices = &self.vertex_ids[block * BLOCK..][..BLOCK];
            for (corners, &vertex) in rings.iter_mut().zip(vertices) {
                corners.clear();
                corners.extend(ring(topology, vertex as usize));
            }
            let longest = rings.iter().map(Vec::len).max().unwrap_or(0);
            for step in 0..=longest {
                let corner = |lane: usize| rings[lane].get(step).copied();
                self.neighbours.push(std::array::from_fn(|lane| {
                    let corner = corner(lane).unwrap_or(rings[lane][0]);
                    4 * number[neighbour(topology, corner) as usize]
                }));
                let place = |corner: usize| 4 * triangle_number[corner / 3] + (corner % 3) as u32;
                self.places.push(std::array::from_fn(|lane| corner(lane).map_or(nothing, place)));
            }
            self.steps.push(self.neighbours.len() as u32);
            self.longest = self.longest.max(longest + 1);
            let last = |lane: usize| rings[lane][rings[lane].len() - 1];
            self.before.push(std::array::from_fn(|lane| 4 * triangle_number[last(lane) / 3]));
            self.neighbours_before.push(std::array::from_fn(|lane| {
                4 * number[neighbour(topology, last(lane)) as usize]
            }));
        }
    }

    /// For each step and lane, where the edge opposite the vertex in the triangle is a step of its own: the
    /// index of step and lane. Built when first asked for.
    pub fn opposite(&self) -> &[[u32; BLOCK]] {
        self.opposite.get_or_init(|| {
            let nothing = 4 * self.triangle_ids.len() as u32;
            let mut index_of_place = vec![0u32; nothing as usize];
            for (step, lanes) in self.places.iter().enumerate() {
                for (lane, &place) in lanes.iter().enumerate() {
                    let block = self.steps.partition_point(|&start| start as usize <= step) - 1;
                    let filling = block * BLOCK + lane >= self.num_vertices;
                    if place != nothing && !filling {
                        index_of_place[place as usize] = (step * BLOCK + lane) as u32;
                    }
                }
            }
            // The side opposite place k runs from place k + 1 to place k + 2.
            let of = |&place: &u32| match place {
                place if place == nothing => 0,
                place => index_of_place[(place & !3) as usize + ((place & 3) as usize + 1) % 3],
            };
            self.places.iter().map(|lanes| std::array::from_fn(|lane| of(&lanes[lane]))).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::icosahedron;

    #[test]
    fn every_element_has_one_place() {
        let topology = Topology::new(&icosahedron().1, 12).unwrap();
        let layout = Layout::new(&topology);
        let mut vertices = layout.vertex_ids[..12].to_vec();
        vertices.sort_unstable();
        assert_eq!(vertices, (0..12).collect::<Vec<_>>());
        let mut triangles = layout.triangle_ids[..20].to_vec();
        triangles.sort_unstable();
        assert_eq!(triangles, (0..20).collect::<Vec<_>>());
        assert_eq!(layout.corners.len(), 3);
        assert_eq!(layout.steps, [0, 6, 12]);
    }

    #[test]
    fn rings_close_and_steps_know_their_triangles() {
        let topology = Topology::new(&icosahedron().1, 12).unwrap();
        let layout = Layout::new(&topology);
        let opposite = layout.opposite();
        for index in 0..12 {
            let (block, lane) = (index / BLOCK, index % BLOCK);
            let steps = layout.steps[block] as usize..layout.steps[block + 1] as usize - 1;
            assert_eq!(layout.neighbours[steps.start][lane], layout.neighbours[steps.end][lane]);
            for step in steps {
                let triangle = layout.places[step][lane] as usize / 4;
                let place = layout.places[step][lane] as usize % 4;
                let corners =
                    layout.corners[triangle / BLOCK].map(|lanes| lanes[triangle % BLOCK] as usize);
                assert_eq!(corners[place], 4 * index);
                assert_eq!(corners[(place + 1) % 3] as u32, layout.neighbours[step][lane]);
                assert_eq!(corners[(place + 2) % 3] as u32, layout.neighbours[step + 1][lane]);
                let facing = opposite[step][lane] as usize;
                let start = layout.neighbours[facing / BLOCK][facing % BLOCK];
                assert_eq!(corners[(place + 2) % 3] as u32, start);
            }
        }
    }
}
