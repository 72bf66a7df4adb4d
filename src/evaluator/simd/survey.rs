//! From the passes' tiles to a [`Survey`], whose elements have the order of the mesh.

use super::layout::TILE;
use super::sweep::Sweep;
use super::tiles::{Column, TriangleTile, VertexTile};
use crate::evaluator::{Survey, SurveyedTriangle, SurveyedVertex};
use crate::mesh::geometry::{TriangleGeometry, Vec3, VertexGeometry};
use crate::mesh::vertex_vectors::VertexVectors;
use crate::potentials::{Needs, Triangles, Vertices};
use crate::team::Parts;

/// A survey that several threads fill, each with the elements of its tiles.
pub struct Findings<'a> {
    triangles: Parts<'a, SurveyedTriangle>,
    vertices: Parts<'a, SurveyedVertex>,
    vectors: Parts<'a, VertexVectors>,
    has_vectors: bool,
}

impl<'a> Findings<'a> {
    /// Divide a survey that has room for all elements.
    pub fn new(survey: &'a mut Survey) -> Self {
        Self {
            has_vectors: !survey.vectors.is_empty(),
            triangles: Parts::new(&mut survey.triangles),
            vertices: Parts::new(&mut survey.vertices),
            vectors: Parts::new(&mut survey.vectors),
        }
    }
}

impl Sweep<'_, '_> {
    /// Note a tile of triangles, of which the columns are filled.
    pub fn survey_triangles(&self, index: usize, tile: &TriangleTile, findings: &Findings) {
        let range = self.layout.triangle_tile(index);
        let ids = &self.layout.triangle_ids[range.clone()];
        let mut geometry = [TriangleGeometry::default(); TILE];
        for (n, known) in geometry[..ids.len()].iter_mut().enumerate() {
            let normal = vector(self.arrays.normals.at(4 * (range.start + n)));
            let twice_area = tile.twice_area.0[n];
            let dots = three(&tile.dots, n);
            *known = TriangleGeometry { normal: normal * twice_area, twice_area, dots };
        }
        let geometry = &geometry[..ids.len()];
        let mut energies = [0.0; TILE];
        for term in self.terms {
            if term.potential.needs(term).contains(Needs::TRIANGLES) {
                let energies = &mut energies[..ids.len()];
                term.potential.triangles(term, Triangles::Energies { ids, geometry, energies });
            }
        }
        for ((&id, &geometry), energy) in ids.iter().zip(geometry).zip(energies) {
            let id = id as usize;
            // SAFETY: a triangle belongs to one tile.
            let place = unsafe { findings.triangles.part(id..id + 1) };
            place[0] = SurveyedTriangle { geometry, energy };
        }
    }

    /// Note a tile of vertices, of which the columns are filled that terms need.
    pub fn survey_vertices(&self, index: usize, tile: &VertexTile, findings: &Findings) {
        let (known, needs) = (&tile.known, self.needs);
        let range = self.layout.vertex_tile(index);
        let ids = &self.layout.vertex_ids[range.clone()];
        let count = ids.len();
        let mut scalars = [VertexGeometry::default(); TILE];
        let mut vectors = [VertexVectors::default(); TILE];
        for (n, scalars) in scalars[..count].iter_mut().enumerate() {
            scalars.area = known.area.0[n];
            if needs.contains(Needs::CURVATURES) {
                scalars.curvature = known.curvature.0[n];
            }
            if needs.contains(Needs::VECTORS) {
                scalars.voronoi_area = known.voronoi_area.0[n];
            }
        }
        if needs.contains(Needs::CURVATURE_VECTORS) {
            for (n, vectors) in vectors[..count].iter_mut().enumerate() {
                vectors.cotangent = three(&known.cotangent, n).into();
                vectors.umbrella = three(&known.umbrella, n).into();
                if needs.contains(Needs::NORMALS) {
                    vectors.normal_sum = three(&known.normal_sum, n).into();
                }
            }
        }
        let mut energies = [0.0; TILE];
        let of_terms = if findings.has_vectors { &vectors[..count] } else { &[] };
        for term in self.terms {
            if term.potential.needs(term).contains(Needs::VERTICES) {
                let (scalars, energies) = (&scalars[..count], &mut energies[..count]);
                let total = self.layout.num_vertices;
                let run = Vertices::Energies { total, ids, scalars, vectors: of_terms, energies };
                term.potential.vertices(term, run);
            }
        }
        for (n, &id) in ids.iter().enumerate() {
            let id = id as usize;
            let position = vector(self.arrays.positions.at(4 * (range.start + n)));
            let found = SurveyedVertex { position, scalars: scalars[n], energy: energies[n] };
            // SAFETY: a vertex belongs to one tile.
            unsafe {
                findings.vertices.part(id..id + 1)[0] = found;
                if findings.has_vectors {
                    findings.vectors.part(id..id + 1)[0] = vectors[n];
                }
            }
        }
    }
}

fn three(columns: &[Column; 3], index: usize) -> [f64; 3] {
    columns.each_ref().map(|column| column.0[index])
}

/// The first three numbers of a record.
fn vector(record: *const f64) -> Vec3 {
    // SAFETY: callers give a record of positions or normals, which a pass has written before.
    let [x, y, z] = unsafe { *record.cast::<[f64; 3]>() };
    Vec3::new(x, y, z)
}
