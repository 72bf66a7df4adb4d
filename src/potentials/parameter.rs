//! The scalars of potentials: names, units, domains and defaults.

use crate::error::{Error, Result};
use std::f64::consts::PI;
use std::ffi::CStr;

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
    /// Whether it stands behind the form in constructors.
    pub last: bool,
}

impl Parameter {
    /// A scalar that the user must give, with its powers of kJ/mol and nm.
    pub const fn new(name: &'static CStr, energy: i8, length: i8, domain: Domain) -> Self {
        Self { name, energy, length, domain, default: None, per: None, last: false }
    }

    /// The same with a default.
    pub const fn or(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }

    /// The same, but it can be given for each element.
    pub const fn per(self, element: Element) -> Self {
        Self { per: Some(element), ..self }
    }

    /// The same, but behind the form in constructors, so that a scalar that is added to a class leaves older calls valid.
    pub const fn last(self) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
