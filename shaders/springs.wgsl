// Energies that several potentials share: the twins of those in src/potentials/mod.rs.

// ½ k e² / x₀ for a quantity that exceeds its target x₀ by e; the derivatives with respect to k and x₀ are
// those of the contribution. The force is k e / x₀.
fn relative_spring(modulus: real, reference: real, excess: real) -> Contribution {
    let strain = excess / reference;
    let by_modulus = real(0.5) * strain * excess;
    let by_reference = -modulus * (strain + real(0.5) * strain * strain);
    return Contribution(modulus * by_modulus, vec4r(by_modulus, by_reference, real(0.0), real(0.0)));
}

// (x − ½)² and its derivative for x > ½, else 0.
fn repulsion(x: real) -> vec2<real> {
    let excess = max(x - real(0.5), real(0.0));
    return vec2<real>(excess * excess, real(2.0) * excess);
}
