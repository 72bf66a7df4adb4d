// Solutes: n kT (x − 1 − ln x), x = c V / n.

// ln x for x > 0: that of two to a power, and 2 artanh of what is left, (x − 1) / (x + 1).
fn logarithm(x: real) -> real {
    var rest = x;
    var powers = real(0.0);
    while rest > real(1.4142135623730950488) {
        rest *= real(0.5);
        powers += real(1.0);
    }
    while rest < real(0.70710678118654752440) {
        rest *= real(2.0);
        powers -= real(1.0);
    }
    let s = (rest - real(1.0)) / (rest + real(1.0));
    return powers * real(0.69314718055994530942) + real(2.0) * s * (real(1.0) + s * s * artanh_rest(s));
}

// (artanh s − s) / s³ for |s| < 0.18: its series.
fn artanh_rest(s: real) -> real {
    var sum = real(0.0);
    for (var k = 11u; k > 0u; k--) {
        sum = real(1.0) / real(2u * k + 1u) + s * s * sum;
    }
    return sum;
}

// d − ln(1 + d), also where that is a small difference; infinite where there is no logarithm.
fn less_logarithm(d: real) -> real {
    let x = real(1.0) + d;
    if x <= real(0.0) {
        return real(1.0) / max(x, real(0.0));
    }
    if abs(d) > real(0.25) {
        return d - logarithm(x);
    }
    // d = 2 s + d s.
    let s = d / (real(2.0) + d);
    return s * (d - real(2.0) * s * s * artanh_rest(s));
}

fn osmotic_pressure_totals(term: u32, partials: ptr<function, TotalPartials>) -> Contribution {
    let solutes = value(term, 0u, 0u);
    let concentration = value(term, 1u, 0u);
    let thermal_energy = value(term, 2u, 0u);
    let reference = solutes / concentration;
    // x − 1.
    let excess = excess_of_volume(term, reference) / reference;
    let by_thermal_energy = solutes * less_logarithm(excess);
    (*partials).volume += thermal_energy * concentration * excess / max(real(1.0) + excess, real(0.0));
    return Contribution(
        thermal_energy * by_thermal_energy,
        vec4r(
            thermal_energy * (less_logarithm(excess) - excess),
            thermal_energy * excess * reference,
            by_thermal_energy,
            real(0.0),
        ),
    );
}
