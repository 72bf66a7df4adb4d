//! The best instructions of the processor that runs, chosen when the program starts.
//!
//! A [`Kernel`] is plain loops, which the compiler turns into vector instructions once for each instruction set
//! that `pulp` knows (AVX2, AVX-512, NEON, and none). Where there are fused multiply-adds, some formulas
//! use them; whether there are any is all that results depend on.

use pulp::{Arch, Scalar, Simd, WithSimd};
use std::any::TypeId;

/// How to compute a b + c.
pub trait Arithmetic {
    /// a b + c.
    fn multiply_add(a: f64, b: f64, c: f64) -> f64;

    /// c₀ + c₁ x + c₂ x² + ….
    #[inline(always)]
    fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
        let (last, others) = coefficients.split_last().expect("a polynomial has coefficients");
        others.iter().rev().fold(*last, |sum, &c| Self::multiply_add(sum, x, c))
    }
}

/// With two roundings.
pub struct Plain;

/// With one rounding, in one instruction.
pub struct Fused;

impl Arithmetic for Plain {
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

impl Arithmetic for Fused {
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

/// Loops that are compiled for each instruction set. All that `execute` calls must be `#[inline(always)]`.
pub trait Kernel {
    /// Do the work.
    fn execute<A: Arithmetic>(self);
}

/// Execute a kernel with the best instructions that there are.
#[inline]
pub fn run(kernel: impl Kernel) {
    struct Compiled<K>(K);
    impl<K: Kernel> WithSimd for Compiled<K> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            // All instruction sets but the fallback have fused multiply-adds.
            if TypeId::of::<S>() == TypeId::of::<Scalar>() {
                self.0.execute::<Plain>();
            } else {
                self.0.execute::<Fused>();
            }
        }
    }
    Arch::new().dispatch(Compiled(kernel));
}
