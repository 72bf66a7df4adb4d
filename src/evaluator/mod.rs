//! Evaluators own the buffers and run the passes over a mesh; they know no physics.

mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
mod passes;

pub use cpu::CpuEvaluator;
