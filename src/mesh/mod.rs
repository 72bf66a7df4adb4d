//! Triangulated surfaces: their topology, their orientation and their geometry.

pub mod borders;
pub mod cell;
pub mod closest;
mod culprit;
mod flip;
pub mod geometry;
pub mod numbering;
pub mod orientation;
mod pairing;
mod parts;
pub mod topology;
pub mod triangulation;
pub mod unfolding;
pub mod vertex_vectors;

pub use cell::{Cell, Configuration};
pub(crate) use culprit::culprit;
pub use topology::{NONE, Topology};
pub use triangulation::Triangulation;
pub use unfolding::Unfolding;
