//! Potentials: energies of geometric quantities, and their partial derivatives.
//!
//! A potential states its energy and its derivatives with respect to geometry and never touches a
//! coordinate; the chain rule from there to forces is in [`crate::mesh`]. Each potential is one file
//! here; `.ci/potentials.py` writes the list of all, [`REGISTRY`].

pub mod codes;
mod constants;
mod elements;
mod in_lanes;
mod parameter;
mod request;
mod runs;
mod strain;
mod term;

// .ci/potentials.py writes what follows, from the files here with an `impl Potential`.
pub(crate) mod area_difference;
pub(crate) mod bending;
pub(crate) mod dihedral;
pub(crate) mod edge_tension;
pub(crate) mod enclosed_volume;
pub(crate) mod gaussian_curvature;
pub(crate) mod lim;
pub(crate) mod line_tension;
pub(crate) mod linear_elastic;
pub(crate) mod neo_hookean;
pub(crate) mod osmotic_pressure;
pub(crate) mod particle_surface;
pub(crate) mod plaquette_area;
pub(crate) mod pressure;
pub(crate) mod skalak;
pub(crate) mod spring;
pub(crate) mod surface_area;
pub(crate) mod surface_repulsion;
pub(crate) mod surface_tension;
pub(crate) mod triangle_area;
pub(crate) mod triangle_area_repulsion;
pub(crate) mod triangle_height;

/// All potentials, by the names of their OpenMM classes.
pub static REGISTRY: [&dyn Potential; 22] = [
    &area_difference::AreaDifference,
    &bending::Bending,
    &dihedral::Dihedral,
    &edge_tension::EdgeTension,
    &enclosed_volume::EnclosedVolume,
    &gaussian_curvature::GaussianCurvature,
    &lim::Lim,
    &line_tension::LineTension,
    &linear_elastic::LinearElastic,
    &neo_hookean::NeoHookean,
    &osmotic_pressure::OsmoticPressure,
    &particle_surface::ParticleSurface,
    &plaquette_area::PlaquetteArea,
    &pressure::Pressure,
    &skalak::Skalak,
    &spring::Spring,
    &surface_area::SurfaceArea,
    &surface_repulsion::SurfaceRepulsion,
    &surface_tension::SurfaceTension,
    &triangle_area::TriangleArea,
    &triangle_area_repulsion::TriangleAreaRepulsion,
    &triangle_height::TriangleHeight,
];
// Up to here.

use crate::error::{Error, Result};
use crate::mesh::borders::{BorderPartials, BorderTotals};
use crate::mesh::geometry::{TotalPartials, Totals};
use crate::real::Real;
pub use codes::{Attraction, CONSTANTS, Contribution, MAX_PARAMETERS, Needs};
pub use constants::{Common, Constants, Corners, Flaw, MadeOf, TriangleConstants, VertexNumbers};
pub use elements::*;
pub use parameter::{Domain, Element, Parameter};
pub use request::{Evaluator, Request};
pub use runs::*;
use std::ffi::CStr;
pub use surface_repulsion::ONLY_BETWEEN_PARTS;
pub use term::{Term, Values};

impl std::ops::AddAssign for Contribution {
    fn add_assign(&mut self, other: Self) {
        self.energy += other.energy;
        for (sum, value) in self.by_parameter.iter_mut().zip(other.by_parameter) {
            *sum += value;
        }
    }
}

/// A value of one of the totals of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Total {
    /// nm².
    Area(f64),
    /// nm³.
    Volume(f64),
    /// nm.
    MeanCurvature(f64),
}

/// One kind of energy. The methods for elements get a run of them to apply a formula to; a potential
/// implements those that it [`Needs`].
pub trait Potential: Sync {
    /// The name of the OpenMM class.
    fn name(&self) -> &'static str;

    /// The scalars.
    fn parameters(&self) -> &'static [Parameter];

    /// What the forms of the potential are called as a whole ("scheme"), and their names.
    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        None
    }

    /// The names of what can be switched on; all are off by default.
    fn switches(&self) -> &'static [&'static CStr] {
        &[]
    }

    /// Where energy is added, and from what.
    fn needs(&self, term: &Term) -> Needs;

    /// The constants that it has for each triangle, if any: what the user gives for each vertex, and what becomes of it.
    fn constants(&self, _: &Term) -> Option<MadeOf> {
        None
    }

    /// The units of the constants, as powers of nm.
    fn constant_lengths(&self) -> [i8; CONSTANTS] {
        [0; CONSTANTS]
    }

    /// Whether the energy makes no sense on a surface that is turned inside out. Such a surface is refused when it is
    /// first evaluated; what a shape becomes later is not. One with a border, which has no outside, is refused at once.
    fn needs_outside(&self) -> bool {
        false
    }

    /// Whether the energy of vertices acts on those at a border, too.
    fn acts_at_borders(&self) -> bool {
        true
    }

    /// Whether no vertex can have an energy below zero: then a move that must gain more than its vertices have is
    /// refused without a look at what they would get. To say no is always right, but slower.
    fn is_never_negative(&self, _: &Term) -> bool {
        false
    }

    /// The total that the energy is a function of, at the value from which it is measured: single precision takes the
    /// difference before it rounds.
    fn reference(&self, _: &Term) -> Option<Total> {
        None
    }

    /// Whether a side of a triangle can become too long for it: then every evaluation, also of forces alone, refuses an
    /// energy that is not finite.
    fn limits_sides(&self, _: &Term) -> bool {
        false
    }

    /// The lengths, nm, that the sides of a triangle must stay below, if there are any such.
    fn longest_sides(&self, _: &Term, _: &Constants) -> [f64; 3] {
        [f64::INFINITY; 3]
    }

    /// Energy of the total area, volume and mean curvature.
    fn totals(&self, _: &Term, _: &Totals, _: &mut TotalPartials) -> Contribution {
        Contribution::default()
    }

    /// Energy of the borders. Evaluators know nothing of it: it is added beside them.
    fn borders(&self, _: &Term, _: &BorderTotals, _: &mut BorderPartials) -> Contribution {
        Contribution::default()
    }

    /// Energy of a run of triangles.
    fn triangles(&self, _: &Term, _: Triangles) -> Contribution {
        Contribution::default()
    }

    /// Energy of a run of edges.
    fn edges(&self, _: &Term, _: Edges) -> Contribution {
        Contribution::default()
    }

    /// Energy of a run of vertices.
    fn vertices(&self, _: &Term, _: Vertices) -> Contribution {
        Contribution::default()
    }
}

/// The potential of a class name.
pub fn find(name: &str) -> Result<&'static dyn Potential> {
    REGISTRY.into_iter().find(|potential| potential.name() == name).ok_or_else(|| {
        Error::UnknownName {
            what: "potential",
            name: name.to_owned(),
            known: REGISTRY.map(|potential| potential.name()).join(", "),
        }
    })
}

/// Energy of the kind of Weeks, Chandler and Andersen, ε (x − ½)² = ε (x² − x + ¼) with x = (d/h)⁴, of
/// the repulsion below a distance: (x − ½)² and its derivative with respect to x, 0 below x = ½.
#[inline(always)]
fn repulsion<R: Real>(x: R) -> (R, R) {
    let excess = (x - 0.5).max(x.zero());
    (excess * excess, excess + excess)
}

/// Energy ½ k (x − x₀)² / x₀ of a quantity x around its target, with its derivatives with respect to k and
/// x₀, and its derivative with respect to x.
#[inline(always)]
fn relative_spring<R: Real>(modulus: R, target: R, value: R) -> (Sums<R>, R) {
    let stretch = value - target;
    let strain = stretch / target;
    let by_modulus = strain * stretch * 0.5;
    let by_target = (value.zero() - modulus) * (strain + strain * strain * 0.5);
    (Sums { energy: modulus * by_modulus, by_parameter: [by_modulus, by_target] }, modulus * strain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for potential in REGISTRY {
            assert_eq!(find(potential.name()).unwrap().name(), potential.name());
            assert!(potential.parameters().len() <= MAX_PARAMETERS);
        }
        assert!(find("NoSuchForce").is_err());
    }

    #[test]
    fn energies_of_totals_say_which_total() {
        for potential in REGISTRY {
            // A half is in every domain.
            let values = vec![0.5; potential.parameters().len()];
            let term = Term::new(potential.name(), 0, &values).unwrap();
            let acts = potential.needs(&term).contains(Needs::TOTALS);
            assert_eq!(potential.reference(&term).is_some(), acts, "{}", potential.name());
        }
    }

    #[test]
    fn relative_spring_has_exact_derivatives() {
        let (k, x0, x, h) = (1.7, 3.0, 3.4, 1e-6);
        let energy = |k, x0, x| relative_spring(k, x0, x).0.energy;
        let (contribution, slope) = relative_spring(k, x0, x);
        let [by_k, by_x0] = contribution.by_parameter;
        let central = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        assert!((slope - central(&|s| energy(k, x0, x + s))).abs() < 1e-9);
        assert!((by_k - central(&|s| energy(k + s, x0, x))).abs() < 1e-9);
        assert!((by_x0 - central(&|s| energy(k, x0 + s, x))).abs() < 1e-9);
    }
}
