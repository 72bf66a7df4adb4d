// Line tension of borders: γ l for each side of a triangle that has no other triangle.

fn edge_tension_triangle(
    term: u32,
    element: u32,
    triangle: TriangleGeometry,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let tension = value(term, 0u, element);
    var sum = real(0.0);
    for (var side = 0u; side < 3u; side++) {
        if is_border_side(element, side) {
            let length = root(triangle.length_squared[side]);
            sum += length;
            (*partials).length_squared[side] += real(0.5) * tension / length;
        }
    }
    return Contribution(tension * sum, vec4r(sum, real(0.0), real(0.0), real(0.0)));
}
