// The difference of the monolayers' areas: ½ m (M − M₀)².

fn area_difference_totals(term: u32, partials: ptr<function, TotalPartials>) -> Contribution {
    let modulus = value(term, 0u, 0u);
    let excess = excess_of_mean_curvature(term, value(term, 1u, 0u));
    let by_modulus = real(0.5) * excess * excess;
    (*partials).mean_curvature += modulus * excess;
    return Contribution(modulus * by_modulus, vec4r(by_modulus, -modulus * excess, real(0.0), real(0.0)));
}
