//! Loops over the elements of a mesh that give the same bits on any number of threads.

use rayon::prelude::*;
use std::ops::AddAssign;

/// Elements that one task handles. Sums are formed within a chunk, then over chunks in order, whether
/// or not threads share the work: so this number is part of what decides the last bits.
const CHUNK: usize = 1024;

/// Fill `out` by chunks with `body(first, chunk)` and sum what it returns.
pub fn fill<T, R, F>(parallel: bool, out: &mut [T], body: F) -> R
where
    T: Send,
    R: AddAssign + Default + Send,
    F: Fn(usize, &mut [T]) -> R + Sync,
{
    let mut sum = R::default();
    if parallel {
        let chunks = out.par_chunks_mut(CHUNK).enumerate();
        let parts: Vec<R> = chunks.map(|(k, chunk)| body(k * CHUNK, chunk)).collect();
        for part in parts {
            sum += part;
        }
    } else {
        for (k, chunk) in out.chunks_mut(CHUNK).enumerate() {
            sum += body(k * CHUNK, chunk);
        }
    }
    sum
}

/// [`fill`] for two arrays side by side, of which the second may be empty instead.
pub fn fill_pair<T, U, R, F>(parallel: bool, out: &mut [T], beside: &mut [U], body: F) -> R
where
    T: Send,
    U: Send,
    R: AddAssign + Default + Send,
    F: Fn(usize, &mut [T], &mut [U]) -> R + Sync,
{
    if beside.is_empty() {
        return fill(parallel, out, |first, chunk| body(first, chunk, &mut []));
    }
    debug_assert_eq!(out.len(), beside.len());
    let mut sum = R::default();
    if parallel {
        let chunks = out.par_chunks_mut(CHUNK).zip(beside.par_chunks_mut(CHUNK)).enumerate();
        let parts: Vec<R> = chunks.map(|(k, (one, two))| body(k * CHUNK, one, two)).collect();
        for part in parts {
            sum += part;
        }
    } else {
        for (k, (one, two)) in out.chunks_mut(CHUNK).zip(beside.chunks_mut(CHUNK)).enumerate() {
            sum += body(k * CHUNK, one, two);
        }
    }
    sum
}

/// For a pass that has nothing to sum.
#[derive(Default)]
pub struct Nothing;

impl AddAssign for Nothing {
    fn add_assign(&mut self, _: Self) {}
}
