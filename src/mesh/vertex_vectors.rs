//! Vector-valued quantities of a vertex: the curvature vectors and the normal.
//!
//! Each is a sum over the corners at the vertex. The corner of vertex a in a triangle a, b, c with
//! normal N, unit normal n, area t and angles α, β, γ gives
//!
//! - S, the curvature vector of Itzykson and of Gompper and Kroll (B7), ½ n × (c − b), which is the
//!   gradient of the triangle's area and equals ½ [cot γ (a − b) + cot β (a − c)];
//! - Voronoi's area a_V (B8), ⅛ [l²_ab cot γ + l²_ac cot β], which can be negative at obtuse angles;
//! - the umbrella vector of Espriu, (2a − b − c) / (2√3): S of a mesh of equilateral triangles;
//! - the normal sum (B9 before normalisation), α n.

use super::geometry::{EdgeTension, TriangleGeometry, Vec3, VertexGeometry, corner_forces};

/// 1/√3, the cotangent of 60°.
pub const COT_60: f64 = 0.577_350_269_189_625_8;

/// Forward: the vectors of one vertex. Backward: derivatives of the energy with respect to them.
#[derive(Debug, Clone, Copy)]
pub struct VertexVectors {
    /// S = Σ_j (cot θ₁ + cot θ₂)(r_i − r_j) / 2, nm; points outward where the surface is convex.
    pub cotangent: Vec3,
    /// Σ_j (r_i − r_j) / √3, nm.
    pub umbrella: Vec3,
    /// Σ_t α_t n_t; the vertex normal is this divided by its length.
    pub normal_sum: Vec3,
}

impl Default for VertexVectors {
    fn default() -> Self {
        Self { cotangent: Vec3::zeros(), umbrella: Vec3::zeros(), normal_sum: Vec3::zeros() }
    }
}

/// Add what a corner gives to the Voronoi area and the vectors of its vertex; `corners` starts with
/// the vertex, `k` is its place in the triangle. The normal sum costs an arc tangent, so it is optional.
#[inline]
pub fn add_corner(
    vertex: &mut VertexGeometry,
    vectors: &mut VertexVectors,
    [a, b, c]: [&Vec3; 3],
    triangle: &TriangleGeometry,
    k: usize,
    normals: bool,
) {
    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
    let inverse = 1.0 / triangle.twice_area;
    vectors.cotangent += triangle.normal.cross(&(c - b)) * (0.5 * inverse);
    vectors.umbrella += (2.0 * a - b - c) * (0.5 * COT_60);
    let (ab, ca) = (triangle.length_squared(k), triangle.length_squared(last));
    vertex.voronoi_area += 0.125 * inverse * (ab * triangle.dots[last] + ca * triangle.dots[next]);
    if normals {
        let angle = triangle.twice_area.atan2(triangle.dots[k]);
        vectors.normal_sum += triangle.normal * (angle * inverse);
    }
}

/// What the vectors and Voronoi areas of a triangle's three vertices pass on to its corners.
#[derive(Debug, Clone, Copy, Default)]
pub struct CornerStress {
    /// ∂E/∂(area of the triangle), kJ/mol/nm².
    pub area: f64,
    /// ∂E/∂l² of each side, kJ/mol/nm².
    pub length_squared: [f64; 3],
    /// The gradient along the triangle's normal N at each corner, kJ/mol/nm³.
    pub pressure: [f64; 3],
    /// Forces on the corners that are not along sides or normal, kJ/mol/nm.
    pub forces: [Vec3; 3],
}

impl CornerStress {
    /// The forces on the corners of the triangle, without those of its edges' angles and of the volume.
    pub fn applied(&self, corners: [&Vec3; 3], triangle: &TriangleGeometry) -> [Vec3; 3] {
        let edges = [EdgeTension::default(); 3];
        let mut forces =
            corner_forces(corners, triangle, self.area, &self.length_squared, edges, 0.0);
        for k in 0..3 {
            forces[k] += self.forces[k] - triangle.normal * self.pressure[k];
        }
        forces
    }
}

/// The chain rule from the derivatives with respect to Voronoi areas (`voronoi`) and vectors of the
/// three vertices, which are constants here, to the triangle.
///
/// With g = ∂E/∂S and v = ∂E/∂a_V the triangle's share of the energy is
/// Σ_sides cot(opposite angle) [ ½ (g_i − g_j)·(r_i − r_j) + ⅛ (v_i + v_j) l² ]; each named part below
/// is one factor's derivative.
pub fn corner_stress(
    corners: [&Vec3; 3],
    triangle: &TriangleGeometry,
    voronoi: [f64; 3],
    partials: [&VertexVectors; 3],
    normals: bool,
) -> CornerStress {
    let mut stress = CornerStress::default();
    let inverse = 1.0 / triangle.twice_area;
    let cotangent = triangle.dots.map(|dot| dot * inverse);
    let next = |k: usize| (k + 1) % 3;
    let last = |k: usize| (k + 2) % 3;

    for k in 0..3 {
        let (here, there, opposite) = (k, next(k), last(k));
        let difference = partials[here].cotangent - partials[there].cotangent;
        // The explicit r_i − r_j.
        let pull = difference * (0.5 * cotangent[opposite]);
        stress.forces[here] -= pull;
        stress.forces[there] += pull;
        // The explicit l² of Voronoi's area.
        let mean = 0.125 * (voronoi[here] + voronoi[there]);
        stress.length_squared[k] += mean * cotangent[opposite];
        // The cotangent, (l²₁ + l²₂ − l²₃) / 4t with l₃ the side opposite its angle.
        let by_cotangent = 0.5 * difference.dot(&(corners[here] - corners[there]))
            + mean * triangle.length_squared(k);
        let by_length = 0.5 * inverse * by_cotangent;
        stress.length_squared[next(k)] += by_length;
        stress.length_squared[last(k)] += by_length;
        stress.length_squared[k] -= by_length;
        stress.area -= 2.0 * inverse * by_cotangent * cotangent[opposite];
        // The umbrella vector is linear in the positions.
        let umbrella =
            2.0 * partials[k].umbrella - partials[next(k)].umbrella - partials[last(k)].umbrella;
        stress.forces[k] -= umbrella * (0.5 * COT_60);
    }
    if normals {
        add_normal_stress(&mut stress, corners, triangle, partials);
    }
    stress
}

/// The part of [`corner_stress`] from the normal sums: their angles and their unit normals.
fn add_normal_stress(
    stress: &mut CornerStress,
    corners: [&Vec3; 3],
    triangle: &TriangleGeometry,
    partials: [&VertexVectors; 3],
) {
    let inverse = 1.0 / triangle.twice_area;
    let mut weighted = Vec3::zeros();
    for k in 0..3 {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        let dot = triangle.dots[k];
        weighted += partials[k].normal_sum * triangle.twice_area.atan2(dot);
        // The angle is that of (d, |N|), and d² + |N|² is the product of the squared sides at it.
        let product = triangle.length_squared(k) * triangle.length_squared(last);
        let by_angle = partials[k].normal_sum.dot(&triangle.normal) * inverse / product;
        stress.area += 2.0 * by_angle * dot;
        let by_length = 0.5 * by_angle * triangle.twice_area;
        stress.length_squared[k] -= by_length;
        stress.length_squared[last] -= by_length;
        stress.length_squared[next] += by_length;
    }
    // A unit normal turns only: n's gradient at a corner, times a constant vector, is along n.
    for k in 0..3 {
        let side = corners[(k + 1) % 3] - corners[(k + 2) % 3];
        stress.pressure[k] +=
            triangle.normal.dot(&side.cross(&weighted)) * inverse * inverse * inverse;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::noise;

    /// The share of one triangle in Σ g·S + v a_V + u·U + h·(α n), with constant g, v, u, h.
    fn share(points: &[Vec3; 3], voronoi: [f64; 3], partials: &[VertexVectors; 3]) -> f64 {
        let triangle = TriangleGeometry::new(&points[0], &points[1], &points[2]);
        (0..3)
            .map(|k| {
                let (mut vertex, mut vectors) =
                    (VertexGeometry::default(), VertexVectors::default());
                let corners = [k, (k + 1) % 3, (k + 2) % 3].map(|i| &points[i]);
                add_corner(&mut vertex, &mut vectors, corners, &triangle, k, true);
                voronoi[k] * vertex.voronoi_area
                    + partials[k].cotangent.dot(&vectors.cotangent)
                    + partials[k].umbrella.dot(&vectors.umbrella)
                    + partials[k].normal_sum.dot(&vectors.normal_sum)
            })
            .sum()
    }

    #[test]
    fn corner_stress_is_minus_the_gradient() {
        let mut random = noise(11);
        let mut vector = || Vec3::new(random(), random(), random());
        for _ in 0..5 {
            let points: [Vec3; 3] = std::array::from_fn(|_| vector());
            let partials: [VertexVectors; 3] = std::array::from_fn(|_| VertexVectors {
                cotangent: vector(),
                umbrella: vector(),
                normal_sum: vector(),
            });
            let voronoi = [0.3, -0.8, 0.5];
            let [a, b, c] = &points;
            let triangle = TriangleGeometry::new(a, b, c);
            let stress = corner_stress([a, b, c], &triangle, voronoi, partials.each_ref(), true);
            let forces = stress.applied([a, b, c], &triangle);
            for k in 0..3 {
                for axis in 0..3 {
                    let step = 1e-5;
                    let at = |shift: f64| {
                        let mut moved = points;
                        moved[k][axis] += shift;
                        share(&moved, voronoi, &partials)
                    };
                    let expected = -(at(step) - at(-step)) / (2.0 * step);
                    let error = (forces[k][axis] - expected).abs();
                    assert!(error < 1e-6 * expected.abs().max(1.0), "{k} {axis}: {error}");
                }
            }
        }
    }

    #[test]
    fn equilateral_triangles_have_one_curvature_vector() {
        let points = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.5, 0.75f64.sqrt(), 0.0),
        ];
        let triangle = TriangleGeometry::new(&points[0], &points[1], &points[2]);
        let (mut vertex, mut vectors) = (VertexGeometry::default(), VertexVectors::default());
        add_corner(&mut vertex, &mut vectors, points.each_ref(), &triangle, 0, true);
        assert!((vectors.cotangent - vectors.umbrella).norm() < 1e-15);
        assert!((vertex.voronoi_area - triangle.area() / 3.0).abs() < 1e-15);
        assert!((vectors.normal_sum.z - std::f64::consts::FRAC_PI_3).abs() < 1e-15);
    }
}
