// Local area: ½ k_A (a − a₀)² / a₀ for each triangle.

fn triangle_area_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let modulus = value(term, 0u, element);
    let reference = value(term, 1u, element);
    let excess = real(0.5) * triangle.twice_area - reference;
    (*partials).area += modulus * excess / reference;
    var contribution = relative_spring(modulus, reference, excess);
    contribution.by_parameter.y *= is_scalar(term, 1u);
    return contribution;
}
