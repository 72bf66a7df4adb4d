//! The evaluator on the GPU, in single or double precision, through wgpu (Vulkan, Metal, DirectX 12).
//!
//! The shaders in `shaders/` are the twins of the formulas in [`crate::mesh`] and [`crate::potentials`]; build.rs
//! composes and validates them. [`adapters`] finds GPUs and [`device`] opens one, once for all Contexts;
//! `lattice.rs` and `frame.rs` bring positions and terms into the shaders' form; `buffers.rs` holds what a mesh
//! needs on the device, and `evaluator.rs` runs the passes.

pub mod adapters;
mod buffers;
pub mod calibration;
pub mod device;
mod evaluator;
pub mod faults;
mod frame;
mod lattice;

pub use evaluator::{GpuEvaluator, Timings};

/// The composed shaders.
mod shaders {
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}

/// The numbers that a device computes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `f32`, on every device.
    Single,
    /// `f64`, where the adapter offers it.
    Double,
}

impl Precision {
    /// Bytes of a number.
    const fn size(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }

    /// Append a number to what a device will read.
    fn put(self, bytes: &mut Vec<u8>, value: f64) {
        match self {
            Self::Single => bytes.extend_from_slice(&(value as f32).to_ne_bytes()),
            Self::Double => bytes.extend_from_slice(&value.to_ne_bytes()),
        }
    }
}

/// Numbers that a device has written.
enum Reals<'a> {
    Single(&'a [f32]),
    Double(&'a [f64]),
}

impl<'a> Reals<'a> {
    fn new(precision: Precision, bytes: &'a [u8]) -> Self {
        match precision {
            Precision::Single => Self::Single(bytemuck::cast_slice(bytes)),
            Precision::Double => Self::Double(bytemuck::cast_slice(bytes)),
        }
    }

    /// The sum of a run, in order.
    fn sum(&self, first: usize, count: usize) -> f64 {
        match self {
            Self::Single(all) => all[first..][..count].iter().map(|x| f64::from(*x)).sum(),
            Self::Double(all) => all[first..][..count].iter().sum(),
        }
    }

    fn get(&self, index: usize) -> f64 {
        match self {
            Self::Single(all) => f64::from(all[index]),
            Self::Double(all) => all[index],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::potentials::REGISTRY;

    #[test]
    fn every_potential_has_a_shader_and_every_shader_a_potential() {
        assert_eq!(shaders::POTENTIALS.len(), REGISTRY.len());
        for potential in REGISTRY {
            assert!(frame::shader_of(potential) < REGISTRY.len());
        }
    }
}
