//! Bending energy of a fluid membrane with spontaneous curvature, in five discretisations.
//!
//! E = ½ κ Σ_i [ c_i² / a_i − 2 C₀ c_i + C₀² a_i ] over the vertices, with an integrated curvature c
//! (the numerator) and an area a. κ multiplies ½ (C₁ + C₂ − C₀)², so a sphere has 8πκ at C₀ = 0.
//!
//! | scheme | c | a | equation of doi:10.1103/PhysRevE.108.015301 |
//! | --- | --- | --- | --- |
//! | `Julicher` | J = Σ l φ / 2 | barycentric | (B13) |
//! | `GompperKroll` | S = Σ (cot θ₁ + cot θ₂)(r_i − r_j) / 2 | Voronoi | (B10) |
//! | `GompperKrollBarycentric` | S | barycentric | (B15) |
//! | `JulicherVoronoi` | J | Voronoi | (B16) |
//! | `Espriu` | Σ (r_i − r_j) / √3, as S of equilateral triangles | barycentric | VCM `Espiru1987` |
//!
//! For a vector c, c² is its square and the linear term takes n·c with the vertex normal n (B9), or |c|
//! (|J|) if the spontaneous curvature is switched to unsigned, as in VCM. The Voronoi area goes through
//! zero on obtuse meshes; the energy is then large, of either sign, as the formula says.

use super::codes::{BENDING_SWITCHES, Scheme, UNSIGNED};
use super::{
    Contribution, Domain, Element, Needs, Parameter, Place, Potential, Sums, Term, Vertex,
    VertexFormula, Vertices,
};
use crate::real::{Real, dot, plus, plus_scaled, scaled};
use std::ffi::CStr;

/// Curvature elasticity.
pub struct Bending;

/// The integrated curvature of a scheme.
#[derive(Clone, Copy, PartialEq)]
enum Numerator {
    Julicher,
    Cotangent,
    Umbrella,
}

/// The area of a scheme.
#[derive(Clone, Copy, PartialEq)]
enum Area {
    Barycentric,
    Voronoi,
}

/// What the scheme of a term is made of.
fn parts(term: &Term) -> (Numerator, Area) {
    match Scheme::ALL[term.form] {
        Scheme::Julicher => (Numerator::Julicher, Area::Barycentric),
        Scheme::GompperKroll => (Numerator::Cotangent, Area::Voronoi),
        Scheme::GompperKrollBarycentric => (Numerator::Cotangent, Area::Barycentric),
        Scheme::JulicherVoronoi => (Numerator::Julicher, Area::Voronoi),
        Scheme::Espriu => (Numerator::Umbrella, Area::Barycentric),
    }
}

const RIGIDITY: usize = 0;
const SPONTANEOUS: usize = 1;

impl Potential for Bending {
    fn name(&self) -> &'static str {
        "BendingForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"rigidity", 1, 0, Domain::NonNegative).per(Element::Vertex),
                Parameter::new(c"spontaneousCurvature", 0, -1, Domain::Real)
                    .or(0.0)
                    .per(Element::Vertex),
            ]
        }
    }

    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        Some((c"scheme", Scheme::NAMES))
    }

    fn switches(&self) -> &'static [&'static CStr] {
        BENDING_SWITCHES
    }

    fn needs(&self, term: &Term) -> Needs {
        let (numerator, area) = parts(term);
        let mut needs = Needs::VERTICES;
        if numerator == Numerator::Julicher {
            needs |= Needs::CURVATURES;
        }
        if area == Area::Voronoi {
            needs |= Needs::VECTORS | Needs::VORONOI_AREAS;
        }
        match numerator {
            Numerator::Julicher => {}
            Numerator::Cotangent => needs |= Needs::VECTORS | Needs::COTANGENTS,
            Numerator::Umbrella => needs |= Needs::VECTORS | Needs::UMBRELLAS,
        }
        let signed = term.switches & UNSIGNED == 0;
        if numerator != Numerator::Julicher && signed {
            // The normals cost more than all the rest, so they are left out while nothing depends on
            // them; only the derivative with respect to C₀ does so at C₀ = 0.
            if !term.vanishes(SPONTANEOUS) || term.wants_derivatives {
                needs |= Needs::NORMALS;
            }
        }
        needs
    }

    /// Curvature is not defined at a border, which is free: no moment acts there.
    fn acts_at_borders(&self) -> bool {
        false
    }

    /// Over an area above zero the energy is a square: ½ κ a (c / a − C₀)², or more where C₀ takes a component of c.
    fn is_never_negative(&self, term: &Term) -> bool {
        parts(term).1 == Area::Barycentric
    }

    fn vertices(&self, term: &Term, run: Vertices) -> Contribution {
        const J: u8 = Numerator::Julicher as u8;
        const S: u8 = Numerator::Cotangent as u8;
        const U: u8 = Numerator::Umbrella as u8;
        let (numerator, area) = parts(term);
        let unsigned = term.switches & UNSIGNED != 0;
        let linear = !term.vanishes(SPONTANEOUS) || term.wants_derivatives;
        match (numerator, area) {
            (Numerator::Julicher, Area::Barycentric) => {
                run.apply(term, &Curvature::<J, false> { unsigned, linear })
            }
            (Numerator::Julicher, Area::Voronoi) => {
                run.apply(term, &Curvature::<J, true> { unsigned, linear })
            }
            (Numerator::Cotangent, Area::Barycentric) => {
                run.apply(term, &Curvature::<S, false> { unsigned, linear })
            }
            (Numerator::Cotangent, Area::Voronoi) => {
                run.apply(term, &Curvature::<S, true> { unsigned, linear })
            }
            (Numerator::Umbrella, _) => {
                run.apply(term, &Curvature::<U, false> { unsigned, linear })
            }
        }
    }
}

/// The formula for a numerator and an area.
struct Curvature<const NUMERATOR: u8, const VORONOI: bool> {
    /// Whether the linear term takes |c| for c or n·c.
    unsigned: bool,
    /// Whether there is a linear term at all.
    linear: bool,
}

impl<const NUMERATOR: u8, const VORONOI: bool> VertexFormula for Curvature<NUMERATOR, VORONOI> {
    const USES: Needs = {
        let area = if VORONOI { Needs::VORONOI_AREAS } else { Needs::empty() };
        area.union(match NUMERATOR {
            _ if Self::IS_SCALAR => Needs::CURVATURES,
            _ if Self::IS_COTANGENT => Needs::COTANGENTS.union(Needs::NORMALS),
            _ => Needs::UMBRELLAS.union(Needs::NORMALS),
        })
    };

    #[inline(always)]
    fn apply<R: Real>(
        &self,
        place: Place,
        vertex: &Vertex<R>,
        partials: &mut Vertex<R>,
    ) -> Sums<R> {
        let area = if VORONOI { vertex.voronoi_area } else { vertex.area };
        let (rigidity, spontaneous) = (place.value(RIGIDITY, area), place.value(SPONTANEOUS, area));
        let (square, linear) = self.measure(vertex);
        let per_area = area.of(1.0) / area;
        let density = square * per_area;
        let by_rigidity = (density + spontaneous * (spontaneous * area - linear - linear)) * 0.5;
        let by_spontaneous = rigidity * (spontaneous * area - linear);
        let half = rigidity * 0.5;
        let by_area = half * (spontaneous * spontaneous - density * per_area);
        let slot = if VORONOI { &mut partials.voronoi_area } else { &mut partials.area };
        *slot = *slot + by_area;
        let by_linear = area.zero() - rigidity * spontaneous;
        self.spread(vertex, partials, half * per_area, by_linear);
        Sums { energy: rigidity * by_rigidity, by_parameter: [by_rigidity, by_spontaneous] }
    }
}

impl<const NUMERATOR: u8, const VORONOI: bool> Curvature<NUMERATOR, VORONOI> {
    const IS_SCALAR: bool = NUMERATOR == Numerator::Julicher as u8;
    const IS_COTANGENT: bool = NUMERATOR == Numerator::Cotangent as u8;

    #[inline(always)]
    fn vector<R: Real>(vertex: &Vertex<R>) -> [R; 3] {
        if Self::IS_COTANGENT { vertex.cotangent } else { vertex.umbrella }
    }

    /// c² and the linear term: c or |c|, n·c or |c|.
    #[inline(always)]
    fn measure<R: Real>(&self, vertex: &Vertex<R>) -> (R, R) {
        if Self::IS_SCALAR {
            let c = vertex.curvature;
            return (c * c, if self.unsigned { c.max(c.zero() - c) } else { c });
        }
        let vector = Self::vector(vertex);
        let square = dot(vector, vector);
        if !self.linear {
            return (square, square.zero());
        }
        if self.unsigned {
            return (square, square.sqrt());
        }
        // A vertex whose normals cancel has no normal.
        let length = dot(vertex.normal_sum, vertex.normal_sum).sqrt();
        let along = dot(vector, vertex.normal_sum) / length;
        (square, along.or_else(length.above(length.zero()), length))
    }

    /// The way back, from the derivatives with respect to c² and to the linear term.
    #[inline(always)]
    fn spread<R: Real>(
        &self,
        vertex: &Vertex<R>,
        partials: &mut Vertex<R>,
        by_square: R,
        by_linear: R,
    ) {
        let zero = by_square.zero();
        if Self::IS_SCALAR {
            let c = vertex.curvature;
            // At 0, where |c| has no derivative, the mean of those on its two sides.
            let sign = if self.unsigned {
                let one = zero.of(1.0);
                one.or_else(c.above(zero), (zero - one).or_else(zero.above(c), zero))
            } else {
                zero.of(1.0)
            };
            partials.curvature = partials.curvature + (c + c) * by_square + sign * by_linear;
            return;
        }
        let vector = Self::vector(vertex);
        let mut partial = plus_scaled([zero; 3], by_square + by_square, vector);
        if self.linear {
            // |c| has no derivative at 0, where the mean over all directions is 0; and a vertex whose normals
            // cancel has no normal.
            let direction = if self.unsigned { vector } else { vertex.normal_sum };
            let length = dot(direction, direction).sqrt();
            let inverse = (zero.of(1.0) / length).or_else(length.above(zero), zero);
            let unit = scaled(direction, inverse);
            partial = plus_scaled(partial, by_linear, unit);
            if !self.unsigned {
                let across = plus_scaled(vector, zero - dot(unit, vector), unit);
                partials.normal_sum = plus_scaled(partials.normal_sum, by_linear * inverse, across);
            }
        }
        let slot =
            if Self::IS_COTANGENT { &mut partials.cotangent } else { &mut partials.umbrella };
        *slot = plus(*slot, partial);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::{Vec3, VertexGeometry, VertexPartials};
    use crate::mesh::vertex_vectors::VertexVectors;
    use crate::test_meshes::noise;

    type State = (VertexGeometry, VertexVectors);
    type Partials = (VertexPartials, VertexVectors);

    fn evaluate(
        state: &State,
        form: usize,
        switches: u32,
        values: [f64; 2],
    ) -> (Contribution, Partials) {
        let mut term = Term::new("BendingForce", form, &values).unwrap();
        term.switches = switches;
        let (scalars, vectors) = ([state.0], [state.1]);
        let mut partials = ([VertexPartials::default()], [VertexVectors::default()]);
        let run = Vertices::Plain {
            first: 0,
            total: 1,
            left_out: &[],
            scalars: &scalars,
            vectors: &vectors,
            scalar_partials: &mut partials.0,
            vector_partials: &mut partials.1,
        };
        let sum = Bending.vertices(&term, run);
        (sum, (partials.0[0], partials.1[0]))
    }

    fn state() -> State {
        let mut random = noise(5);
        let mut vector = || Vec3::new(random(), random(), random());
        let scalars = VertexGeometry { area: 1.7, voronoi_area: 1.4, curvature: -0.6 };
        let vectors =
            VertexVectors { cotangent: vector(), umbrella: vector(), normal_sum: vector() };
        (scalars, vectors)
    }

    #[test]
    fn energies_are_those_of_the_formulas() {
        let (k, c0) = (1.3, 0.4);
        let (vertex, vectors) = state();
        let n = vectors.normal_sum.normalize();
        let energy = |square: f64, linear: f64, a: f64| {
            0.5 * k * (square / a - 2.0 * c0 * linear + c0 * c0 * a)
        };
        let (j, s, u) = (vertex.curvature, vectors.cotangent, vectors.umbrella);
        let (b, v) = (vertex.area, vertex.voronoi_area);
        let signed = [
            energy(j * j, j, b),
            energy(s.norm_squared(), n.dot(&s), v),
            energy(s.norm_squared(), n.dot(&s), b),
            energy(j * j, j, v),
            energy(u.norm_squared(), n.dot(&u), b),
        ];
        let unsigned = [
            energy(j * j, j.abs(), b),
            energy(s.norm_squared(), s.norm(), v),
            energy(s.norm_squared(), s.norm(), b),
            energy(j * j, j.abs(), v),
            energy(u.norm_squared(), u.norm(), b),
        ];
        for form in 0..5 {
            for (switches, expected) in [(0, signed[form]), (UNSIGNED, unsigned[form])] {
                let found = evaluate(&state(), form, switches, [k, c0]).0.energy;
                assert!((found - expected).abs() < 1e-14, "{form} {switches}");
            }
        }
    }

    #[test]
    fn derivatives_match_finite_differences() {
        let h = 1e-6;
        let central = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        for form in 0..5 {
            for switches in [0, UNSIGNED] {
                let (k, c0) = (1.3, -0.4);
                let energy =
                    |state: &State, k, c0| evaluate(state, form, switches, [k, c0]).0.energy;
                let moved = |change: &dyn Fn(&mut State, f64)| {
                    central(&|shift| {
                        let mut state = state();
                        change(&mut state, shift);
                        energy(&state, k, c0)
                    })
                };
                let (sum, (scalars, vectors)) = evaluate(&state(), form, switches, [k, c0]);
                let mut checks = vec![
                    (sum.by_parameter[0], central(&|s| energy(&state(), k + s, c0))),
                    (sum.by_parameter[1], central(&|s| energy(&state(), k, c0 + s))),
                    (scalars.area, moved(&|state, s| state.0.area += s)),
                    (scalars.voronoi_area, moved(&|state, s| state.0.voronoi_area += s)),
                    (scalars.curvature, moved(&|state, s| state.0.curvature += s)),
                ];
                for k in 0..3 {
                    checks
                        .push((vectors.cotangent[k], moved(&|state, s| state.1.cotangent[k] += s)));
                    checks.push((vectors.umbrella[k], moved(&|state, s| state.1.umbrella[k] += s)));
                    checks.push((
                        vectors.normal_sum[k],
                        moved(&|state, s| state.1.normal_sum[k] += s),
                    ));
                }
                for (index, (found, expected)) in checks.into_iter().enumerate() {
                    assert!((found - expected).abs() < 1e-8, "{form} {switches} {index}");
                }
            }
        }
    }

    #[test]
    fn vertices_can_have_their_own_values() {
        let mut term = Term::new("BendingForce", 0, &[1.0, 0.0]).unwrap();
        let (rigidities, spontaneous) = ([7.0, 2.0, 3.0], [9.0, 0.1, -0.2]);
        term.fields[..2].copy_from_slice(&[&rigidities, &spontaneous]);
        let scalars = [state().0; 2];
        let mut partials = [VertexPartials::default(); 2];
        let run = Vertices::Plain {
            first: 1,
            total: 3,
            left_out: &[],
            scalars: &scalars,
            vectors: &[],
            scalar_partials: &mut partials,
            vector_partials: &mut [],
        };
        let sum = Bending.vertices(&term, run);
        let one = |k, c0| evaluate(&state(), 0, 0, [k, c0]).0.energy;
        assert!((sum.energy - one(2.0, 0.1) - one(3.0, -0.2)).abs() < 1e-14);
        assert_eq!(sum.by_parameter, [0.0; 4]);
    }
}
