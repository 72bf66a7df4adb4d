//! Which vertex and which triangle is in which lane, and what is around a vertex.
//!
//! Places are what lanes load from: that of vertex v is where its x stands in an array of [`Vectors`], with y and z
//! [`LANES`] further on each; likewise that of a corner in the gradients of triangles.

use super::LANES;
use crate::error::{Error, Result};
use crate::mesh::numbering::breadth_first;
use crate::mesh::topology::NONE;
use crate::mesh::triangulation::{next, previous};
use crate::mesh::{Topology, Triangulation};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;

/// How many groups of lanes are summed up before tiles are.
const TILE: usize = 32;

/// An index for each lane.
pub type Places = [u32; LANES];

/// The triangles of some force.
pub struct Sheet<'a> {
    /// The particles at the corners.
    pub triangles: &'a [[i32; 3]],
    /// Whether its sides are nearest images in the periodic box.
    pub is_periodic: bool,
}

/// Some groups of lanes of one surface.
#[derive(Clone, Copy)]
pub struct Tile {
    start: usize,
    end: usize,
    /// Of all surfaces.
    pub surface: usize,
    /// How many of the last lanes hold nothing.
    pub padding: usize,
}

impl Tile {
    /// Its groups of lanes.
    pub fn groups(&self) -> Range<usize> {
        self.start..self.end
    }
}

/// All connected surfaces of a System.
pub struct Layout {
    /// The particle in each lane, [`NONE`] in those that pad a surface.
    pub particles: Vec<Places>,
    /// The vertices by tiles.
    pub tiles: Vec<Tile>,
    /// The triangles by tiles.
    pub triangle_tiles: Vec<Tile>,
    /// The places of each triangle's corners.
    pub corners: Vec<[Places; 3]>,
    /// Where the slots of each group of vertices begin: what is around them, counter-clockwise. One entry more than
    /// groups.
    offsets: Vec<usize>,
    /// For each slot the vertex that a side leads to, by the number of its lane; beyond all lanes where there is none.
    pub neighbours: Vec<Places>,
    /// The triangle after that side, by the number of its lane; beyond all lanes where there is none.
    pub around: Vec<Places>,
    /// The place of the gradient of its area with respect to the vertex that is gone around.
    pub gradients: Vec<Places>,
    /// The place of the gradient in the triangle before the first slot, for each group.
    pub before: Vec<Places>,
    /// Of each surface.
    pub is_periodic: Vec<bool>,
    /// The particles of all triangles, in the order in which forces have them.
    pub triangles: Vec<[u32; 3]>,
}

/// The place of x of a lane among all lanes.
pub fn place(lane: usize) -> usize {
    lane / LANES * 3 * LANES + lane % LANES
}

/// The place of the gradient at a corner of the triangle in some lane.
fn gradient_place(triangle: usize, corner: usize) -> usize {
    (triangle / LANES * 3 + corner) * 3 * LANES + triangle % LANES
}

impl Layout {
    /// Join the triangles of all forces to surfaces. What several of them have counts once.
    ///
    /// # Errors
    /// Triangles that do not make up surfaces, as with two triangulations of the same particles; forces that disagree
    /// whether a surface is in the periodic box.
    pub fn new(sheets: &[Sheet], num_particles: usize) -> Result<Self> {
        let (triangles, is_periodic) = join(sheets)?;
        let topology = Topology::new(&triangles, num_particles).map_err(|reason| {
            Error::Contract(format!(
                "the triangles of all membrane forces together are no surface whose plaquettes could have masses: \
                 {reason}. Give forces on the same particles the same triangles"
            ))
        })?;
        let mesh = Triangulation::new(&topology);
        let mut layout = Self::empty(&mesh);
        let lanes = layout.number_vertices(&mesh);
        let triangle_lanes = layout.number_triangles(&mesh, &lanes);
        layout.surround(&mesh, &lanes, &triangle_lanes);
        layout.look_for_boxes(&mesh, &lanes, &is_periodic)?;
        Ok(layout)
    }

    fn empty(mesh: &Triangulation) -> Self {
        Self {
            particles: Vec::new(),
            tiles: Vec::new(),
            triangle_tiles: Vec::new(),
            corners: Vec::new(),
            offsets: vec![0],
            neighbours: Vec::new(),
            around: Vec::new(),
            gradients: Vec::new(),
            before: Vec::new(),
            is_periodic: Vec::new(),
            triangles: (0..mesh.triangles().len()).map(|t| mesh.particles_of(t)).collect(),
        }
    }

    /// Where the slots of some groups of vertices are.
    pub fn slots_of(&self, groups: Range<usize>) -> Range<usize> {
        self.offsets[groups.start]..self.offsets[groups.end]
    }

    /// Put the vertices into lanes, each surface into groups of its own. Returns the lane of each vertex.
    fn number_vertices(&mut self, mesh: &Triangulation) -> Vec<u32> {
        let parts = mesh.parts();
        let mut lanes = vec![NONE; mesh.num_vertices()];
        let order = breadth_first(mesh);
        let same_part = |a: &u32, b: &u32| parts[*a as usize] == parts[*b as usize];
        for (surface, vertices) in order.chunk_by(same_part).enumerate() {
            let first = self.particles.len();
            for (i, &vertex) in vertices.iter().enumerate() {
                lanes[vertex as usize] = (first * LANES + i) as u32;
            }
            self.particles.extend(vertices.chunks(LANES).map(|chunk| {
                let particle = |vertex: &u32| mesh.particles()[*vertex as usize];
                std::array::from_fn(|lane| chunk.get(lane).map_or(NONE, particle))
            }));
            tile(&mut self.tiles, first, vertices.len(), surface);
            self.is_periodic.push(false);
        }
        lanes
    }

    /// Put the triangles into lanes, each surface's into groups of its own, in the order of their vertices. Returns the
    /// lane of each triangle.
    fn number_triangles(&mut self, mesh: &Triangulation, lanes: &[u32]) -> Vec<u32> {
        let first_lane =
            |t: &u32| mesh.triangles()[*t as usize].map(|v| lanes[v as usize]).into_iter().min();
        let mut order: Vec<_> = (0..mesh.triangles().len() as u32).collect();
        order.sort_by_key(first_lane);
        let surfaces: Vec<_> = self.tiles.iter().map(|tile| (tile.end, tile.surface)).collect();
        let surface_of = |t: &u32| {
            let group = lanes[mesh.triangles()[*t as usize][0] as usize] as usize / LANES;
            surfaces[surfaces.partition_point(|(end, _)| *end <= group)].1
        };
        let mut triangle_lanes = vec![NONE; order.len()];
        for triangles in order.chunk_by(|a, b| surface_of(a) == surface_of(b)) {
            let first = self.corners.len();
            for (i, &triangle) in triangles.iter().enumerate() {
                triangle_lanes[triangle as usize] = (first * LANES + i) as u32;
            }
            self.corners.extend(triangles.chunks(LANES).map(|chunk| {
                // Lanes that pad do what the last one does, and nobody looks at them.
                let corner = |lane: usize, k: usize| {
                    let vertex = mesh.triangles()[chunk[lane.min(chunk.len() - 1)] as usize][k];
                    place(lanes[vertex as usize] as usize) as u32
                };
                std::array::from_fn(|k| std::array::from_fn(|lane| corner(lane, k)))
            }));
            tile(&mut self.triangle_tiles, first, triangles.len(), surface_of(&triangles[0]));
        }
        triangle_lanes
    }

    /// Note what is around each vertex, in the order of its ring.
    fn surround(&mut self, mesh: &Triangulation, lanes: &[u32], triangle_lanes: &[u32]) {
        let (no_vertex, no_triangle) = (self.particles.len() * LANES, self.corners.len() * LANES);
        let no_gradient = [gradient_place(no_triangle, 0) as u32; LANES];
        let gradient = |half: u32| {
            let triangle = triangle_lanes[half as usize / 3] as usize;
            gradient_place(triangle, half as usize % 3) as u32
        };
        let mut vertex_of = vec![NONE; self.particles.len() * LANES];
        for (vertex, &lane) in lanes.iter().enumerate() {
            vertex_of[lane as usize] = vertex as u32;
        }
        let mut ring = Vec::new();
        for vertices in vertex_of.chunks(LANES) {
            let vertices = || vertices.iter().enumerate().filter(|(_, vertex)| **vertex != NONE);
            let degree = vertices().map(|(_, vertex)| mesh.degrees()[*vertex as usize]).max();
            let (start, mut before) = (self.neighbours.len(), no_gradient);
            let end = start + degree.unwrap_or(0) as usize;
            self.neighbours.resize(end, [no_vertex as u32; LANES]);
            self.around.resize(end, [no_triangle as u32; LANES]);
            self.gradients.resize(end, no_gradient);
            for (lane, &vertex) in vertices() {
                mesh.ring(vertex, &mut ring);
                for (slot, &half) in (start..).zip(&ring) {
                    self.neighbours[slot][lane] = lanes[mesh.origin(next(half)) as usize];
                    self.around[slot][lane] = triangle_lanes[half as usize / 3];
                    self.gradients[slot][lane] = gradient(half);
                }
                let last = ring[ring.len() - 1];
                if mesh.is_border(vertex) {
                    // After the last side there is no triangle.
                    let neighbour = mesh.origin(previous(last));
                    self.neighbours[start + ring.len()][lane] = lanes[neighbour as usize];
                } else {
                    before[lane] = gradient(last);
                }
            }
            self.before.push(before);
            self.offsets.push(end);
        }
    }

    /// Note which surfaces are in the periodic box; the whole of each must be.
    fn look_for_boxes(
        &mut self,
        mesh: &Triangulation,
        lanes: &[u32],
        is_periodic: &[bool],
    ) -> Result<()> {
        let mut known = vec![None; self.is_periodic.len()];
        for (triangle, &periodic) in is_periodic.iter().enumerate() {
            let group = lanes[mesh.triangles()[triangle][0] as usize] as usize / LANES;
            let tile = self.tiles.partition_point(|tile| tile.end <= group);
            let surface = self.tiles[tile].surface;
            if *known[surface].get_or_insert(periodic) != periodic {
                return Err(disagreement(mesh.particles_of(triangle)));
            }
            self.is_periodic[surface] = periodic;
        }
        Ok(())
    }
}

/// Divide groups of lanes from `first` on, with `count` lanes in use, into tiles.
fn tile(tiles: &mut Vec<Tile>, first: usize, count: usize, surface: usize) {
    let last = first + count.div_ceil(LANES);
    for start in (first..last).step_by(TILE) {
        let end = (start + TILE).min(last);
        let padding = if end == last { (last - first) * LANES - count } else { 0 };
        tiles.push(Tile { start, end, surface, padding });
    }
}

/// Each triangle once, with whether it is in the periodic box.
fn join(sheets: &[Sheet]) -> Result<(Vec<[i64; 3]>, Vec<bool>)> {
    let (mut triangles, mut is_periodic) = (Vec::new(), Vec::<bool>::new());
    let mut known = HashMap::new();
    for sheet in sheets {
        for corners in sheet.triangles {
            let mut key = *corners;
            key.sort_unstable();
            match known.entry(key) {
                Entry::Vacant(entry) => {
                    entry.insert(triangles.len());
                    triangles.push(corners.map(i64::from));
                    is_periodic.push(sheet.is_periodic);
                }
                Entry::Occupied(entry) if is_periodic[*entry.get()] != sheet.is_periodic => {
                    return Err(disagreement(corners.map(|corner| corner as u32)));
                }
                Entry::Occupied(_) => {}
            }
        }
    }
    Ok((triangles, is_periodic))
}

fn disagreement([a, b, c]: [u32; 3]) -> Error {
    Error::Contract(format!(
        "of the forces on the surface with triangle ({a}, {b}, {c}), some use periodic boundary conditions and some do \
         not; call setUsesPeriodicBoundaryConditions() of all with the same value"
    ))
}
