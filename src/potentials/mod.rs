//! Potentials: energies of geometric quantities, and their partial derivatives.
//!
//! A potential states its energy and its derivatives with respect to geometry and never touches a
//! coordinate; the chain rule from there to forces is in [`crate::mesh`]. Each potential is one file
//! here, and one line in [`REGISTRY`].

mod area_difference;
mod bending;
pub mod codes;
mod constants;
mod dihedral;
mod edge_tension;
mod elements;
mod enclosed_volume;
mod gaussian_curvature;
mod lim;
mod line_tension;
mod linear_elastic;
mod neo_hookean;
mod osmotic_pressure;
pub(crate) mod particle_surface;
mod plaquette_area;
mod pressure;
mod runs;
mod skalak;
mod spring;
mod strain;
mod surface_area;
pub(crate) mod surface_repulsion;
mod surface_tension;
mod triangle_area;
mod triangle_area_repulsion;
mod triangle_height;

use crate::error::{Error, Result};
use crate::mesh::borders::{BorderPartials, BorderTotals};
use crate::mesh::geometry::{TotalPartials, Totals};
use crate::real::Real;
pub use codes::{Attraction, CONSTANTS, Contribution, MAX_PARAMETERS, Needs};
pub use constants::{Common, Constants, Corners, Flaw, MadeOf, TriangleConstants, VertexNumbers};
pub use elements::*;
pub use runs::*;
use std::f64::consts::PI;
use std::ffi::CStr;
pub use surface_repulsion::ONLY_BETWEEN_PARTS;

/// All potentials, by the names of their OpenMM classes.
pub static REGISTRY: [&dyn Potential; 22] = [
    &surface_area::SurfaceArea,
    &enclosed_volume::EnclosedVolume,
    &bending::Bending,
    &triangle_height::TriangleHeight,
    &dihedral::Dihedral,
    &triangle_area::TriangleArea,
    &plaquette_area::PlaquetteArea,
    &triangle_area_repulsion::TriangleAreaRepulsion,
    &edge_tension::EdgeTension,
    &gaussian_curvature::GaussianCurvature,
    &surface_repulsion::SurfaceRepulsion,
    &particle_surface::ParticleSurface,
    &skalak::Skalak,
    &lim::Lim,
    &pressure::Pressure,
    &surface_tension::SurfaceTension,
    &osmotic_pressure::OsmoticPressure,
    &area_difference::AreaDifference,
    &neo_hookean::NeoHookean,
    &linear_elastic::LinearElastic,
    &spring::Spring,
    &line_tension::LineTension,
];

/// What a scalar may be given for one by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Element {
    /// A value for each vertex, in ascending order of particle index.
    Vertex,
    /// A value for each triangle.
    Triangle,
    /// A value for each edge, in lexicographic order of the particles at its ends, the lower one first.
    Edge,
    /// A value for each of the term's particles that are no vertices.
    Particle,
}

/// Which values a scalar may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// Finite and above zero.
    Positive,
    /// Finite and not below zero.
    NonNegative,
    /// Above zero and below one.
    Share,
    /// Finite.
    Real,
    /// From −π to π.
    Angle,
}

/// A scalar parameter of a potential. Its unit is (kJ/mol)^`energy` · nm^`length`.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// As in XML, `setContextParameter` and the Python constructor.
    pub name: &'static CStr,
    /// Power of kJ/mol.
    pub energy: i8,
    /// Power of nm.
    pub length: i8,
    /// Allowed values.
    pub domain: Domain,
    /// What it is if the user does not say; `None` if the user must.
    pub default: Option<f64>,
    /// For what it can be given one by one.
    pub per: Option<Element>,
    /// Whether it stands behind the variant in constructors.
    pub last: bool,
}

impl Parameter {
    /// A scalar that the user must give, with its powers of kJ/mol and nm.
    const fn new(name: &'static CStr, energy: i8, length: i8, domain: Domain) -> Self {
        Self { name, energy, length, domain, default: None, per: None, last: false }
    }

    /// The same with a default.
    const fn or(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }

    /// The same, but it can be given for each element.
    const fn per(self, element: Element) -> Self {
        Self { per: Some(element), ..self }
    }

    /// The same, but behind the variant in constructors, as what has come later must be.
    const fn last(self) -> Self {
        Self { last: true, ..self }
    }

    /// Refuse a value outside the domain, NaN and infinity in any case.
    pub fn check(&self, value: f64) -> Result<()> {
        let (allowed, domain) = match self.domain {
            Domain::Positive => (value > 0.0, "a finite number above zero"),
            Domain::NonNegative => (value >= 0.0, "a finite number, zero or above"),
            Domain::Share => (value > 0.0 && value < 1.0, "a number above zero and below one"),
            Domain::Real => (true, "a finite number"),
            Domain::Angle => (value.abs() <= PI, "an angle from -pi to pi"),
        };
        if allowed && value.is_finite() {
            return Ok(());
        }
        Err(Error::Parameter { parameter: self.name.to_string_lossy().into_owned(), domain, value })
    }
}

impl std::ops::AddAssign for Contribution {
    fn add_assign(&mut self, other: Self) {
        self.energy += other.energy;
        for (sum, value) in self.by_parameter.iter_mut().zip(other.by_parameter) {
            *sum += value;
        }
    }
}

/// The values that a potential is evaluated with.
pub type Values = [f64; MAX_PARAMETERS];

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

    /// What the variants are called as a whole ("scheme"), and their names.
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

/// A potential with its variant and values.
#[derive(Clone, Copy)]
pub struct Term<'a> {
    /// From the [`REGISTRY`].
    pub potential: &'static dyn Potential,
    /// Index into the names of [`Potential::forms`]; 0 if there are none.
    pub form: usize,
    /// One bit for each of [`Potential::switches`].
    pub switches: u32,
    /// One for each parameter; the rest is unused.
    pub values: Values,
    /// For each parameter the values of the single elements that replace it; empty if there are none.
    pub fields: [&'a [f64]; MAX_PARAMETERS],
    /// Particles beside the vertices that the term acts on, by their indices in the System.
    pub particles: &'a [u32],
    /// What the user has given for each vertex, if the potential has constants of triangles; their owner and version tell
    /// whether the constants hold.
    pub numbers: &'a VertexNumbers,
    /// These constants; a [`Membrane`](crate::membrane::Membrane) makes them.
    pub constants: &'a TriangleConstants,
    /// Whether the derivatives with respect to the scalars will be read; those that cost extra may be
    /// wrong otherwise.
    pub wants_derivatives: bool,
}

impl<'a> Term<'a> {
    /// Look up a potential and check its values.
    ///
    /// # Errors
    /// An unknown name or variant, too few or too many values, a value outside its domain.
    pub fn new(name: &str, form: usize, values: &[f64]) -> Result<Self> {
        let potential = find(name)?;
        let forms = potential.forms().map_or(1, |(_, names)| names.len());
        if form >= forms {
            return Err(Error::Contract(format!("there is no variant {form}, only {forms}")));
        }
        let count = potential.parameters().len();
        if values.len() != count {
            return Err(Error::Contract(format!("needs {count} values, got {}", values.len())));
        }
        let mut padded = Values::default();
        padded[..count].copy_from_slice(values);
        let term = Self { form, values: padded, ..Self::of(potential) };
        term.check()?;
        Ok(term)
    }

    /// A potential with zeros for values, and nothing else.
    pub fn of(potential: &'static dyn Potential) -> Self {
        Self {
            potential,
            form: 0,
            switches: 0,
            values: Values::default(),
            fields: Default::default(),
            particles: &[],
            numbers: VertexNumbers::NONE,
            constants: TriangleConstants::NONE,
            wants_derivatives: false,
        }
    }

    /// Refuse values outside their domains.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<()> {
        let parameters = self.potential.parameters();
        parameters
            .iter()
            .zip(&self.values)
            .try_for_each(|(parameter, value)| parameter.check(*value))
    }

    /// The value of a parameter at an element.
    #[inline]
    pub fn value(&self, parameter: usize, element: usize) -> f64 {
        self.fields[parameter].get(element).copied().unwrap_or(self.values[parameter])
    }

    /// Whether a parameter is a single value that may change what is computed: zero everywhere.
    pub fn vanishes(&self, parameter: usize) -> bool {
        self.fields[parameter].is_empty() && self.values[parameter] == 0.0
    }

    /// Whether a parameter has a value for each vertex.
    pub fn is_of_vertices(&self, parameter: usize) -> bool {
        let known = self.potential.parameters().get(parameter);
        known.is_some_and(|known| known.per == Some(Element::Vertex))
            && !self.fields[parameter].is_empty()
    }

    /// Whether a derivative with respect to this parameter makes sense: a field hides the scalar.
    #[inline]
    pub fn is_scalar(&self, parameter: usize) -> bool {
        self.fields[parameter].is_empty()
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
    fn domains_are_kept() {
        let parameter = |domain| Parameter::new(c"x", 0, 1, domain);
        assert!(parameter(Domain::Angle).check(3.2).is_err());
        assert!(parameter(Domain::Share).check(0.999).is_ok());
        for value in [f64::NAN, -0.1, 0.0, 1.0, f64::INFINITY] {
            assert!(parameter(Domain::Share).check(value).is_err());
        }
        for domain in [Domain::Positive, Domain::NonNegative, Domain::Real, Domain::Angle] {
            assert!(parameter(domain).check(f64::NAN).is_err());
            assert!(parameter(domain).check(f64::INFINITY).is_err());
            assert!(parameter(domain).check(1.0).is_ok());
            assert_eq!(parameter(domain).check(0.0).is_ok(), domain != Domain::Positive);
            let negative = [Domain::Real, Domain::Angle].contains(&domain);
            assert_eq!(parameter(domain).check(-1.0).is_ok(), negative);
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
