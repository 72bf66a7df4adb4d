//! The readable reference: plain scalar code, one pass for each kind of element.

use super::checks::{check_energies, culprit};
use super::passes::{Nothing, fill, fill_pair};
use crate::error::Result;
use crate::mesh::cell::{Cell, Image};
use crate::mesh::geometry::{
    EdgeGeometry, EdgePartials, EdgeTension, TotalPartials, Totals, TriangleGeometry,
    TrianglePartials, Vec3, VertexGeometry, VertexPartials, corner_forces,
};
use crate::mesh::vertex_vectors::{VertexVectors, add_corner, corner_stress};
use crate::mesh::{NONE, Topology};
use crate::potentials::{Contribution, Edges, Needs, Term, Triangles, Vertices};
use std::ops::AddAssign;
use std::sync::Arc;

/// From this many triangles on, threads save more than waking them costs.
const PARALLEL_TRIANGLES: usize = 8192;

/// Evaluates any set of terms on one mesh: geometry forward, potentials, geometry backward.
///
/// Work is O(N), no memory is allocated once the buffers exist (but for a few words per pass when
/// threads take part), and the bits of the result do not depend on the number of threads.
pub struct ReferenceEvaluator {
    topology: Arc<Topology>,
    parallel: bool,
    /// Relative to the first vertex, so that a mesh far from the origin loses no digits.
    positions: Vec<Vec3>,
    /// How far corners of triangles are from their vertices where the mesh spans a periodic box; otherwise empty.
    shifts: Vec<[Vec3; 3]>,
    triangles: Vec<TriangleGeometry>,
    edges: Vec<EdgeGeometry>,
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

/// Where the corners of triangles are.
struct Places<'a> {
    topology: &'a Topology,
    positions: &'a [Vec3],
    shifts: &'a [[Vec3; 3]],
}

/// A macro, since passes write to other fields meanwhile.
macro_rules! places {
    ($evaluator:ident) => {
        Places {
            topology: &$evaluator.topology,
            positions: &$evaluator.positions,
            shifts: &$evaluator.shifts,
        }
    };
}

impl Places<'_> {
    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        let corners = self.topology.triangles[triangle].map(|v| self.positions[v as usize]);
        match self.shifts.get(triangle) {
            None => corners,
            Some(shifts) => std::array::from_fn(|k| corners[k] + shifts[k]),
        }
    }

    /// The corners, beginning with that of a vertex.
    fn from(&self, triangle: u32, vertex: u32) -> [Vec3; 3] {
        let mut corners = self.corners(triangle as usize);
        let vertices = self.topology.triangles[triangle as usize];
        corners.rotate_left(vertices.iter().position(|v| *v == vertex).unwrap_or(0));
        corners
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
            positions: vec![Vec3::zeros(); v],
            shifts: Vec::new(),
            triangles: vec![geometry; t],
            edges: vec![EdgeGeometry::default(); topology.edges.len()],
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
            topology,
        }
    }

    /// Let corners of triangles be images of their vertices in a periodic box, as [`Triangulation::images`] has them.
    ///
    /// [`Triangulation::images`]: crate::mesh::Triangulation::images
    pub fn set_images(&mut self, images: &[[Image; 3]], cell: &Cell) {
        self.shifts = images.iter().map(|images| images.map(|image| cell.shift(image))).collect();
    }

    /// As [`super::CpuEvaluator::evaluate`].
    pub fn evaluate(
        &mut self,
        terms: &[&Term],
        positions: &[f64],
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
    ) -> Result<()> {
        let needs = terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        self.gather_positions(positions);
        let totals = self.forward_triangles().ok_or_else(|| {
            let topology = &self.topology;
            let triangles = (0..topology.triangles.len()).map(|triangle| {
                let shifts = self.shifts.get(triangle).copied().unwrap_or_default();
                let particles = topology.particles_of(triangle);
                std::array::from_fn(|k| (particles[k], shifts[k]))
            });
            culprit(&topology.particles, triangles, positions)
        })?;
        if needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            self.forward_edges();
        }
        if needs.contains(Needs::VERTICES) {
            self.forward_vertices(needs);
        }
        if needs.contains(Needs::VECTORS) {
            self.forward_vectors(needs);
        }
        let mut ignored = vec![Contribution::default(); terms.len()];
        let contributions = if contributions.is_empty() { &mut ignored[..] } else { contributions };
        let total_partials = self.potentials(terms, needs, &totals, contributions);
        check_energies(terms, contributions)?;
        if let Some(forces) = forces {
            if needs.intersects(Needs::EDGES | Needs::CURVATURES) {
                self.backward_edges(needs);
            }
            self.backward_triangles(needs, &total_partials);
            self.add_forces(forces);
        }
        Ok(())
    }

    fn gather_positions(&mut self, all: &[f64]) {
        let particles = &self.topology.particles;
        let position = |particle: u32| Vec3::from_column_slice(&all[3 * particle as usize..][..3]);
        let origin = position(particles[0]);
        fill(self.parallel, &mut self.positions, |first, chunk| {
            for (slot, &particle) in chunk.iter_mut().zip(&particles[first..]) {
                *slot = position(particle) - origin;
            }
            Nothing
        });
    }

    /// Fails where the mesh has no geometry: at a triangle without area, or where positions are not
    /// finite.
    fn forward_triangles(&mut self) -> Option<Totals> {
        let places = places!(self);
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
        (sums.smallest > 0.0 && sums.area.is_finite())
            .then(|| Totals { area: sums.area, volume: sums.six_volumes / 6.0 })
    }

    fn forward_edges(&mut self) {
        let (places, triangles) = (places!(self), &self.triangles);
        let topology = &self.topology;
        fill(self.parallel, &mut self.edges, |first, chunk| {
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
            }
            Nothing
        });
    }

    fn forward_vertices(&mut self, needs: Needs) {
        let (triangles, edges, topology) = (&self.triangles, &self.edges, &self.topology);
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
        let (places, triangles) = (places!(self), &self.triangles);
        let topology = &self.topology;
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

    /// Let every term add its energy and its partial derivatives.
    fn potentials(
        &mut self,
        terms: &[&Term],
        needs: Needs,
        totals: &Totals,
        contributions: &mut [Contribution],
    ) -> TotalPartials {
        let mut total_partials = TotalPartials::default();
        if needs.contains(Needs::TRIANGLES) {
            self.triangle_partials.fill(TrianglePartials::default());
        }
        if needs.contains(Needs::EDGES) {
            self.edge_partials.fill(EdgePartials::default());
        }
        if needs.contains(Needs::VERTICES) {
            self.vertex_partials.fill(VertexPartials::default());
        }
        if needs.contains(Needs::VECTORS) {
            self.vector_partials.fill(VertexVectors::default());
        }
        for (&term, contribution) in terms.iter().zip(contributions) {
            let (potential, needs) = (term.potential, term.potential.needs(term));
            *contribution = Contribution::default();
            if needs.contains(Needs::TOTALS) {
                *contribution += potential.totals(term, totals, &mut total_partials);
            }
            if needs.contains(Needs::TRIANGLES) {
                let triangles = &self.triangles;
                *contribution +=
                    fill(self.parallel, &mut self.triangle_partials, |first, chunk| {
                        let geometry = &triangles[first..][..chunk.len()];
                        let partials = chunk;
                        potential.triangles(term, Triangles::Plain { first, geometry, partials })
                    });
            }
            if needs.contains(Needs::EDGES) {
                let edges = &self.edges;
                *contribution += fill(self.parallel, &mut self.edge_partials, |first, chunk| {
                    let geometry = &edges[first..][..chunk.len()];
                    potential.edges(term, Edges::Plain { geometry, partials: chunk })
                });
            }
            if needs.contains(Needs::VERTICES) {
                *contribution += self.potential_of_vertices(term, needs);
            }
        }
        total_partials
    }

    fn potential_of_vertices(&mut self, term: &Term, needs: Needs) -> Contribution {
        let (vertices, all_vectors) = (&self.vertices, &self.vectors);
        let wants_vectors = needs.contains(Needs::VECTORS);
        let left_out = if term.potential.acts_at_borders() { &[] } else { &self.on_border[..] };
        let beside: &mut [_] = if wants_vectors { &mut self.vector_partials } else { &mut [] };
        fill_pair(self.parallel, &mut self.vertex_partials, beside, |first, scalars, vectors| {
            let here = first..first + scalars.len();
            let known: &[_] = if wants_vectors { &all_vectors[here.clone()] } else { &[] };
            let run = Vertices::Plain {
                first,
                total: vertices.len(),
                left_out: left_out.get(here.clone()).unwrap_or_default(),
                scalars: &vertices[here],
                vectors: known,
                scalar_partials: scalars,
                vector_partials: vectors,
            };
            term.potential.vertices(term, run)
        })
    }

    fn backward_edges(&mut self, needs: Needs) {
        let (edges, topology) = (&self.edges, &self.topology);
        let (vertex_partials, edge_partials) = (&self.vertex_partials, &self.edge_partials);
        fill(self.parallel, &mut self.tensions, |first, chunk| {
            for (offset, slot) in chunk.iter_mut().enumerate() {
                let (geometry, edge) = (&edges[first + offset], &topology.edges[first + offset]);
                *slot = EdgeTension::default();
                if needs.contains(Needs::CURVATURES) {
                    let [start, end] = edge.vertices.map(|v| &vertex_partials[v as usize]);
                    *slot = EdgeTension::from_curvature(geometry, start, end);
                }
                if needs.contains(Needs::EDGES) {
                    slot.add_angle(geometry, &edge_partials[first + offset]);
                }
            }
            Nothing
        });
    }

    fn backward_triangles(&mut self, needs: Needs, totals: &TotalPartials) {
        let topology = &self.topology;
        let (places, triangles) = (places!(self), &self.triangles);
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
        for (force, &particle) in self.forces.iter().zip(&self.topology.particles) {
            for (sum, part) in forces[3 * particle as usize..][..3].iter_mut().zip(force) {
                *sum += part;
            }
        }
    }
}
