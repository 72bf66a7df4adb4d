//! The energies of single elements, as they are and as a flip would make them.

use super::hinges::{HINGES, Hinges};
use super::local::{Flipped, LocalEnergy, turned};
use crate::mesh::NONE;
use crate::mesh::borders::{BorderPartials, BorderTotals, angle};
use crate::mesh::geometry::{
    EdgeGeometry, TotalPartials, Totals, TriangleGeometry, Vec3, VertexGeometry,
};
use crate::mesh::triangulation::{Quad, Triangulation, next, previous};
use crate::mesh::vertex_vectors::{VertexVectors, add_corner};
use crate::potentials::{
    Constants, Corners, Edges, Flaw, MadeOf, Needs, Term, Triangles, Vertices,
};
use smallvec::SmallVec;

/// The terms that act on each kind of element, by their places among all.
#[derive(Default)]
pub(super) struct Acting {
    pub totals: Places,
    pub triangles: Places,
    pub edges: Places,
    pub vertices: Places,
    pub borders: Places,
}

pub(super) type Places = SmallVec<[u32; 8]>;

impl Acting {
    pub fn new(terms: &[Term]) -> Self {
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
pub(super) fn at<'a, 't>(
    terms: &'a [Term<'t>],
    places: &'a Places,
) -> impl Iterator<Item = &'a Term<'t>> {
    places.iter().map(|place| &terms[*place as usize])
}

impl LocalEnergy {
    pub(super) fn energy_of_totals(&self, terms: &[Term], totals: &Totals) -> f64 {
        let mut unused = TotalPartials::default();
        at(terms, &self.acting.totals)
            .map(|term| term.potential.totals(term, totals, &mut unused).energy)
            .sum()
    }

    pub(super) fn energy_of_borders(&self, terms: &[Term], totals: &BorderTotals) -> f64 {
        let mut unused = BorderPartials::default();
        at(terms, &self.acting.borders)
            .map(|term| term.potential.borders(term, totals, &mut unused).energy)
            .sum()
    }

    /// Energies of I and J, less those of the triangles that they replace; not a number where one has no shape at rest.
    pub(super) fn triangles_of(
        &self,
        mesh: &Triangulation,
        terms: &[Term],
        quad: &Quad,
        flipped: &mut Flipped,
    ) -> f64 {
        let ids = &flipped.slots.map(|slot| slot as u32);
        flipped.triangle_energies = [0.0; 2];
        let (geometry, energies) = (&flipped.triangles, &mut flipped.triangle_energies);
        for term in at(terms, &self.acting.triangles) {
            let energies = &mut energies[..];
            let made;
            let constants = match term.potential.constants(term) {
                None => &[][..],
                Some(made_of) => match constants_of(mesh, quad, term, made_of) {
                    Ok(constants) => {
                        made = constants;
                        &made
                    }
                    Err(_) => return f64::NAN,
                },
            };
            let run = Triangles::Energies { ids, geometry, constants, energies };
            term.potential.triangles(term, run);
        }
        let before = flipped.slots.map(|slot| self.survey.triangles[slot].energy);
        energies[0] + energies[1] - before[0] - before[1]
    }

    /// An edge as it is.
    pub(super) fn edge_of(&self, mesh: &Triangulation, half: u32) -> EdgeGeometry {
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

    pub(super) fn add_edges(
        &self,
        terms: &[Term],
        geometry: &[EdgeGeometry],
        energies: &mut [f64],
    ) {
        // Values of single edges do not follow flips, so no edge is asked for its own.
        let names = &[0; HINGES][..geometry.len()];
        for term in at(terms, &self.acting.edges) {
            term.potential.edges(term, Edges::Energies { names, geometry, energies });
        }
    }

    /// Jülicher's curvatures of the four vertices and in total; the change of energies of angles.
    pub(super) fn edges_of(
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
            flipped.totals.mean_curvature += ki + il + jk + lj + come - gone;
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
    pub(super) fn vertices_of(
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
    // Apart, so that attempts without it stay short.
    #[inline(never)]
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
}

/// The constants that I and J will have for a term.
// Apart, so that attempts without it stay short.
#[inline(never)]
fn constants_of(
    mesh: &Triangulation,
    quad: &Quad,
    term: &Term,
    made_of: MadeOf,
) -> Result<[Constants; 2], Flaw> {
    let ([i, j, k, l], [a, b]) = (quad.vertices, quad.halves);
    let is_border = |half| mesh.twin(half) == NONE;
    let make = |vertices: [u32; 3], on_border| {
        let are_outer = vertices.map(|vertex| mesh.is_border(vertex));
        let corners = Corners { vertices, are_outer, on_border };
        made_of.constants(term, &corners, term.constants.share)
    };
    Ok([
        // The sides of I are il, lk and ki, those of J are jk, kl and lj.
        make([i, l, k], [is_border(next(b)), false, is_border(previous(a))])?,
        make([j, k, l], [is_border(next(a)), false, is_border(previous(b))])?,
    ])
}

/// By how much the angles at those of the four vertices that are on borders will grow.
// Apart, so that attempts without it stay short.
#[inline(never)]
pub(super) fn angles_on_borders(mesh: &Triangulation, quad: &Quad, points: &[Vec3; 4]) -> f64 {
    // Corners by their places among i, j, k, l.
    let angle_at = |corner: [usize; 3]| match mesh.is_border(quad.vertices[corner[0]]) {
        true => angle(corner.map(|n| points[n])),
        false => 0.0,
    };
    let of =
        |[a, b, c]: [usize; 3]| angle_at([a, b, c]) + angle_at([b, c, a]) + angle_at([c, a, b]);
    of([0, 3, 2]) + of([1, 2, 3]) - of([0, 1, 2]) - of([1, 0, 3])
}
