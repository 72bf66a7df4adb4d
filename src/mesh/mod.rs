//! Triangulated closed surfaces: their topology, their orientation and their geometry.

pub mod geometry;
pub mod orientation;
pub mod topology;
pub mod vertex_vectors;

pub use topology::Topology;
