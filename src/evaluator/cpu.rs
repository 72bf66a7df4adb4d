//! The double-precision evaluator on the processor.

use super::passes::{Nothing, fill};
use crate::error::{Error, Result};
use crate::mesh::Topology;
use crate::mesh::geometry::{
    EdgeGeometry, EdgeTension, TotalPartials, Totals, TriangleGeometry, TrianglePartials, Vec3,
    VertexGeometry, VertexPartials, corner_forces,
};
use crate::potentials::{Contribution, Stages, Term};
use std::ops::AddAssign;
use std::sync::Arc;

/// From this many triangles on, threads save more than waking them costs.
const PARALLEL_TRIANGLES: usize = 8192;

/// Evaluates any set of terms on one mesh: geometry forward, potentials, geometry backward.
///
/// Work is O(N), no memory is allocated once the buffers exist (but for a few words per pass when
/// threads take part), and the bits of the result do not depend on the number of threads.
pub struct CpuEvaluator {
    topology: Arc<Topology>,
    parallel: bool,
    /// Relative to the first vertex, so that a mesh far from the origin loses no digits.
    positions: Vec<Vec3>,
    triangles: Vec<TriangleGeometry>,
    edges: Vec<EdgeGeometry>,
    vertices: Vec<VertexGeometry>,
    triangle_partials: Vec<TrianglePartials>,
    vertex_partials: Vec<VertexPartials>,
    tensions: Vec<EdgeTension>,
    corner_forces: Vec<[Vec3; 3]>,
    forces: Vec<Vec3>,
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

impl CpuEvaluator {
    /// Buffers for a mesh.
    pub fn new(topology: Arc<Topology>) -> Self {
        let (v, t) = (topology.num_vertices(), topology.triangles.len());
        let geometry = TriangleGeometry { normal: Vec3::zeros(), twice_area: 0.0, dots: [0.0; 3] };
        Self {
            parallel: t >= PARALLEL_TRIANGLES,
            positions: vec![Vec3::zeros(); v],
            triangles: vec![geometry; t],
            edges: vec![EdgeGeometry::default(); topology.edges.len()],
            vertices: vec![VertexGeometry::default(); v],
            triangle_partials: vec![TrianglePartials::default(); t],
            vertex_partials: vec![VertexPartials::default(); v],
            tensions: vec![EdgeTension::default(); topology.edges.len()],
            corner_forces: vec![[Vec3::zeros(); 3]; t],
            forces: vec![Vec3::zeros(); v],
            topology,
        }
    }

    /// Evaluate terms at the positions of all particles, x y z of one after the other, nm.
    ///
    /// `contributions` gets the energy of each term; forces, if wanted, are **added**, kJ/mol/nm, in
    /// the layout of the positions.
    ///
    /// # Errors
    /// A position of the mesh that is not finite; a triangle without area; an energy that overflows.
    /// Nothing has been added to the forces then.
    pub fn evaluate<'a>(
        &mut self,
        terms: impl Iterator<Item = &'a Term> + Clone,
        positions: &[f64],
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
    ) -> Result<()> {
        let stages =
            terms.clone().fold(Stages::empty(), |all, term| all | term.potential.stages(term.form));
        self.gather_positions(positions);
        let totals = self.forward_triangles().ok_or_else(|| self.culprit(positions))?;
        if stages.contains(Stages::VERTICES) {
            self.forward_edges();
            self.forward_vertices();
        }
        let total_partials = self.potentials(terms, stages, &totals, contributions);
        let energy = contributions.iter().map(|part| part.energy).sum::<f64>();
        if !energy.is_finite() {
            return Err(Error::NonFiniteEnergy { energy });
        }
        if let Some(forces) = forces {
            if stages.contains(Stages::VERTICES) {
                self.backward_edges();
            }
            self.backward_triangles(stages, &total_partials);
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
        let (positions, topology) = (&self.positions, &self.topology);
        let sums = fill(self.parallel, &mut self.triangles, |first, chunk| {
            let mut sums = TriangleSums::default();
            for (triangle, corners) in chunk.iter_mut().zip(&topology.triangles[first..]) {
                let [a, b, c] = corners.map(|v| &positions[v as usize]);
                *triangle = TriangleGeometry::new(a, b, c);
                sums.area += triangle.area();
                sums.six_volumes += a.dot(&triangle.normal);
                sums.smallest = sums.smallest.min(triangle.twice_area);
            }
            sums
        });
        (sums.smallest > 0.0 && sums.area.is_finite())
            .then(|| Totals { area: sums.area, volume: sums.six_volumes / 6.0 })
    }

    /// Why the geometry of the triangles is not usable.
    fn culprit(&self, positions: &[f64]) -> Error {
        let topology = &self.topology;
        for &particle in &topology.particles {
            let position = std::array::from_fn(|axis| positions[3 * particle as usize + axis]);
            if !position.iter().all(|x: &f64| x.is_finite()) {
                return Error::NonFinitePosition { particle, position };
            }
        }
        let bad = |t: &TriangleGeometry| !(t.twice_area > 0.0 && t.twice_area.is_finite());
        let triangle = self.triangles.iter().position(bad).unwrap_or(0);
        Error::DegenerateTriangle { triangle, corners: topology.particles_of(triangle) }
    }

    fn forward_edges(&mut self) {
        let (positions, triangles) = (&self.positions, &self.triangles);
        let topology = &self.topology;
        fill(self.parallel, &mut self.edges, |first, chunk| {
            for (slot, edge) in chunk.iter_mut().zip(&topology.edges[first..]) {
                let [start, end] = edge.vertices.map(|v| &positions[v as usize]);
                let [left, right] = edge.triangles.map(|t| &triangles[t as usize]);
                let right_tip = &positions[edge.opposite[1] as usize];
                *slot = EdgeGeometry::new(start, end, right_tip, left, right);
            }
            Nothing
        });
    }

    fn forward_vertices(&mut self) {
        let (triangles, edges, topology) = (&self.triangles, &self.edges, &self.topology);
        fill(self.parallel, &mut self.vertices, |first, chunk| {
            for (offset, slot) in chunk.iter_mut().enumerate() {
                let ring = topology.ring(first + offset);
                let mut twice_area = 0.0;
                for &corner in &topology.corners[ring.clone()] {
                    twice_area += triangles[corner as usize / 3].twice_area;
                }
                let mut twice_curvature = 0.0;
                for &edge in &topology.vertex_edges[ring] {
                    let edge = &edges[edge as usize];
                    twice_curvature += edge.length_squared * edge.bend;
                }
                *slot = VertexGeometry { area: twice_area / 6.0, curvature: 0.5 * twice_curvature };
            }
            Nothing
        });
    }

    /// Let every term add its energy and its partial derivatives.
    fn potentials<'a>(
        &mut self,
        terms: impl Iterator<Item = &'a Term>,
        stages: Stages,
        totals: &Totals,
        contributions: &mut [Contribution],
    ) -> TotalPartials {
        let mut total_partials = TotalPartials::default();
        if stages.contains(Stages::TRIANGLES) {
            self.triangle_partials.fill(TrianglePartials::default());
        }
        if stages.contains(Stages::VERTICES) {
            self.vertex_partials.fill(VertexPartials::default());
        }
        for (term, contribution) in terms.zip(contributions) {
            let (potential, stages) = (term.potential, term.potential.stages(term.form));
            *contribution = Contribution::default();
            if stages.contains(Stages::TOTALS) {
                *contribution += potential.totals(term, totals, &mut total_partials);
            }
            if stages.contains(Stages::TRIANGLES) {
                let triangles = &self.triangles;
                *contribution +=
                    fill(self.parallel, &mut self.triangle_partials, |first, chunk| {
                        potential.triangles(term, &triangles[first..][..chunk.len()], chunk)
                    });
            }
            if stages.contains(Stages::VERTICES) {
                let vertices = &self.vertices;
                *contribution += fill(self.parallel, &mut self.vertex_partials, |first, chunk| {
                    potential.vertices(term, &vertices[first..][..chunk.len()], chunk)
                });
            }
        }
        total_partials
    }

    fn backward_edges(&mut self) {
        let (edges, partials, topology) = (&self.edges, &self.vertex_partials, &self.topology);
        fill(self.parallel, &mut self.tensions, |first, chunk| {
            let here = edges[first..].iter().zip(&topology.edges[first..]);
            for (slot, (geometry, edge)) in chunk.iter_mut().zip(here) {
                let [start, end] = edge.vertices.map(|v| &partials[v as usize]);
                *slot = EdgeTension::from_curvature(geometry, start, end);
            }
            Nothing
        });
    }

    fn backward_triangles(&mut self, stages: Stages, totals: &TotalPartials) {
        let topology = &self.topology;
        let (positions, triangles) = (&self.positions, &self.triangles);
        let (tensions, triangle_partials) = (&self.tensions, &self.triangle_partials);
        let vertex_partials = &self.vertex_partials;
        let by_vertices = stages.contains(Stages::VERTICES);
        let by_triangles = stages.contains(Stages::TRIANGLES);
        fill(self.parallel, &mut self.corner_forces, |first, chunk| {
            for (offset, slot) in chunk.iter_mut().enumerate() {
                let triangle = first + offset;
                let corners = topology.triangles[triangle];
                let mut area = totals.area;
                let mut lengths = [0.0; 3];
                let mut edges = [EdgeTension::default(); 3];
                if by_triangles {
                    area += triangle_partials[triangle].area;
                    lengths = triangle_partials[triangle].length_squared;
                }
                if by_vertices {
                    let [a, b, c] = corners.map(|v| vertex_partials[v as usize].area);
                    area += (a + b + c) / 3.0;
                    edges = topology.triangle_edges[triangle].map(|edge| tensions[edge as usize]);
                }
                *slot = corner_forces(
                    corners.map(|v| &positions[v as usize]),
                    &triangles[triangle],
                    area,
                    &lengths,
                    edges,
                    totals.volume,
                );
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
