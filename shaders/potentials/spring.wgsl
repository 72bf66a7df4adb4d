// Springs along the edges, each with its share of a side: k (l − l₀)² times ½, or B / D for a worm-like chain with a
// repulsion, of which src/potentials/spring.rs has the formula.

// f / (l − l₀)², f′ / (l − l₀), and the derivative of the former with respect to the ratio, of a chain of stiffness 1.
fn chain(length: real, at_rest: real, ratio: real) -> vec3r {
    let u = real(1.0) / (real(1.0) - ratio);
    let slope_at_rest = u * u - real(1.0) + real(4.0) * ratio;
    let bend_at_rest = real(2.0) * u * u * u + real(4.0);
    let scale = real(1.0) / (bend_at_rest + real(2.0) * slope_at_rest / ratio);
    let scale_by_ratio = real(6.0) * u * u * u * u
        + real(2.0) * (bend_at_rest - slope_at_rest / ratio) / ratio;
    let growth = real(1.0) / at_rest;
    let x = length * growth * ratio;
    let left = u * u / (real(1.0) - x);
    let bracket = left + real(2.0) + slope_at_rest / x;
    let slope = left / (real(1.0) - x) - slope_at_rest / (x * x);
    let by_ratio = slope * length * growth + real(2.0) * u * left + bend_at_rest / x
        - bracket * scale_by_ratio * scale;
    return scale * vec3r(bracket, real(2.0) * bracket + (length - at_rest) * slope * growth * ratio, by_ratio);
}

fn spring_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let stiffness = value(term, 0u, element);
    let ratio = value(term, 1u, element);
    var contribution = nothing();
    for (var k = 0u; k < 3u; k++) {
        let next = (k + 1u) % 3u;
        let share = constant_of(term, element, 3u + k);
        let length = root(triangle.length_squared[k]);
        let at_rest = root(constant_of(term, element, k) + constant_of(term, element, next));
        let excess = dot_excess(term, element, triangle, k) + dot_excess(term, element, triangle, next);
        let stretch = excess / (length + at_rest);
        var factors = vec3r(real(0.5), real(1.0), real(0.0));
        if frame.terms[term].form == SPRING_W_L_C_POWER {
            if length * ratio >= at_rest {
                // The processor says which one.
                atomicAdd(&thin_triangles, 1u);
                return nothing();
            }
            factors = chain(length, at_rest, ratio);
        }
        let squared = share * stretch * stretch;
        contribution.energy += stiffness * squared * factors.x;
        contribution.by_parameter.x += squared * factors.x;
        contribution.by_parameter.y += stiffness * squared * factors.z;
        (*partials).length_squared[k] += real(0.5) * stiffness * share * stretch * factors.y / length;
    }
    return contribution;
}
