// Gaussian curvature: κ_G [2π χ − Σ (π − Σ θ)], with the angles θ of triangles at the vertices of borders, of which there are
// as many as sides that have no other triangle. Each triangle has its share of 2π χ. With a modulus for each vertex it is
// −Σ κ θ of the corners, and a share of 2π Σ κ.

fn gaussian_curvature_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    if frame.terms[term].field_starts[0] != NO_FIELD {
        return curvature_by_vertex(term, element, triangle, partials);
    }
    let modulus = value(term, 0u, element);
    let characteristic = i32(frame.num_vertices + frame.num_triangles) - i32(frame.num_edges);
    var curvature = real(2.0 * PI) * real(characteristic) / real(frame.num_triangles);
    for (var k = 0u; k < 3u; k++) {
        if is_border_side(element, k) {
            curvature -= real(PI);
        }
        if !is_on_border(corner_vertex(element, k)) {
            continue;
        }
        curvature += angle_of(triangle.twice_area, triangle.dots[k]);
        add_partial_of_angle(triangle, k, modulus, partials);
    }
    return Contribution(modulus * curvature, vec4r(curvature, real(0.0), real(0.0), real(0.0)));
}

fn curvature_by_vertex(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    var energy = constant_of(term, element, 3u);
    for (var k = 0u; k < 3u; k++) {
        let modulus = constant_of(term, element, k);
        energy -= modulus * angle_of(triangle.twice_area, triangle.dots[k]);
        add_partial_of_angle(triangle, k, -modulus, partials);
    }
    return Contribution(energy, vec4r());
}

// Of an energy that is a multiple of the angle at corner k.
fn add_partial_of_angle(triangle: TriangleGeometry, k: u32, multiple: real, partials: ptr<function, TrianglePartials>) {
    let next = (k + 1u) % 3u;
    let last = (k + 2u) % 3u;
    let by_angle = multiple / (triangle.length_squared[k] * triangle.length_squared[last]);
    (*partials).area += real(2.0) * by_angle * triangle.dots[k];
    let by_length = real(0.5) * by_angle * triangle.twice_area;
    (*partials).length_squared[k] -= by_length;
    (*partials).length_squared[last] -= by_length;
    (*partials).length_squared[next] += by_length;
}
