//! Tests from outside the crate: one program, which is linked once and whose tests run side by side.

mod evaluator;
mod flips;
mod floors;
#[cfg(feature = "gpu")]
mod gpu;
mod joint_distribution;
mod openmm;
mod periodic;
mod support;
mod swaps;
