//! The structures that cross the border to C++.
//!
//! build.rs includes this file, and has the C++ compiler compare those of `Core.h` and `HelfrichDynamics.h` with their layout.

use crate::potentials::{Contribution, MAX_PARAMETERS};
use std::ffi::{c_char, c_int, c_void};

/// A scalar of a potential, for C++ and Python: `name` lives as long as the library, the unit is
/// (kJ/mol)^`energy` nm^`length`, and a default of NaN says that the user must give a value.
#[repr(C)]
pub struct ParameterInfo {
    pub(super) name: *const c_char,
    pub(super) energy: c_int,
    pub(super) length: c_int,
    pub(super) default_value: f64,
    /// 0: only as a scalar; 1: also for each vertex; 2: also for each triangle; 3: also for each particle; 4:
    /// also for each edge.
    pub(super) per: c_int,
    /// Whether it stands behind the variant in constructors.
    pub(super) last: c_int,
}

/// One term of an evaluation, as C++ hands it over.
#[repr(C)]
pub struct TermInput {
    pub(super) potential: c_int,
    pub(super) form: c_int,
    pub(super) switches: u32,
    pub(super) wants_derivatives: c_int,
    pub(super) values: [f64; MAX_PARAMETERS],
    /// Values of single elements, null where there are none.
    pub(super) fields: [*const f64; MAX_PARAMETERS],
    pub(super) field_lengths: [i64; MAX_PARAMETERS],
    /// Particles beside the vertices, null where there are none.
    pub(super) particles: *const u32,
    pub(super) num_particles: i64,
    /// What the user has given for each vertex, as `Helfrich_Numbers_create` has made it; null where there is nothing.
    pub(super) numbers: *const c_void,
}

/// What is evaluated of one of several membranes, as C++ hands it over.
#[repr(C)]
pub struct TurnInput {
    pub(super) subject: *const c_char,
    pub(super) membrane: *mut c_void,
    pub(super) terms: *const TermInput,
    pub(super) num_terms: i64,
    /// One a term, or null.
    pub(super) contributions: *mut Contribution,
    /// The vectors of its periodic box, or null.
    pub(super) box_vectors: *const [[f64; 3]; 3],
}

/// A membrane that follows the flips of another, as C++ hands it over.
#[repr(C)]
pub struct FollowerInput {
    pub(super) membrane: *mut c_void,
    pub(super) first_triangle: i64,
    pub(super) terms: *const TermInput,
    pub(super) num_terms: i64,
}

/// The arrays of a time step; three values for each particle.
#[repr(C)]
pub struct ParticleArrays {
    pub(super) num_particles: i64,
    pub(super) positions: *mut f64,
    pub(super) velocities: *mut f64,
    pub(super) forces: *const f64,
}

/// Friction and noise along edges, as C++ hands them over.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct EdgeBath {
    /// Friction times time, amu.
    pub(super) friction: f64,
    /// kJ/mol.
    pub(super) kt: f64,
    /// How long before the positions they act, ps.
    pub(super) lag: f64,
}

/// The triangles of a force, as C++ hands them over.
#[repr(C)]
pub struct SheetInput {
    pub(super) corners: *const c_int,
    pub(super) num_triangles: i64,
    /// Whether its sides are nearest images in the periodic box.
    pub(super) is_periodic: c_int,
}

/// What C++ reads of a buffer.
#[repr(C)]
pub struct NativeBuffer {
    pub(super) item_size: i64,
    pub(super) items: i64,
    /// Null if the host has nothing for it.
    pub(super) data: *const u8,
    pub(super) data_size: i64,
    pub(super) version: u64,
}

/// What C++ reads of a pass.
#[repr(C)]
pub struct NativePass {
    pub(super) name: *const c_char,
    pub(super) groups: i64,
}

/// What C++ reads of a plan; it holds until the next one is made.
#[repr(C)]
pub struct NativePlan {
    pub(super) num_buffers: i64,
    pub(super) num_passes: i64,
    pub(super) num_targets: i64,
    pub(super) num_runs: i64,
    pub(super) targets: *const [c_int; 4],
    pub(super) runs: *const [c_int; 4],
    pub(super) version: u64,
    /// The lattice reaches 2 to this power to both sides, nm; the least number where the device has to find out.
    pub(super) extent: c_int,
    /// The unit of length as a power of two, nm.
    pub(super) unit: c_int,
    pub(super) num_vertices: i64,
    /// The particle of each vertex, and the first vertex of its connected part.
    pub(super) particles: *const u32,
    pub(super) anchors: *const u32,
}
