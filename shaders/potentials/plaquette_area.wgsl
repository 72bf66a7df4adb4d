// Plaquettes: ½ k (N a / A₀ − 1)² for each of the N vertices.

fn plaquette_area_vertex(
    term: u32,
    element: u32,
    vertex: VertexGeometry,
    partials: ptr<function, VertexPartials>,
) -> Contribution {
    let stiffness = value(term, 0u, element);
    let reference = value(term, 1u, element);
    let scale = real(frame.num_vertices) / reference;
    let strain = scale * vertex.area - real(1.0);
    (*partials).area += stiffness * scale * strain;
    let half_square = real(0.5) * strain * strain;
    let by_reference = -stiffness * strain * (strain + real(1.0)) / reference;
    return Contribution(stiffness * half_square, vec4r(half_square, by_reference, real(0.0), real(0.0)));
}
