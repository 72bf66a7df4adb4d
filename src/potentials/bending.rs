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

use super::{
    Contribution, Domain, Element, Needs, Parameter, Potential, Term, VertexSlopes, Vertices,
};
use crate::mesh::geometry::Vec3;
use crate::mesh::vertex_vectors::VertexVectors;
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

/// In the order of the names.
const SCHEMES: [(Numerator, Area); 5] = [
    (Numerator::Julicher, Area::Barycentric),
    (Numerator::Cotangent, Area::Voronoi),
    (Numerator::Cotangent, Area::Barycentric),
    (Numerator::Julicher, Area::Voronoi),
    (Numerator::Umbrella, Area::Barycentric),
];

const RIGIDITY: usize = 0;
const SPONTANEOUS: usize = 1;
const UNSIGNED: u32 = 1;

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
        const NAMES: &[&CStr] = &[
            c"Julicher",
            c"GompperKroll",
            c"GompperKrollBarycentric",
            c"JulicherVoronoi",
            c"Espriu",
        ];
        Some((c"scheme", NAMES))
    }

    fn switches(&self) -> &'static [&'static CStr] {
        &[c"unsignedSpontaneousCurvature"]
    }

    fn needs(&self, term: &Term) -> Needs {
        let (numerator, area) = SCHEMES[term.form];
        let mut needs = Needs::VERTICES;
        if numerator == Numerator::Julicher {
            needs |= Needs::CURVATURES;
        }
        if numerator != Numerator::Julicher || area == Area::Voronoi {
            needs |= Needs::VECTORS;
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

    fn vertices(&self, term: &Term, vertices: Vertices, slopes: VertexSlopes) -> Contribution {
        let unsigned = term.switches & UNSIGNED != 0;
        match SCHEMES[term.form].0 {
            Numerator::Julicher => sum(term, vertices, slopes, &Integrated { unsigned }),
            Numerator::Cotangent => sum(term, vertices, slopes, &Vector::<COTANGENT> { unsigned }),
            Numerator::Umbrella => sum(term, vertices, slopes, &Vector::<UMBRELLA> { unsigned }),
        }
    }
}

/// A numerator: c² and the linear term (n·c or |c|) of a vertex, and the way back from the derivatives
/// with respect to them.
trait Curvature {
    fn measure(&self, vertices: &Vertices, index: usize) -> (f64, f64);
    fn spread(
        &self,
        vertices: &Vertices,
        index: usize,
        slopes: &mut VertexSlopes,
        by_square: f64,
        by_linear: f64,
    );
}

/// The energy and its derivatives, for any numerator and area.
fn sum(
    term: &Term,
    vertices: Vertices,
    mut slopes: VertexSlopes,
    curvature: &impl Curvature,
) -> Contribution {
    let voronoi = SCHEMES[term.form].1 == Area::Voronoi;
    let mut total = Contribution::default();
    for (index, vertex) in vertices.scalars.iter().enumerate() {
        let rigidity = term.value(RIGIDITY, vertices.first + index);
        let spontaneous = term.value(SPONTANEOUS, vertices.first + index);
        let area = if voronoi { vertex.voronoi_area } else { vertex.area };
        let (square, linear) = curvature.measure(&vertices, index);
        let density = square / area;
        let by_rigidity = 0.5 * (density + spontaneous * (spontaneous * area - 2.0 * linear));
        total.energy += rigidity * by_rigidity;
        total.by_parameter[RIGIDITY] += by_rigidity;
        total.by_parameter[SPONTANEOUS] += rigidity * (spontaneous * area - linear);
        let by_area = 0.5 * rigidity * (spontaneous * spontaneous - density / area);
        let slot = &mut slopes.scalars[index];
        *if voronoi { &mut slot.voronoi_area } else { &mut slot.area } += by_area;
        let by_square = 0.5 * rigidity / area;
        curvature.spread(&vertices, index, &mut slopes, by_square, -rigidity * spontaneous);
    }
    for parameter in [RIGIDITY, SPONTANEOUS] {
        // A field hides the scalar, on which nothing depends then.
        if !term.is_scalar(parameter) {
            total.by_parameter[parameter] = 0.0;
        }
    }
    total
}

/// Jülicher's J.
struct Integrated {
    unsigned: bool,
}

impl Curvature for Integrated {
    #[inline]
    fn measure(&self, vertices: &Vertices, index: usize) -> (f64, f64) {
        let curvature = vertices.scalars[index].curvature;
        (curvature * curvature, if self.unsigned { curvature.abs() } else { curvature })
    }

    #[inline]
    fn spread(
        &self,
        vertices: &Vertices,
        index: usize,
        slopes: &mut VertexSlopes,
        by_square: f64,
        by_linear: f64,
    ) {
        let curvature = vertices.scalars[index].curvature;
        let sign = if self.unsigned { sign(curvature) } else { 1.0 };
        slopes.scalars[index].curvature += 2.0 * curvature * by_square + sign * by_linear;
    }
}

/// −1, 0 or 1; at 0, where |x| has no derivative, the mean of those on its two sides.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

const COTANGENT: u8 = 0;
const UMBRELLA: u8 = 1;

/// The vectors of Gompper and Kroll (`COTANGENT`) and of Espriu (`UMBRELLA`).
struct Vector<const KIND: u8> {
    unsigned: bool,
}

impl<const KIND: u8> Vector<KIND> {
    #[inline]
    fn pick(vectors: &VertexVectors) -> &Vec3 {
        if KIND == COTANGENT { &vectors.cotangent } else { &vectors.umbrella }
    }
}

impl<const KIND: u8> Curvature for Vector<KIND> {
    #[inline]
    fn measure(&self, vertices: &Vertices, index: usize) -> (f64, f64) {
        let vectors = &vertices.vectors[index];
        let vector = Self::pick(vectors);
        let square = vector.norm_squared();
        if self.unsigned {
            return (square, square.sqrt());
        }
        // Where nobody asked for normals their sums are zero, and so is what the linear term is for.
        let length = vectors.normal_sum.norm();
        let linear = if length > 0.0 { vector.dot(&vectors.normal_sum) / length } else { 0.0 };
        (square, linear)
    }

    #[inline]
    fn spread(
        &self,
        vertices: &Vertices,
        index: usize,
        slopes: &mut VertexSlopes,
        by_square: f64,
        by_linear: f64,
    ) {
        let vectors = &vertices.vectors[index];
        let vector = Self::pick(vectors);
        let mut slope = 2.0 * by_square * vector;
        let out = &mut slopes.vectors[index];
        if by_linear != 0.0 {
            let length = if self.unsigned { vector.norm() } else { vectors.normal_sum.norm() };
            // |c| has no derivative at 0, where the mean over all directions is 0; and a vertex whose
            // normals cancel has no normal.
            if length > 0.0 {
                if self.unsigned {
                    slope += vector * (by_linear / length);
                } else {
                    let normal = vectors.normal_sum / length;
                    slope += normal * by_linear;
                    let across = vector - normal * normal.dot(vector);
                    out.normal_sum += across * (by_linear / length);
                }
            }
        }
        *if KIND == COTANGENT { &mut out.cotangent } else { &mut out.umbrella } += slope;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::geometry::{VertexGeometry, VertexPartials};
    use crate::test_meshes::noise;

    type State = (VertexGeometry, VertexVectors);
    type Slopes = (VertexPartials, VertexVectors);

    fn evaluate(
        state: &State,
        form: usize,
        switches: u32,
        values: [f64; 2],
    ) -> (Contribution, Slopes) {
        let mut term = Term::new("BendingForce", form, &values).unwrap();
        term.switches = switches;
        let (scalars, vectors) = ([state.0], [state.1]);
        let mut slopes = ([VertexPartials::default()], [VertexVectors::default()]);
        let sum = Bending.vertices(
            &term,
            Vertices { first: 0, total: 1, scalars: &scalars, vectors: &vectors },
            VertexSlopes { scalars: &mut slopes.0, vectors: &mut slopes.1 },
        );
        (sum, (slopes.0[0], slopes.1[0]))
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
        let mut slopes = [VertexPartials::default(); 2];
        let sum = Bending.vertices(
            &term,
            Vertices { first: 1, total: 3, scalars: &scalars, vectors: &[] },
            VertexSlopes { scalars: &mut slopes, vectors: &mut [] },
        );
        let one = |k, c0| evaluate(&state(), 0, 0, [k, c0]).0.energy;
        assert!((sum.energy - one(2.0, 0.1) - one(3.0, -0.2)).abs() < 1e-14);
        assert_eq!(sum.by_parameter, [0.0; 4]);
    }
}
