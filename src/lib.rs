//! Fluid membranes in OpenMM: energies and forces of triangulated vesicles.
//!
//! [`mesh`] validates a triangulated surface, closed or with borders, and holds its geometry; [`potentials`] state
//! energies of geometric quantities; [`evaluator`] runs both over a mesh and turns the potentials' partial derivatives
//! into forces. [`membrane`] lets the forces of one OpenMM Context that live on the same mesh share one evaluation, and
//! [`ffi`] hands it all to C++. ARCHITECTURE.md has a picture of all modules.
//!
//! Rust programs use the forces through [`force`], beside OpenMM's C API in [`openmm`].
//!
//! Units are OpenMM's (nm, ps, amu, kJ/mol). Orientation and signs are stated in [`mesh::geometry`].
//!
//! ```
//! use openmm_helfrich::evaluator::CpuEvaluator;
//! use openmm_helfrich::mesh::Topology;
//! use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term};
//! use std::sync::Arc;
//!
//! // A regular octahedron of area 4√3 that would rather have half of it.
//! let triangles =
//!     [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
//! let positions = [1., 0., 0., -1., 0., 0., 0., 1., 0., 0., -1., 0., 0., 0., 1., 0., 0., -1.];
//! let topology = Arc::new(Topology::new(&triangles, 6)?);
//! let area = Term::new("SurfaceAreaForce", 0, &[1.0, 2.0 * 3f64.sqrt()])?;
//! let (mut energy, mut forces) = ([Contribution::default()], [0.0; 18]);
//! let terms = [area];
//! let request = Request::new(&terms, &positions).with_energies(&mut energy);
//! CpuEvaluator::new(topology).evaluate(request.with_forces(&mut forces[..]))?;
//! assert!((energy[0].energy - 3f64.sqrt()).abs() < 1e-12);
//! assert!(forces[0] < 0.0);
//! # Ok::<(), openmm_helfrich::error::Error>(())
//! ```

#![deny(unsafe_op_in_unsafe_fn)]
#![warn(missing_docs)]

pub mod backend;
pub mod contact;
pub mod dynamics;
pub mod error;
pub mod evaluator;
pub mod ffi;
pub mod force;
mod lanes;
pub mod membrane;
pub mod mesh;
pub mod moves;
pub mod openmm;
pub mod potentials;
pub mod real;
mod remembered;
pub mod team;

#[cfg(test)]
mod test_meshes;
