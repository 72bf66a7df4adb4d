// Minimal triangle areas: ε (x − ½)² for x = (a_m/a)⁴ > ½.

fn triangle_area_repulsion_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let min_area = value(term, 0u, element);
    let epsilon = value(term, 1u, element);
    let area = real(0.5) * triangle.twice_area;
    let ratio = min_area / area;
    let x = ratio * ratio * ratio * ratio;
    let energy = repulsion(x);
    if energy.x == real(0.0) {
        return nothing();
    }
    let slope = real(4.0) * epsilon * energy.y * x;
    (*partials).area -= slope / area;
    return Contribution(epsilon * energy.x, vec4r(slope / min_area, energy.x, real(0.0), real(0.0)));
}
