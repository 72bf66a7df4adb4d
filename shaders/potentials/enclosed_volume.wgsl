// Global volume: ½ k_V (V − V₀)² / V₀.

fn enclosed_volume_totals(term: u32, partials: ptr<function, TotalPartials>) -> Contribution {
    let modulus = value(term, 0u, 0u);
    let reference = value(term, 1u, 0u);
    let excess = excess_of_volume(term, reference);
    (*partials).volume += modulus * excess / reference;
    return relative_spring(modulus, reference, excess);
}
