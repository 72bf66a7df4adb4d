//! What is near a surface: pairs of vertices and triangles, or of other particles and triangles, and their energies.
//!
//! [`crate::evaluator`] knows elements of a mesh and what they share; contacts are pairs that the mesh says nothing of. They are
//! found by a `grid`, kept in `lists`, and evaluated on the processor, whatever evaluates the rest.
//! What is farther than a term reaches adds exactly nothing, and sums are formed in the order of triangles and then vertices,
//! or of particles and then triangles: so neither the age of lists nor the number of threads shows in the bits.

mod block;
mod evaluator;
mod following;
mod grid;
mod inner;
mod lists;
mod outer;
mod particles;
mod reach;
mod rough;
mod spheres;
mod surface;

pub use evaluator::{Contacts, is_contact};
