// A surface tension: σ A.

fn surface_tension_totals(term: u32, partials: ptr<function, TotalPartials>) -> Contribution {
    let tension = value(term, 0u, 0u);
    let area = excess_of_area(term, real(0.0));
    (*partials).area += tension;
    return Contribution(tension * area, vec4r(area, real(0.0), real(0.0), real(0.0)));
}
