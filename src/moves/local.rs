//! The energy of any terms, known element by element, so that a local change costs what it touches.
//!
//! [`LocalEnergy::fill`] goes over the whole mesh once; then [`LocalEnergy::flipped`] says what the flip of an edge
//! would make of the two triangles, five edges and four vertices that it touches and of the total area and volume,
//! and [`LocalEnergy::apply`] notes that it was made. Positions stay as they were at the beginning.
//! Energies come from the potentials' own formulas, through the form `Energies` of their runs.

use super::hinges::{CHUNK, Hinges};
use crate::mesh::geometry::{EdgeGeometry, TotalPartials, Totals, TriangleGeometry, Vec3};
use crate::mesh::geometry::{VertexGeometry, bend};
use crate::mesh::triangulation::{Quad, Triangulation, Turn, next, previous};
use crate::mesh::vertex_vectors::{VertexVectors, add_corner};
use crate::potentials::{Edges, Needs, Term, Triangles, Vertices};
use smallvec::SmallVec;

/// Below twice this area, nm², a triangle has none.
const SMALLEST_AREA: f64 = 1e-140;

/// Energies of all elements of a mesh, and the geometry that they come from.
#[derive(Default)]
pub struct LocalEnergy {
    needs: Needs,
    acting: Acting,
    triangles: Vec<TriangleRecord>,
    /// The energy of the edge that each side is; empty unless a term needs it.
    edge_energies: Vec<[f64; 3]>,
    vertices: Vec<VertexRecord>,
    /// Empty unless a term needs them.
    vectors: Vec<VertexVectors>,
    totals: Totals,
    /// Of the total area and volume, kJ/mol.
    totals_energy: f64,
}

/// What is known of a triangle, in one cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct TriangleRecord {
    face: Face,
    /// φ / l of each side, if a term needs it.
    bends: [f64; 3],
    energy: f64,
}

/// N and |N| of a triangle, as in [`TriangleGeometry`].
#[derive(Clone, Copy)]
struct Face {
    normal: Vec3,
    twice_area: f64,
}

impl From<&TriangleGeometry> for Face {
    #[inline(always)]
    fn from(&TriangleGeometry { normal, twice_area, .. }: &TriangleGeometry) -> Self {
        Self { normal, twice_area }
    }
}

/// What is known of a vertex, in one cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct VertexRecord {
    /// Relative to the first vertex, so that a mesh far from the origin loses no digits.
    position: Vec3,
    scalars: VertexGeometry,
    energy: f64,
}

/// What a flip makes of the elements that it touches. With i, j, k, l as in [`Quad`], I is the new triangle (i, l, k)
/// and J the new triangle (j, k, l).
pub struct Flipped {
    /// By how much the energy changes, kJ/mol; not a number where the new shape has none.
    pub difference: f64,
    /// Where I and J are kept, and at which of its places i or j is.
    slots: [(usize, usize); 2],
    triangles: [TriangleGeometry; 2],
    triangle_energies: [f64; 2],
    /// Of kl, ki, il, jk and lj.
    edges: [EdgeGeometry; 5],
    edge_energies: [f64; 5],
    /// Of i, j, k and l.
    vertices: [VertexGeometry; 4],
    vectors: [VertexVectors; 4],
    vertex_energies: [f64; 4],
    totals: Totals,
    totals_energy: f64,
}

/// The terms that act on each kind of element, by their places among all.
#[derive(Default)]
struct Acting {
    totals: Places,
    triangles: Places,
    edges: Places,
    vertices: Places,
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

    /// Go over the whole mesh. Positions are those of all particles, x y z of one after the other, nm.
    ///
    /// Returns false where the mesh has no geometry: a position that is not finite, or a triangle without area.
    pub fn fill(&mut self, mesh: &Triangulation, terms: &[Term], positions: &[f64]) -> bool {
        self.needs =
            terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        self.acting = Acting::new(terms);
        self.edge_energies.clear();
        self.vectors.clear();
        self.gather_positions(mesh, positions);
        if !self.fill_triangles(mesh, terms) {
            return false;
        }
        if self.needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            self.fill_bends(mesh, terms);
        }
        if self.needs.contains(Needs::VECTORS) {
            self.fill_vectors(mesh);
        }
        self.fill_energies(terms);
        true
    }

    /// The energy of all terms, kJ/mol.
    pub fn total(&self, mesh: &Triangulation) -> f64 {
        let edges = if self.edge_energies.is_empty() {
            0.0
        } else {
            mesh.edges().map(|half| self.edge_energies.as_flattened()[half as usize]).sum()
        };
        self.triangles.iter().map(|triangle| triangle.energy).sum::<f64>()
            + self.vertices.iter().map(|vertex| vertex.energy).sum::<f64>()
            + edges
            + self.totals_energy
    }

    fn gather_positions(&mut self, mesh: &Triangulation, all: &[f64]) {
        let position = |particle: u32| Vec3::from_column_slice(&all[3 * particle as usize..][..3]);
        let origin = position(mesh.particles()[0]);
        self.vertices.clear();
        self.vertices.extend(mesh.particles().iter().map(|&particle| VertexRecord {
            position: position(particle) - origin,
            scalars: VertexGeometry::default(),
            energy: 0.0,
        }));
    }

    /// Triangles with their energies, totals, and the barycentric areas of the vertices.
    fn fill_triangles(&mut self, mesh: &Triangulation, terms: &[Term]) -> bool {
        self.triangles.clear();
        let (mut twice_area, mut six_volumes, mut smallest) = (0.0, 0.0, f64::INFINITY);
        let mut first = 0;
        for chunk in mesh.triangles().chunks(CHUNK) {
            let mut ids = [0; CHUNK];
            let nothing =
                TriangleGeometry { normal: Vec3::zeros(), twice_area: 0.0, dots: [0.0; 3] };
            let (mut geometry, mut energies) = ([nothing; CHUNK], [0.0; CHUNK]);
            for (n, corners) in chunk.iter().enumerate() {
                let corners = corners.map(|vertex| vertex as usize);
                let [a, b, c] = corners.map(|vertex| &self.vertices[vertex].position);
                geometry[n] = TriangleGeometry::new(a, b, c);
                ids[n] = first + n as u32;
                twice_area += geometry[n].twice_area;
                six_volumes += a.dot(&geometry[n].normal);
                smallest = geometry[n].twice_area.min(smallest);
                let third = geometry[n].area() / 3.0;
                for vertex in corners {
                    self.vertices[vertex].scalars.area += third;
                }
            }
            let (ids, geometry) = (&ids[..chunk.len()], &geometry[..chunk.len()]);
            for term in at(terms, &self.acting.triangles) {
                let energies = &mut energies[..chunk.len()];
                term.potential.triangles(term, Triangles::Energies { ids, geometry, energies });
            }
            self.triangles.extend(geometry.iter().zip(energies).map(|(known, energy)| {
                TriangleRecord { face: known.into(), bends: [0.0; 3], energy }
            }));
            first += chunk.len() as u32;
        }
        self.totals = Totals { area: 0.5 * twice_area, volume: six_volumes / 6.0 };
        smallest > SMALLEST_AREA && twice_area.is_finite()
    }

    /// Angles of all edges, and Jülicher's curvatures.
    fn fill_bends(&mut self, mesh: &Triangulation, terms: &[Term]) {
        if !self.acting.edges.is_empty() {
            self.edge_energies.resize(self.triangles.len(), [0.0; 3]);
        }
        let mut hinges = Hinges::default();
        let mut count = 0;
        let halves = 3 * self.triangles.len() as u32;
        for (half, &twin) in (0..halves).zip(mesh.twins().as_flattened()) {
            // Each edge once. Which of its half-edges comes first is up to chance, so there is no branch.
            hinges.halves[count] = half;
            count += usize::from(half < twin);
            if count == CHUNK {
                self.take_hinges(mesh, terms, &mut hinges, count);
                count = 0;
            }
        }
        self.take_hinges(mesh, terms, &mut hinges, count);
    }

    fn take_hinges(
        &mut self,
        mesh: &Triangulation,
        terms: &[Term],
        hinges: &mut Hinges,
        count: usize,
    ) {
        for n in 0..count {
            let half = hinges.halves[n];
            let twin = mesh.twin(half);
            let (left, right) = (self.beside(half), self.beside(twin));
            let [start, end, tip] = [half, twin, previous(twin)]
                .map(|half| &self.vertices[mesh.origin(half) as usize].position);
            hinges.twins[n] = twin;
            hinges.lengths_squared[n] = (end - start).norm_squared();
            hinges.determinants[n] = left.normal.dot(&(start - tip));
            hinges.cosines[n] = left.normal.dot(&right.normal);
            hinges.products[n] = left.twice_area * right.twice_area;
        }
        let edges = hinges.bend(count);
        let edges_act = !self.acting.edges.is_empty();
        let mut energies = [0.0; CHUNK];
        for term in at(terms, &self.acting.edges) {
            let (geometry, energies) = (&edges[..count], &mut energies[..count]);
            term.potential.edges(term, Edges::Energies { geometry, energies });
        }
        for n in 0..count {
            let edge = &edges[n];
            let share = 0.5 * edge.bend * edge.length_squared;
            for half in [hinges.halves[n], hinges.twins[n]] {
                self.triangles[half as usize / 3].bends[half as usize % 3] = edge.bend;
                self.vertices[mesh.origin(half) as usize].scalars.curvature += share;
                if edges_act {
                    self.edge_energies.as_flattened_mut()[half as usize] = energies[n];
                }
            }
        }
    }

    /// Energies of vertices and totals.
    fn fill_energies(&mut self, terms: &[Term]) {
        let mut ids = [0; CHUNK];
        let total = self.vertices.len();
        let mut first = 0;
        for chunk in self.vertices.chunks_mut(CHUNK) {
            let count = chunk.len();
            let (mut scalars, mut energies) = ([chunk[0].scalars; CHUNK], [0.0; CHUNK]);
            for n in 0..count {
                (ids[n], scalars[n]) = (first + n as u32, chunk[n].scalars);
            }
            let (ids, scalars) = (&ids[..count], &scalars[..count]);
            let vectors = self.vectors.get(first as usize..first as usize + count);
            let vectors = vectors.unwrap_or_default();
            for term in at(terms, &self.acting.vertices) {
                let energies = &mut energies[..count];
                let run = Vertices::Energies { total, ids, scalars, vectors, energies };
                term.potential.vertices(term, run);
            }
            for (record, energy) in chunk.iter_mut().zip(energies) {
                record.energy = energy;
            }
            first += count as u32;
        }
        self.totals_energy = self.energy_of_totals(terms, &self.totals);
    }

    /// The triangle that a half-edge is a side of.
    #[inline(always)]
    fn beside(&self, half: u32) -> &Face {
        &self.triangles[half as usize / 3].face
    }

    /// φ / l of an edge.
    #[inline(always)]
    fn bend_of(&self, half: u32) -> f64 {
        self.triangles[half as usize / 3].bends[half as usize % 3]
    }

    /// Bring what an attempt will need near: first, of the triangle that it begins with.
    #[inline(always)]
    pub fn fetch_triangle(&self, mesh: &Triangulation, half: u32) {
        let triangle = half as usize / 3;
        fetch(&mesh.triangles()[triangle]);
        fetch(&mesh.twins()[triangle]);
        fetch(&self.triangles[triangle]);
    }

    /// Then, of the other triangle and the vertices.
    #[inline(always)]
    pub fn fetch_quad(&self, mesh: &Triangulation, half: u32) {
        self.fetch_triangle(mesh, mesh.twin(half));
        fetch(&self.triangles[mesh.twin(next(half)) as usize / 3]);
        fetch(&self.triangles[mesh.twin(previous(half)) as usize / 3]);
        for half in [half, next(half), previous(half)] {
            let vertex = mesh.origin(half) as usize;
            fetch(&self.vertices[vertex]);
            fetch(&mesh.degrees()[vertex]);
        }
    }

    /// At last, of what lies around the other triangle.
    #[inline(always)]
    pub fn fetch_rest(&self, mesh: &Triangulation, half: u32) {
        let twin = mesh.twin(half);
        fetch(&self.triangles[mesh.twin(next(twin)) as usize / 3]);
        fetch(&self.triangles[mesh.twin(previous(twin)) as usize / 3]);
        let vertex = mesh.origin(previous(twin)) as usize;
        fetch(&self.vertices[vertex]);
        fetch(&mesh.degrees()[vertex]);
    }

    fn fill_vectors(&mut self, mesh: &Triangulation) {
        self.vectors.resize(self.vertices.len(), VertexVectors::default());
        let normals = self.needs.contains(Needs::NORMALS);
        for corners in mesh.triangles() {
            let points = corners.map(|vertex| self.vertices[vertex as usize].position);
            let geometry = TriangleGeometry::new(&points[0], &points[1], &points[2]);
            for k in 0..3 {
                let vertex = corners[k] as usize;
                let around = [&points[k], &points[(k + 1) % 3], &points[(k + 2) % 3]];
                let scalars = &mut self.vertices[vertex].scalars;
                add_corner(scalars, &mut self.vectors[vertex], around, &geometry, k, normals);
            }
        }
    }

    /// The square of the length, nm², that the edge kl would have.
    #[inline]
    pub fn new_length_squared(&self, quad: &Quad) -> f64 {
        let [_, _, k, l] = quad.vertices;
        (self.vertices[k as usize].position - self.vertices[l as usize].position).norm_squared()
    }

    /// What a flip would change.
    pub fn flipped(
        &self,
        mesh: &Triangulation,
        terms: &[Term],
        quad: &Quad,
        turn: Turn,
    ) -> Flipped {
        let [a, b] = quad.halves;
        let [slot_a, slot_b] = quad.triangles();
        let [i, j, k, l] = quad.vertices.map(|vertex| &self.vertices[vertex as usize].position);
        let triangles = [TriangleGeometry::new(i, l, k), TriangleGeometry::new(j, k, l)];
        let slots = match turn {
            Turn::Left => [(slot_a, a as usize % 3), (slot_b, b as usize % 3)],
            Turn::Right => [(slot_b, next(b) as usize % 3), (slot_a, next(a) as usize % 3)],
        };
        let old = [slot_a, slot_b].map(|slot| &self.triangles[slot].face);
        let old_area = 0.5 * (old[0].twice_area + old[1].twice_area);
        // The volume loses the tetrahedron ijkl where ij is convex, and gains it where ij is concave.
        let mut flipped = Flipped {
            difference: f64::NAN,
            slots,
            triangles,
            triangle_energies: [0.0; 2],
            edges: [EdgeGeometry::default(); 5],
            edge_energies: [0.0; 5],
            vertices: quad.vertices.map(|vertex| self.vertices[vertex as usize].scalars),
            vectors: [VertexVectors::default(); 4],
            vertex_energies: [0.0; 4],
            totals: Totals {
                area: self.totals.area + triangles[0].area() + triangles[1].area() - old_area,
                volume: self.totals.volume - old[0].normal.dot(&(i - l)) / 6.0,
            },
            totals_energy: self.totals_energy,
        };
        let smallest = triangles[0].twice_area.min(triangles[1].twice_area);
        if smallest <= SMALLEST_AREA || !flipped.totals.area.is_finite() {
            return flipped;
        }
        let mut difference = 0.0;
        if self.needs.contains(Needs::TOTALS) {
            flipped.totals_energy = self.energy_of_totals(terms, &flipped.totals);
            difference += flipped.totals_energy - self.totals_energy;
        }
        if self.needs.contains(Needs::TRIANGLES) {
            difference += self.triangles_of(terms, &mut flipped);
        }
        if self.needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            difference += self.edges_of(mesh, terms, quad, &mut flipped);
        }
        if self.needs.contains(Needs::VERTICES) {
            difference += self.vertices_of(terms, quad, &mut flipped);
        }
        flipped.difference = difference;
        flipped
    }

    /// Energies of I and J, less those of the triangles that they replace.
    fn triangles_of(&self, terms: &[Term], flipped: &mut Flipped) -> f64 {
        let ids = &flipped.slots.map(|(slot, _)| slot as u32);
        let (geometry, energies) = (&flipped.triangles, &mut flipped.triangle_energies);
        for term in at(terms, &self.acting.triangles) {
            let energies = &mut energies[..];
            term.potential.triangles(term, Triangles::Energies { ids, geometry, energies });
        }
        let before = flipped.slots.map(|(slot, _)| self.triangles[slot].energy);
        energies[0] + energies[1] - before[0] - before[1]
    }

    /// Bends of the five edges, and Jülicher's curvatures; the change of energies of angles.
    fn edges_of(
        &self,
        mesh: &Triangulation,
        terms: &[Term],
        quad: &Quad,
        flipped: &mut Flipped,
    ) -> f64 {
        let [a, b] = quad.halves;
        let [i, j, k, l] = quad.vertices.map(|vertex| &self.vertices[vertex as usize].position);
        let [new_i, new_j] = &flipped.triangles;
        let across = k - l;
        let rim = [previous(a), next(b), next(a), previous(b)];
        // Seen from outside the quadrilateral, the tip beyond ki and jk is l, the tip beyond il and lj is k; the
        // determinant is that of the edge's start less the tip.
        let outside = rim.map(|half| self.beside(mesh.twin(half)));
        let (face_i, face_j) = (Face::from(new_i), Face::from(new_j));
        flipped.edges = [
            edge_between(&face_i, &face_j, across.norm_squared(), k - j),
            edge_between(outside[0], &face_i, new_i.length_squared(2), across),
            edge_between(outside[1], &face_i, new_i.length_squared(0), -across),
            edge_between(outside[2], &face_j, new_j.length_squared(0), across),
            edge_between(outside[3], &face_j, new_j.length_squared(2), -across),
        ];
        let old = [a, rim[0], rim[1], rim[2], rim[3]];
        if self.needs.contains(Needs::CURVATURES) {
            let curvature = |edge: &EdgeGeometry| 0.5 * edge.bend * edge.length_squared;
            let gone = 0.5 * self.bend_of(a) * (j - i).norm_squared();
            let come = curvature(&flipped.edges[0]);
            let [ki, il, jk, lj] = std::array::from_fn(|n| {
                let edge = &flipped.edges[n + 1];
                0.5 * edge.length_squared * (edge.bend - self.bend_of(old[n + 1]))
            });
            flipped.vertices[0].curvature += ki + il - gone;
            flipped.vertices[1].curvature += jk + lj - gone;
            flipped.vertices[2].curvature += ki + jk + come;
            flipped.vertices[3].curvature += il + lj + come;
        }
        if !self.needs.contains(Needs::EDGES) {
            return 0.0;
        }
        let (geometry, energies) = (&flipped.edges, &mut flipped.edge_energies);
        for term in at(terms, &self.acting.edges) {
            let energies = &mut energies[..];
            term.potential.edges(term, Edges::Energies { geometry, energies });
        }
        let known = self.edge_energies.as_flattened();
        energies.iter().zip(old).map(|(energy, half)| energy - known[half as usize]).sum()
    }

    /// Areas and vectors of the four vertices; the change of their energies.
    fn vertices_of(&self, terms: &[Term], quad: &Quad, flipped: &mut Flipped) -> f64 {
        let [old_a, old_b] =
            quad.triangles().map(|slot| self.triangles[slot].face.twice_area / 6.0);
        let [new_i, new_j] = flipped.triangles.map(|triangle| triangle.area() / 3.0);
        flipped.vertices[0].area += new_i - old_a - old_b;
        flipped.vertices[1].area += new_j - old_a - old_b;
        flipped.vertices[2].area += new_i + new_j - old_a;
        flipped.vertices[3].area += new_i + new_j - old_b;
        let wants_vectors = self.needs.contains(Needs::VECTORS);
        if wants_vectors {
            flipped.vectors = quad.vertices.map(|vertex| self.vectors[vertex as usize]);
            let [i, j, k, l] = quad.vertices.map(|vertex| &self.vertices[vertex as usize].position);
            let (a, b) = (TriangleGeometry::new(i, j, k), TriangleGeometry::new(j, i, l));
            let [new_i, new_j] = flipped.triangles;
            // The corners of each triangle as places among i, j, k, l.
            for (geometry, corners, sign) in [
                (&a, [0, 1, 2], -1.0),
                (&b, [1, 0, 3], -1.0),
                (&new_i, [0, 3, 2], 1.0),
                (&new_j, [1, 2, 3], 1.0),
            ] {
                self.add_corners(quad, geometry, corners, sign, flipped);
            }
        }
        let vectors = if wants_vectors { &flipped.vectors[..] } else { &[] };
        let (total, ids, scalars) = (self.vertices.len(), &quad.vertices, &flipped.vertices);
        for term in at(terms, &self.acting.vertices) {
            let energies = &mut flipped.vertex_energies[..];
            let run = Vertices::Energies { total, ids, scalars, vectors, energies };
            term.potential.vertices(term, run);
        }
        let known = quad.vertices.map(|vertex| self.vertices[vertex as usize].energy);
        flipped.vertex_energies.iter().zip(known).map(|(energy, known)| energy - known).sum()
    }

    /// Add or take away what the corners of a triangle give to Voronoi areas and vectors.
    fn add_corners(
        &self,
        quad: &Quad,
        geometry: &TriangleGeometry,
        corners: [usize; 3],
        sign: f64,
        flipped: &mut Flipped,
    ) {
        let normals = self.needs.contains(Needs::NORMALS);
        let points = corners.map(|n| &self.vertices[quad.vertices[n] as usize].position);
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
        let edges_act = !self.edge_energies.is_empty();
        for (n, (slot, place)) in flipped.slots.into_iter().enumerate() {
            let record = &mut self.triangles[slot];
            record.face = Face::from(&flipped.triangles[n]);
            record.energy = flipped.triangle_energies[n];
            // The sides of I are il, lk, ki; those of J are jk, kl, lj.
            let sides = if n == 0 { [2, 0, 1] } else { [3, 0, 4] };
            for (side, edge) in sides.into_iter().enumerate() {
                let half = 3 * slot + (place + side) % 3;
                for half in [half, mesh.twin(half as u32) as usize] {
                    self.triangles[half / 3].bends[half % 3] = flipped.edges[edge].bend;
                    if edges_act {
                        self.edge_energies.as_flattened_mut()[half] = flipped.edge_energies[edge];
                    }
                }
            }
        }
        for (n, vertex) in quad.vertices.map(|vertex| vertex as usize).into_iter().enumerate() {
            self.vertices[vertex].scalars = flipped.vertices[n];
            self.vertices[vertex].energy = flipped.vertex_energies[n];
            if let Some(vectors) = self.vectors.get_mut(vertex) {
                *vectors = flipped.vectors[n];
            }
        }
        self.totals = flipped.totals;
        self.totals_energy = flipped.totals_energy;
    }
}

/// The edge of a triangle on the left and one on the right; `arm` leads from the tip of the right one to the edge.
#[inline(always)]
fn edge_between(left: &Face, right: &Face, length_squared: f64, arm: Vec3) -> EdgeGeometry {
    let cosine = left.normal.dot(&right.normal);
    let product = left.twice_area * right.twice_area;
    let bend = bend(length_squared, left.normal.dot(&arm), cosine, product);
    EdgeGeometry { length_squared, bend }
}

/// Ask for the cache lines of something that will be needed soon.
#[inline(always)]
fn fetch<T>(what: &T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch has no effect but on caches.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first = std::ptr::from_ref(what).cast::<i8>();
        _mm_prefetch::<_MM_HINT_T0>(first);
        _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(size_of::<T>() - 1));
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = what;
}
