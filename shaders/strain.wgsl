// Strains of triangles against their shape at rest: the twin of src/potentials/strain.rs, where formulas are explained.

struct Strain {
    trace: real,
    determinant: real,
    // Area at rest.
    area: real,
    // By how much the corners' scalar products exceed those at rest, and those at rest.
    excess: array<real, 3>,
    rest: array<real, 3>,
    // 1 / 2|N⁰|².
    inverse: real,
}

fn strain_of(term: u32, index: u32, triangle: TriangleGeometry) -> Strain {
    var strain: Strain;
    strain.area = constant_of(term, index, 3u);
    strain.inverse = constant_of(term, index, 4u);
    for (var k = 0u; k < 3u; k++) {
        strain.rest[k] = constant_of(term, index, k);
        strain.excess[k] = dot_excess(term, index, triangle, k);
    }
    for (var k = 0u; k < 3u; k++) {
        let next = (k + 1u) % 3u;
        strain.trace += strain.excess[k] * (strain.rest[next] + strain.rest[(k + 2u) % 3u]) * strain.inverse;
        strain.determinant += real(0.5) * strain.excess[k] * strain.excess[next] * strain.inverse;
    }
    return strain;
}

// The energy of a triangle, by its derivatives with respect to the two moduli and the two invariants, each by area.
fn elastic(
    term: u32,
    index: u32,
    strain: Strain,
    by_moduli: vec2<real>,
    by_trace: real,
    by_determinant: real,
    partials: ptr<function, TrianglePartials>,
) -> Contribution {
    let scale = strain.area * strain.inverse;
    for (var k = 0u; k < 3u; k++) {
        let opposite = (k + 2u) % 3u;
        (*partials).length_squared[k] += scale
            * (by_trace * strain.rest[opposite] + real(0.5) * by_determinant * strain.excess[opposite]);
    }
    let by_parameter = by_moduli * strain.area;
    let energy = by_parameter.x * value(term, 0u, index) + by_parameter.y * value(term, 1u, index);
    return Contribution(energy, vec4r(by_parameter, real(0.0), real(0.0)));
}
