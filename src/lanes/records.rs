//! Records: loading numbers from scattered places into lanes, and storing them, which `pulp` lacks.
//!
//! Here is what every instruction set can do, one number after the other; `x86.rs` has what x86 does better.

use pulp::{Scalar, Simd};

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
        let [a, b, c, _] = unsafe { self.gather4::<false>(base, offsets) };
        [a, b, c]
    }

    /// A record of four numbers for each lane. With `WITHIN`, offsets may point into a record instead of to its
    /// beginning.
    ///
    /// # Safety
    /// As [`Records::gather3`].
    #[inline(always)]
    unsafe fn gather4<const WITHIN: bool>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 4] {
        unsafe {
            if WITHIN {
                let mut starts = [0; BLOCK];
                for (lane, start) in starts[..Self::F64_LANES].iter_mut().enumerate() {
                    *start = *offsets.add(lane) & !3;
                }
                return gather::<Self, 4, 1>(self, base, starts.as_ptr());
            }
            gather::<Self, 4, 1>(self, base, offsets)
        }
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
