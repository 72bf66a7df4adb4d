//! The evaluator on the processor: the fast one, and the reference for what it does not know.

use super::reference::ReferenceEvaluator;
use super::simd::SimdEvaluator;
use crate::error::Result;
use crate::mesh::Topology;
use crate::potentials::{Contribution, Needs, Term};
use pulp::Arch;
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

/// From this many vertices on, a second thread saves more than it costs.
const PARALLEL_VERTICES: usize = 2000;

/// Evaluates any set of terms on one mesh: geometry forward, potentials, geometry backward.
///
/// Work is O(N), nothing is allocated once the buffers exist, and the bits of the result do not depend on the
/// number of threads. They do depend on the instruction set, by rounding.
pub struct CpuEvaluator {
    topology: Arc<Topology>,
    simd: SimdEvaluator,
    /// For terms with normals of vertices; made when first needed.
    reference: Option<Box<ReferenceEvaluator>>,
}

impl InstructionSet {
    fn arch(self) -> Arch {
        match self {
            Self::Best => Arch::new(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => pulp::x86::V3::try_new().map_or(Arch::Scalar, Arch::V3),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 => Arch::Scalar,
            Self::Scalar => Arch::Scalar,
        }
    }
}

impl CpuEvaluator {
    /// Buffers for a mesh, with as many threads as pay off.
    pub fn new(topology: Arc<Topology>) -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = if topology.num_vertices() < PARALLEL_VERTICES { 1 } else { cores };
        Self::with(topology, InstructionSet::Best, threads)
    }

    /// The same with a certain instruction set and number of threads.
    pub fn with(topology: Arc<Topology>, set: InstructionSet, threads: usize) -> Self {
        let simd = SimdEvaluator::new(topology.clone(), set.arch(), threads);
        Self { topology, simd, reference: None }
    }

    /// Let so many threads share the work, or fewer if the system has no more.
    pub fn set_threads(&mut self, threads: usize) {
        self.simd.set_threads(threads);
    }

    /// Evaluate terms at the positions of all particles, x y z of one after the other, nm.
    ///
    /// `contributions` gets the energy of each term; it can be empty if nobody wants to know. Forces, if
    /// wanted, are **added**, kJ/mol/nm, in the layout of the positions.
    ///
    /// # Errors
    /// A position of the mesh that is not finite; a triangle without area; an energy that overflows.
    /// Nothing has been added to the forces then.
    pub fn evaluate(
        &mut self,
        terms: &[&Term],
        positions: &[f64],
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
    ) -> Result<()> {
        let normals = |term: &&Term| term.potential.needs(term).contains(Needs::NORMALS);
        if terms.iter().any(normals) {
            let reference = self
                .reference
                .get_or_insert_with(|| Box::new(ReferenceEvaluator::new(self.topology.clone())));
            return reference.evaluate(terms, positions, contributions, forces);
        }
        self.simd.evaluate(terms, positions, contributions, forces)
    }
}
