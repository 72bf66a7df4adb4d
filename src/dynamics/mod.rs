//! Time steps: the schemes of OpenMM's integrators and of masses that follow plaquettes, and the random numbers for
//! them.

pub mod instructions;
pub mod integrate;
pub mod plaquettes;
pub mod random;
pub mod variable_mass;
