//! From positions in a periodic box to a surface in one piece.
//!
//! Evaluators want neighbours beside each other, wherever they have been wrapped to. A vertex v at r_v is taken at
//! u_v = r_v + m_v · box, with whole numbers m_v such that the edges of a tree, breadth first, are nearest images. The first vertex of
//! each connected part is wrapped into the box at the origin. Where a surface spans the box, some of the other edges do not
//! fit then; the corners of triangles have images of their own there ([`Triangulation::images`]).
//!
//! An edge that is shorter than half of the box' least width has one image that is that short. So if all edges are, what
//! comes out is a function of positions, box and connectivity, whatever was there before. Every edge need not be looked at
//! again before vertices have moved so far that one could have grown too long.

use super::cell::{Cell, Image, minus, nowhere, plus};
use super::geometry::Vec3;
use super::triangulation::Triangulation;
use crate::error::{Error, Result};
use std::ops::Range;

/// The unfolded positions of a mesh, and what is remembered to find the next ones.
#[derive(Default)]
pub struct Unfolding {
    /// The vertices, breadth first, part by part, each with the one it was met from; the first of a part with itself.
    /// Empty if the connectivity has changed.
    tree: Vec<[u32; 2]>,
    /// Where the parts are in the tree.
    parts: Vec<Range<usize>>,
    /// The box when all edges were looked at last.
    cell: Option<Cell>,
    /// m_v of all vertices.
    images: Vec<Image>,
    /// m_v · box, nm.
    shifts: Vec<Vec3>,
    /// r_v when all edges were looked at last, nm.
    verified: Vec<Vec3>,
    /// The square of how far vertices may be from there until all edges must be looked at again, nm².
    reach_squared: f64,
    /// Of all particles; those of no vertex are zero.
    positions: Vec<f64>,
}

/// What [`Unfolding::unfold`] has found.
pub struct Unfolded<'a> {
    /// Positions of all particles, nm, in which the surface is in one piece.
    pub positions: &'a [f64],
    /// Whether the mesh has got other images of corners.
    pub has_new_images: bool,
}

impl Unfolding {
    /// The mesh has other triangles now, or is in another Context's hands.
    pub fn connectivity_changed(&mut self) {
        self.tree.clear();
    }

    /// Unfold the positions of all particles (nm), and give the corners of the mesh their images.
    ///
    /// # Errors
    /// A position that is not finite; an edge that is not shorter than half of the box' least width.
    pub fn unfold<'a>(
        &'a mut self,
        mesh: &mut Triangulation,
        positions: &[f64],
        cell: &Cell,
    ) -> Result<Unfolded<'a>> {
        self.positions.resize(positions.len(), 0.0);
        let mut has_new_images = false;
        if !self.stay_near(mesh, positions, cell) && !self.follow(mesh, positions, cell) {
            let corners = self.find(mesh, positions, cell).inspect_err(|_| self.tree.clear())?;
            has_new_images = mesh.set_images(corners);
        }
        Ok(Unfolded { positions: &self.positions, has_new_images })
    }

    /// Positions by the images that are known, if no edge can have become too long.
    fn stay_near(&mut self, mesh: &Triangulation, positions: &[f64], cell: &Cell) -> bool {
        if self.tree.is_empty() || self.cell.as_ref() != Some(cell) {
            return false;
        }
        self.wrap_parts(mesh, positions, cell);
        let (from, to) = (positions.as_chunks::<3>().0, self.positions.as_chunks_mut::<3>().0);
        let mut all_near = true;
        for ((&particle, shift), before) in
            mesh.particles().iter().zip(&self.shifts).zip(&self.verified)
        {
            let here = Vec3::from(from[particle as usize]);
            all_near &= (here - before).norm_squared() < self.reach_squared;
            to[particle as usize] = (here + shift).into();
        }
        all_near
    }

    /// Move whole parts whose first vertex has left the box at the origin.
    fn wrap_parts(&mut self, mesh: &Triangulation, positions: &[f64], cell: &Cell) {
        for part in &self.parts {
            let first = self.tree[part.start][0] as usize;
            let (wanted, known) =
                (cell.wrap(&position(mesh, positions, first)), self.images[first]);
            if wanted == known {
                continue;
            }
            for &[vertex, _] in &self.tree[part.clone()] {
                let image = plus(self.images[vertex as usize], minus(wanted, known));
                self.images[vertex as usize] = image;
                self.shifts[vertex as usize] = cell.shift(image);
            }
        }
    }

    /// The same in a box that has changed or after longer ways, if every edge is short enough as it is.
    fn follow(&mut self, mesh: &Triangulation, positions: &[f64], cell: &Cell) -> bool {
        if self.tree.is_empty() {
            return false;
        }
        self.wrap_parts(mesh, positions, cell);
        self.place(mesh, positions, cell);
        self.measure(mesh, mesh.images(), positions, cell).is_ok()
    }

    /// Find all images anew. Returns those of corners, or nothing if the surface is in one piece.
    fn find(
        &mut self,
        mesh: &Triangulation,
        positions: &[f64],
        cell: &Cell,
    ) -> Result<Vec<[Image; 3]>> {
        if self.tree.is_empty() {
            self.grow_tree(mesh);
        }
        self.images.resize(mesh.num_vertices(), [0; 3]);
        for &[vertex, parent] in &self.tree {
            let (vertex, parent) = (vertex as usize, parent as usize);
            let here = position(mesh, positions, vertex);
            self.images[vertex] = if vertex == parent {
                cell.wrap(&here)
            } else {
                let step = cell.nearest(&(here - position(mesh, positions, parent)));
                plus(self.images[parent], step)
            };
        }
        self.place(mesh, positions, cell);
        let corners = (0..mesh.triangles().len()).map(|triangle| {
            let [a, b, c] = mesh.particles_of(triangle).map(|particle| self.unfolded(particle));
            [[0; 3], cell.nearest(&(b - a)), cell.nearest(&(c - a))]
        });
        let mut corners: Vec<_> = corners.collect();
        if corners.iter().all(|images| *images == [[0; 3]; 3]) {
            corners.clear();
        }
        self.measure(mesh, &corners, positions, cell)?;
        Ok(corners)
    }

    /// Vertices breadth first, each part from its first one.
    fn grow_tree(&mut self, mesh: &Triangulation) {
        self.parts.clear();
        let mut met = vec![false; mesh.num_vertices()];
        let mut neighbours = Vec::new();
        for first in 0..mesh.num_vertices() {
            if std::mem::replace(&mut met[first], true) {
                continue;
            }
            let start = self.tree.len();
            self.tree.push([first as u32; 2]);
            let mut head = start;
            while let Some(&[vertex, _]) = self.tree.get(head) {
                head += 1;
                mesh.neighbours(vertex, &mut neighbours);
                for &other in &neighbours {
                    if !std::mem::replace(&mut met[other as usize], true) {
                        self.tree.push([other, vertex]);
                    }
                }
            }
            self.parts.push(start..self.tree.len());
        }
    }

    /// Positions by the images that are known.
    fn place(&mut self, mesh: &Triangulation, positions: &[f64], cell: &Cell) {
        self.shifts.clear();
        self.shifts.extend(self.images.iter().map(|image| cell.shift(*image)));
        let (from, to) = (positions.as_chunks::<3>().0, self.positions.as_chunks_mut::<3>().0);
        for (&particle, shift) in mesh.particles().iter().zip(&self.shifts) {
            to[particle as usize] = (Vec3::from(from[particle as usize]) + shift).into();
        }
    }

    /// Look at all edges as they are now, and note how far vertices may move from here.
    fn measure(
        &mut self,
        mesh: &Triangulation,
        images: &[[Image; 3]],
        positions: &[f64],
        cell: &Cell,
    ) -> Result<()> {
        self.cell = None;
        let limit = cell.half_width();
        let mut longest = 0.0f64;
        for triangle in 0..mesh.triangles().len() {
            let particles = mesh.particles_of(triangle);
            let mut corners = particles.map(|particle| self.unfolded(particle));
            if let Some(images) = images.get(triangle) {
                for (corner, image) in corners.iter_mut().zip(images) {
                    *corner += cell.shift(*image);
                }
            }
            for k in 0..3 {
                let length = (corners[(k + 1) % 3] - corners[k]).norm();
                if length >= limit || length.is_nan() {
                    let edge = [particles[k], particles[(k + 1) % 3]];
                    return Err(too_long(edge, length, positions, cell));
                }
                longest = longest.max(length);
            }
        }
        self.verified.clear();
        self.verified.extend((0..mesh.num_vertices()).map(|v| position(mesh, positions, v)));
        self.reach_squared = (0.5 * (limit - longest)).powi(2);
        self.cell = Some(*cell);
        Ok(())
    }

    fn unfolded(&self, particle: u32) -> Vec3 {
        Vec3::from(self.positions.as_chunks::<3>().0[particle as usize])
    }
}

/// Where the particle of a vertex is.
#[inline]
fn position(mesh: &Triangulation, positions: &[f64], vertex: usize) -> Vec3 {
    Vec3::from(positions.as_chunks::<3>().0[mesh.particles()[vertex] as usize])
}

/// Why an edge is not short enough.
pub fn too_long(edge: [u32; 2], length: f64, positions: &[f64], cell: &Cell) -> Error {
    for particle in edge {
        let position = positions.as_chunks::<3>().0[particle as usize].into();
        if let Some(reason) = nowhere(Some(cell), particle, &position) {
            return reason;
        }
    }
    let vectors = cell.vectors().map(<[f64; 3]>::from);
    Error::LongEdge { edge, length, limit: cell.half_width(), vectors: Box::new(vectors) }
}
