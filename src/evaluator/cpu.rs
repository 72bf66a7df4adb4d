//! The evaluator on the processor, and the choice of what it computes with.

use super::Survey;
use super::simd::SimdEvaluator;
use crate::error::Result;
use crate::lanes::Level;
use crate::mesh::numbering::breadth_first;
use crate::mesh::{Cell, Topology, Triangulation};
use crate::potentials::{Evaluator, Request};
use crate::team::default_threads;
use std::sync::Arc;

/// What the processor computes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InstructionSet {
    /// The best that it has.
    Best,
    /// At most AVX2 on x86.
    Avx2,
    /// One number at a time, on any processor.
    Scalar,
}

/// Below so many vertices several threads are never faster, whatever the processor.
const PARALLEL_VERTICES: usize = 700;

/// Evaluates any set of terms on one mesh: geometry forward, potentials, geometry backward.
///
/// Work is O(N), nothing is allocated once the buffers exist, and the bits of the result do not depend on the
/// number of threads. They do depend on the instruction set, by rounding.
pub struct CpuEvaluator {
    simd: SimdEvaluator,
}

impl InstructionSet {
    fn level(self) -> Level {
        match self {
            Self::Best => Level::best(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => pulp::x86::V3::try_new().map_or(Level::Scalar, Level::Avx2),
            _ => Level::Scalar,
        }
    }
}

impl CpuEvaluator {
    /// Buffers for a mesh. Threads share the work where that turns out faster.
    pub fn new(topology: Arc<Topology>) -> Self {
        Self::with(topology, InstructionSet::Best, 0)
    }

    /// The same with a certain instruction set and number of threads at most, 0 for as many as there are.
    pub fn with(topology: Arc<Topology>, set: InstructionSet, threads: usize) -> Self {
        let mesh = Triangulation::new(&topology);
        Self::of(&mesh, &breadth_first(&mesh), set, threads)
    }

    /// The same for a mesh whose connectivity may change; `order` has its vertices so that neighbours are near each
    /// other.
    pub fn of(mesh: &Triangulation, order: &[u32], set: InstructionSet, threads: usize) -> Self {
        let mut evaluator = Self { simd: SimdEvaluator::new(mesh, order, set.level()) };
        evaluator.set_threads(threads);
        evaluator
    }

    /// Go on with a mesh whose connectivity has changed, or with another order of its vertices.
    pub fn lay_out(&mut self, mesh: &Triangulation, order: &[u32]) {
        self.simd.lay_out(mesh, order);
    }

    /// Say in which periodic box the mesh is; needed before each evaluation where it spans the box, and the box has
    /// changed.
    pub fn set_cell(&mut self, cell: &Cell) {
        self.simd.set_cell(cell);
    }

    /// Let so many threads share the work, 0 for as many as there are; fewer if the system has no more.
    pub fn set_threads(&mut self, threads: usize) {
        let threads = if threads == 0 { default_threads() } else { threads };
        let small = self.simd.num_vertices() < PARALLEL_VERTICES;
        self.simd.set_threads(if small { 1 } else { threads });
    }

    /// Evaluate terms, and note what is known of every element. Forces, if wanted, are **added**.
    ///
    /// # Errors
    /// Those of [`Evaluator::evaluate`]; what is in the survey then is not to be used.
    pub fn survey(&mut self, request: Request, survey: &mut Survey) -> Result<()> {
        self.simd.evaluate(request, Some(survey))
    }
}

impl Evaluator for CpuEvaluator {
    fn evaluate(&mut self, request: Request) -> Result<()> {
        self.simd.evaluate(request, None)
    }
}
