//! Time steps: the schemes of OpenMM's integrators, random numbers, and what else changes velocities.

pub mod instructions;
pub mod integrate;
pub mod random;
pub mod viscosity;
