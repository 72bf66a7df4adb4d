//! Meshes and terms for the tests of the evaluators.

use openmm_helfrich::potentials::Term;

/// Positions of all particles, x y z of one after the other, and triangles.
pub type Mesh = (Vec<f64>, Vec<[i64; 3]>);

/// A grid of `rings` × `sectors` quadrilaterals round a spheroid, halved into triangles, with two poles:
/// vertices of many degrees and triangles of many shapes. `noise` moves every coordinate.
pub fn spheroid(rings: i64, sectors: i64, noise: &mut impl FnMut() -> f64) -> Mesh {
    let mut positions = Vec::new();
    let mut add = |x: f64, y: f64, z: f64| {
        for (coordinate, stretch) in [x, y, z].into_iter().zip([10.0, 12.0, 7.0]) {
            positions.push(coordinate * stretch * (1.0 + 0.04 * noise()) + 5.0);
        }
    };
    add(0.0, 0.0, 1.0);
    for ring in 1..=rings {
        let polar = std::f64::consts::PI * ring as f64 / (rings + 1) as f64;
        for sector in 0..sectors {
            let azimuth = std::f64::consts::TAU * sector as f64 / sectors as f64;
            add(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
        }
    }
    add(0.0, 0.0, -1.0);
    let south = 1 + rings * sectors;
    let at = |ring: i64, sector: i64| 1 + ring * sectors + sector.rem_euclid(sectors);
    let mut triangles = Vec::new();
    for sector in 0..sectors {
        triangles.push([0, at(0, sector), at(0, sector + 1)]);
        for ring in 0..rings - 1 {
            let (a, b) = (at(ring, sector), at(ring, sector + 1));
            let (c, d) = (at(ring + 1, sector), at(ring + 1, sector + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
        triangles.push([south, at(rings - 1, sector + 1), at(rings - 1, sector)]);
    }
    (positions, triangles)
}

/// Numbers in [−1, 1) from a seed.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Every potential in every variant, with values that make it act on the meshes of these tests; all with or all
/// without the derivatives with respect to their scalars.
pub fn all_terms(wants_derivatives: bool) -> Vec<Term<'static>> {
    let mut terms = Vec::new();
    let mut add = |name, form, values: &[f64]| terms.push(Term::new(name, form, values).unwrap());
    for form in 0..5 {
        for spontaneous in [0.0, 0.13, -0.2] {
            add("BendingForce", form, &[2.0, spontaneous]);
        }
        add("DihedralForce", form, &[1.5]);
    }
    add("SurfaceAreaForce", 0, &[3.0, 900.0]);
    add("EnclosedVolumeForce", 0, &[0.7, 3000.0]);
    add("TriangleHeightForce", 0, &[3.0, 2.0]);
    add("TriangleAreaForce", 0, &[1.0, 8.0]);
    add("PlaquetteAreaForce", 0, &[4.0, 1000.0]);
    add("TriangleAreaRepulsionForce", 0, &[9.0, 2.0]);
    for index in 0..terms.len() {
        if terms[index].potential.name() == "BendingForce" && terms[index].values[1] != 0.0 {
            let mut unsigned = terms[index];
            unsigned.switches = 1;
            terms.push(unsigned);
        }
    }
    for term in &mut terms {
        term.wants_derivatives = wants_derivatives;
    }
    terms
}
