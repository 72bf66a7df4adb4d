//! Instruction sets: the one that the processor turned out to have, and code that is compiled for it.

use super::records::Records;
use pulp::{Arch, Scalar};

/// What is done with lanes of any kind.
pub trait WithLanes {
    /// What comes out.
    type Output;

    /// Do it; must be `#[inline(always)]`, so that it is compiled for the instruction set.
    fn with_lanes<S: Records>(self, simd: S) -> Self::Output;
}

struct Vectorized<S, Op>(S, Op);

impl<S: Records, Op: WithLanes> pulp::NullaryFnOnce for Vectorized<S, Op> {
    type Output = Op::Output;

    #[inline(always)]
    fn call(self) -> Op::Output {
        self.1.with_lanes(self.0)
    }
}

/// An instruction set that the processor has.
#[derive(Debug, Clone, Copy)]
pub enum Level {
    /// One number at a time.
    Scalar,
    /// AVX2 with fused multiplication and addition: four at a time.
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
    /// AVX-512: eight at a time.
    #[cfg(target_arch = "x86_64")]
    Avx512(pulp::x86::V4),
    /// NEON: two at a time.
    #[cfg(target_arch = "aarch64")]
    Neon(pulp::aarch64::Neon),
}

impl Level {
    /// The best that this processor has.
    pub fn best() -> Self {
        match Arch::new() {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(simd) => Self::Avx512(simd),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(simd) => Self::Avx2(simd),
            #[cfg(target_arch = "aarch64")]
            Arch::Neon(simd) => Self::Neon(simd),
            _ => Self::Scalar,
        }
    }
}

/// Do something with the lanes of an instruction set.
#[inline]
pub fn dispatch<Op: WithLanes>(level: Level, op: Op) -> Op::Output {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(simd) => simd.vectorize(Vectorized(simd, op)),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(simd) => simd.vectorize(Vectorized(simd, op)),
        #[cfg(target_arch = "aarch64")]
        Level::Neon(simd) => simd.vectorize(Vectorized(simd, op)),
        Level::Scalar => op.with_lanes(Scalar),
    }
}
