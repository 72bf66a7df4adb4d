// A pressure difference: −p V.

fn pressure_totals(term: u32, partials: ptr<function, TotalPartials>) -> Contribution {
    let pressure = value(term, 0u, 0u);
    let volume = excess_of_volume(term, real(0.0));
    (*partials).volume -= pressure;
    return Contribution(-pressure * volume, vec4r(-volume, real(0.0), real(0.0), real(0.0)));
}
