// The law of de Saint-Venant and Kirchhoff: a⁰ [ ½ K (tr ε)² + ½ μ ((tr ε)² − 4 det ε) ] for each triangle.

fn linear_elastic_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let shear = value(term, 0u, element);
    let area = value(term, 1u, element);
    let strain = strain_of(term, element, triangle);
    let half_square = real(0.5) * strain.trace * strain.trace;
    let by_moduli = vec2<real>(half_square - real(2.0) * strain.determinant, half_square);
    let by_trace = (shear + area) * strain.trace;
    return elastic(term, element, strain, by_moduli, by_trace, real(-2.0) * shear, partials);
}
