//! Evaluators own the buffers and run the passes over a mesh; they know no physics.

mod cpu;
mod passes;

pub use cpu::CpuEvaluator;
