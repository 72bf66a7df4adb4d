//! Numbers that a formula can be written for once: one `f64`, or a processor's whole register of them.

use std::ops::{Add, Div, Mul, Sub};

/// Numbers in a [`Record`].
pub const RECORD: usize = 8;

/// Numbers of one element that are loaded together.
pub type Record = [f64; RECORD];

/// A real number, or several side by side (lanes) that go through the same formula.
///
/// Formulas of potentials are generic over it: the readable reference evaluates them for `f64`, the fast
/// evaluator for the lanes of whatever instruction set the processor has.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Which lanes fulfil a condition.
    type Mask: Copy;

    /// A constant in every lane; `self` only says how many there are.
    fn of(self, value: f64) -> Self;

    /// `self` · `factor` + `term`, rounded once where the processor can.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// `term` − `self` · `factor`, rounded once where the processor can.
    fn neg_mul_add(self, factor: Self, term: Self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The larger of two.
    fn max(self, other: Self) -> Self;

    /// Where `self` > `other`.
    fn above(self, other: Self) -> Self::Mask;

    /// Whether a condition holds in any lane.
    fn any(self, mask: Self::Mask) -> bool;

    /// `self` where the condition holds, `other` elsewhere.
    fn or_else(self, mask: Self::Mask, other: Self) -> Self;

    /// A function that exists for `f64` only, lane by lane.
    fn map(self, function: impl FnMut(f64) -> f64) -> Self;

    /// A record for each lane, number by number: those at some places, of which lanes beyond repeat the last.
    fn gather(self, records: &[Record], places: &[u32]) -> [Self; RECORD];

    /// 0 in every lane.
    #[inline(always)]
    fn zero(self) -> Self {
        self.of(0.0)
    }
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        value
    }

    // Without an instruction for it, the fused operation is a slow call; the reference does not need it.
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        term - self * factor
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn above(self, other: Self) -> bool {
        self > other
    }

    #[inline(always)]
    fn any(self, mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn or_else(self, mask: bool, other: Self) -> Self {
        if mask { self } else { other }
    }

    #[inline(always)]
    fn map(self, mut function: impl FnMut(f64) -> f64) -> Self {
        function(self)
    }

    #[inline(always)]
    fn gather(self, records: &[Record], places: &[u32]) -> [Self; RECORD] {
        records[places[0] as usize]
    }
}

// No closures below, nor in the passes of the fast evaluator: the compiler may leave a closure a function of its
// own, without the instruction set of its surroundings, and lanes then travel through memory.

/// The scalar product of two vectors.
#[inline(always)]
pub fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The vector product of two vectors.
#[inline(always)]
pub fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [
        a[2].neg_mul_add(b[1], a[1] * b[2]),
        a[0].neg_mul_add(b[2], a[2] * b[0]),
        a[1].neg_mul_add(b[0], a[0] * b[1]),
    ]
}

/// The difference of two vectors.
#[inline(always)]
pub fn minus<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The sum of two vectors.
#[inline(always)]
pub fn plus<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// A vector times a number.
#[inline(always)]
pub fn scaled<R: Real>(vector: [R; 3], factor: R) -> [R; 3] {
    [vector[0] * factor, vector[1] * factor, vector[2] * factor]
}

/// `sum` + `factor` · `vector`.
#[inline(always)]
pub fn plus_scaled<R: Real>(sum: [R; 3], factor: R, vector: [R; 3]) -> [R; 3] {
    [
        factor.mul_add(vector[0], sum[0]),
        factor.mul_add(vector[1], sum[1]),
        factor.mul_add(vector[2], sum[2]),
    ]
}

/// `sum` − `factor` · `vector`.
#[inline(always)]
pub fn minus_scaled<R: Real>(sum: [R; 3], factor: R, vector: [R; 3]) -> [R; 3] {
    [
        factor.neg_mul_add(vector[0], sum[0]),
        factor.neg_mul_add(vector[1], sum[1]),
        factor.neg_mul_add(vector[2], sum[2]),
    ]
}
