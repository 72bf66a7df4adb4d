//! Evaluators own the buffers and run the passes over a mesh; they know no physics.

mod borders;
pub(crate) mod checks;
mod chosen;
mod cpu;
#[cfg_attr(not(feature = "gpu"), allow(dead_code, reason = "wgpu needs the rest"))]
pub mod gpu;
mod passes;
mod reference;
pub(crate) mod simd;
mod survey;

pub use borders::{BorderEvaluator, place};
pub use chosen::{ChosenEvaluator, LEAST_VERTICES_FOR_GPU, Present, check_backend};
pub use cpu::{CpuEvaluator, InstructionSet};
pub use reference::ReferenceEvaluator;
pub use survey::{Survey, SurveyedTriangle, SurveyedVertex};
