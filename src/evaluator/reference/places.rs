//! Where the corners of triangles are, of which some are images of their vertices where a mesh spans a periodic box.

use crate::error::Error;
use crate::evaluator::passes::{Nothing, fill};
use crate::mesh::Topology;
use crate::mesh::cell::{Cell, Image};
use crate::mesh::culprit;
use crate::mesh::geometry::Vec3;
use std::sync::Arc;

/// A mesh, and where its vertices and corners are, nm.
pub struct Places {
    pub topology: Arc<Topology>,
    /// Relative to the first vertex, so that a mesh far from the origin loses no digits.
    positions: Vec<Vec3>,
    /// How far corners of triangles are from their vertices where the mesh spans a periodic box; otherwise empty.
    shifts: Vec<[Vec3; 3]>,
}

impl Places {
    pub fn new(topology: Arc<Topology>) -> Self {
        let positions = vec![Vec3::zeros(); topology.num_vertices()];
        Self { topology, positions, shifts: Vec::new() }
    }

    pub fn set_images(&mut self, images: &[[Image; 3]], cell: &Cell) {
        self.shifts = images.iter().map(|images| images.map(|image| cell.shift(image))).collect();
    }

    /// Take the vertices' positions from those of all particles.
    pub fn gather(&mut self, all: &[f64], parallel: bool) {
        let particles = &self.topology.particles;
        let position = |particle: u32| Vec3::from_column_slice(&all[3 * particle as usize..][..3]);
        let origin = position(particles[0]);
        fill(parallel, &mut self.positions, |first, chunk| {
            for (slot, &particle) in chunk.iter_mut().zip(&particles[first..]) {
                *slot = position(particle) - origin;
            }
            Nothing
        });
    }

    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        let corners = self.topology.triangles[triangle].map(|v| self.positions[v as usize]);
        match self.shifts.get(triangle) {
            None => corners,
            Some(shifts) => std::array::from_fn(|k| corners[k] + shifts[k]),
        }
    }

    /// The corners, beginning with that of a vertex.
    pub fn from(&self, triangle: u32, vertex: u32) -> [Vec3; 3] {
        let mut corners = self.corners(triangle as usize);
        let vertices = self.topology.triangles[triangle as usize];
        corners.rotate_left(vertices.iter().position(|v| *v == vertex).unwrap_or(0));
        corners
    }

    /// Why the mesh has no geometry at the positions of all particles.
    pub fn culprit(&self, positions: &[f64]) -> Error {
        let triangles = (0..self.topology.triangles.len()).map(|triangle| {
            let shifts = self.shifts.get(triangle).copied().unwrap_or_default();
            let particles = self.topology.particles_of(triangle);
            std::array::from_fn(|k| (particles[k], shifts[k]))
        });
        culprit(&self.topology.particles, triangles, positions)
    }
}
