// Evans' first-order law: a⁰ [ μ ((1 + tr ε)/J − 1) + ½ K (J − 1)² ] for each triangle, with J = a/a⁰.

fn neo_hookean_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let shear = value(term, 0u, element);
    let area = value(term, 1u, element);
    let strain = strain_of(term, element, triangle);
    let trace = strain.trace;
    let determinant = strain.determinant;
    let stretch = real(0.5) * triangle.twice_area / strain.area;
    let inverse = real(1.0) / stretch;
    let growth = real(2.0) * (trace + real(2.0) * determinant) / (stretch + real(1.0));
    let shape = (trace * growth - real(4.0) * determinant) * inverse / (stretch + real(1.0));
    let by_moduli = vec2<real>(shape, real(0.5) * growth * growth);
    let by_stretch = area * growth * inverse;
    let cube = shear * inverse * inverse * inverse;
    let by_trace = by_stretch + cube * (trace + real(4.0) * determinant);
    let by_determinant = real(2.0) * (by_stretch - cube * (trace + real(1.0)));
    return elastic(term, element, strain, by_moduli, by_trace, by_determinant, partials);
}
