// The values of a term. What the passes read and write, `frame` and the buffers beside it, with all constants that the
// host shares, is declared by build.rs from src/evaluator/gpu/interface.rs and src/potentials/codes.rs.

// The value of a parameter at an element.
fn value(term: u32, parameter: u32, element: u32) -> real {
    let start = frame.terms[term].field_starts[parameter];
    if start == NO_FIELD {
        return frame.terms[term].values[parameter];
    }
    return fields[start + element] * frame.terms[term].field_units[parameter];
}

// 1 if a parameter is one value for all elements, else 0: a field hides the scalar, on which nothing
// depends then.
fn is_scalar(term: u32, parameter: u32) -> real {
    return select(real(0.0), real(1.0), frame.terms[term].field_starts[parameter] == NO_FIELD);
}

// Where a constant of a triangle is for a term.
fn constant_place(term: u32, triangle: u32, k: u32) -> u32 {
    return frame.terms[term].constants_start + CONSTANTS * triangle + k;
}
