//! What an evaluation knows of every triangle and vertex, by its index in the mesh: moves go on from there.

use crate::mesh::geometry::{Totals, TriangleGeometry, Vec3, VertexGeometry};
use crate::mesh::vertex_vectors::VertexVectors;
use crate::potentials::Needs;

/// All triangles and vertices at some positions.
#[derive(Default)]
pub struct Survey {
    /// What the terms needed.
    pub needs: Needs,
    /// All triangles.
    pub triangles: Vec<SurveyedTriangle>,
    /// All vertices.
    pub vertices: Vec<SurveyedVertex>,
    /// The vectors of all vertices; empty unless a term needs Voronoi areas or vectors.
    pub vectors: Vec<VertexVectors>,
    /// Of the whole surface, as far as terms need them.
    pub totals: Totals,
}

/// A triangle, in one cache line.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub struct SurveyedTriangle {
    /// Its geometry.
    pub geometry: TriangleGeometry,
    /// Of all terms of triangles, kJ/mol.
    pub energy: f64,
}

/// A vertex, in one cache line.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub struct SurveyedVertex {
    /// Relative to some vertex, so that a mesh far from the origin loses no digits, nm.
    pub position: Vec3,
    /// Areas and curvature, as far as terms need them.
    pub scalars: VertexGeometry,
    /// Of all terms of vertices, kJ/mol.
    pub energy: f64,
}

impl Survey {
    /// Have a place for each element.
    pub(crate) fn make_room(&mut self, needs: Needs, triangles: usize, vertices: usize) {
        self.needs = needs;
        self.triangles.resize(triangles, SurveyedTriangle::default());
        self.vertices.resize(vertices, SurveyedVertex::default());
        let vectors = if needs.contains(Needs::VECTORS) { vertices } else { 0 };
        self.vectors.resize(vectors, VertexVectors::default());
    }
}
