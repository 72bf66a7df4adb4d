// Geometry of triangles, edges and vertices, forward and backward: the twin of src/mesh/geometry.rs, where
// signs and formulas are explained.

struct TriangleGeometry {
    normal: vec3r,
    twice_area: real,
    // From each corner to the next.
    sides: array<vec3r, 3>,
    // At each corner the scalar product of the two sides that leave it.
    dots: array<real, 3>,
    length_squared: array<real, 3>,
}

struct EdgeGeometry {
    length_squared: real,
    // φ / l.
    bend: real,
}

struct VertexGeometry {
    area: real,
    voronoi_area: real,
    curvature: real,
    cotangent: vec3r,
    umbrella: vec3r,
    normal_sum: vec3r,
}

// Derivatives of the energy.
struct TotalPartials {
    area: real,
    volume: real,
    mean_curvature: real,
}

struct TrianglePartials {
    area: real,
    length_squared: array<real, 3>,
}

struct VertexPartials {
    area: real,
    voronoi_area: real,
    curvature: real,
    cotangent: vec3r,
    umbrella: vec3r,
    normal_sum: vec3r,
}

// An energy and its derivatives with respect to the scalars of its potential.
struct Contribution {
    energy: real,
    by_parameter: vec4r,
}

fn nothing() -> Contribution {
    return Contribution(real(0.0), vec4r());
}

fn corner_vertex(triangle: u32, k: u32) -> u32 {
    return corner_vertices[3u * triangle + k];
}

// Sides and what follows from them; normal and area as they were stored.
fn load_triangle(triangle: u32) -> TriangleGeometry {
    let a = corner_vertex(triangle, 0u);
    let b = corner_vertex(triangle, 1u);
    let c = corner_vertex(triangle, 2u);
    let ab = separation(a, b);
    let bc = separation(b, c);
    let ca = separation(c, a);
    let stored = triangle_geometry[triangle];
    return TriangleGeometry(
        stored.xyz,
        stored.w,
        array<vec3r, 3>(ab, bc, ca),
        array<real, 3>(-dot(ca, ab), -dot(ab, bc), -dot(bc, ca)),
        array<real, 3>(dot(ab, ab), dot(bc, bc), dot(ca, ca)),
    );
}

// Normal and twice the area; counts the triangle if it is too thin or too large.
fn new_triangle(triangle: u32) -> vec4r {
    let a = corner_vertex(triangle, 0u);
    let ab = separation(a, corner_vertex(triangle, 1u));
    let ac = separation(a, corner_vertex(triangle, 2u));
    let normal = cross(ab, ac);
    let twice_area = root(dot(normal, normal));
    let longest = max(max(dot(ab, ab), dot(ac, ac)), dot(ab - ac, ab - ac));
    if !(twice_area > real(THINNEST) * longest) || longest >= real(frame.longest_squared) {
        atomicAdd(&thin_triangles, 1u);
    }
    return vec4r(normal, twice_area);
}

fn new_edge(edge: u32) -> EdgeGeometry {
    let left_corner = edge_corners[edge].x;
    let right_corner = edge_corners[edge].y;
    if right_corner == NO_CORNER {
        // A border has no dihedral angle.
        let triangle = left_corner / 3u;
        let border = separation(corner_vertices[left_corner], corner_vertex(triangle, (left_corner + 1u) % 3u));
        return EdgeGeometry(dot(border, border), real(0.0));
    }
    let left = triangle_geometry[left_corner / 3u];
    let right = triangle_geometry[right_corner / 3u];
    let start = corner_vertices[left_corner];
    let end = corner_vertices[right_corner];
    let right_tip = corner_vertex(right_corner / 3u, (right_corner + 2u) % 3u);
    let along = separation(start, end);
    let length_squared = dot(along, along);
    let cosine = dot(left.xyz, right.xyz);
    let determinant = dot(left.xyz, separation(right_tip, start));
    let slope = determinant / (cosine + left.w * right.w);
    let z = length_squared * slope * slope;
    // Not a number, where a fold divides by zero, is not below the range either.
    if z <= real(POLYNOMIAL_RANGE) {
        return EdgeGeometry(length_squared, real(2.0) * slope * arctan_over_argument(z));
    }
    let length = root(length_squared);
    return EdgeGeometry(length_squared, angle_of(length * determinant, cosine) / length);
}

// The forces on the corners of a triangle: T_ab (b − a) + T_ca (c − a) − p_a N.
fn forces_on_corners(
    triangle: TriangleGeometry,
    by_area: real,
    length_partials: array<real, 3>,
    half_tensions: vec3r,
    moments: vec3r,
    by_volume: real,
) -> array<vec3r, 3> {
    let inverse = real(1.0) / triangle.twice_area;
    let stress = real(0.5) * by_area * inverse;
    var pulls: array<vec3r, 3>;
    for (var k = 0u; k < 3u; k++) {
        let tension = stress * triangle.dots[(k + 2u) % 3u]
            + real(2.0) * length_partials[k] + half_tensions[k];
        pulls[k] = triangle.sides[k] * tension;
    }
    var forces: array<vec3r, 3>;
    for (var k = 0u; k < 3u; k++) {
        let next = (k + 1u) % 3u;
        let last = (k + 2u) % 3u;
        let opposite = moments[next];
        let bending = triangle.dots[next] * (moments[k] - opposite)
            + triangle.dots[last] * (moments[last] - opposite);
        let pressure = bending * inverse * inverse + by_volume / real(6.0);
        forces[k] = pulls[k] - pulls[last] - triangle.normal * pressure;
    }
    return forces;
}
