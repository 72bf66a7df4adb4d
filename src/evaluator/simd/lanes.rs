//! Lanes: the registers of the instruction set that the processor turned out to have.
//!
//! The crate `pulp` has the arithmetic and the choice at run time; here are operators on it, so that
//! formulas read as formulas, and what it lacks: to load records of four numbers from scattered places
//! and to transpose them into lanes.

use crate::real::Real;
use pulp::{Arch, Scalar, Simd};
use std::ops::{Add, Div, Mul, Sub};

/// The largest number of lanes; elements are laid out in blocks of it whatever the processor has.
pub const BLOCK: usize = 8;

/// Records of numbers from scattered places, transposed into lanes.
///
/// Offsets count numbers from `base`. The hardware's own gather instructions are slower than to load
/// whole records and to transpose them in registers.
pub trait Records: Simd {
    /// The first three numbers of a record of four for each lane.
    ///
    /// # Safety
    /// `offsets` has as many entries as there are lanes, and four numbers follow `base` at each.
    #[inline(always)]
    unsafe fn gather3(self, base: *const f64, offsets: *const u32) -> [Self::f64s; 3] {
        let [a, b, c, _] = unsafe { self.gather4(base, offsets) };
        [a, b, c]
    }

    /// A record of four numbers for each lane.
    ///
    /// # Safety
    /// As [`Records::gather3`].
    #[inline(always)]
    unsafe fn gather4(self, base: *const f64, offsets: *const u32) -> [Self::f64s; 4] {
        unsafe { gather::<Self, 4, 1>(self, base, offsets) }
    }

    /// Two numbers for each lane, at its offset divided by `BY`.
    ///
    /// # Safety
    /// As [`Records::gather3`], for two numbers.
    #[inline(always)]
    unsafe fn gather2<const BY: u32>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 2] {
        unsafe { gather::<Self, 2, BY>(self, base, offsets) }
    }

    /// One number for each lane.
    ///
    /// # Safety
    /// As [`Records::gather3`], for one number.
    #[inline(always)]
    unsafe fn gather1(self, base: *const f64, offsets: *const u32) -> Self::f64s {
        unsafe { gather::<Self, 1, 1>(self, base, offsets)[0] }
    }

    /// Whether a condition holds in any lane.
    #[inline(always)]
    fn any(self, mask: Self::m64s) -> bool {
        self.first_true_m64s(mask) < Self::F64_LANES
    }

    /// Write a record of four numbers for each lane, one after the other from `to` on.
    ///
    /// # Safety
    /// There is room for as many records as there are lanes.
    #[inline(always)]
    unsafe fn store4(self, to: *mut f64, columns: [Self::f64s; 4]) {
        unsafe { store::<Self, 4>(to, columns) }
    }

    /// The same for records of two numbers.
    ///
    /// # Safety
    /// As [`Records::store4`].
    #[inline(always)]
    unsafe fn store2(self, to: *mut f64, columns: [Self::f64s; 2]) {
        unsafe { store::<Self, 2>(to, columns) }
    }
}

/// Number by number, for instruction sets that have nothing better.
#[inline(always)]
unsafe fn gather<S: Simd, const K: usize, const BY: u32>(
    simd: S,
    base: *const f64,
    offsets: *const u32,
) -> [S::f64s; K] {
    let mut columns = [simd.splat_f64s(0.0); K];
    for lane in 0..S::F64_LANES {
        for (k, column) in columns.iter_mut().enumerate() {
            // SAFETY: the caller's records are there, and a register is an array of its lanes.
            unsafe {
                let value = *base.add((*offsets.add(lane) / BY) as usize + k);
                *std::ptr::from_mut(column).cast::<f64>().add(lane) = value;
            }
        }
    }
    columns
}

#[inline(always)]
unsafe fn store<S: Simd, const K: usize>(to: *mut f64, columns: [S::f64s; K]) {
    for lane in 0..S::F64_LANES {
        for (k, column) in columns.iter().enumerate() {
            // SAFETY: the caller's room is there, and a register is an array of its lanes.
            unsafe { *to.add(lane * K + k) = *std::ptr::from_ref(column).cast::<f64>().add(lane) };
        }
    }
}

impl Records for Scalar {}

#[cfg(target_arch = "aarch64")]
impl Records for pulp::aarch64::Neon {}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Records;
    use pulp::cast;
    use pulp::x86::{V3, V4};
    use std::arch::x86_64::{__m256d, __m512d};

    /// Numbers `k` and `k + 1` of the records of lanes 0 and 2, and of lanes 1 and 3.
    #[inline(always)]
    unsafe fn halves<const BY: u32>(
        simd: V3,
        base: *const f64,
        offsets: *const u32,
        k: usize,
    ) -> [__m256d; 2] {
        // SAFETY: the caller's records are there.
        unsafe {
            let half = |lane: usize| {
                simd.sse2._mm_loadu_pd(base.add((*offsets.add(lane) / BY) as usize + k))
            };
            let pair = |low: usize, high: usize| {
                let low = simd.avx._mm256_castpd128_pd256(half(low));
                simd.avx._mm256_insertf128_pd::<1>(low, half(high))
            };
            [pair(0, 2), pair(1, 3)]
        }
    }

    #[inline(always)]
    fn columns(simd: V3, [even, odd]: [__m256d; 2]) -> [__m256d; 2] {
        [simd.avx._mm256_unpacklo_pd(even, odd), simd.avx._mm256_unpackhi_pd(even, odd)]
    }

    impl Records for V3 {
        #[inline(always)]
        fn any(self, mask: Self::m64s) -> bool {
            self.avx._mm256_movemask_pd(cast!(mask)) != 0
        }

        #[inline(always)]
        unsafe fn gather3(self, base: *const f64, offsets: *const u32) -> [Self::f64s; 3] {
            // SAFETY: the caller's records are there.
            let [low, high] = unsafe { [0, 2].map(|k| halves::<1>(self, base, offsets, k)) };
            let [a, b] = columns(self, low);
            [cast!(a), cast!(b), cast!(self.avx._mm256_unpacklo_pd(high[0], high[1]))]
        }

        #[inline(always)]
        unsafe fn gather4(self, base: *const f64, offsets: *const u32) -> [Self::f64s; 4] {
            // SAFETY: the caller's records are there.
            let [low, high] = unsafe { [0, 2].map(|k| columns(self, halves::<1>(self, base, offsets, k))) };
            [cast!(low[0]), cast!(low[1]), cast!(high[0]), cast!(high[1])]
        }

        #[inline(always)]
        unsafe fn gather2<const BY: u32>(
            self,
            base: *const f64,
            offsets: *const u32,
        ) -> [Self::f64s; 2] {
            // SAFETY: the caller's records are there.
            let [a, b] = columns(self, unsafe { halves::<BY>(self, base, offsets, 0) });
            [cast!(a), cast!(b)]
        }

        #[inline(always)]
        unsafe fn store4(self, to: *mut f64, columns: [Self::f64s; 4]) {
            let [a, b, c, d] = columns;
            let (a, b, c, d): (__m256d, __m256d, __m256d, __m256d) =
                (cast!(a), cast!(b), cast!(c), cast!(d));
            let avx = self.avx;
            let even = [avx._mm256_unpacklo_pd(a, b), avx._mm256_unpacklo_pd(c, d)];
            let odd = [avx._mm256_unpackhi_pd(a, b), avx._mm256_unpackhi_pd(c, d)];
            let rows = [
                avx._mm256_permute2f128_pd::<0x20>(even[0], even[1]),
                avx._mm256_permute2f128_pd::<0x20>(odd[0], odd[1]),
                avx._mm256_permute2f128_pd::<0x31>(even[0], even[1]),
                avx._mm256_permute2f128_pd::<0x31>(odd[0], odd[1]),
            ];
            for (k, row) in rows.into_iter().enumerate() {
                // SAFETY: the caller's room is there.
                unsafe { avx._mm256_storeu_pd(to.add(4 * k), row) };
            }
        }

        #[inline(always)]
        unsafe fn store2(self, to: *mut f64, [a, b]: [Self::f64s; 2]) {
            let avx = self.avx;
            let (a, b): (__m256d, __m256d) = (cast!(a), cast!(b));
            let (even, odd) = (avx._mm256_unpacklo_pd(a, b), avx._mm256_unpackhi_pd(a, b));
            // SAFETY: the caller's room is there.
            unsafe {
                avx._mm256_storeu_pd(to, avx._mm256_permute2f128_pd::<0x20>(even, odd));
                avx._mm256_storeu_pd(to.add(4), avx._mm256_permute2f128_pd::<0x31>(even, odd));
            }
        }
    }

    /// Two registers of four lanes as one of eight.
    #[inline(always)]
    fn joined<const K: usize>(
        simd: V4,
        low: [<V3 as pulp::Simd>::f64s; K],
        high: [<V3 as pulp::Simd>::f64s; K],
    ) -> [<V4 as pulp::Simd>::f64s; K] {
        std::array::from_fn(|k| {
            let low: __m512d = simd.avx512f._mm512_castpd256_pd512(cast!(low[k]));
            cast!(simd.avx512f._mm512_insertf64x4::<1>(low, cast!(high[k])))
        })
    }

    #[inline(always)]
    fn split<const K: usize>(
        columns: [<V4 as pulp::Simd>::f64s; K],
    ) -> [[<V3 as pulp::Simd>::f64s; K]; 2] {
        let halves = columns.map(|column| -> [<V3 as pulp::Simd>::f64s; 2] { cast!(column) });
        [0, 1].map(|half| halves.map(|pair| pair[half]))
    }

    impl Records for V4 {
        #[inline(always)]
        fn any(self, mask: Self::m64s) -> bool {
            mask.0 != 0
        }

        #[inline(always)]
        unsafe fn gather3(self, base: *const f64, offsets: *const u32) -> [Self::f64s; 3] {
            // SAFETY: as the caller says.
            let [low, high] = unsafe { [0, 4].map(|k| (*self).gather3(base, offsets.add(k))) };
            joined(self, low, high)
        }

        #[inline(always)]
        unsafe fn gather4(self, base: *const f64, offsets: *const u32) -> [Self::f64s; 4] {
            // SAFETY: as the caller says.
            let [low, high] = unsafe { [0, 4].map(|k| (*self).gather4(base, offsets.add(k))) };
            joined(self, low, high)
        }

        #[inline(always)]
        unsafe fn gather2<const BY: u32>(
            self,
            base: *const f64,
            offsets: *const u32,
        ) -> [Self::f64s; 2] {
            // SAFETY: as the caller says.
            let [low, high] =
                unsafe { [0, 4].map(|k| (*self).gather2::<BY>(base, offsets.add(k))) };
            joined(self, low, high)
        }

        #[inline(always)]
        unsafe fn store4(self, to: *mut f64, columns: [Self::f64s; 4]) {
            for (half, columns) in split(columns).into_iter().enumerate() {
                // SAFETY: as the caller says.
                unsafe { (*self).store4(to.add(16 * half), columns) };
            }
        }

        #[inline(always)]
        unsafe fn store2(self, to: *mut f64, columns: [Self::f64s; 2]) {
            for (half, columns) in split(columns).into_iter().enumerate() {
                // SAFETY: as the caller says.
                unsafe { (*self).store2(to.add(8 * half), columns) };
            }
        }
    }
}

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

/// Do something with the lanes of an instruction set.
#[inline]
pub fn dispatch<Op: WithLanes>(arch: Arch, op: Op) -> Op::Output {
    match arch {
        #[cfg(target_arch = "x86_64")]
        Arch::V4(simd) => simd.vectorize(Vectorized(simd, op)),
        #[cfg(target_arch = "x86_64")]
        Arch::V3(simd) => simd.vectorize(Vectorized(simd, op)),
        #[cfg(target_arch = "aarch64")]
        Arch::Neon(simd) => simd.vectorize(Vectorized(simd, op)),
        _ => op.with_lanes(Scalar),
    }
}

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
        unsafe { simd.gather2::<BY>(base, offsets) }.map(|value| Self { simd, value })
    }

    /// [`Records::gather3`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn gather3(simd: S, base: *const f64, offsets: *const u32) -> [Self; 3] {
        // SAFETY: as the caller says.
        unsafe { simd.gather3(base, offsets) }.map(|value| Self { simd, value })
    }

    /// [`Records::gather4`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn gather4(simd: S, base: *const f64, offsets: *const u32) -> [Self; 4] {
        // SAFETY: as the caller says.
        unsafe { simd.gather4(base, offsets) }.map(|value| Self { simd, value })
    }

    /// [`Records::store4`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn store4(to: *mut f64, columns: [Self; 4]) {
        // SAFETY: as the caller says.
        unsafe { columns[0].simd.store4(to, columns.map(|column| column.value)) };
    }

    /// [`Records::store2`].
    ///
    /// # Safety
    /// As there.
    #[inline(always)]
    pub unsafe fn store2(to: *mut f64, columns: [Self; 2]) {
        // SAFETY: as the caller says.
        unsafe { columns[0].simd.store2(to, columns.map(|column| column.value)) };
    }

    /// The sum over the lanes.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        self.simd.reduce_sum_f64s(self.value)
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
        let mut lane = 0;
        self.map(|a| {
            let value = function(a, b_lanes[lane], c_lanes[lane]);
            lane += 1;
            value
        })
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
        Self { value: self.simd.select_f64s(mask, self.value, other.value), ..self }
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
}
