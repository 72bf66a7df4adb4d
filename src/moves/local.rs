//! The energy of any terms, known element by element, so that a local change costs what it touches.
//!
//! It begins with what an evaluation finds ([`Survey`]); then [`LocalEnergy::flipped`] says what the flip of an edge
//! would make of the two triangles, five edges and four vertices that it touches and of the total area and volume,
//! and [`LocalEnergy::apply`] notes that it was made. Positions stay as they were at the beginning.
//! Energies come from the potentials' own formulas, through the form `Energies` of their runs.

use super::hinges::{HINGES, Hinges};
use crate::error::Result;
use crate::evaluator::{Survey, SurveyedTriangle};
use crate::mesh::borders::{BorderPartials, BorderTotals, Borders, angle};
use crate::mesh::geometry::{
    EdgeGeometry, TotalPartials, Totals, TriangleGeometry, Vec3, VertexGeometry,
};
use crate::mesh::triangulation::{Quad, Triangulation, Turn, next, previous};
use crate::mesh::vertex_vectors::{VertexVectors, add_corner};
use crate::mesh::{Cell, NONE};
use crate::potentials::{Edges, Needs, Term, Triangles, Vertices};
use smallvec::SmallVec;

/// Below twice this area, nm², a triangle has none.
const SMALLEST_AREA: f64 = 1e-140;

/// Of half of the width of a periodic box, what new edges have for themselves; an edge as long as that half ends the
/// run, and the rest is for vertices to move before the edge flips again.
const SHARE_OF_HALF_WIDTH: f64 = 0.8;

/// Energies of all elements of a mesh, and the geometry that they come from.
#[derive(Default)]
pub struct LocalEnergy {
    survey: Survey,
    /// The periodic box, if there is one.
    cell: Option<Cell>,
    acting: Acting,
    /// Whether no vertex can have an energy below zero.
    vertices_never_negative: bool,
    /// Of the total area and volume, kJ/mol.
    totals_energy: f64,
    /// If a term acts on them.
    borders: BorderTotals,
}

/// What a flip makes of the elements that it touches. With i, j, k, l as in [`Quad`], I is the new triangle (i, l, k)
/// and J the new triangle (j, k, l).
#[derive(Default)]
pub struct Flipped {
    /// Where I and J are kept.
    slots: [usize; 2],
    triangles: [TriangleGeometry; 2],
    triangle_energies: [f64; 2],
    /// Of i, j, k and l.
    vertices: [VertexGeometry; 4],
    vectors: [VertexVectors; 4],
    vertex_energies: [f64; 4],
    totals: Totals,
    totals_energy: f64,
    borders: BorderTotals,
}

/// The terms that act on each kind of element, by their places among all.
#[derive(Default)]
struct Acting {
    totals: Places,
    triangles: Places,
    edges: Places,
    vertices: Places,
    borders: Places,
}

type Places = SmallVec<[u32; 8]>;

impl Acting {
    fn new(terms: &[Term]) -> Self {
        let on = |element: Needs| {
            let acts = |term: &Term| term.potential.needs(term).contains(element);
            terms.iter().enumerate().filter(|(_, term)| acts(term)).map(|(k, _)| k as u32).collect()
        };
        Self {
            totals: on(Needs::TOTALS),
            triangles: on(Needs::TRIANGLES),
            edges: on(Needs::EDGES),
            vertices: on(Needs::VERTICES),
            borders: on(Needs::BORDERS),
        }
    }
}

/// The terms at some places.
#[inline(always)]
fn at<'a, 't>(terms: &'a [Term<'t>], places: &'a Places) -> impl Iterator<Item = &'a Term<'t>> {
    places.iter().map(|place| &terms[*place as usize])
}

impl LocalEnergy {
    fn energy_of_totals(&self, terms: &[Term], totals: &Totals) -> f64 {
        let mut unused = TotalPartials::default();
        at(terms, &self.acting.totals)
            .map(|term| term.potential.totals(term, totals, &mut unused).energy)
            .sum()
    }

    fn energy_of_borders(&self, terms: &[Term], totals: &BorderTotals) -> f64 {
        let mut unused = BorderPartials::default();
        at(terms, &self.acting.borders)
            .map(|term| term.potential.borders(term, totals, &mut unused).energy)
            .sum()
    }

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
                self.add_edges(terms, &[geometry], &mut energy);
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
    fn corner(&self, mesh: &Triangulation, half: u32) -> Vec3 {
        let position = *self.position(mesh.origin(half));
        match (mesh.images().as_flattened().get(half as usize), &self.cell) {
            (Some(image), Some(cell)) => position + cell.shift(*image),
            _ => position,
        }
    }

    /// All elements as they are.
    #[inline(always)]
    pub(super) fn survey(&self) -> &Survey {
        &self.survey
    }

    #[inline(always)]
    fn position(&self, vertex: u32) -> &Vec3 {
        &self.survey.vertices[vertex as usize].position
    }

    /// The triangle that a half-edge is a side of.
    #[inline(always)]
    fn beside(&self, half: u32) -> &TriangleGeometry {
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
        };
        let smallest = triangles[0].twice_area.min(triangles[1].twice_area);
        if smallest <= SMALLEST_AREA || !flipped.totals.area.is_finite() {
            return f64::NAN;
        }
        let mut difference = 0.0;
        flipped.totals_energy = self.totals_energy;
        if survey.needs.contains(Needs::TOTALS) {
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
            difference += self.triangles_of(terms, flipped);
        }
        // The most that the vertices can give.
        let known = quad.vertices.map(|vertex| survey.vertices[vertex as usize].energy);
        let at_hand = known.iter().sum();
        let most = if self.vertices_never_negative { at_hand } else { f64::INFINITY };
        let edges_act = survey.needs.contains(Needs::EDGES);
        if !edges_act && difference - most > limit {
            return difference - most;
        }
        flipped.vertices = quad.vertices.map(|vertex| survey.vertices[vertex as usize].scalars);
        if survey.needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            difference += self.edges_of(mesh, terms, quad, &points, flipped);
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

    /// Energies of I and J, less those of the triangles that they replace.
    fn triangles_of(&self, terms: &[Term], flipped: &mut Flipped) -> f64 {
        let ids = &flipped.slots.map(|slot| slot as u32);
        flipped.triangle_energies = [0.0; 2];
        let (geometry, energies) = (&flipped.triangles, &mut flipped.triangle_energies);
        for term in at(terms, &self.acting.triangles) {
            let energies = &mut energies[..];
            term.potential.triangles(term, Triangles::Energies { ids, geometry, energies });
        }
        let before = flipped.slots.map(|slot| self.survey.triangles[slot].energy);
        energies[0] + energies[1] - before[0] - before[1]
    }

    /// An edge as it is.
    fn edge_of(&self, mesh: &Triangulation, half: u32) -> EdgeGeometry {
        let (twin, left) = (mesh.twin(half), self.beside(half));
        let length_squared = left.length_squared(half as usize % 3);
        if twin == NONE {
            return EdgeGeometry { length_squared, bend: 0.0 };
        }
        let right = self.beside(twin);
        let [start, tip] = [next(twin), previous(twin)].map(|half| self.corner(mesh, half));
        let mut hinges = Hinges::default();
        hinges.set(0, left, right, length_squared, &(start - tip));
        hinges.bend()[0]
    }

    fn add_edges(&self, terms: &[Term], geometry: &[EdgeGeometry], energies: &mut [f64]) {
        for term in at(terms, &self.acting.edges) {
            term.potential.edges(term, Edges::Energies { geometry, energies });
        }
    }

    /// Jülicher's curvatures of the four vertices; the change of energies of angles.
    fn edges_of(
        &self,
        mesh: &Triangulation,
        terms: &[Term],
        quad: &Quad,
        [i, j, k, l]: &[Vec3; 4],
        flipped: &mut Flipped,
    ) -> f64 {
        let [a, b] = quad.halves;
        let [new_i, new_j] = &flipped.triangles;
        let (old_a, old_b) = (self.beside(a), self.beside(b));
        // ki, il, jk and lj with what lies beyond them.
        let rim = [previous(a), next(b), next(a), previous(b)];
        let beyond = rim.map(|half| mesh.twin(half));
        let lengths = [new_i, new_i, new_j, new_j].into_iter().zip([2, 0, 0, 2]);
        let (old, new) = ([old_a, old_b, old_a, old_b], [new_i, new_i, new_j, new_j]);
        // Seen from outside the quadrilateral, the tip beyond the rim was j or i, and will be l or k. Arms lead from
        // there to the edge.
        let (across, along) = (k - l, i - j);
        let old_arms = [k - j, along, k - i, -along];
        let new_arms = [across, -across, across, -across];
        let mut hinges = Hinges::default();
        hinges.set(0, old_a, old_b, along.norm_squared(), &(i - l));
        hinges.set(1, new_i, new_j, across.norm_squared(), &(k - j));
        for (n, (side, place)) in lengths.enumerate() {
            // At a border they stay flat.
            if beyond[n] != NONE {
                let (outside, length_squared) =
                    (self.beside(beyond[n]), side.length_squared(place));
                hinges.set(2 + n, outside, old[n], length_squared, &old_arms[n]);
                hinges.set(6 + n, outside, new[n], length_squared, &new_arms[n]);
            }
        }
        let edges = hinges.bend();
        if self.survey.needs.contains(Needs::CURVATURES) {
            let curvature = |n: usize| 0.5 * edges[n].bend * edges[n].length_squared;
            let (gone, come) = (curvature(0), curvature(1));
            let [ki, il, jk, lj] = std::array::from_fn(|n| curvature(6 + n) - curvature(2 + n));
            flipped.vertices[0].curvature += ki + il - gone;
            flipped.vertices[1].curvature += jk + lj - gone;
            flipped.vertices[2].curvature += ki + jk + come;
            flipped.vertices[3].curvature += il + lj + come;
        }
        if !self.survey.needs.contains(Needs::EDGES) {
            return 0.0;
        }
        let mut energies = [0.0; HINGES];
        self.add_edges(terms, &edges[..10], &mut energies[..10]);
        let rim: f64 = (2..6).map(|n| energies[n + 4] - energies[n]).sum();
        energies[1] - energies[0] + rim
    }

    /// Areas, vectors and energies of the four vertices.
    fn vertices_of(
        &self,
        mesh: &Triangulation,
        terms: &[Term],
        quad: &Quad,
        points: &[Vec3; 4],
        flipped: &mut Flipped,
    ) {
        let [old_a, old_b] =
            quad.triangles().map(|slot| self.survey.triangles[slot].geometry.area() / 3.0);
        let [new_i, new_j] = flipped.triangles.map(|triangle| triangle.area() / 3.0);
        flipped.vertices[0].area += new_i - old_a - old_b;
        flipped.vertices[1].area += new_j - old_a - old_b;
        flipped.vertices[2].area += new_i + new_j - old_a;
        flipped.vertices[3].area += new_i + new_j - old_b;
        let wants_vectors = !self.survey.vectors.is_empty();
        if wants_vectors {
            flipped.vectors = quad.vertices.map(|vertex| self.survey.vectors[vertex as usize]);
            let [a, b] = quad.triangles().map(|slot| self.survey.triangles[slot].geometry);
            let [new_i, new_j] = flipped.triangles;
            // Corners as they are kept: a triangle of the survey begins with any of its corners.
            let [first_a, first_b] = quad.halves.map(|half| half as usize % 3);
            // The corners of each triangle as places among i, j, k, l.
            for (geometry, corners, sign) in [
                (&turned(&a, first_a), [0, 1, 2], -1.0),
                (&turned(&b, first_b), [1, 0, 3], -1.0),
                (&new_i, [0, 3, 2], 1.0),
                (&new_j, [1, 2, 3], 1.0),
            ] {
                self.add_corners(points, geometry, corners, sign, flipped);
            }
        }
        flipped.vertex_energies = [0.0; 4];
        let vectors = if wants_vectors { &flipped.vectors[..] } else { &[] };
        let total = self.survey.vertices.len();
        let (ids, scalars) = (&quad.vertices, &flipped.vertices);
        for term in at(terms, &self.acting.vertices) {
            if !mesh.is_closed() && !term.potential.acts_at_borders() {
                continue;
            }
            let energies = &mut flipped.vertex_energies[..];
            let run = Vertices::Energies { total, ids, scalars, vectors, energies };
            term.potential.vertices(term, run);
        }
        if !mesh.is_closed() {
            self.inner_vertices_of(mesh, terms, quad, flipped);
        }
    }

    /// The energies of those of the four vertices that are on no border, of the terms that act on no others.
    fn inner_vertices_of(
        &self,
        mesh: &Triangulation,
        terms: &[Term],
        quad: &Quad,
        flipped: &mut Flipped,
    ) {
        let total = self.survey.vertices.len();
        for term in at(terms, &self.acting.vertices) {
            if term.potential.acts_at_borders() {
                continue;
            }
            for n in (0..4).filter(|n| !mesh.is_border(quad.vertices[*n])) {
                let vectors = if self.survey.vectors.is_empty() { 0..0 } else { n..n + 1 };
                let run = Vertices::Energies {
                    total,
                    ids: &quad.vertices[n..=n],
                    scalars: &flipped.vertices[n..=n],
                    vectors: &flipped.vectors[vectors],
                    energies: &mut flipped.vertex_energies[n..=n],
                };
                term.potential.vertices(term, run);
            }
        }
    }

    /// Add or take away what the corners of a triangle give to Voronoi areas and vectors.
    fn add_corners(
        &self,
        points: &[Vec3; 4],
        geometry: &TriangleGeometry,
        corners: [usize; 3],
        sign: f64,
        flipped: &mut Flipped,
    ) {
        let normals = self.survey.needs.contains(Needs::NORMALS);
        let points = corners.map(|n| &points[n]);
        for k in 0..3 {
            let (mut scalars, mut vectors) = (VertexGeometry::default(), VertexVectors::default());
            let around = [points[k], points[(k + 1) % 3], points[(k + 2) % 3]];
            add_corner(&mut scalars, &mut vectors, around, geometry, k, normals);
            let sum = &mut flipped.vectors[corners[k]];
            sum.cotangent += vectors.cotangent * sign;
            sum.umbrella += vectors.umbrella * sign;
            sum.normal_sum += vectors.normal_sum * sign;
            flipped.vertices[corners[k]].voronoi_area += scalars.voronoi_area * sign;
        }
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

/// By how much the angles at those of the four vertices that are on borders will grow.
fn angles_on_borders(mesh: &Triangulation, quad: &Quad, points: &[Vec3; 4]) -> f64 {
    // Corners by their places among i, j, k, l.
    let angle_at = |corner: [usize; 3]| match mesh.is_border(quad.vertices[corner[0]]) {
        true => angle(corner.map(|n| points[n])),
        false => 0.0,
    };
    let of =
        |[a, b, c]: [usize; 3]| angle_at([a, b, c]) + angle_at([b, c, a]) + angle_at([c, a, b]);
    of([0, 3, 2]) + of([1, 2, 3]) - of([0, 1, 2]) - of([1, 0, 3])
}

/// The same triangle with another corner for its first.
#[inline]
fn turned(triangle: &TriangleGeometry, first: usize) -> TriangleGeometry {
    let dots = std::array::from_fn(|k| triangle.dots[(k + first) % 3]);
    TriangleGeometry { dots, ..*triangle }
}
