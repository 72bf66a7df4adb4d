// Curvature vectors, Voronoi areas and normals of vertices: the twin of src/mesh/vertex_vectors.rs.

// 1/√3, the cotangent of 60°.
const COT_60 = 0.57735026918962576451;

// Add what corner k of a triangle gives to its vertex.
fn add_corner(vertex: ptr<function, VertexGeometry>, triangle: TriangleGeometry, k: u32, normals: bool) {
    let next = (k + 1u) % 3u;
    let last = (k + 2u) % 3u;
    let inverse = real(1.0) / triangle.twice_area;
    (*vertex).cotangent += cross(triangle.normal, triangle.sides[next]) * (real(0.5) * inverse);
    (*vertex).umbrella += (triangle.sides[last] - triangle.sides[k]) * real(0.5 * COT_60);
    let sum = triangle.length_squared[k] * triangle.dots[last]
        + triangle.length_squared[last] * triangle.dots[next];
    (*vertex).voronoi_area += real(0.125) * inverse * sum;
    if normals {
        let angle = angle_of(triangle.twice_area, triangle.dots[k]);
        (*vertex).normal_sum += triangle.normal * (angle * inverse);
    }
}

fn vector_partial(vertex: u32, which: u32) -> vec3r {
    let first = PARTIALS_PER_VERTEX * vertex + 3u * which;
    return vec3r(vector_partials[first], vector_partials[first + 1u], vector_partials[first + 2u]);
}

fn store_vector_partial(vertex: u32, which: u32, partial: vec3r) {
    let first = PARTIALS_PER_VERTEX * vertex + 3u * which;
    vector_partials[first] = partial.x;
    vector_partials[first + 1u] = partial.y;
    vector_partials[first + 2u] = partial.z;
}

// What the derivatives with respect to Voronoi areas and vectors of its three vertices do to a triangle.
fn forces_of_vectors(index: u32, triangle: TriangleGeometry, normals: bool) -> array<vec3r, 3> {
    var area = real(0.0);
    var lengths: array<real, 3>;
    var direct: array<vec3r, 3>;
    var voronoi: array<real, 3>;
    var cotangents: array<vec3r, 3>;
    var umbrellas: array<vec3r, 3>;
    let inverse = real(1.0) / triangle.twice_area;
    for (var k = 0u; k < 3u; k++) {
        let vertex = corner_vertex(index, k);
        voronoi[k] = vertex_partials[vertex].y;
        cotangents[k] = vector_partial(vertex, 0u);
        umbrellas[k] = vector_partial(vertex, 1u);
    }
    for (var k = 0u; k < 3u; k++) {
        let next = (k + 1u) % 3u;
        let last = (k + 2u) % 3u;
        let cotangent = triangle.dots[last] * inverse;
        let difference = cotangents[k] - cotangents[next];
        // The explicit r_i − r_j.
        let pull = difference * (real(0.5) * cotangent);
        direct[k] -= pull;
        direct[next] += pull;
        // The explicit l² of Voronoi's area.
        let mean = real(0.125) * (voronoi[k] + voronoi[next]);
        lengths[k] += mean * cotangent;
        // The cotangent.
        let by_cotangent = mean * triangle.length_squared[k]
            - real(0.5) * dot(difference, triangle.sides[k]);
        let by_length = real(0.5) * inverse * by_cotangent;
        lengths[next] += by_length;
        lengths[last] += by_length;
        lengths[k] -= by_length;
        area -= real(2.0) * inverse * by_cotangent * cotangent;
        // The umbrella vector is linear in the positions.
        let umbrella = (umbrellas[k] - umbrellas[next]) + (umbrellas[k] - umbrellas[last]);
        direct[k] -= umbrella * real(0.5 * COT_60);
    }
    var pressures = vec3r();
    if normals {
        var weighted = vec3r();
        for (var k = 0u; k < 3u; k++) {
            let next = (k + 1u) % 3u;
            let last = (k + 2u) % 3u;
            let partial = vector_partial(corner_vertex(index, k), 2u);
            weighted += partial * angle_of(triangle.twice_area, triangle.dots[k]);
            let product = triangle.length_squared[k] * triangle.length_squared[last];
            let by_angle = dot(partial, triangle.normal) * inverse / product;
            area += real(2.0) * by_angle * triangle.dots[k];
            let by_length = real(0.5) * by_angle * triangle.twice_area;
            lengths[k] -= by_length;
            lengths[last] -= by_length;
            lengths[next] += by_length;
        }
        // A unit normal turns only: n's gradient at a corner, times a constant vector, is along n.
        for (var k = 0u; k < 3u; k++) {
            let side = -triangle.sides[(k + 1u) % 3u];
            pressures[k] = dot(triangle.normal, cross(side, weighted)) * inverse * inverse * inverse;
        }
    }
    var forces = forces_on_corners(triangle, area, lengths, vec3r(), vec3r(), real(0.0));
    for (var k = 0u; k < 3u; k++) {
        forces[k] += direct[k] - triangle.normal * pressures[k];
    }
    return forces;
}
