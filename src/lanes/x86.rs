//! Records in the instruction sets of x86: two numbers a load, transposed in registers.

use super::records::Records;
use pulp::cast;
use pulp::x86::{V3, V4};
use std::arch::x86_64::{__m256d, __m512d};

/// Two numbers of the records of two lanes.
#[inline(always)]
unsafe fn pair<const BY: u32, const KEEP: u32>(
    simd: V3,
    base: *const f64,
    low: *const u32,
    high: *const u32,
) -> __m256d {
    // SAFETY: the caller's records are there.
    unsafe {
        let low = simd.sse2._mm_loadu_pd(base.add(((*low & KEEP) / BY) as usize));
        let high = simd.sse2._mm_loadu_pd(base.add(((*high & KEEP) / BY) as usize));
        simd.avx._mm256_insertf128_pd::<1>(simd.avx._mm256_castpd128_pd256(low), high)
    }
}

/// Two numbers of the records of lanes 0 and 2, and of lanes 1 and 3.
#[inline(always)]
unsafe fn halves<const BY: u32, const KEEP: u32>(
    simd: V3,
    base: *const f64,
    offsets: *const u32,
) -> [__m256d; 2] {
    // SAFETY: the caller's records are there.
    unsafe {
        [
            pair::<BY, KEEP>(simd, base, offsets, offsets.add(2)),
            pair::<BY, KEEP>(simd, base, offsets.add(1), offsets.add(3)),
        ]
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
        let (low, high) = unsafe {
            (
                halves::<1, { u32::MAX }>(self, base, offsets),
                halves::<1, { u32::MAX }>(self, base.add(2), offsets),
            )
        };
        let [a, b] = columns(self, low);
        [cast!(a), cast!(b), cast!(self.avx._mm256_unpacklo_pd(high[0], high[1]))]
    }

    #[inline(always)]
    unsafe fn gather4<const WITHIN: bool>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 4] {
        // SAFETY: the caller's records are there.
        let (low, high) = unsafe {
            if WITHIN {
                let low = halves::<1, { !3 }>(self, base, offsets);
                (low, halves::<1, { !3 }>(self, base.add(2), offsets))
            } else {
                let low = halves::<1, { u32::MAX }>(self, base, offsets);
                (low, halves::<1, { u32::MAX }>(self, base.add(2), offsets))
            }
        };
        let ([a, b], [c, d]) = (columns(self, low), columns(self, high));
        [cast!(a), cast!(b), cast!(c), cast!(d)]
    }

    #[inline(always)]
    unsafe fn gather2<const BY: u32>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 2] {
        // SAFETY: the caller's records are there.
        let [a, b] = columns(self, unsafe { halves::<BY, { u32::MAX }>(self, base, offsets) });
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
        // SAFETY: the caller's room is there.
        unsafe {
            avx._mm256_storeu_pd(to, rows[0]);
            avx._mm256_storeu_pd(to.add(4), rows[1]);
            avx._mm256_storeu_pd(to.add(8), rows[2]);
            avx._mm256_storeu_pd(to.add(12), rows[3]);
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

type Four = <V3 as pulp::Simd>::f64s;
type Eight = <V4 as pulp::Simd>::f64s;

/// Two registers of four lanes as one of eight.
#[inline(always)]
fn join(simd: V4, low: Four, high: Four) -> Eight {
    let low: __m512d = simd.avx512f._mm512_castpd256_pd512(cast!(low));
    cast!(simd.avx512f._mm512_insertf64x4::<1>(low, cast!(high)))
}

#[inline(always)]
fn split(eight: Eight) -> [Four; 2] {
    cast!(eight)
}

// Each is two of four lanes.
impl Records for V4 {
    #[inline(always)]
    fn any(self, mask: Self::m64s) -> bool {
        mask.0 != 0
    }

    #[inline(always)]
    unsafe fn gather3(self, base: *const f64, offsets: *const u32) -> [Self::f64s; 3] {
        // SAFETY: as the caller says.
        let (low, high) =
            unsafe { ((*self).gather3(base, offsets), (*self).gather3(base, offsets.add(4))) };
        [join(self, low[0], high[0]), join(self, low[1], high[1]), join(self, low[2], high[2])]
    }

    #[inline(always)]
    unsafe fn gather4<const WITHIN: bool>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 4] {
        // SAFETY: as the caller says.
        let (low, high) = unsafe {
            let low = (*self).gather4::<WITHIN>(base, offsets);
            (low, (*self).gather4::<WITHIN>(base, offsets.add(4)))
        };
        [
            join(self, low[0], high[0]),
            join(self, low[1], high[1]),
            join(self, low[2], high[2]),
            join(self, low[3], high[3]),
        ]
    }

    #[inline(always)]
    unsafe fn gather2<const BY: u32>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 2] {
        // SAFETY: as the caller says.
        let (low, high) = unsafe {
            ((*self).gather2::<BY>(base, offsets), (*self).gather2::<BY>(base, offsets.add(4)))
        };
        [join(self, low[0], high[0]), join(self, low[1], high[1])]
    }

    #[inline(always)]
    unsafe fn store4(self, to: *mut f64, [a, b, c, d]: [Self::f64s; 4]) {
        let (a, b, c, d) = (split(a), split(b), split(c), split(d));
        // SAFETY: as the caller says.
        unsafe {
            (*self).store4(to, [a[0], b[0], c[0], d[0]]);
            (*self).store4(to.add(16), [a[1], b[1], c[1], d[1]]);
        }
    }

    #[inline(always)]
    unsafe fn store2(self, to: *mut f64, [a, b]: [Self::f64s; 2]) {
        let (a, b) = (split(a), split(b));
        // SAFETY: as the caller says.
        unsafe {
            (*self).store2(to, [a[0], b[0]]);
            (*self).store2(to.add(8), [a[1], b[1]]);
        }
    }
}
