//! Evaluators own the buffers and run the passes over a mesh; they know no physics.

mod checks;
mod cpu;
mod passes;
mod reference;
pub(crate) mod simd;

pub use cpu::{CpuEvaluator, InstructionSet};
pub use reference::ReferenceEvaluator;
