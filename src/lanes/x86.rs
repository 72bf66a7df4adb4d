//! Records in the instruction sets of x86: AVX2 loads two numbers at a time, AVX-512 four; they are transposed in registers.

use super::records::Records;
use pulp::cast;
use pulp::x86::{V3, V4};
use std::arch::x86_64::{__m128d, __m256d, __m512d};

/// An offset. By itself, or the compiler masks many at once and takes them apart again, which costs as much as the shuffles.
#[inline(always)]
unsafe fn offset<const BY: u32, const KEEP: u32>(from: *const u32) -> usize {
    // SAFETY: the caller's offsets are there.
    ((unsafe { from.read_volatile() } & KEEP) / BY) as usize
}

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
        let low = simd.sse2._mm_loadu_pd(base.add(offset::<BY, KEEP>(low)));
        let high = simd.sse2._mm_loadu_pd(base.add(offset::<BY, KEEP>(high)));
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

/// The eight lanes of a pair of registers at these places, those of the second counted from 8 on.
#[inline(always)]
fn chosen(simd: V4, [a, b]: [__m512d; 2], places: [i64; 8]) -> __m512d {
    simd.avx512f._mm512_permutex2var_pd(a, cast!(places), b)
}

#[inline(always)]
fn columns_of_eight(simd: V4, [even, odd]: [__m512d; 2]) -> [__m512d; 2] {
    [simd.avx512f._mm512_unpacklo_pd(even, odd), simd.avx512f._mm512_unpackhi_pd(even, odd)]
}

/// The records of four numbers of a lane and of the fourth one after it.
#[inline(always)]
unsafe fn row<const KEEP: u32>(simd: V4, base: *const f64, offsets: *const u32) -> __m512d {
    // SAFETY: the caller's records are there.
    let (low, high) = unsafe {
        (
            simd.avx._mm256_loadu_pd(base.add(offset::<1, KEEP>(offsets))),
            simd.avx._mm256_loadu_pd(base.add(offset::<1, KEEP>(offsets.add(4)))),
        )
    };
    simd.avx512f._mm512_insertf64x4::<1>(simd.avx512f._mm512_castpd256_pd512(low), high)
}

/// The records of four numbers of eight lanes, two in a register.
#[inline(always)]
unsafe fn rows<const KEEP: u32>(simd: V4, base: *const f64, offsets: *const u32) -> [__m512d; 4] {
    // SAFETY: the caller's records are there.
    unsafe {
        [
            row::<KEEP>(simd, base, offsets),
            row::<KEEP>(simd, base, offsets.add(1)),
            row::<KEEP>(simd, base, offsets.add(2)),
            row::<KEEP>(simd, base, offsets.add(3)),
        ]
    }
}

/// The first numbers of two pairs of lanes and of those four lanes on, and the third ones likewise: from what
/// [`columns_of_eight`] makes of rows 0 and 1, and of rows 2 and 3.
const FIRST: [i64; 8] = [0, 1, 8, 9, 4, 5, 12, 13];
const THIRD: [i64; 8] = [2, 3, 10, 11, 6, 7, 14, 15];

/// Pairs of numbers in turns, of the lower half of each register and of the upper one.
const LOWER: [i64; 8] = [0, 1, 8, 9, 2, 3, 10, 11];
const UPPER: [i64; 8] = [4, 5, 12, 13, 6, 7, 14, 15];

/// Two numbers of a record.
#[inline(always)]
unsafe fn two<const BY: u32>(simd: V4, base: *const f64, from: *const u32) -> __m128d {
    // SAFETY: the caller's record is there.
    unsafe { simd.sse2._mm_loadu_pd(base.add(offset::<BY, { u32::MAX }>(from))) }
}

/// Two numbers of the records of a lane and of every second one after it.
#[inline(always)]
unsafe fn every_second<const BY: u32>(simd: V4, base: *const f64, offsets: *const u32) -> __m512d {
    // SAFETY: the caller's records are there.
    unsafe {
        let first = simd.avx512f._mm512_castpd128_pd512(two::<BY>(simd, base, offsets));
        let next = two::<BY>(simd, base, offsets.add(2));
        let first = simd.avx512dq._mm512_insertf64x2::<1>(first, next);
        let next = two::<BY>(simd, base, offsets.add(4));
        let first = simd.avx512dq._mm512_insertf64x2::<2>(first, next);
        let next = two::<BY>(simd, base, offsets.add(6));
        simd.avx512dq._mm512_insertf64x2::<3>(first, next)
    }
}

impl Records for V4 {
    #[inline(always)]
    fn any(self, mask: Self::m64s) -> bool {
        mask.0 != 0
    }

    #[inline(always)]
    unsafe fn gather4<const WITHIN: bool>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 4] {
        // SAFETY: as the caller says.
        let [a, b, c, d] = unsafe {
            if WITHIN {
                rows::<{ !3 }>(self, base, offsets)
            } else {
                rows::<{ u32::MAX }>(self, base, offsets)
            }
        };
        let ([ac, bd], [ac_on, bd_on]) =
            (columns_of_eight(self, [a, b]), columns_of_eight(self, [c, d]));
        [
            cast!(chosen(self, [ac, ac_on], FIRST)),
            cast!(chosen(self, [bd, bd_on], FIRST)),
            cast!(chosen(self, [ac, ac_on], THIRD)),
            cast!(chosen(self, [bd, bd_on], THIRD)),
        ]
    }

    #[inline(always)]
    unsafe fn gather2<const BY: u32>(
        self,
        base: *const f64,
        offsets: *const u32,
    ) -> [Self::f64s; 2] {
        // SAFETY: as the caller says.
        let halves = unsafe {
            [
                every_second::<BY>(self, base, offsets),
                every_second::<BY>(self, base, offsets.add(1)),
            ]
        };
        let [a, b] = columns_of_eight(self, halves);
        [cast!(a), cast!(b)]
    }

    #[inline(always)]
    unsafe fn store4(self, to: *mut f64, [a, b, c, d]: [Self::f64s; 4]) {
        let [even, odd] = columns_of_eight(self, [cast!(a), cast!(b)]);
        let [even_on, odd_on] = columns_of_eight(self, [cast!(c), cast!(d)]);
        // Lanes 0 and 2, 4 and 6, 1 and 3, 5 and 7.
        for (lane, pair, places) in [
            (0, [even, even_on], LOWER),
            (4, [even, even_on], UPPER),
            (1, [odd, odd_on], LOWER),
            (5, [odd, odd_on], UPPER),
        ] {
            let both = chosen(self, pair, places);
            let first = self.avx512f._mm512_castpd512_pd256(both);
            let second = self.avx512f._mm512_extractf64x4_pd::<1>(both);
            // SAFETY: as the caller says.
            unsafe {
                self.avx._mm256_storeu_pd(to.add(4 * lane), first);
                self.avx._mm256_storeu_pd(to.add(4 * (lane + 2)), second);
            }
        }
    }

    #[inline(always)]
    unsafe fn store2(self, to: *mut f64, [a, b]: [Self::f64s; 2]) {
        let pair = columns_of_eight(self, [cast!(a), cast!(b)]);
        // SAFETY: as the caller says.
        unsafe {
            self.avx512f._mm512_storeu_pd(to, chosen(self, pair, LOWER));
            let rest = chosen(self, pair, UPPER);
            self.avx512f._mm512_storeu_pd(to.add(8), rest);
        }
    }
}
