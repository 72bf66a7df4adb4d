//! Particles and triangles: a repulsive core that nothing slips through, and adhesion by area.
//!
//! With the gap g = d − R between a particle of radius R and a triangle at the distance d of its nearest point,
//!
//! E = Σ_pairs ε [ (D/g)⁶ − 1 ]²  for g < D  +  Σ_pairs ∫ u(|x − r| − R) dA over the triangle,
//!
//! u(g) = −w φ(g/D), φ(x) = 1 for x ≤ 1; beyond that the tail, φ = 2 x⁻⁶ − x⁻¹² (LennardJones) or
//! (3 x⁻³ − x⁻⁹)/2 (NineThree: a half-space of Lennard-Jones particles), which begins there with φ = 1 and φ′ = 0, and
//! which S(x) = 1 − 10 y³ + 15 y⁴ − 6 y⁵, y = x − 2, takes to zero from x = 2 to 3. So w is the energy that an area gains which
//! touches: a bead of radius R wraps at w (R + D)² = 2 κ (M. Deserno, doi:10.1103/PhysRevE.69.031903).
//! The integral is a third of the area times the values at three points inside (exact to the second degree).
//! WCA has no adhesion.

use super::surface_repulsion::core;
use super::{
    Attraction, Contribution, Domain, Element, MAX_PARAMETERS, Needs, Parameter, Potential, Term,
};
use crate::mesh::closest::Arms;
use crate::mesh::geometry::Vec3;
use std::ffi::CStr;

/// Particles that a surface repels and attracts.
pub struct ParticleSurface;

/// The name of its class.
pub const NAME: &str = "ParticleSurfaceForce";

/// The place of the radius among the scalars.
pub const RADIUS: usize = 3;

/// Beyond so many D from a particle's rim there is no attraction.
const TAIL: f64 = 3.0;

/// Gaps below this share of D count as none: rounding leaves some to a particle that touches a triangle.
const TOUCHING: f64 = 1e-9;

impl Potential for ParticleSurface {
    fn name(&self) -> &'static str {
        NAME
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"distance", 0, 1, Domain::Positive),
                Parameter::new(c"epsilon", 1, 0, Domain::NonNegative),
                Parameter::new(c"adhesion", 1, -2, Domain::NonNegative).or(0.0),
                Parameter::new(c"radius", 0, 1, Domain::NonNegative).or(0.0).per(Element::Particle),
            ]
        }
    }

    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        Some((c"attraction", Attraction::NAMES))
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::CONTACTS
    }
}

/// How far from a particle's rim a term acts, nm.
pub fn reach(term: &Term) -> f64 {
    if attracts(term) { TAIL * term.values[0] } else { term.values[0] }
}

/// Whether there is adhesion, whose energies are below zero.
pub fn attracts(term: &Term) -> bool {
    Attraction::ALL[term.form] != Attraction::WCA
        && (term.values[2] > 0.0 || term.wants_derivatives)
}

/// What a particle and a triangle do to each other.
#[derive(Default)]
pub struct Pair {
    /// Energy and derivatives.
    pub contribution: Contribution,
    /// On the triangle's second and third corner and on the particle; the first corner has what balances them.
    pub forces: [Vec3; 3],
}

/// −φ and −φ′ with respect to x = g/D.
#[inline]
fn tail(attraction: Attraction, x: f64) -> [f64; 2] {
    if x <= 1.0 {
        return [-1.0, 0.0];
    }
    if x >= TAIL {
        return [0.0, 0.0];
    }
    let cube = 1.0 / (x * x * x);
    let (value, slope) = match attraction {
        Attraction::NineThree => {
            (0.5 * cube * (3.0 - cube * cube), 4.5 * cube * (cube * cube - 1.0) / x)
        }
        _ => {
            let six = cube * cube;
            (six * (2.0 - six), 12.0 * six * (six - 1.0) / x)
        }
    };
    let y = (x - 2.0).max(0.0);
    let switch = 1.0 - y * y * y * (10.0 + y * (6.0 * y - 15.0));
    let by_x = -30.0 * (y * (1.0 - y)).powi(2);
    [-value * switch, -slope * switch - value * by_x]
}

/// A particle of some radius and a triangle.
pub fn pair(term: &Term, radius: f64, arms: &Arms) -> Pair {
    let [distance, epsilon, adhesion, _] = term.values;
    let mut pair = Pair::default();
    let nearest = arms.nearest();
    let far = nearest.squared.sqrt();
    let gap = far - radius;
    if gap < distance {
        // Inside of the radius, and where the gap is nothing but rounding, the energy is infinite and will be refused.
        let ratio =
            if gap > TOUCHING * distance { (distance / gap).powi(2) } else { f64::INFINITY };
        let (contribution, slope) = core(distance, epsilon, ratio, gap * gap);
        let slope = 2.0 * gap * slope;
        pair.contribution = contribution;
        pair.contribution.by_parameter[RADIUS] = -slope;
        let force = arms.separation(&nearest) * (-slope / far);
        pair.forces = [force * -nearest.s, force * -nearest.t, force];
    }
    if attracts(term) && gap < TAIL * distance {
        add_adhesion(term, adhesion, radius, arms, &mut pair);
    }
    pair
}

fn add_adhesion(term: &Term, adhesion: f64, radius: f64, arms: &Arms, pair: &mut Pair) {
    let distance = term.values[0];
    let [u, v] = &arms.sides;
    let normal = u.cross(v);
    let twice_area = normal.norm();
    let share = twice_area / 6.0;
    let (mut mean, mut by_gap, mut by_distance) = (0.0, 0.0, 0.0);
    for (s, t) in [(1.0 / 6.0, 1.0 / 6.0), (2.0 / 3.0, 1.0 / 6.0), (1.0 / 6.0, 2.0 / 3.0)] {
        let separation = arms.point - u * s - v * t;
        let far = separation.norm();
        let x = (far - radius) / distance;
        let [value, slope] = tail(Attraction::ALL[term.form], x);
        mean += value / 3.0;
        by_gap += slope / distance;
        by_distance -= slope * x / distance;
        if slope != 0.0 {
            let force = separation * (-share * adhesion * slope / (distance * far));
            for (sum, weight) in pair.forces.iter_mut().zip([-s, -t, 1.0]) {
                *sum += force * weight;
            }
        }
    }
    if twice_area > 0.0 {
        // The area pulls its corners together.
        let tension = normal * (-0.5 * adhesion * mean / twice_area);
        pair.forces[0] += v.cross(&tension);
        pair.forces[1] += tension.cross(u);
    }
    let by_adhesion = 0.5 * twice_area * mean;
    let by_parameter: [f64; MAX_PARAMETERS] =
        [adhesion * share * by_distance, 0.0, by_adhesion, -adhesion * share * by_gap];
    pair.contribution += Contribution { energy: adhesion * by_adhesion, by_parameter };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::noise;

    fn term(attraction: Attraction, values: [f64; 4]) -> Term<'static> {
        let form = Attraction::ALL.iter().position(|known| *known == attraction).unwrap();
        let mut term = Term::new("ParticleSurfaceForce", form, &values).unwrap();
        term.wants_derivatives = true;
        term
    }

    #[test]
    fn forces_and_derivatives_are_those_of_the_energy() {
        let mut random = noise(9);
        for attraction in Attraction::ALL.iter().copied() {
            let mut acting = 0;
            for _ in 0..2000 {
                let mut point = |size: f64| Vec3::from_fn(|_, _| size * random());
                let [a, b, c] = [point(1.0), point(1.0), point(1.0)];
                let particle = a + point(2.5);
                let values = [0.7, 1.5, 2.0, 0.2];
                let energy = |points: [Vec3; 4], values: [f64; 4]| {
                    let arms = Arms::new(None, &points[0], [&points[1], &points[2], &points[3]]);
                    pair(&term(attraction, values), values[RADIUS], &arms)
                };
                let points = [particle, a, b, c];
                let found = energy(points, values);
                let scale = found.contribution.energy.abs();
                if scale == 0.0 || scale > 50.0 {
                    continue;
                }
                acting += 1;
                let h = 1e-5;
                let [on_b, on_c, on_particle] = found.forces;
                let forces = [on_particle, -on_particle - on_b - on_c, on_b, on_c];
                for (place, force) in forces.iter().enumerate() {
                    for axis in 0..3 {
                        let at = |h: f64| {
                            let mut moved = points;
                            moved[place][axis] += h;
                            energy(moved, values).contribution.energy
                        };
                        let expected = (at(-h) - at(h)) / (2.0 * h);
                        assert!((force[axis] - expected).abs() < 1e-5 * (1.0 + 10.0 * scale));
                    }
                }
                for (place, derivative) in found.contribution.by_parameter.iter().enumerate() {
                    let at = |h: f64| {
                        let mut moved = values;
                        moved[place] += h;
                        energy(points, moved).contribution.energy
                    };
                    let expected = (at(h) - at(-h)) / (2.0 * h);
                    assert!((derivative - expected).abs() < 1e-5 * (1.0 + 10.0 * scale));
                }
            }
            assert!(acting > 50, "{acting}");
        }
    }

    #[test]
    fn the_tail_begins_at_its_depth_and_ends_smoothly() {
        for attraction in [Attraction::LennardJones, Attraction::NineThree] {
            for (x, value) in [(1.0, -1.0), (TAIL, 0.0)] {
                let [below, above] = [x - 1e-7, x + 1e-7].map(|x| tail(attraction, x));
                assert!((below[0] - value).abs() < 1e-12 && (above[0] - value).abs() < 1e-12);
                assert!((below[1] - above[1]).abs() < 1e-4);
            }
            let middle = tail(attraction, 2.0)[0];
            let expected = if attraction == Attraction::NineThree {
                -0.186_523_437_5
            } else {
                -0.031_005_859_375
            };
            assert!((middle - expected).abs() < 1e-12, "{middle}");
        }
    }
}
