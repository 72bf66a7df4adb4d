//! Time steps: the schemes of OpenMM's integrators, and the random numbers for them.

pub mod instructions;
pub mod integrate;
pub mod random;
