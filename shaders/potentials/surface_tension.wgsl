// A surface tension: σ A.

fn surface_tension_totals(term: u32, slopes: ptr<function, TotalSlopes>) -> Contribution {
    let tension = value(term, 0u, 0u);
    let area = excess_of_area(term, real(0.0));
    (*slopes).area += tension;
    return Contribution(tension * area, vec4r(area, real(0.0), real(0.0), real(0.0)));
}
