// Line tension between domains: γ times some shares of the sides and of the medians.

fn line_tension_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let tension = value(term, 0u, element);
    let of_medians = constant_of(term, element, 3u);
    var sum = real(0.0);
    for (var k = 0u; k < 3u; k++) {
        let next = (k + 1u) % 3u;
        let last = (k + 2u) % 3u;
        let share = constant_of(term, element, k);
        if share != real(0.0) {
            let length = root(triangle.length_squared[k]);
            sum += share * length;
            (*partials).length_squared[k] += real(0.5) * tension * share / length;
        }
        if of_medians != real(0.0) {
            let squared = triangle.length_squared[k] + triangle.length_squared[last] + real(2.0) * triangle.dots[k];
            let median = root(real(0.25) * squared);
            sum += of_medians * median;
            let by_median = real(0.125) * tension * of_medians / median;
            (*partials).length_squared[k] += real(2.0) * by_median;
            (*partials).length_squared[last] += real(2.0) * by_median;
            (*partials).length_squared[next] -= by_median;
        }
    }
    return Contribution(tension * sum, vec4r(sum, real(0.0), real(0.0), real(0.0)));
}
