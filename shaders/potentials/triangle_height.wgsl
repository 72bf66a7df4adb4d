// Triangle heights: ε (x − ½)² for each height h of a triangle with x = (d/h)⁴ = (d l / 2a)⁴ > ½.

fn triangle_height_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let min_height = value(term, 0u, element);
    let epsilon = value(term, 1u, element);
    let ratio = min_height / triangle.twice_area;
    var contribution = nothing();
    for (var side = 0u; side < 3u; side++) {
        let ratio_squared = ratio * ratio * triangle.length_squared[side];
        let x = ratio_squared * ratio_squared;
        let energy = repulsion(x);
        if energy.x == real(0.0) {
            continue;
        }
        let slope = energy.y * x;
        contribution.energy += epsilon * energy.x;
        contribution.by_parameter.x += real(4.0) * epsilon * slope / min_height;
        contribution.by_parameter.y += energy.x;
        (*partials).area -= real(8.0) * epsilon * slope / triangle.twice_area;
        (*partials).length_squared[side] += real(2.0) * epsilon * slope / triangle.length_squared[side];
    }
    return contribution;
}
