// Skalak's law: a⁰ [ μ (½ (tr ε)² − det ε) + ½ K (tr ε + 2 det ε)² ] for each triangle.

fn skalak_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let shear = value(term, 0u, element);
    let area = value(term, 1u, element);
    let strain = strain_of(term, element, triangle);
    let trace = strain.trace;
    let growth = trace + real(2.0) * strain.determinant;
    let by_moduli = vec2<real>(
        real(0.5) * trace * trace - strain.determinant,
        real(0.5) * growth * growth,
    );
    let by_trace = shear * trace + area * growth;
    let by_determinant = real(2.0) * area * growth - shear;
    return elastic(term, element, strain, by_moduli, by_trace, by_determinant, partials);
}
