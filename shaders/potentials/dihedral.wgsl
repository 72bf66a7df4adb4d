// Dihedral angles φ: K f(x), f by the form, x = φ − φ₀ in (−π, π] and c = 1 − cos x.

fn dihedral_edge(term: u32, element: u32, edge: EdgeGeometry, partial: ptr<function, real>) -> Contribution {
    if edge_corners[element].y == NO_CORNER {
        // A border has no angle.
        return nothing();
    }
    let stiffness = value(term, 0u, element);
    var angle = edge.bend * root(edge.length_squared) - value(term, 1u, element);
    if angle > real(PI) {
        angle -= real(2.0 * PI);
    } else if angle <= real(-PI) {
        angle += real(2.0 * PI);
    }
    // 1 − cos x without cancellation.
    let half_sine = sine(real(0.5) * angle);
    let c = real(2.0) * half_sine * half_sine;
    let sine = real(2.0) * half_sine * cosine(real(0.5) * angle);
    var f = c;
    var by_angle = sine;
    switch frame.terms[term].form {
        case FORM_QUARTIC: {
            f = c * c;
            by_angle = real(2.0) * c * sine;
        }
        // As it is.
        case FORM_COSINE: {}
        case FORM_EXP: {
            let growth = exp_minus_one(real(2.0) * c);
            f = real(0.5) * growth;
            by_angle = (growth + real(1.0)) * sine;
        }
        case FORM_SMOOTH_EXP: {
            let growth = exp_minus_one(real(10.0) * c);
            f = real(0.04) * growth;
            by_angle = real(0.4) * (growth + real(1.0)) * sine;
        }
        case FORM_SMOOTH_EXP46: {
            let growth = exp_minus_one(real(2.0) * c);
            f = real(0.5) * (growth - angle * angle);
            by_angle = (growth + real(1.0)) * sine - angle;
        }
        default: {}
    }
    *partial += stiffness * by_angle;
    let by_stiffness = f * is_scalar(term, 0u);
    let by_rest = -stiffness * by_angle * is_scalar(term, 1u);
    return Contribution(stiffness * f, vec4r(by_stiffness, by_rest, real(0.0), real(0.0)));
}
