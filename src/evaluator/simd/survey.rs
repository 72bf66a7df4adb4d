//! From the passes' tiles to a [`Survey`], whose elements have the order of the mesh.

use super::sweep::Sweep;
use crate::evaluator::{Survey, SurveyedTriangle, SurveyedVertex};
use crate::lanes::tiles::{Column, TriangleTile, VertexTile};
use crate::mesh::geometry::{TriangleGeometry, Vec3, VertexGeometry};
use crate::mesh::vertex_vectors::VertexVectors;
use crate::potentials::Needs;
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
    /// Note a tile of triangles, of which the columns are filled, with the energies of its potentials.
    pub fn survey_triangles(&self, index: usize, tile: &TriangleTile, findings: &Findings) {
        let range = self.layout.triangle_tile(index);
        let ids = &self.layout.triangle_ids[range.clone()];
        for (n, &id) in ids.iter().enumerate() {
            let normal = vector(self.arrays.normals.at(4 * (range.start + n)));
            let (twice_area, dots) = (tile.twice_area.0[n], three(&tile.dots, n));
            let geometry = TriangleGeometry { normal: normal * twice_area, twice_area, dots };
            // SAFETY: a triangle belongs to one tile.
            let place = unsafe { findings.triangles.part(id as usize..id as usize + 1) };
            place[0] = SurveyedTriangle { geometry, energy: tile.energies.sum.0[n] };
        }
    }

    /// Note a tile of vertices, of which the columns are filled that terms need, with the energies of its potentials.
    pub fn survey_vertices(&self, index: usize, tile: &VertexTile, findings: &Findings) {
        let (known, needs) = (&tile.known, self.needs);
        let range = self.layout.vertex_tile(index);
        let ids = &self.layout.vertex_ids[range.clone()];
        let has = |what| needs.contains(what);
        for (n, &id) in ids.iter().enumerate() {
            let scalars = VertexGeometry {
                area: known.area.0[n],
                voronoi_area: if has(Needs::VORONOI_AREAS) { known.voronoi_area.0[n] } else { 0.0 },
                curvature: if has(Needs::CURVATURES) { known.curvature.0[n] } else { 0.0 },
            };
            let position = vector(self.arrays.positions.at(4 * (range.start + n)));
            let id = id as usize;
            // SAFETY: a vertex belongs to one tile.
            let place = unsafe { findings.vertices.part(id..id + 1) };
            place[0] = SurveyedVertex { position, scalars, energy: tile.energies.sum.0[n] };
        }
        if !findings.has_vectors {
            return;
        }
        for (n, &id) in ids.iter().enumerate() {
            let mut vectors = VertexVectors::default();
            if has(Needs::COTANGENTS) {
                vectors.cotangent = three(&known.cotangent, n).into();
            }
            if has(Needs::UMBRELLAS) {
                vectors.umbrella = three(&known.umbrella, n).into();
            }
            if has(Needs::NORMALS) {
                vectors.normal_sum = three(&known.normal_sum, n).into();
            }
            // SAFETY: as above.
            unsafe { findings.vectors.part(id as usize..id as usize + 1)[0] = vectors };
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
