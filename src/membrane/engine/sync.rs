//! The primitives of the thread pool. The package in `tests/loom` compiles the pool with those of the model checker in
//! their place.

pub(super) use std::hint::spin_loop;
pub(super) use std::sync::Arc;
pub(super) use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering, fence};
pub(super) use std::thread::{Builder, JoinHandle, Thread, park, yield_now};

/// Looks at an atomic before a thread yields its processor.
pub(super) const SPINS: u32 = 200;

/// Looks for a task before a worker parks.
pub(super) const LOOKS: u32 = 2_000;

/// [`std::cell::UnsafeCell`] with the accessors that loom checks.
pub(super) struct UnsafeCell<T>(std::cell::UnsafeCell<T>);

impl<T> UnsafeCell<T> {
    /// A cell that holds `value`.
    pub(super) fn new(value: T) -> UnsafeCell<T> {
        UnsafeCell(std::cell::UnsafeCell::new(value))
    }

    /// Calls `read` with a pointer to the value.
    pub(super) fn with<R>(&self, read: impl FnOnce(*const T) -> R) -> R {
        read(self.0.get())
    }

    /// Calls `write` with a pointer to the value.
    pub(super) fn with_mut<R>(&self, write: impl FnOnce(*mut T) -> R) -> R {
        write(self.0.get())
    }
}
