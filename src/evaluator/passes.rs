//! Loops over the elements of a mesh, by chunks.

use std::ops::AddAssign;

/// Elements of a chunk. Sums are formed within a chunk, then over chunks in order, which loses fewer digits than one long
/// sum.
const CHUNK: usize = 1024;

/// Fill `out` by chunks with `body(first, chunk)` and sum what it returns.
pub fn fill<T, R: AddAssign + Default>(
    out: &mut [T],
    mut body: impl FnMut(usize, &mut [T]) -> R,
) -> R {
    let mut sum = R::default();
    for (k, chunk) in out.chunks_mut(CHUNK).enumerate() {
        sum += body(k * CHUNK, chunk);
    }
    sum
}

/// [`fill`] for two arrays side by side, of which the second may be empty instead.
pub fn fill_pair<T, U, R: AddAssign + Default>(
    out: &mut [T],
    beside: &mut [U],
    mut body: impl FnMut(usize, &mut [T], &mut [U]) -> R,
) -> R {
    if beside.is_empty() {
        return fill(out, |first, chunk| body(first, chunk, &mut []));
    }
    debug_assert_eq!(out.len(), beside.len());
    let mut sum = R::default();
    for (k, (one, two)) in out.chunks_mut(CHUNK).zip(beside.chunks_mut(CHUNK)).enumerate() {
        sum += body(k * CHUNK, one, two);
    }
    sum
}

/// For a pass that has nothing to sum.
#[derive(Default)]
pub struct Nothing;

impl AddAssign for Nothing {
    fn add_assign(&mut self, _: Self) {}
}
