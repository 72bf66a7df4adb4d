// Global area: ½ k_A (A − A₀)² / A₀.

fn surface_area_totals(term: u32, slopes: ptr<function, TotalSlopes>) -> Contribution {
    let modulus = value(term, 0u, 0u);
    let reference = value(term, 1u, 0u);
    let excess = excess_of_area(term, reference);
    (*slopes).area += modulus * excess / reference;
    return relative_spring(modulus, reference, excess);
}
