//! The evaluator on the GPU, in single or double precision, through wgpu (Vulkan, Metal, DirectX 12).
//!
//! The shaders in `shaders/` are the twins of the formulas in [`crate::mesh`] and [`crate::potentials`]; build.rs
//! composes and validates them. [`adapters`] finds GPUs and [`device`] opens one, once for all Contexts;
//! `interface.rs` states what the two share;
//! `lattice.rs` and `frame.rs` bring positions and terms into the shaders' form; `buffers.rs` holds what a mesh
//! needs on the device, and `evaluator.rs` runs the passes.

#[cfg(feature = "gpu")]
pub mod adapters;
#[cfg(feature = "gpu")]
mod buffers;
#[cfg(feature = "gpu")]
pub mod calibration;
#[cfg(feature = "gpu")]
pub mod device;
#[cfg(feature = "gpu")]
mod evaluator;
#[cfg(feature = "gpu")]
pub mod faults;
mod frame;
#[allow(dead_code, reason = "build.rs uses the rest")]
mod interface;
mod lattice;
mod layout;
pub mod native;

#[cfg(feature = "gpu")]
pub use evaluator::{GpuEvaluator, Timings};
use interface::Sink;

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
}

/// What a device will read.
struct Bytes<'a> {
    precision: Precision,
    bytes: &'a mut Vec<u8>,
}

impl Sink for Bytes<'_> {
    fn word(&mut self, word: u32) {
        self.bytes.extend_from_slice(&word.to_ne_bytes());
    }

    fn real(&mut self, value: f64) {
        match self.precision {
            Precision::Single => self.bytes.extend_from_slice(&(value as f32).to_ne_bytes()),
            Precision::Double => self.bytes.extend_from_slice(&value.to_ne_bytes()),
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
    use crate::potentials::{Needs, Potential, REGISTRY, Term};

    /// But for those of pairs, which evaluators never see: the processor computes them beside any of them.
    #[test]
    fn every_potential_has_a_shader_and_every_shader_a_potential() {
        let is_for_device = |potential: &&'static dyn Potential| {
            !potential.needs(&Term::of(*potential)).contains(Needs::CONTACTS)
        };
        let potentials: Vec<_> = REGISTRY.into_iter().filter(is_for_device).collect();
        assert_eq!(shaders::POTENTIALS.len(), potentials.len());
        for potential in potentials {
            assert!(frame::shader_of(potential) < shaders::POTENTIALS.len());
        }
    }
}
