//! The energy of any terms, known element by element, so that a local change costs what it touches.
//!
//! It begins with what an evaluation finds ([`Survey`]); then [`LocalEnergy::flipped`] says what the flip of an edge
//! would make of the two triangles, five edges and four vertices that it touches and of the totals,
//! and [`LocalEnergy::apply`] notes that it was made. Positions stay as they were at the beginning.
//! Energies come from the potentials' own formulas, through the form `Energies` of their runs.

use super::elements::{Acting, angles_on_borders, at};
use crate::error::Result;
use crate::evaluator::{Survey, SurveyedTriangle};
use crate::mesh::borders::{BorderTotals, Borders};
use crate::mesh::geometry::{Totals, TriangleGeometry, Vec3, VertexGeometry};
use crate::mesh::triangulation::{Quad, Triangulation, Turn};
use crate::mesh::vertex_vectors::VertexVectors;
use crate::mesh::{Cell, NONE};
use crate::potentials::{Needs, Term};

/// |N| below which a triangle counts as having no area, nm².
const SMALLEST_AREA: f64 = 1e-140;

/// New edges stay below this share of half of the width of a periodic box. An edge as long as that half ends the run, so the
/// rest is room for its ends to move before it flips again.
const SHARE_OF_HALF_WIDTH: f64 = 0.8;

/// Energies of all elements of a mesh, and the geometry that they come from.
#[derive(Default)]
pub struct LocalEnergy {
    pub(super) survey: Survey,
    /// The periodic box, if there is one.
    cell: Option<Cell>,
    pub(super) acting: Acting,
    /// Whether no vertex can have an energy below zero.
    vertices_never_negative: bool,
    /// Of the totals, kJ/mol.
    totals_energy: f64,
    /// If a term acts on them.
    borders: BorderTotals,
}

/// What a flip makes of the elements that it touches. With i, j, k, l as in [`Quad`], I is the new triangle (i, l, k)
/// and J the new triangle (j, k, l).
#[derive(Default)]
pub struct Flipped {
    /// Where I and J are kept.
    pub(super) slots: [usize; 2],
    pub(super) triangles: [TriangleGeometry; 2],
    pub(super) triangle_energies: [f64; 2],
    /// Of i, j, k and l.
    pub(super) vertices: [VertexGeometry; 4],
    pub(super) vectors: [VertexVectors; 4],
    pub(super) vertex_energies: [f64; 4],
    pub(super) totals: Totals,
    totals_energy: f64,
    borders: BorderTotals,
}

impl LocalEnergy {
    /// Begin with what a survey finds of a mesh at some positions in a periodic box or none.
    ///
    /// # Errors
    /// Those of the survey; nothing is known then.
    pub fn fill(
        &mut self,
        mesh: &Triangulation,
        terms: &[Term],
        cell: Option<&Cell>,
        survey: impl FnOnce(&mut Survey) -> Result<()>,
    ) -> Result<()> {
        survey(&mut self.survey)?;
        self.cell = cell.copied();
        self.acting = Acting::new(terms);
        self.vertices_never_negative =
            at(terms, &self.acting.vertices).all(|term| term.potential.is_never_negative(term));
        self.totals_energy = self.energy_of_totals(terms, &self.survey.totals);
        if !self.acting.borders.is_empty() {
            self.borders = Borders::new(mesh).totals(|half| self.corner(mesh, half));
        }
        Ok(())
    }

    /// The energy of all terms, kJ/mol.
    pub fn total(&self, mesh: &Triangulation, terms: &[Term]) -> f64 {
        let edges: f64 = mesh
            .edges()
            .map(|half| {
                let geometry = self.edge_of(mesh, half);
                let mut energy = [0.0];
                if mesh.twin(half) != NONE {
                    self.add_edges(terms, &[geometry], &mut energy);
                }
                energy[0]
            })
            .sum();
        self.survey.triangles.iter().map(|triangle| triangle.energy).sum::<f64>()
            + self.survey.vertices.iter().map(|vertex| vertex.energy).sum::<f64>()
            + edges
            + self.totals_energy
            + self.energy_of_borders(terms, &self.borders)
    }

    /// The square of the length, nm², that the edge kl would have.
    #[inline]
    pub fn new_length_squared(&self, mesh: &Triangulation, quad: &Quad) -> f64 {
        let [_, _, k, l] = self.points(mesh, quad);
        (k - l).norm_squared()
    }

    /// The length, nm, that new edges must stay below: that of the rules, or what a periodic box allows; 0 for any.
    pub fn longest(&self, max_edge_length: f64) -> f64 {
        match self.cell.as_ref().map(Cell::half_width) {
            Some(half) if max_edge_length == 0.0 => SHARE_OF_HALF_WIDTH * half,
            // The next evaluation may measure the edge between other images, and round differently.
            Some(half) => max_edge_length.min(half * (1.0 - 1e-9)),
            None => max_edge_length,
        }
    }

    /// Where i, j, k and l are, beside each other.
    #[inline(always)]
    fn points(&self, mesh: &Triangulation, quad: &Quad) -> [Vec3; 4] {
        let mut points = quad.vertices.map(|vertex| *self.position(vertex));
        if let (Some(images), Some(cell)) = (mesh.images_of(quad), &self.cell) {
            for (point, image) in points.iter_mut().zip(images) {
                *point += cell.shift(image);
            }
        }
        points
    }

    /// Where the vertex is that a half-edge begins at, beside the other corners of its triangle.
    pub(super) fn corner(&self, mesh: &Triangulation, half: u32) -> Vec3 {
        let position = *self.position(mesh.origin(half));
        match (mesh.images().as_flattened().get(half as usize), &self.cell) {
            (Some(image), Some(cell)) => position + cell.shift(*image),
            _ => position,
        }
    }

    #[inline(always)]
    fn position(&self, vertex: u32) -> &Vec3 {
        &self.survey.vertices[vertex as usize].position
    }

    /// The triangle that a half-edge is a side of.
    #[inline(always)]
    pub(super) fn beside(&self, half: u32) -> &TriangleGeometry {
        &self.survey.triangles[half as usize / 3].geometry
    }

    /// What a flip would change: fills `flipped`, and returns by how much the energy changes, kJ/mol; not a number where
    /// the new shape has none. If the energy is sure to change by more than `limit`, something above that is
    /// returned as soon as it is known, and `flipped` is not to be used.
    pub fn flipped(
        &self,
        mesh: &Triangulation,
        terms: &[Term],
        quad: &Quad,
        turn: Turn,
        limit: f64,
        flipped: &mut Flipped,
    ) -> f64 {
        let survey = &self.survey;
        let [slot_a, slot_b] = quad.triangles();
        let points = self.points(mesh, quad);
        let [i, j, k, l] = &points;
        let triangles = [TriangleGeometry::new(i, l, k), TriangleGeometry::new(j, k, l)];
        flipped.slots = match turn {
            Turn::Left => [slot_a, slot_b],
            Turn::Right => [slot_b, slot_a],
        };
        flipped.triangles = triangles;
        let old = [slot_a, slot_b].map(|slot| &survey.triangles[slot].geometry);
        let old_area = 0.5 * (old[0].twice_area + old[1].twice_area);
        flipped.totals = Totals {
            area: survey.totals.area + triangles[0].area() + triangles[1].area() - old_area,
            // It loses the tetrahedron ijkl where ij is convex, and gains it where ij is concave.
            volume: survey.totals.volume - old[0].normal.dot(&(i - l)) / 6.0,
            mean_curvature: survey.totals.mean_curvature,
        };
        let smallest = triangles[0].twice_area.min(triangles[1].twice_area);
        if smallest <= SMALLEST_AREA || !flipped.totals.area.is_finite() {
            return f64::NAN;
        }
        let mut difference = 0.0;
        flipped.totals_energy = self.totals_energy;
        // The mean curvature comes of the edges.
        let totals_after_edges = survey.needs.contains(Needs::MEAN_CURVATURE);
        if survey.needs.contains(Needs::TOTALS) && !totals_after_edges {
            flipped.totals_energy = self.energy_of_totals(terms, &flipped.totals);
            difference += flipped.totals_energy - self.totals_energy;
        }
        if !mesh.is_closed() && !self.acting.borders.is_empty() {
            flipped.borders = self.borders;
            flipped.borders.turning -= angles_on_borders(mesh, quad, &points);
            difference += self.energy_of_borders(terms, &flipped.borders)
                - self.energy_of_borders(terms, &self.borders);
        }
        if survey.needs.contains(Needs::TRIANGLES) {
            difference += self.triangles_of(mesh, terms, quad, flipped);
        }
        // The most that the vertices can give.
        let known = quad.vertices.map(|vertex| survey.vertices[vertex as usize].energy);
        let at_hand = known.iter().sum();
        let most = if self.vertices_never_negative { at_hand } else { f64::INFINITY };
        let edges_act = survey.needs.intersects(Needs::EDGES | Needs::MEAN_CURVATURE);
        if !edges_act && difference - most > limit {
            return difference - most;
        }
        flipped.vertices = quad.vertices.map(|vertex| survey.vertices[vertex as usize].scalars);
        if survey.needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            difference += self.edges_of(mesh, terms, quad, &points, flipped);
        }
        if totals_after_edges {
            flipped.totals_energy = self.energy_of_totals(terms, &flipped.totals);
            difference += flipped.totals_energy - self.totals_energy;
        }
        if difference - most > limit {
            return difference - most;
        }
        if survey.needs.contains(Needs::VERTICES) {
            self.vertices_of(mesh, terms, quad, &points, flipped);
            difference += flipped.vertex_energies.iter().sum::<f64>() - at_hand;
        }
        difference
    }

    /// A flip has been made: `mesh` has the new edge already, `quad` is the quadrilateral as it was before.
    pub fn apply(&mut self, mesh: &Triangulation, quad: &Quad, flipped: &Flipped) {
        let survey = &mut self.survey;
        for (n, slot) in flipped.slots.into_iter().enumerate() {
            // I begins with i and J with j; the corners of the mesh may begin elsewhere.
            let first = mesh.triangles()[slot].iter().position(|v| *v == quad.vertices[n]);
            let first = first.expect("I has i for a corner, and J has j");
            let geometry = turned(&flipped.triangles[n], (3 - first) % 3);
            survey.triangles[slot] =
                SurveyedTriangle { geometry, energy: flipped.triangle_energies[n] };
        }
        for (n, vertex) in quad.vertices.map(|vertex| vertex as usize).into_iter().enumerate() {
            survey.vertices[vertex].scalars = flipped.vertices[n];
            survey.vertices[vertex].energy = flipped.vertex_energies[n];
            if let Some(vectors) = survey.vectors.get_mut(vertex) {
                *vectors = flipped.vectors[n];
            }
        }
        survey.totals = flipped.totals;
        self.totals_energy = flipped.totals_energy;
        if !mesh.is_closed() {
            self.borders = flipped.borders;
        }
    }
}

/// The same triangle with another corner for its first.
#[inline]
pub(super) fn turned(triangle: &TriangleGeometry, first: usize) -> TriangleGeometry {
    let dots = std::array::from_fn(|k| triangle.dots[(k + first) % 3]);
    TriangleGeometry { dots, ..*triangle }
}
