// Gaussian curvature: κ_G [2π χ − Σ (π − Σ θ)], with the angles θ of triangles at the vertices of borders, of which there are
// as many as sides that have no other triangle. Each triangle has its share of 2π χ.

fn gaussian_curvature_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    slopes: ptr<function, TriangleSlopes>,
) -> Contribution {
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
        let next = (k + 1u) % 3u;
        let last = (k + 2u) % 3u;
        curvature += angle_of(triangle.twice_area, triangle.dots[k]);
        let by_angle = modulus / (triangle.length_squared[k] * triangle.length_squared[last]);
        (*slopes).area += real(2.0) * by_angle * triangle.dots[k];
        let by_length = real(0.5) * by_angle * triangle.twice_area;
        (*slopes).length_squared[k] -= by_length;
        (*slopes).length_squared[last] -= by_length;
        (*slopes).length_squared[next] += by_length;
    }
    return Contribution(modulus * curvature, vec4r(curvature, real(0.0), real(0.0), real(0.0)));
}
