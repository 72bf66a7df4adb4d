//! Geometry of a triangulated surface, forward (quantities) and backward (forces).
//!
//! Signs, once for the whole crate: triangles run counter-clockwise seen from outside; normals point
//! outward; a dihedral angle φ is 0 when flat, positive at a convex edge, negative at a concave one;
//! curvature is the sum of the principal curvatures, positive on a sphere.
//!
//! Everything here is a scalar function of one triangle, one edge or one vertex; which of them are
//! evaluated, in which order and on how many threads is the evaluator's business.

#[cfg(test)]
mod tests;

use crate::real::Real;
use nalgebra::Vector3;

/// A vector in space.
pub type Vec3 = Vector3<f64>;

/// Forward geometry of one triangle with corners a, b, c.
#[derive(Debug, Clone, Copy, Default)]
pub struct TriangleGeometry {
    /// N = (b − a) × (c − a), nm².
    pub normal: Vec3,
    /// |N|, twice the area, nm².
    pub twice_area: f64,
    /// At each corner the scalar product of the two sides that leave it, nm². The cotangent of the
    /// corner's angle is this over |N|; the squared length of a side is the sum of those at its ends.
    pub dots: [f64; 3],
}

impl TriangleGeometry {
    /// From the positions of the corners.
    #[inline]
    pub fn new(a: &Vec3, b: &Vec3, c: &Vec3) -> Self {
        let (ab, bc, ca) = (b - a, c - b, a - c);
        let normal = ca.cross(&ab);
        Self { normal, twice_area: normal.norm(), dots: [-ca.dot(&ab), -ab.dot(&bc), -bc.dot(&ca)] }
    }

    /// Area, nm².
    #[inline]
    pub fn area(&self) -> f64 {
        0.5 * self.twice_area
    }

    /// Squared length of side `k`, from corner `k` to corner `k + 1`, nm².
    #[inline]
    pub fn length_squared(&self, k: usize) -> f64 {
        self.dots[k] + self.dots[(k + 1) % 3]
    }
}

/// Forward geometry of one edge.
#[derive(Debug, Clone, Copy, Default)]
pub struct EdgeGeometry {
    /// l², nm².
    pub length_squared: f64,
    /// φ / l, 1/nm, with the dihedral angle φ in (−π, π].
    pub bend: f64,
}

/// tan² of 22.5°: up to a dihedral angle of 45° the angle is a polynomial in its half's tangent.
pub const POLYNOMIAL_RANGE: f64 = 0.171_572_875_253_809_9;

/// arctan(t) / t for t² = `z` ≤ [`POLYNOMIAL_RANGE`], to 2e-18: the Chebyshev fit of degree 11 in z.
#[inline(always)]
pub fn arctan_over_argument<R: Real>(z: R) -> R {
    const C: [f64; 12] = [
        1.0,
        -0.333_333_333_333_331_2,
        0.199_999_999_999_408_93,
        -0.142_857_142_792_502_45,
        0.111_111_107_449_196_58,
        -0.090_908_968_090_640_27,
        0.076_920_453_309_022_25,
        -0.066_629_518_136_291_92,
        0.058_468_782_973_308_72,
        -0.050_351_024_566_015_52,
        0.037_965_257_453_865_93,
        -0.017_805_397_205_419_446,
    ];
    // Estrin's scheme: the pairs do not wait for each other, as the steps of Horner's would.
    let z2 = z * z;
    let z4 = z2 * z2;
    let low = four(z, z2, [C[0], C[1], C[2], C[3]]);
    let middle = four(z, z2, [C[4], C[5], C[6], C[7]]);
    let high = four(z, z2, [C[8], C[9], C[10], C[11]]);
    z4.mul_add(z4.mul_add(high, middle), low)
}

/// A polynomial of third degree.
#[inline(always)]
fn four<R: Real>(z: R, z2: R, c: [f64; 4]) -> R {
    let (low, high) = (z.mul_add(z.of(c[1]), z.of(c[0])), z.mul_add(z.of(c[3]), z.of(c[2])));
    z2.mul_add(high, low)
}

impl EdgeGeometry {
    /// From the start and end of the edge, a point of the right triangle off the edge, and the
    /// geometry of the left and right triangles.
    ///
    /// With n₁, n₂ the normals, tan φ = l D / n₁·n₂, where D, six times the volume of the tetrahedron that
    /// the two triangles span, carries the sign of φ.
    #[inline]
    pub fn new(
        start: &Vec3,
        end: &Vec3,
        right_tip: &Vec3,
        left: &TriangleGeometry,
        right: &TriangleGeometry,
    ) -> Self {
        let length_squared = (end - start).norm_squared();
        let cosine = left.normal.dot(&right.normal);
        let determinant = left.normal.dot(&(start - right_tip));
        let length = length_squared.sqrt();
        let bend = (length * determinant).atan2(cosine) / length;
        Self { length_squared, bend }
    }
}

/// φ / l of an edge, 1/nm: from its squared length l²; the determinant D of [`EdgeGeometry::new`]; the scalar product
/// of the two normals and the product of their lengths. As in lanes: up to 45° the angle is a polynomial in
/// tan(φ/2) = l D / (n₁·n₂ + |n₁||n₂|).
#[inline(always)]
pub fn bend(length_squared: f64, determinant: f64, cosine: f64, product: f64) -> f64 {
    if is_small(cosine, product) {
        return small_bend(length_squared, determinant, cosine, product);
    }
    let length = length_squared.sqrt();
    (length * determinant).atan2(cosine) / length
}

/// Whether the angle is 45° at most.
#[inline(always)]
pub fn is_small(cosine: f64, product: f64) -> bool {
    cosine >= std::f64::consts::FRAC_1_SQRT_2 * product
}

/// [`bend`] up to 45°.
#[inline(always)]
pub fn small_bend(length_squared: f64, determinant: f64, cosine: f64, product: f64) -> f64 {
    let slope = determinant / (cosine + product);
    (slope + slope) * arctan_over_argument(length_squared * (slope * slope))
}

/// The angle of (`adjacent`, `opposite`) in (0, π): eight times that of which the tangent is small enough for
/// the polynomial, found by three times tan(α/2) = tan α / (1 + √(1 + tan² α)).
#[inline(always)]
pub fn corner_angle<R: Real>(opposite: R, adjacent: R) -> R {
    let hypotenuse = opposite.mul_add(opposite, adjacent * adjacent).sqrt();
    // tan(α/2) in the form that does not cancel, on either side of a right angle.
    let one = opposite.of(1.0);
    let obtuse = adjacent.zero().above(adjacent);
    let half =
        ((hypotenuse - adjacent) / opposite).or_else(obtuse, opposite / (hypotenuse + adjacent));
    let quarter = half / (one + half.mul_add(half, one).sqrt());
    let eighth = quarter / (one + quarter.mul_add(quarter, one).sqrt());
    eighth * arctan_over_argument(eighth * eighth) * 8.0
}

/// Forward geometry of one vertex.
#[derive(Debug, Clone, Copy, Default)]
pub struct VertexGeometry {
    /// Barycentric area a_B, a third of the areas of its triangles, nm² (B12).
    pub area: f64,
    /// Voronoi's area a_V = Σ_j l² (cot θ₁ + cot θ₂) / 8, nm² (B8); it can be zero or negative.
    pub voronoi_area: f64,
    /// Jülicher's integrated curvature J = Σ l φ / 2 over its edges, nm (B11).
    pub curvature: f64,
}

/// Sums over the whole mesh.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Totals {
    /// Area, nm² (B2).
    pub area: f64,
    /// Enclosed volume, nm³ (B3, B4).
    pub volume: f64,
    /// Integral of the mean curvature, half the sum of the principal ones: M = Σ l φ / 2 over the edges, and so half the
    /// sum of J over the vertices, nm. Known only where a term wants it.
    pub mean_curvature: f64,
}

/// Derivatives of the energy with respect to the [`Totals`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TotalPartials {
    /// ∂E/∂A, kJ/mol/nm².
    pub area: f64,
    /// ∂E/∂V, kJ/mol/nm³.
    pub volume: f64,
    /// ∂E/∂M, kJ/mol/nm.
    pub mean_curvature: f64,
}

impl TotalPartials {
    /// Whether all are numbers.
    pub fn are_finite(&self) -> bool {
        self.area.is_finite() && self.volume.is_finite() && self.mean_curvature.is_finite()
    }
}

/// Derivatives of the energy with respect to a [`VertexGeometry`].
#[derive(Debug, Clone, Copy, Default)]
pub struct VertexPartials {
    /// ∂E/∂a_B, kJ/mol/nm².
    pub area: f64,
    /// ∂E/∂a_V, kJ/mol/nm².
    pub voronoi_area: f64,
    /// ∂E/∂J, kJ/mol/nm.
    pub curvature: f64,
}

/// Derivatives of the energy with respect to area and sides of one triangle.
#[derive(Debug, Clone, Copy, Default)]
pub struct TrianglePartials<R = f64> {
    /// ∂E/∂a, kJ/mol/nm².
    pub area: R,
    /// ∂E/∂l² of each side at fixed area, kJ/mol/nm².
    pub length_squared: [R; 3],
}

/// Derivative of the energy with respect to the dihedral angle of an edge.
#[derive(Debug, Clone, Copy, Default)]
pub struct EdgePartials {
    /// ∂E/∂φ, kJ/mol.
    pub angle: f64,
}

/// What an edge passes on to the forces of its two triangles.
#[derive(Debug, Clone, Copy, Default)]
pub struct EdgeTension {
    /// Half of the tension along the edge, kJ/mol/nm²: each of the two triangles applies its half.
    pub half_tension: f64,
    /// (∂E/∂φ) / l, kJ/mol/nm: the bending moment per length.
    pub moment: f64,
}

impl EdgeTension {
    /// The chain rule for Jülicher's curvature: with m the mean of ∂E/∂J at the two ends, the edge
    /// adds m d(l φ), a tension m φ/l along the edge and a moment per length m.
    #[inline]
    pub fn from_curvature(
        edge: &EdgeGeometry,
        start: &VertexPartials,
        end: &VertexPartials,
    ) -> Self {
        let moment = 0.5 * (start.curvature + end.curvature);
        Self { half_tension: 0.5 * moment * edge.bend, moment }
    }

    /// Add what an energy of the total M does: m d(l φ) with m = ½ ∂E/∂M, at every edge that has two triangles.
    #[inline]
    pub fn add_mean_curvature(&mut self, edge: &EdgeGeometry, partial: f64) {
        let moment = 0.5 * partial;
        self.half_tension += 0.5 * moment * edge.bend;
        self.moment += moment;
    }

    /// Add the moment of a potential of the angle itself.
    #[inline]
    pub fn add_angle(&mut self, edge: &EdgeGeometry, partials: &EdgePartials) {
        self.moment += partials.angle / edge.length_squared.sqrt();
    }
}

/// The forces on the three corners of a triangle, kJ/mol/nm.
///
/// Every energy of areas, lengths, angles and volume comes down to scalar tensions along the sides
/// and, at each corner, a scalar pressure on the triangle's normal:
///
/// - F_a = T_ab (b − a) + T_ca (c − a) − p_a N
/// - T_ab = ½ (∂E/∂a) cot γ + 2 ∂E/∂l²_ab + ½ tension of the edge, with γ the angle opposite ab
/// - p_a = [d_b (q_ab − q_bc) + d_c (q_ca − q_bc)] / |N|² + (∂E/∂V) / 6, with q the moments per
///   length of the sides and d the corners' scalar products. It is the gradient of the dihedral
///   angles: a corner that moves outward flattens the side opposite it and bends the other two.
///
/// The moment of an edge acts in both its triangles, and so does half of its tension.
#[inline]
pub fn corner_forces(
    corners: [&Vec3; 3],
    geometry: &TriangleGeometry,
    area_partial: f64,
    length_partials: &[f64; 3],
    edges: [EdgeTension; 3],
    volume_partial: f64,
) -> [Vec3; 3] {
    let inverse = 1.0 / geometry.twice_area;
    let stress = 0.5 * area_partial * inverse;
    let tension = |k: usize| {
        stress * geometry.dots[(k + 2) % 3] + 2.0 * length_partials[k] + edges[k].half_tension
    };
    let inverse_squared = inverse * inverse;
    let pressure = |k: usize| {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        let opposite = edges[next].moment;
        let bending = geometry.dots[next] * (edges[k].moment - opposite)
            + geometry.dots[last] * (edges[last].moment - opposite);
        bending * inverse_squared + volume_partial / 6.0
    };
    let along = |k: usize| (corners[(k + 1) % 3] - corners[k]) * tension(k);
    let (ab, bc, ca) = (along(0), along(1), along(2));
    [
        ab - ca - geometry.normal * pressure(0),
        bc - ab - geometry.normal * pressure(1),
        ca - bc - geometry.normal * pressure(2),
    ]
}
