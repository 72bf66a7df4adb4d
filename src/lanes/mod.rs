//! Lanes: the registers of the instruction set that the processor turned out to have.
//!
//! The crate `pulp` has the arithmetic of each; here are operators on it, so that formulas read as formulas.

mod instructions;
pub mod kernels;
mod records;
pub mod tiles;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use instructions::{Level, WithLanes, dispatch};
pub use kernels::{Arithmetic, Kernel, run};
pub use records::{BLOCK, Records};

use crate::real::{RECORD, Real, Record};
use pulp::Simd;
use pulp::bytemuck::cast;
use std::ops::{Add, Div, Mul, Sub};

/// As many numbers as the instruction set computes with at once.
#[derive(Clone, Copy)]
pub struct Lane<S: Simd> {
    simd: S,
    value: S::f64s,
}

impl<S: Records> Lane<S> {
    /// How many.
    pub const COUNT: usize = S::F64_LANES;

    /// A constant in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, value: simd.splat_f64s(value) }
    }

    /// The instruction set.
    #[inline(always)]
    pub fn simd(self) -> S {
        self.simd
    }

    /// From consecutive places in memory.
    ///
    /// # Safety
    /// There are [`Lane::COUNT`] numbers.
    #[inline(always)]
    pub unsafe fn load(simd: S, from: *const f64) -> Self {
        // SAFETY: the caller's numbers are there.
        Self { simd, value: unsafe { from.cast::<S::f64s>().read_unaligned() } }
    }

    /// To consecutive places in memory.
    ///
    /// # Safety
    /// There is room for [`Lane::COUNT`] numbers.
    #[inline(always)]
    pub unsafe fn store(self, to: *mut f64) {
        // SAFETY: the caller's room is there.
        unsafe { to.cast::<S::f64s>().write_unaligned(self.value) };
    }

    /// [`Records::gather1`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn gather1(simd: S, base: *const f64, offsets: *const u32) -> Self {
        // SAFETY: as the caller says.
        Self { simd, value: unsafe { simd.gather1(base, offsets) } }
    }

    /// [`Records::gather2`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn gather2<const BY: u32>(
        simd: S,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self; 2] {
        // SAFETY: as the caller says.
        let [a, b] = unsafe { simd.gather2::<BY>(base, offsets) };
        [Self { simd, value: a }, Self { simd, value: b }]
    }

    /// [`Records::gather3`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn gather3(simd: S, base: *const f64, offsets: *const u32) -> [Self; 3] {
        // SAFETY: as the caller says.
        let [a, b, c] = unsafe { simd.gather3(base, offsets) };
        [Self { simd, value: a }, Self { simd, value: b }, Self { simd, value: c }]
    }

    /// [`Records::gather4`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn gather4(simd: S, base: *const f64, offsets: *const u32) -> [Self; 4] {
        // SAFETY: as the caller says.
        Self::four(simd, unsafe { simd.gather4::<false>(base, offsets) })
    }

    /// [`Records::gather4`] with offsets that may point into a record.
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn gather4_within(simd: S, base: *const f64, offsets: *const u32) -> [Self; 4] {
        // SAFETY: as the caller says.
        Self::four(simd, unsafe { simd.gather4::<true>(base, offsets) })
    }

    #[inline(always)]
    fn four(simd: S, [a, b, c, d]: [S::f64s; 4]) -> [Self; 4] {
        [
            Self { simd, value: a },
            Self { simd, value: b },
            Self { simd, value: c },
            Self { simd, value: d },
        ]
    }

    /// [`Records::store4`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn store4(to: *mut f64, [a, b, c, d]: [Self; 4]) {
        // SAFETY: as the caller says.
        unsafe { a.simd.store4(to, [a.value, b.value, c.value, d.value]) };
    }

    /// [`Records::store2`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn store2(to: *mut f64, [a, b]: [Self; 2]) {
        // SAFETY: as the caller says.
        unsafe { a.simd.store2(to, [a.value, b.value]) };
    }

    /// The sum over the lanes.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        self.simd.reduce_sum_f64s(self.value)
    }

    /// The sum of the first `count` lanes, at most all.
    #[inline(always)]
    pub fn sum_of_first(self, count: usize) -> f64 {
        let mut lanes = [0.0; BLOCK];
        // SAFETY: no instruction set has more lanes than a block.
        unsafe { self.store(lanes.as_mut_ptr()) };
        lanes[..count.min(Self::COUNT)].iter().sum()
    }

    /// The smallest of the lanes; NaN counts as none.
    #[inline(always)]
    pub fn smallest(self) -> f64 {
        self.simd.reduce_min_f64s(self.value)
    }

    /// A function of three numbers that exists for `f64` only, lane by lane.
    #[inline(always)]
    pub fn map3(self, b: Self, c: Self, function: impl Fn(f64, f64, f64) -> f64) -> Self {
        let (mut b_lanes, mut c_lanes) = ([0.0; BLOCK], [0.0; BLOCK]);
        // SAFETY: no instruction set has more lanes than a block.
        unsafe {
            b.store(b_lanes.as_mut_ptr());
            c.store(c_lanes.as_mut_ptr());
        }
        let mut value = self.value;
        for lane in 0..S::F64_LANES {
            // SAFETY: a register is an array of its lanes.
            unsafe {
                let place = std::ptr::from_mut(&mut value).cast::<f64>().add(lane);
                *place = function(*place, b_lanes[lane], c_lanes[lane]);
            }
        }
        Self { value, ..self }
    }

    /// The smaller of two.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self { value: self.simd.min_f64s(self.value, other.value), ..self }
    }
}

macro_rules! operator {
    ($($trait:ident $function:ident $simd:ident),*) => {$(
        impl<S: Simd> $trait for Lane<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self { value: self.simd.$simd(self.value, other.value), ..self }
            }
        }

        impl<S: Simd> $trait<f64> for Lane<S> {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: f64) -> Self {
                self.$function(Self { value: self.simd.splat_f64s(other), ..self })
            }
        }
    )*};
}

operator!(Add add add_f64s, Sub sub sub_f64s, Mul mul mul_f64s, Div div div_f64s);

impl<S: Records> Real for Lane<S> {
    type Mask = S::m64s;

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        Self { value: self.simd.splat_f64s(value), ..self }
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self { value: self.simd.mul_add_e_f64s(self.value, factor.value, term.value), ..self }
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        let value = self.simd.negate_mul_add_e_f64s(self.value, factor.value, term.value);
        Self { value, ..self }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self { value: self.simd.sqrt_f64s(self.value), ..self }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self { value: self.simd.max_f64s(self.value, other.value), ..self }
    }

    #[inline(always)]
    fn above(self, other: Self) -> Self::Mask {
        self.simd.greater_than_f64s(self.value, other.value)
    }

    #[inline(always)]
    fn any(self, mask: Self::Mask) -> bool {
        self.simd.any(mask)
    }

    #[inline(always)]
    fn or_else(self, mask: Self::Mask, other: Self) -> Self {
        let (value, other) = (cast(self.value), cast(other.value));
        Self { value: cast(self.simd.select_u64s(mask, value, other)), ..self }
    }

    #[inline(always)]
    fn map(self, mut function: impl FnMut(f64) -> f64) -> Self {
        let mut value = self.value;
        for lane in 0..S::F64_LANES {
            // SAFETY: a register is an array of its lanes.
            unsafe {
                let lane = std::ptr::from_mut(&mut value).cast::<f64>().add(lane);
                *lane = function(*lane);
            }
        }
        Self { value, ..self }
    }

    #[inline(always)]
    fn gather(self, records: &[Record], places: &[u32]) -> [Self; RECORD] {
        // Offsets count numbers.
        assert!(records.len() <= u32::MAX as usize / RECORD, "no mesh is that large");
        let mut offsets = [0; BLOCK];
        for (lane, offset) in offsets[..Self::COUNT].iter_mut().enumerate() {
            let place = places[lane.min(places.len() - 1)];
            assert!((place as usize) < records.len(), "there is a record for each");
            *offset = RECORD as u32 * place;
        }
        let base = records.as_ptr().cast::<f64>();
        // SAFETY: the offsets are of records that are there, each of twice four numbers.
        let ([a, b, c, d], [e, f, g, h]) = unsafe {
            (
                Self::gather4(self.simd, base, offsets.as_ptr()),
                Self::gather4(self.simd, base.add(4), offsets.as_ptr()),
            )
        };
        [a, b, c, d, e, f, g, h]
    }
}
