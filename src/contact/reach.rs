//! How far particles reach, and which triangles or vertices are near the boxes that they may be in.

use super::grid::{Grid, bounds};
use crate::mesh::closest::in_one_piece;
use crate::mesh::geometry::Vec3;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::Term;
use crate::potentials::particle_surface::{self, RADIUS};

/// The skin as a share of the reach.
pub const SKIN: f64 = 0.3;

/// Triangles by boxes, or vertices.
#[derive(Default)]
pub struct Map {
    /// The reach, and the mesh that it is of; 0 for vertices, whatever connects them.
    made_for: Option<(f64, Option<Cell>, u64)>,
    reference: Vec<Vec3>,
    pub grid: Grid,
}

impl Map {
    /// Give each box the list of the triangles that may be nearer than `reach` to any of its points.
    pub fn refresh(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        reach: f64,
        positions: &[Vec3],
    ) {
        let wanted = (reach, cell.copied(), mesh.fingerprint());
        self.renew(wanted, positions, 16 * mesh.triangles().len(), |grid, range| {
            for (triangle, corners) in mesh.triangles().iter().enumerate() {
                let frame = in_one_piece(cell, corners.map(|corner| &positions[corner as usize]));
                grid.add_around(triangle as u32, &frame, range);
            }
        });
    }

    /// The same of vertices.
    pub fn refresh_vertices(&mut self, cell: Option<&Cell>, reach: f64, positions: &[Vec3]) {
        self.renew((reach, cell.copied(), 0), positions, 16 * positions.len(), |grid, range| {
            for (vertex, at) in positions.iter().enumerate() {
                grid.add_around(vertex as u32, std::slice::from_ref(at), range);
            }
        });
    }

    fn renew(
        &mut self,
        wanted: (f64, Option<Cell>, u64),
        positions: &[Vec3],
        most: usize,
        fill: impl FnOnce(&mut Grid, f64),
    ) {
        let (reach, cell, _) = wanted;
        let skin = SKIN * reach;
        if self.made_for == Some(wanted) {
            let pairs = positions.iter().zip(&self.reference);
            if pairs.fold(0.0, |far: f64, (now, then)| far.max((now - then).norm_squared()))
                < skin * skin
            {
                return;
            }
        }
        let [low, high] = bounds(positions);
        let range = reach + skin;
        let around = [low.add_scalar(-range), high.add_scalar(range)];
        self.grid.set_up(cell.as_ref(), around, range, most);
        fill(&mut self.grid, range);
        self.grid.seal();
        self.reference.clear();
        self.reference.extend_from_slice(positions);
        self.made_for = Some(wanted);
    }
}

/// How far particles act from their middles. Those whose reach is within a factor of two are a class.
pub struct Reach {
    /// From their rims.
    pub from_rim: f64,
    /// The least from their middles.
    least: f64,
    most: f64,
    /// Which classes have particles, from the least reach on.
    pub classes: Vec<bool>,
}

impl Reach {
    /// Of the particles of a term.
    pub fn new(term: &Term) -> Self {
        let from_rim = particle_surface::reach(term);
        let radii = term.fields[RADIUS];
        let one = [term.values[RADIUS]];
        let radii = if radii.is_empty() { &one } else { radii };
        let fold =
            |choose: fn(f64, f64) -> f64| from_rim + radii.iter().copied().fold(radii[0], choose);
        let (least, most) = (fold(f64::min), fold(f64::max));
        let mut reach = Self { from_rim, least, most, classes: Vec::new() };
        reach.classes = vec![false; reach.class(most - from_rim) + 1];
        for radius in radii {
            let class = reach.class(*radius);
            reach.classes[class] = true;
        }
        reach
    }

    /// The class of particles of a radius.
    #[inline]
    pub fn class(&self, radius: f64) -> usize {
        // The exponent of a number that is 1 or more, or a little less by rounding.
        let exponent = ((self.from_rim + radius) / self.least).to_bits() >> 52;
        (exponent.max(1023) - 1023) as usize
    }

    /// The most in a class, nm.
    pub fn of_class(&self, class: usize) -> f64 {
        self.most.min(self.least * 2f64.powi(class as i32 + 1))
    }
}
