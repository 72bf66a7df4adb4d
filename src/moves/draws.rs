//! The random numbers of attempts, which are functions of the key and of the number of the attempt.

use crate::dynamics::random;
use crate::lanes::{Arithmetic, Kernel, run};

/// Attempts whose random numbers are made together.
pub(super) const BLOCK: usize = 64;

/// One attempt's random numbers.
#[derive(Clone, Copy, Default)]
pub(super) struct Draw {
    /// Uniform among some places.
    pub place: u32,
    /// Uniform in [0, 1).
    pub uniform: f64,
}

/// The random numbers of attempts from one on, for so many places.
pub(super) fn draw(key: [u32; 2], first: u64, places: usize, draws: &mut [Draw; BLOCK]) {
    struct Fill<'a>([u32; 2], u64, f64, &'a mut [Draw; BLOCK]);
    impl Kernel for Fill<'_> {
        #[inline(always)]
        fn execute<A: Arithmetic>(self) {
            let Self(key, first, places, draws) = self;
            for (number, draw) in draws.iter_mut().enumerate() {
                let [one, other] = random::bits(key, first + number as u64);
                // Uniform to one part in 2⁵² / (number of places); the product stays below that number.
                draw.place = ((one >> 12) as f64 / (1u64 << 52) as f64 * places) as u32;
                draw.uniform = (other >> 11) as f64 / (1u64 << 53) as f64;
            }
        }
    }
    run(Fill(key, first, places as f64, draws));
}
