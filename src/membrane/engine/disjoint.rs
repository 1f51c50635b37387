//! Slices that several threads write at the same time, each its own part.

use std::marker::PhantomData;
use std::ops::Range;

/// A slice that several threads write at the same time, each its own part.
pub(super) struct Disjoint<'a, T> {
    start: *mut T,
    len: usize,
    borrowed: PhantomData<&'a mut [T]>,
}

// SAFETY: it hands out parts of an exclusive slice; that they do not overlap is promised at each use.
unsafe impl<T: Send> Sync for Disjoint<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Send> Send for Disjoint<'_, T> {}

impl<'a, T> Disjoint<'a, T> {
    /// The slice, to be handed out in parts.
    pub(super) fn new(slice: &'a mut [T]) -> Disjoint<'a, T> {
        Disjoint { start: slice.as_mut_ptr(), len: slice.len(), borrowed: PhantomData }
    }

    /// Part of the slice.
    ///
    /// # Safety
    /// No other part that overlaps with it may be held.
    #[allow(clippy::mut_from_ref)]
    #[inline]
    pub(super) unsafe fn range(&self, range: Range<usize>) -> &mut [T] {
        // Checked in release builds too: the contract is on overlap alone, and a check costs little beside a range.
        assert!(range.start <= range.end && range.end <= self.len);
        // SAFETY: it lies within the slice, and the caller holds no other part of it.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.end - range.start) }
    }

    /// One entry of the slice.
    ///
    /// # Safety
    /// No other part with this entry may be held.
    #[allow(clippy::mut_from_ref)]
    #[inline]
    pub(super) unsafe fn entry(&self, index: usize) -> &mut T {
        assert!(index < self.len);
        // SAFETY: it lies within the slice, and the caller holds no other part of it.
        unsafe { &mut *self.start.add(index) }
    }
}
