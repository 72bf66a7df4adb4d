//! Images of vertices, for surfaces that span a periodic box.
//!
//! A corner or neighbour that is beyond the box' faces is a ghost: a place of its own behind the vertices, with the position of
//! an image. So the passes see a surface in one piece. They write to vertices only; what they gather from neighbours,
//! ghosts get from the vertices that they are images of.

use super::arrays::{Arrays, Numbers};
use super::layout::Layout;
use crate::lanes::BLOCK;
use crate::mesh::Triangulation;
use crate::mesh::cell::{Cell, Image, minus};
use crate::mesh::geometry::Vec3;
use crate::potentials::Needs;
use std::collections::HashMap;

/// All ghosts, in the order of their places.
#[derive(Default)]
pub struct Ghosts {
    /// The number of each one's vertex, and which image it is.
    ghosts: Vec<(u32, Image)>,
    place: HashMap<(u32, Image), u32>,
    /// How far each is from its vertex in the present box, nm.
    shifts: Vec<Vec3>,
}

impl Ghosts {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.ghosts.len()
    }

    /// The vertex, by its number, of which one is an image, and how far it is from it.
    pub fn vertex_and_shift(&self, ghost: usize) -> (usize, Vec3) {
        (self.ghosts[ghost].0 as usize, self.shifts[ghost])
    }

    /// Put them where they are in a box.
    pub fn set_cell(&mut self, cell: &Cell) {
        self.shifts.clear();
        self.shifts.extend(self.ghosts.iter().map(|(_, image)| cell.shift(*image)));
    }

    /// The offset of the position of a vertex' image; `behind` is the place of the first ghost.
    fn offset(&mut self, vertex: u32, image: Image, behind: u32) -> u32 {
        if image == [0; 3] {
            return 4 * vertex;
        }
        let next = self.ghosts.len() as u32;
        let place = *self.place.entry((vertex, image)).or_insert(next);
        if place == next {
            self.ghosts.push((vertex, image));
        }
        4 * (behind + place)
    }

    /// Give the ghosts what neighbours gather: the partials of their vertices.
    pub fn copy_partials(&self, arrays: &Arrays, needs: Needs, behind: usize) {
        let copy = |numbers: &Numbers, width: usize| {
            for (place, &(vertex, _)) in self.ghosts.iter().enumerate() {
                let (from, to) = (width * vertex as usize, width * (behind + place));
                // SAFETY: there are records for all vertices and ghosts, and no pass is running.
                unsafe { numbers.at(from).copy_to_nonoverlapping(numbers.at(to), width) };
            }
        };
        copy(&arrays.partials, 2);
        if needs.intersects(Needs::VORONOI_AREAS | Needs::COTANGENTS) {
            copy(&arrays.vector_partials, 4);
        }
        if needs.contains(Needs::UMBRELLAS) {
            copy(&arrays.umbrella_partials, 4);
        }
        if needs.contains(Needs::NORMALS) {
            copy(&arrays.normal_partials, 4);
        }
    }
}

impl Layout {
    /// Let corners and neighbours refer to ghosts where the mesh has images; everything else has been laid out.
    pub(super) fn lay_ghosts(&mut self, mesh: &Triangulation) {
        let mut ghosts = std::mem::take(&mut self.ghosts);
        ghosts.ghosts.clear();
        ghosts.place.clear();
        if !mesh.images().is_empty() {
            self.place_corners(mesh, &mut ghosts);
            self.place_neighbours(mesh, &mut ghosts);
        }
        ghosts.shifts.clear();
        ghosts.shifts.resize(ghosts.ghosts.len(), Vec3::zeros());
        self.ghosts = ghosts;
    }

    fn place_corners(&mut self, mesh: &Triangulation, ghosts: &mut Ghosts) {
        let behind = self.vertex_ids.len() as u32;
        for (block, corners) in self.corners.iter_mut().enumerate() {
            for lane in 0..BLOCK {
                let images = mesh.images()[self.triangle_ids[block * BLOCK + lane] as usize];
                for (offsets, image) in corners.iter_mut().zip(images) {
                    offsets[lane] = ghosts.offset(offsets[lane] / 4, image, behind);
                }
            }
        }
    }

    /// The neighbours of a vertex are images as its triangles have them, the vertex itself being none.
    fn place_neighbours(&mut self, mesh: &Triangulation, ghosts: &mut Ghosts) {
        let behind = self.vertex_ids.len() as u32;
        let nothing = 4 * self.triangle_ids.len() as u32;
        for block in 0..self.steps.len() - 1 {
            let steps = self.steps[block] as usize..self.steps[block + 1] as usize;
            for lane in 0..BLOCK {
                let vertex = self.vertex_ids[block * BLOCK + lane];
                let is_border = mesh.is_border(vertex);
                let end = steps.start + mesh.num_corners(vertex) as usize;
                for step in steps.clone() {
                    // The last neighbour on a border belongs to the triangle before.
                    let (place, further) = match step == end && is_border {
                        true => (self.places[step - 1][lane], 2),
                        false => (self.places[step][lane], 1),
                    };
                    if place == nothing {
                        // Past the end of a ring comes its first neighbour again.
                        self.neighbours[step][lane] = self.neighbours[steps.start][lane];
                        continue;
                    }
                    let images = mesh.images()[self.triangle_ids[place as usize / 4] as usize];
                    let corner = place as usize % 4;
                    let image = minus(images[(corner + further) % 3], images[corner]);
                    let neighbour = self.neighbours[step][lane] / 4;
                    self.neighbours[step][lane] = ghosts.offset(neighbour, image, behind);
                }
                if !is_border {
                    self.neighbours_before[block][lane] = self.neighbours[end - 1][lane];
                }
            }
        }
    }
}
