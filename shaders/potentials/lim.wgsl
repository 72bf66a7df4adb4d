// Lim's law: a⁰ [ ½ K (α² + a₃α³ + a₄α⁴) + μ (β + b₁αβ + b₂β²) ] for each triangle; src/potentials/lim.rs has the names.

const LIM_A3 = -2.0;
const LIM_A4 = 8.0;
const LIM_B1 = 0.7;

fn lim_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let shear = value(term, 0u, element);
    let area = value(term, 1u, element);
    let strain = strain_of(term, element, triangle);
    let trace = strain.trace;
    let b2 = select(real(1.84), real(0.75), frame.terms[term].form == COEFFICIENTS_LIM2002);
    let one = real(1.0);
    let growth = real(2.0) * trace + real(4.0) * strain.determinant;
    let ratio = real(0.5) * triangle.twice_area / strain.area;
    let inverse = one / ratio;
    let alpha = growth / (ratio + one);
    let beta = (trace * trace - real(4.0) * strain.determinant) * inverse / (one + trace + ratio);
    let by_moduli = vec2<real>(
        beta * (one + real(LIM_B1) * alpha + b2 * beta),
        real(0.5) * alpha * alpha * (one + alpha * (real(LIM_A3) + real(LIM_A4) * alpha)),
    );
    let by_alpha = area * alpha * (one + alpha * (real(1.5 * LIM_A3) + real(2.0 * LIM_A4) * alpha))
        + shear * real(LIM_B1) * beta;
    let by_beta = shear * (one + real(LIM_B1) * alpha + real(2.0) * b2 * beta);
    let cube = inverse * inverse * inverse;
    let by_trace = by_alpha * inverse + by_beta * (trace + real(4.0) * strain.determinant) * cube;
    let by_determinant = real(2.0) * (by_alpha * inverse - by_beta * (one + trace) * cube);
    return elastic(term, element, strain, by_moduli, by_trace, by_determinant, partials);
}
