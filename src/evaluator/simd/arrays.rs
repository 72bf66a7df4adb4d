//! What the passes leave for each other.

use std::cell::UnsafeCell;
use std::ops::Range;

/// Two cache lines, since processors fetch lines in pairs.
#[derive(Clone, Copy)]
#[repr(align(128))]
#[expect(dead_code, reason = "the numbers are reached by pointers")]
struct Line([f64; 16]);

/// Numbers that several threads fill, each thread its own places.
pub struct Numbers {
    lines: Box<[UnsafeCell<Line>]>,
    count: usize,
}

// SAFETY: access is through raw pointers only, and each function that takes them says who may write where.
unsafe impl Sync for Numbers {}

impl Numbers {
    /// So many zeros.
    pub fn new(count: usize) -> Self {
        let lines = (0..count.div_ceil(16)).map(|_| UnsafeCell::new(Line([0.0; 16]))).collect();
        Self { lines, count }
    }

    /// Where a number is.
    #[inline(always)]
    pub fn at(&self, index: usize) -> *mut f64 {
        debug_assert!(index <= self.count, "{index} of {}", self.count);
        UnsafeCell::raw_get(self.lines.as_ptr()).cast::<f64>().wrapping_add(index)
    }

    /// Have room for so many; what was there before is lost if there was not.
    pub fn require(&mut self, count: usize, value: f64) {
        if self.count < count {
            *self = Self::new(count);
            for index in 0..count {
                // SAFETY: `&mut self`, and the index is within.
                unsafe { *self.at(index) = value };
            }
        }
    }

    /// Set some to 0, as far as they exist.
    pub fn clear(&mut self, range: Range<usize>) {
        let range = range.start..range.end.min(self.count);
        // SAFETY: `&mut self`, and the numbers are within.
        range.for_each(|index| unsafe { *self.at(index) = 0.0 });
    }
}

impl Default for Numbers {
    fn default() -> Self {
        Self::new(0)
    }
}

/// All of them, empty until needed. Records of vertices and triangles are in the order of the [`Layout`].
#[derive(Default)]
pub struct Arrays {
    /// x, y, z and nothing, relative to the first vertex, nm.
    pub positions: Numbers,
    /// Unit normal and |N| of each triangle, and of the one that does not exist: zeros.
    pub normals: Numbers,
    /// Tensions along sides 2, 0, 1 and 2 again of each triangle, from potentials of triangles, kJ/mol/nm²;
    /// so the sides that meet at corner k are at k and k + 1.
    pub tensions: Numbers,
    /// Angles at corners 0, 1, 2 of each triangle, and nothing.
    pub angles: Numbers,
    /// The same beginning with corner 1.
    pub next_angles: Numbers,
    /// φ / l for each step and lane.
    pub bends: Numbers,
    /// l² for each step and lane.
    pub lengths_squared: Numbers,
    /// Bending moments per length for each step and lane, from potentials of angles.
    pub moments: Numbers,
    /// ½ ∂E/∂J and ⅙ ∂E/∂a_B of each vertex, so that the last pass need not multiply.
    pub partials: Numbers,
    /// ½ ∂E/∂S and ⅛ ∂E/∂a_V of each vertex.
    pub vector_partials: Numbers,
    /// ∂E/∂U, with Espriu's vector U, and nothing.
    pub umbrella_partials: Numbers,
    /// ∂E/∂(sum of normals), and nothing.
    pub normal_partials: Numbers,
}
