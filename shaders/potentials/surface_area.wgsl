// Global area: ½ k_A (A − A₀)² / A₀.

fn surface_area_totals(term: u32, partials: ptr<function, TotalPartials>) -> Contribution {
    let modulus = value(term, 0u, 0u);
    let reference = value(term, 1u, 0u);
    let excess = excess_of_area(term, reference);
    (*partials).area += modulus * excess / reference;
    return relative_spring(modulus, reference, excess);
}
