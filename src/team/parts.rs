//! A slice in parts, for threads that write to one each.

use std::marker::PhantomData;
use std::ops::Range;
use std::slice;

/// A slice that the members of a team divide among themselves.
pub struct Parts<'slice, T> {
    start: *mut T,
    length: usize,
    borrow: PhantomData<&'slice mut [T]>,
}

// SAFETY: a shared `Parts` hands out exclusive parts of its slice only, as `part` demands of its callers; so it is
// like sending these parts to other threads.
unsafe impl<T: Send> Sync for Parts<'_, T> {}

impl<'slice, T> Parts<'slice, T> {
    /// Divide a slice, which nobody else can use meanwhile.
    pub fn new(slice: &'slice mut [T]) -> Self {
        Self { start: slice.as_mut_ptr(), length: slice.len(), borrow: PhantomData }
    }

    /// A part of the slice; panics if there is no such part.
    ///
    /// # Safety
    /// Parts that are in use at the same time must not overlap.
    #[allow(clippy::mut_from_ref, reason = "the caller promises that parts are apart")]
    pub unsafe fn part(&self, range: Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.length, "no part {range:?}");
        // SAFETY: the range lies in the slice, and the caller promises that nobody else uses it.
        unsafe { slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }
}
