//! The readable reference: one number at a time, one pass for each kind of element. Of large meshes the threads of rayon
//! share the passes (`passes.rs`).

use super::checks::check_energies;
use super::passes::{Nothing, fill, fill_pair};
use crate::error::Result;
use crate::mesh::cell::{Cell, Image};
use crate::mesh::geometry::{
    EdgeGeometry, EdgePartials, EdgeTension, TotalPartials, Totals, TriangleGeometry,
    TrianglePartials, Vec3, VertexGeometry, VertexPartials, corner_forces,
};
use crate::mesh::vertex_vectors::{VertexVectors, add_corner, corner_stress};
use crate::mesh::{NONE, Topology};
use crate::potentials::{Contribution, Evaluator, Needs, Request, Term};
use nalgebra::Matrix3;
use std::ops::AddAssign;
use std::sync::Arc;

mod places;
mod terms;

use places::Places;

/// From this many triangles on, threads save more than waking them costs.
const PARALLEL_TRIANGLES: usize = 8192;

/// Evaluates any set of terms on one mesh: geometry forward, potentials, geometry backward.
///
/// Work is O(N), no memory is allocated once the buffers exist (but for a few words per pass when
/// threads take part), and the bits of the result do not depend on the number of threads.
pub struct ReferenceEvaluator {
    places: Places,
    parallel: bool,
    triangles: Vec<TriangleGeometry>,
    edges: Vec<EdgeGeometry>,
    edge_names: Vec<u32>,
    vertices: Vec<VertexGeometry>,
    /// Empty until a term needs them, as are their partials.
    vectors: Vec<VertexVectors>,
    triangle_partials: Vec<TrianglePartials>,
    edge_partials: Vec<EdgePartials>,
    vertex_partials: Vec<VertexPartials>,
    vector_partials: Vec<VertexVectors>,
    tensions: Vec<EdgeTension>,
    corner_forces: Vec<[Vec3; 3]>,
    forces: Vec<Vec3>,
    /// Which vertices are on a border; empty if there is none.
    on_border: Vec<bool>,
}

/// What the pass over the triangles sums.
struct TriangleSums {
    area: f64,
    six_volumes: f64,
    smallest: f64,
}

impl Default for TriangleSums {
    fn default() -> Self {
        Self { area: 0.0, six_volumes: 0.0, smallest: f64::INFINITY }
    }
}

impl AddAssign for TriangleSums {
    fn add_assign(&mut self, other: Self) {
        self.area += other.area;
        self.six_volumes += other.six_volumes;
        self.smallest = self.smallest.min(other.smallest);
    }
}

impl Evaluator for ReferenceEvaluator {
    fn evaluate(&mut self, request: Request) -> Result<()> {
        let Request { terms, positions, energies, forces } = request;
        let (needs, _, partials) = self.forward(terms, positions, energies)?;
        if let Some(forces) = forces {
            self.backward(needs, &partials);
            self.add_forces(forces);
        }
        Ok(())
    }
}

impl ReferenceEvaluator {
    /// Buffers for a mesh.
    pub fn new(topology: Arc<Topology>) -> Self {
        let (v, t) = (topology.num_vertices(), topology.triangles.len());
        let is_closed = topology.edges.iter().all(|edge| edge.triangles[1] != NONE);
        let on_border = (0..v).map(|vertex| topology.is_border(vertex));
        let geometry = TriangleGeometry { normal: Vec3::zeros(), twice_area: 0.0, dots: [0.0; 3] };
        Self {
            parallel: t >= PARALLEL_TRIANGLES,
            triangles: vec![geometry; t],
            edges: vec![EdgeGeometry::default(); topology.edges.len()],
            edge_names: topology.edge_names(),
            vertices: vec![VertexGeometry::default(); v],
            vectors: Vec::new(),
            triangle_partials: vec![TrianglePartials::default(); t],
            edge_partials: vec![EdgePartials::default(); topology.edges.len()],
            vertex_partials: vec![VertexPartials::default(); v],
            vector_partials: Vec::new(),
            tensions: vec![EdgeTension::default(); topology.edges.len()],
            corner_forces: vec![[Vec3::zeros(); 3]; t],
            forces: vec![Vec3::zeros(); v],
            on_border: if is_closed { Vec::new() } else { on_border.collect() },
            places: Places::new(topology),
        }
    }

    /// Let corners of triangles be images of their vertices in a periodic box, as [`Triangulation::images`] has them.
    ///
    /// [`Triangulation::images`]: crate::mesh::Triangulation::images
    pub fn set_images(&mut self, images: &[[Image; 3]], cell: &Cell) {
        self.places.set_images(images, cell);
    }

    /// The derivative of the energy with respect to a homogeneous strain of positions and periodic box, kJ/mol: with r
    /// → r + ε r it is ∂E/∂ε, the sum of −F ⊗ (r − r₀) over the corners of every triangle, r₀ being its first. What the
    /// total volume does to corners is left out there, since it does not sum to zero in a triangle; it gives
    /// (∂E/∂V) V 1.
    ///
    /// # Errors
    /// Those of [`Evaluator::evaluate`].
    pub fn virial(&mut self, terms: &[Term], positions: &[f64]) -> Result<Matrix3<f64>> {
        let (needs, totals, partials) = self.forward(terms, positions, &mut [])?;
        self.backward(needs, &TotalPartials { volume: 0.0, ..partials });
        let mut virial = Matrix3::identity() * (partials.volume * totals.volume);
        let places = &self.places;
        for (triangle, forces) in self.corner_forces.iter().enumerate() {
            let corners = places.corners(triangle);
            for k in 1..3 {
                virial -= forces[k] * (corners[k] - corners[0]).transpose();
            }
        }
        Ok(virial)
    }

    /// Geometry and potentials: what the terms need, the totals, and the energy's derivatives with respect to these.
    fn forward(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        contributions: &mut [Contribution],
    ) -> Result<(Needs, Totals, TotalPartials)> {
        let needs = terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        self.places.gather(positions, self.parallel);
        let mut totals = self.forward_triangles().ok_or_else(|| self.places.culprit(positions))?;
        if needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            totals.mean_curvature = self.forward_edges();
        }
        if needs.contains(Needs::VERTICES) {
            self.forward_vertices(needs);
        }
        if needs.contains(Needs::VECTORS) {
            self.forward_vectors(needs);
        }
        let mut ignored = vec![Contribution::default(); terms.len()];
        let contributions = if contributions.is_empty() { &mut ignored[..] } else { contributions };
        let total_partials = self.potentials(terms, needs, &totals, contributions)?;
        check_energies(terms, contributions)?;
        Ok((needs, totals, total_partials))
    }

    fn backward(&mut self, needs: Needs, totals: &TotalPartials) {
        if needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            self.backward_edges(needs, totals);
        }
        self.backward_triangles(needs, totals);
    }

    /// Fails where the mesh has no geometry: at a triangle without area, or where positions are not
    /// finite.
    fn forward_triangles(&mut self) -> Option<Totals> {
        let places = &self.places;
        let sums = fill(self.parallel, &mut self.triangles, |first, chunk| {
            let mut sums = TriangleSums::default();
            for (offset, triangle) in chunk.iter_mut().enumerate() {
                let [a, b, c] = places.corners(first + offset);
                *triangle = TriangleGeometry::new(&a, &b, &c);
                sums.area += triangle.area();
                sums.six_volumes += a.dot(&triangle.normal);
                sums.smallest = sums.smallest.min(triangle.twice_area);
            }
            sums
        });
        let (area, volume) = (sums.area, sums.six_volumes / 6.0);
        (sums.smallest > 0.0 && sums.area.is_finite()).then(|| Totals {
            area,
            volume,
            ..Totals::default()
        })
    }

    /// Returns the total mean curvature.
    fn forward_edges(&mut self) -> f64 {
        let (places, triangles) = (&self.places, &self.triangles);
        let topology = &self.places.topology;
        fill(self.parallel, &mut self.edges, |first, chunk| {
            let mut mean_curvature = 0.0;
            for (slot, edge) in chunk.iter_mut().zip(&topology.edges[first..]) {
                if edge.triangles[1] == NONE {
                    // A border has no dihedral angle.
                    let [start, end, _] = places.from(edge.triangles[0], edge.vertices[0]);
                    let length_squared = (end - start).norm_squared();
                    *slot = EdgeGeometry { length_squared, bend: 0.0 };
                    continue;
                }
                let [left, right] = edge.triangles.map(|t| &triangles[t as usize]);
                let [tip, end, start] = places.from(edge.triangles[1], edge.opposite[1]);
                *slot = EdgeGeometry::new(&start, &end, &tip, left, right);
                mean_curvature += 0.5 * slot.length_squared * slot.bend;
            }
            mean_curvature
        })
    }

    fn forward_vertices(&mut self, needs: Needs) {
        let (triangles, edges, topology) = (&self.triangles, &self.edges, &self.places.topology);
        fill(self.parallel, &mut self.vertices, |first, chunk| {
            for (offset, slot) in chunk.iter_mut().enumerate() {
                let ring = topology.ring(first + offset);
                let mut twice_area = 0.0;
                for &corner in &topology.corners[ring] {
                    twice_area += triangles[corner as usize / 3].twice_area;
                }
                let mut twice_curvature = 0.0;
                if needs.contains(Needs::CURVATURES) {
                    for &edge in &topology.vertex_edges[topology.edges_at(first + offset)] {
                        let edge = &edges[edge as usize];
                        twice_curvature += edge.length_squared * edge.bend;
                    }
                }
                *slot = VertexGeometry {
                    area: twice_area / 6.0,
                    voronoi_area: 0.0,
                    curvature: 0.5 * twice_curvature,
                };
            }
            Nothing
        });
    }

    /// Voronoi areas and vectors of the vertices, after their other geometry.
    fn forward_vectors(&mut self, needs: Needs) {
        self.vectors.resize(self.vertices.len(), VertexVectors::default());
        self.vector_partials.resize(self.vertices.len(), VertexVectors::default());
        let (places, triangles) = (&self.places, &self.triangles);
        let topology = &self.places.topology;
        let normals = needs.contains(Needs::NORMALS);
        fill_pair(
            self.parallel,
            &mut self.vertices,
            &mut self.vectors,
            |first, scalars, vectors| {
                for (offset, (vertex, vectors)) in scalars.iter_mut().zip(vectors).enumerate() {
                    *vectors = VertexVectors::default();
                    for &corner in &topology.corners[topology.ring(first + offset)] {
                        let (triangle, k) = (corner as usize / 3, corner as usize % 3);
                        let mut points = places.corners(triangle);
                        points.rotate_left(k);
                        let points = points.each_ref();
                        add_corner(vertex, vectors, points, &triangles[triangle], k, normals);
                    }
                }
                Nothing
            },
        );
    }

    fn backward_edges(&mut self, needs: Needs, totals: &TotalPartials) {
        let (edges, topology) = (&self.edges, &self.places.topology);
        let (vertex_partials, edge_partials) = (&self.vertex_partials, &self.edge_partials);
        fill(self.parallel, &mut self.tensions, |first, chunk| {
            for (offset, slot) in chunk.iter_mut().enumerate() {
                let (geometry, edge) = (&edges[first + offset], &topology.edges[first + offset]);
                *slot = EdgeTension::default();
                if needs.contains(Needs::CURVATURES | Needs::VERTICES) {
                    let [start, end] = edge.vertices.map(|v| &vertex_partials[v as usize]);
                    *slot = EdgeTension::from_curvature(geometry, start, end);
                }
                if needs.contains(Needs::MEAN_CURVATURE) && edge.triangles[1] != NONE {
                    slot.add_mean_curvature(geometry, totals.mean_curvature);
                }
                if needs.contains(Needs::EDGES) {
                    slot.add_angle(geometry, &edge_partials[first + offset]);
                }
            }
            Nothing
        });
    }

    fn backward_triangles(&mut self, needs: Needs, totals: &TotalPartials) {
        let topology = &self.places.topology;
        let (places, triangles) = (&self.places, &self.triangles);
        let (tensions, triangle_partials) = (&self.tensions, &self.triangle_partials);
        let (vertex_partials, vector_partials) = (&self.vertex_partials, &self.vector_partials);
        let by_edges = needs.intersects(Needs::EDGES | Needs::CURVATURES);
        fill(self.parallel, &mut self.corner_forces, |first, chunk| {
            for (offset, slot) in chunk.iter_mut().enumerate() {
                let triangle = first + offset;
                let geometry = &triangles[triangle];
                let vertices = topology.triangles[triangle].map(|v| v as usize);
                let corners = places.corners(triangle);
                let corners = corners.each_ref();
                let mut area = totals.area;
                let mut lengths = [0.0; 3];
                let mut edges = [EdgeTension::default(); 3];
                if needs.contains(Needs::TRIANGLES) {
                    area += triangle_partials[triangle].area;
                    lengths = triangle_partials[triangle].length_squared;
                }
                if needs.contains(Needs::VERTICES) {
                    let [a, b, c] = vertices.map(|v| vertex_partials[v].area);
                    area += (a + b + c) / 3.0;
                }
                if by_edges {
                    edges = topology.triangle_edges[triangle].map(|edge| tensions[edge as usize]);
                }
                *slot = corner_forces(corners, geometry, area, &lengths, edges, totals.volume);
                if needs.contains(Needs::VECTORS) {
                    let voronoi = vertices.map(|v| vertex_partials[v].voronoi_area);
                    let partials = vertices.map(|v| &vector_partials[v]);
                    let normals = needs.contains(Needs::NORMALS);
                    let stress = corner_stress(corners, geometry, voronoi, partials, normals);
                    for (sum, force) in slot.iter_mut().zip(stress.applied(corners, geometry)) {
                        *sum += force;
                    }
                }
            }
            Nothing
        });
        let corner_forces = self.corner_forces.as_flattened();
        fill(self.parallel, &mut self.forces, |first, chunk| {
            for (offset, slot) in chunk.iter_mut().enumerate() {
                let corners = &topology.corners[topology.ring(first + offset)];
                *slot = corners.iter().map(|&corner| corner_forces[corner as usize]).sum();
            }
            Nothing
        });
    }

    fn add_forces(&self, forces: &mut [f64]) {
        for (force, &particle) in self.forces.iter().zip(&self.places.topology.particles) {
            for (sum, part) in forces[3 * particle as usize..][..3].iter_mut().zip(force) {
                *sum += part;
            }
        }
    }
}
