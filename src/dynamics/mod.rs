//! Time steps: the schemes of OpenMM's integrators and of masses that follow plaquettes, random numbers, and what else
//! changes velocities.

pub mod integrate;
pub mod plaquettes;
pub mod random;
pub mod variable_mass;
pub mod viscosity;
