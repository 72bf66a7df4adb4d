//! Random numbers by counters: any of them can be computed at any time, in any order, on any thread.
//!
//! Philox4x32-10 (J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, SC'11, doi:10.1145/2063384.2063405) is a
//! function of a counter of 128 bits and a key of 64 bits, whose values pass all statistical tests. The key of
//! a [`Stream`] is the seed and the number of the stream; a counter is the number of the draw (a time step) and
//! that of a pair of normals within it. So the state of the generator is three integers.
//!
//! A pair of normals takes all 128 bits: r = √(−2 ln u) from one half, a point on the unit circle from the other
//! (G. E. P. Box and M. E. Muller, doi:10.1214/aoms/1177706645). u has steps of 2⁻⁵², so that normals reach to
//! ±8.49, beyond which lies a probability of 2e-17. Logarithm, sine and cosine are polynomials, without any
//! branch, so that the compiler can compute as many at once as the processor allows.

use crate::lanes::{Arithmetic, Kernel, run};

/// Normals are made in groups of this many: 64 particles with three components each.
pub const GROUP: usize = 192;

/// Pairs in a group; element i and element `PAIRS` + i are a pair.
const PAIRS: usize = GROUP / 2;

/// A sequence of random numbers and the place in it. C++ holds it and writes it into checkpoints.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stream {
    /// The seed, and a number that tells streams of the same seed apart.
    pub key: [u32; 2],
    /// How many draws there have been.
    pub draws: u64,
}

/// The 128 random bits of a counter; each round is two products whose halves are mixed with the key.
///
/// The words are kept in the lower halves of 64 bits, where a product needs no care; what stands
/// in the upper halves is never read.
#[inline(always)]
fn philox(counter: [u64; 4], key: [u32; 2]) -> [u64; 4] {
    const MULTIPLIERS: [u64; 2] = [0xd251_1f53, 0xcd9e_8d57];
    const WEYL: [u32; 2] = [0x9e37_79b9, 0xbb67_ae85];
    const LOW: u64 = 0xffff_ffff;
    let (mut words, mut key) = (counter, key);
    for _ in 0..10 {
        let product = [(words[0] & LOW) * MULTIPLIERS[0], (words[2] & LOW) * MULTIPLIERS[1]];
        words = [
            (product[1] >> 32) ^ words[1] ^ u64::from(key[0]),
            product[1],
            (product[0] >> 32) ^ words[3] ^ u64::from(key[1]),
            product[0],
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    words.map(|word| word & LOW)
}

/// The 128 random bits that belong to a number and a key.
#[inline(always)]
pub fn bits(key: [u32; 2], number: u64) -> [u64; 2] {
    let words = philox([number, number >> 32, 0, 0], key);
    [words[0] | words[1] << 32, words[2] | words[3] << 32]
}

/// A double in [1, 2) of the upper 52 bits.
#[inline(always)]
fn between_one_and_two(bits: u64) -> f64 {
    f64::from_bits(bits >> 12 | 1f64.to_bits())
}

/// The natural logarithm in (0, 1], for normal numbers; the method of FreeBSD's `e_log.c`.
#[inline(always)]
fn ln<A: Arithmetic>(x: f64) -> f64 {
    const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
    // x = 2ᵏ (1 + f) with 1 + f between √½ and √2; the exponent field becomes k + 1023, never negative.
    let shifted = x.to_bits() + (1f64.to_bits() - ROOT_HALF);
    let f = f64::from_bits((shifted & 0x000f_ffff_ffff_ffff) + ROOT_HALF) - 1.0;
    const TWO_52: f64 = 4_503_599_627_370_496.0;
    let k = f64::from_bits(shifted >> 52 | TWO_52.to_bits()) - (TWO_52 + 1023.0);
    // ln(1 + f) = 2 artanh(s), s = f / (2 + f).
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let odd = A::polynomial(
        w,
        [
            0.666_666_666_666_673_5,
            0.285_714_287_436_623_9,
            0.181_835_721_616_180_5,
            0.147_981_986_051_165_86,
        ],
    );
    let even = A::polynomial(
        w,
        [0.399_999_999_994_094_2, 0.222_221_984_321_497_84, 0.153_138_376_992_093_73],
    );
    let rest = A::multiply_add(w, even, z * odd);
    let half_square = 0.5 * f * f;
    let small = A::multiply_add(s, half_square + rest, k * LN_2[1]) - half_square;
    A::multiply_add(k, LN_2[0], small + f)
}

/// Sine and cosine between −π/4 and π/4; the polynomials of FreeBSD's `k_sin.c` and `k_cos.c`.
#[inline(always)]
fn sin_cos<A: Arithmetic>(x: f64) -> (f64, f64) {
    let z = x * x;
    let sine = A::polynomial(
        z,
        [
            -0.166_666_666_666_666_32,
            8.333_333_333_322_49e-3,
            -1.984_126_982_985_795e-4,
            2.755_731_370_707_006_8e-6,
            -2.505_076_025_340_686_4e-8,
            1.589_690_995_211_55e-10,
        ],
    );
    let cosine = A::polynomial(
        z,
        [
            0.041_666_666_666_666_6,
            -1.388_888_888_887_411e-3,
            2.480_158_728_947_673e-5,
            -2.755_731_435_139_066_3e-7,
            2.087_572_321_298_175e-9,
            -1.135_964_755_778_819_5e-11,
        ],
    );
    let half = 0.5 * z;
    (A::multiply_add(x * z, sine, x), 1.0 - A::multiply_add(-z * z, cosine, half))
}

/// Two independent normals of 128 random bits.
#[inline(always)]
fn box_muller<A: Arithmetic>(words: [u64; 4]) -> (f64, f64) {
    let [radial, angular] = [words[0] | words[1] << 32, words[2] | words[3] << 32];
    // In (0, 1]: the logarithm of 0 would be infinite.
    let u = 2.0 - between_one_and_two(radial);
    let radius = (-2.0 * ln::<A>(u)).sqrt();
    // Any point of the circle is one within 45° of the x axis, up to the sign of x and an exchange of x and y:
    // two bits for these, the others for the angle.
    let turn = between_one_and_two(angular << 2) - 1.5;
    let (y, x) = sin_cos::<A>(turn * std::f64::consts::FRAC_PI_2);
    let x = f64::from_bits(x.to_bits() ^ (angular & 1 << 63));
    let exchange = angular & 1 << 62 != 0;
    let (first, second) = if exchange { (y, x) } else { (x, y) };
    (radius * first, radius * second)
}

/// The normals of one group of one draw.
#[inline(always)]
pub fn fill_group<A: Arithmetic>(stream: &Stream, group: u64, normals: &mut [f64; GROUP]) {
    let (first, second) = normals.split_at_mut(PAIRS);
    // Draws fill the upper half of the counter, pairs the lower one.
    let start = group * PAIRS as u64;
    for (i, (first, second)) in first.iter_mut().zip(second).enumerate() {
        let pair = start + i as u64;
        let words = philox([pair, pair >> 32, stream.draws, stream.draws >> 32], stream.key);
        (*first, *second) = box_muller::<A>(words);
    }
}

/// Fill a slice with the normals of the present draw, and go on to the next draw.
pub fn normals(stream: &mut Stream, out: &mut [f64]) {
    struct Fill<'a>(&'a Stream, &'a mut [f64]);
    impl Kernel for Fill<'_> {
        #[inline(always)]
        fn execute<A: Arithmetic>(self) {
            for (group, part) in self.1.chunks_mut(GROUP).enumerate() {
                let mut normals = [0.0; GROUP];
                fill_group::<A>(self.0, group as u64, &mut normals);
                part.copy_from_slice(&normals[..part.len()]);
            }
        }
    }
    run(Fill(stream, out));
    stream.draws += 1;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::kernels::Plain;

    /// Random123's `kat_vectors`, the lines of philox4x32 with 10 rounds.
    #[test]
    fn known_answers() {
        let ones = u64::from(u32::MAX);
        let cases = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([ones; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox(counter, key), expected);
        }
    }

    /// Spread over all magnitudes, and over both sides of where the method changes its mind.
    #[test]
    fn the_logarithm_is_exact_to_rounding() {
        let ends = [1.0, 1.0 - f64::EPSILON, f64::EPSILON, 0.5f64.sqrt(), 0.5];
        let many = (1..200_000).map(|i| (-36.0 * f64::from(i) / 200_000.0).exp());
        let more = (1..200_000).map(|i| f64::from(i) / 200_000.0);
        for x in ends.into_iter().chain(many).chain(more) {
            let exact = x.ln();
            for found in [ln::<Plain>(x), ln::<crate::lanes::kernels::Fused>(x)] {
                assert!(
                    (found - exact).abs() <= 2.0 * f64::EPSILON * exact.abs(),
                    "{x}: {found} {exact}"
                );
            }
        }
    }

    #[test]
    fn sine_and_cosine_are_exact_to_rounding() {
        for i in -100_000..=100_000 {
            let x = f64::from(i) / 100_000.0 * std::f64::consts::FRAC_PI_4;
            let (exact_sine, exact_cosine) = x.sin_cos();
            let (sine, cosine) = sin_cos::<Plain>(x);
            assert!((sine - exact_sine).abs() <= 1.5 * f64::EPSILON * exact_sine.abs(), "{x}");
            assert!((cosine - exact_cosine).abs() <= 1.5 * f64::EPSILON, "{x}");
        }
    }

    /// The same numbers from the textbook's formula, in the order that the documentation promises.
    #[test]
    fn normals_are_those_of_box_and_muller() {
        let mut stream = Stream { key: [12, 3], draws: 7 };
        let mut found = vec![0.0; 1000];
        normals(&mut stream, &mut found);
        assert_eq!(stream.draws, 8);
        for (group, part) in found.chunks(GROUP).enumerate() {
            for i in 0..PAIRS {
                let pair = (group * PAIRS + i) as u64;
                let words = philox([pair, 0, 7, 0], [12, 3]);
                let radial = words[0] | words[1] << 32;
                let angular = words[2] | words[3] << 32;
                let u = 1.0 - (radial >> 12) as f64 / 2f64.powi(52);
                let angle = ((angular << 2 >> 12) as f64 / 2f64.powi(52) - 0.5)
                    * std::f64::consts::FRAC_PI_2;
                let radius = (-2.0 * u.ln()).sqrt();
                let mut point = [radius * angle.cos(), radius * angle.sin()];
                if angular >> 63 == 1 {
                    point[0] = -point[0];
                }
                if angular >> 62 & 1 == 1 {
                    point.swap(0, 1);
                }
                for (k, expected) in [(i, point[0]), (i + PAIRS, point[1])] {
                    if let Some(found) = part.get(k) {
                        assert!((found - expected).abs() < 1e-15 * (1.0 + radius), "{group} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn extreme_bits_give_finite_numbers() {
        for radial in [0, u64::MAX] {
            for angular in [0, u64::MAX, 1 << 63, 1 << 62] {
                let words = [radial, radial >> 32, angular, angular >> 32].map(|w| w & 0xffff_ffff);
                let (x, y) = box_muller::<Plain>(words);
                let radius = x.hypot(y);
                let expected = if radial == 0 { 0.0 } else { (104.0 * 2f64.ln()).sqrt() };
                assert!((radius - expected).abs() < 1e-14, "{radial} {angular}: {radius}");
            }
        }
    }

    #[test]
    fn streams_and_draws_differ() {
        let draw = |key, draws| {
            let mut out = [0.0; 10];
            normals(&mut Stream { key, draws }, &mut out);
            out
        };
        let base = draw([1, 0], 0);
        for other in [draw([2, 0], 0), draw([1, 1], 0), draw([1, 0], 1), draw([1, 0], 1 << 32)] {
            assert!(base.iter().zip(other).all(|(a, b)| *a != b));
        }
    }
}
