//! The OpenMM force classes for Rust programs, beside OpenMM's C API in [`crate::openmm`].

use crate::error::{Error, Result};
use crate::ffi::c_api;
use crate::ffi::{Status, last_error};
use crate::openmm::OpenMM_Force;
use crate::potentials;
use std::ffi::{CString, c_int};

mod bond_flip;
mod domain_swap;
mod membrane_tension;
mod owned;
mod surface_viscosity;
pub use bond_flip::MonteCarloBondFlip;
pub use domain_swap::MonteCarloDomainSwap;
pub use membrane_tension::{Axes, MonteCarloMembraneTension};
use owned::Owned;
pub use surface_viscosity::SurfaceViscosityThermostat;

/// A force on a membrane that no System owns yet.
///
/// ```
/// use openmm_helfrich::force::MembraneForce;
/// let octahedron =
///     [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
/// let mut bending = MembraneForce::new("BendingForce", &octahedron, &[50.0])?;
/// assert_eq!(bending.get("spontaneousCurvature")?, 0.0);
/// bending.set("rigidity", 40.0)?.set_form("GompperKrollBarycentric")?;
/// assert_eq!(bending.get("rigidity")?, 40.0);
/// assert!(bending.set("rigidity", f64::NAN).is_err());
///
/// let at_rest = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
/// let mut skeleton = MembraneForce::new("SkalakForce", &octahedron, &[0.4, 1.0])?;
/// skeleton.set_reference(&at_rest, None)?;
/// assert!(bending.set_reference(&at_rest, None).is_err());
/// let mut line = MembraneForce::new("LineTensionForce", &octahedron, &[2.0])?;
/// line.set_domains(&[0, 0, 0, 0, 0, 1])?;
/// assert!(skeleton.set_domains(&[0; 6]).is_err());
/// # Ok::<(), openmm_helfrich::error::Error>(())
/// ```
pub struct MembraneForce {
    force: Owned,
    class: &'static str,
}

/// The message of a C function that has failed.
fn check(status: Status) -> Result<()> {
    match status {
        Status::Success => Ok(()),
        Status::Failure => Err(Error::Contract(last_error())),
    }
}

fn c_text(text: &str) -> Result<CString> {
    CString::new(text).map_err(|_| Error::Contract(format!("the name {text:?} has a NUL inside")))
}

impl MembraneForce {
    /// A force of a class ("BendingForce") on triangles of particle indices, counter-clockwise seen from
    /// outside, with the scalars of the class in the order of its C++ constructor. The last ones may be left out if
    /// they have a default.
    ///
    /// # Errors
    /// An unknown class, a scalar that is missing, too many, or one outside its domain.
    pub fn new(class: &str, triangles: &[[c_int; 3]], values: &[f64]) -> Result<Self> {
        let known = potentials::find(class)?.name();
        let count = |length: usize| {
            c_int::try_from(length).map_err(|_| Error::Contract("too many triangles".to_owned()))
        };
        let name = c_text(class)?;
        let corners = triangles.as_flattened();
        // SAFETY: the arrays are as long as is said, and the shim copies them.
        let force = unsafe {
            c_api::create(name.as_ptr(), corners.as_ptr(), count(triangles.len())?, values, 0)
        };
        // SAFETY: nobody else has it.
        let force = unsafe { Owned::new(force) }?;
        Ok(Self { force, class: known })
    }

    /// The value of a scalar, in OpenMM's units.
    ///
    /// # Errors
    /// An unknown name.
    pub fn get(&self, parameter: &str) -> Result<f64> {
        let (name, mut value) = (c_text(parameter)?, f64::NAN);
        // SAFETY: the force is alive and the name ends with a NUL.
        check(unsafe {
            c_api::Helfrich_MembraneForce_getParameterValue(
                self.force.as_ptr(),
                name.as_ptr(),
                &mut value,
            )
        })?;
        Ok(value)
    }

    /// Set a scalar; values of single elements are given up.
    ///
    /// # Errors
    /// An unknown name, or a value outside its domain.
    pub fn set(&mut self, parameter: &str, value: f64) -> Result<&mut Self> {
        let name = c_text(parameter)?;
        // SAFETY: the force is alive and the name ends with a NUL.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setParameterValue(
                self.force.as_ptr(),
                name.as_ptr(),
                value,
            )
        })?;
        Ok(self)
    }

    /// Give a scalar its own value for each vertex, triangle, edge or particle, whichever the class has.
    ///
    /// # Errors
    /// An unknown name, a scalar that cannot have them, or a value outside its domain.
    pub fn set_elements(&mut self, parameter: &str, values: &[f64]) -> Result<&mut Self> {
        let name = c_text(parameter)?;
        // SAFETY: the force is alive, the name ends with a NUL, the values are as many as is said.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setElementValues(
                self.force.as_ptr(),
                name.as_ptr(),
                values.as_ptr(),
                values.len() as c_int,
            )
        })?;
        Ok(self)
    }

    /// Set the particles that a ParticleSurfaceForce acts on.
    ///
    /// # Errors
    /// Another class.
    pub fn set_particles(&mut self, particles: &[c_int]) -> Result<&mut Self> {
        let (force, count) = (self.force.as_ptr(), particles.len() as c_int);
        // SAFETY: the force is alive, and the particles are as many as is said.
        check(unsafe {
            c_api::Helfrich_ParticleSurfaceForce_setParticles(force, particles.as_ptr(), count)
        })?;
        Ok(self)
    }

    /// Say whether the surface lives in the periodic box of the Context.
    ///
    /// # Errors
    /// None that is known.
    pub fn set_uses_periodic_boundary_conditions(&mut self, periodic: bool) -> Result<&mut Self> {
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setUsesPeriodicBoundaryConditions(
                self.force.as_ptr(),
                c_int::from(periodic),
            )
        })?;
        Ok(self)
    }

    /// Set where the vertices are at rest, nm, in ascending order of particle index, and in which periodic box.
    ///
    /// # Errors
    /// A class that has no reference, a position that is not finite, or no box.
    pub fn set_reference(
        &mut self,
        positions: &[[f64; 3]],
        box_vectors: Option<&[[f64; 3]; 3]>,
    ) -> Result<&mut Self> {
        let (numbers, count) = (positions.as_ptr().cast(), positions.len() as c_int);
        let vectors = box_vectors.map_or(std::ptr::null(), |rows| rows.as_ptr().cast());
        // SAFETY: the force is alive, and the positions are as many as is said.
        check(unsafe {
            let force = self.force.as_ptr();
            c_api::Helfrich_MembraneForce_setReference(force, numbers, count, vectors)
        })?;
        Ok(self)
    }

    /// Say to which domain each vertex belongs, in ascending order of particle index.
    ///
    /// # Errors
    /// Another class than LineTensionForce.
    pub fn set_domains(&mut self, domains: &[c_int]) -> Result<&mut Self> {
        let (force, count) = (self.force.as_ptr(), domains.len() as c_int);
        // SAFETY: the force is alive, and the domains are as many as is said.
        check(unsafe {
            c_api::Helfrich_LineTensionForce_setDomains(force, domains.as_ptr(), count)
        })?;
        Ok(self)
    }

    /// Choose a form by its name, such as a bending scheme.
    ///
    /// # Errors
    /// A form that the class does not have.
    pub fn set_form(&mut self, name: &str) -> Result<&mut Self> {
        let (_, names) = potentials::find(self.class)?.forms().unwrap_or((c"form", &[]));
        let form = names.iter().position(|known| known.to_bytes() == name.as_bytes());
        let form = form.ok_or_else(|| {
            let known: Vec<_> = names.iter().map(|name| name.to_string_lossy()).collect();
            let known = match known.is_empty() {
                true => "it has none".to_owned(),
                false => format!("known are: {}", known.join(", ")),
            };
            Error::Contract(format!("{}: there is no form {name:?}; {known}", self.class))
        })?;
        // SAFETY: the force is alive.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setForm(self.force.as_ptr(), form as c_int)
        })?;
        Ok(self)
    }

    /// Choose what computes the force: "cpu", "gpu", "gpu:single", "gpu:double", "auto", or "" for what the
    /// process has chosen.
    ///
    /// # Errors
    /// An unknown backend.
    pub fn set_backend(&mut self, backend: &str) -> Result<&mut Self> {
        let backend = c_text(backend)?;
        // SAFETY: the force is alive and the text ends with a NUL.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setBackend(self.force.as_ptr(), backend.as_ptr())
        })?;
        Ok(self)
    }

    /// Let a Context parameter take the place of a scalar.
    ///
    /// # Errors
    /// An unknown scalar.
    pub fn set_context_parameter(&mut self, parameter: &str, name: &str) -> Result<&mut Self> {
        let (parameter, name) = (c_text(parameter)?, c_text(name)?);
        // SAFETY: the force is alive and the texts end with a NUL.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setContextParameter(
                self.force.as_ptr(),
                parameter.as_ptr(),
                name.as_ptr(),
            )
        })?;
        Ok(self)
    }

    /// Ask for the derivative of the energy with respect to a Context parameter.
    ///
    /// # Errors
    /// No scalar has this Context parameter.
    pub fn add_energy_parameter_derivative(&mut self, name: &str) -> Result<&mut Self> {
        let name = c_text(name)?;
        // SAFETY: the force is alive and the name ends with a NUL.
        check(unsafe {
            c_api::Helfrich_MembraneForce_addEnergyParameterDerivative(
                self.force.as_ptr(),
                name.as_ptr(),
            )
        })?;
        Ok(self)
    }

    /// Switch something on or off, such as "unsignedSpontaneousCurvature".
    ///
    /// # Errors
    /// An unknown name.
    pub fn set_switch(&mut self, name: &str, on: bool) -> Result<&mut Self> {
        let name = c_text(name)?;
        // SAFETY: the force is alive and the name ends with a NUL.
        check(unsafe {
            c_api::Helfrich_MembraneForce_setSwitch(self.force.as_ptr(), name.as_ptr(), on.into())
        })?;
        Ok(self)
    }

    /// The force as OpenMM's C API knows it. Keep it to steer a force that a System has taken over, with the
    /// functions of [`crate::ffi::c_api`]; it lives as long as the System.
    pub fn as_openmm(&self) -> *mut OpenMM_Force {
        self.force.as_ptr()
    }

    /// The force for `OpenMM_System_addForce`, which takes it over.
    pub fn into_openmm(self) -> *mut OpenMM_Force {
        self.force.into_openmm()
    }
}
