//! Interleavings with at most three preemptions of small tasks on the engine's thread pool, by the model checker loom:
//! `cargo test --release -p droptower-loom`.
//!
//! The pool is compiled from the engine's own file, with loom's primitives in place of those of `engine/sync.rs`.

#![cfg(test)]
// The engine uses more of the pool than the tests do, and the limits of its waits are zero here.
#![allow(dead_code, clippy::absurd_extreme_comparisons)]

#[path = "../../../src/membrane/engine/thread_pool.rs"]
mod thread_pool;

/// What the pool needs of the vector instructions: that they have a type.
mod lane {
    #[derive(Clone, Copy)]
    pub enum Width {
        Baseline,
    }

    impl Width {
        pub fn best() -> Width {
            Width::Baseline
        }

        pub fn supported(self) -> Width {
            self
        }
    }
}

/// The primitives of `engine/sync.rs`.
mod sync {
    pub(crate) use loom::cell::UnsafeCell;
    pub(crate) use loom::hint::spin_loop;
    pub(crate) use loom::sync::Arc;
    pub(crate) use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering, fence};
    pub(crate) use loom::thread::{Builder, JoinHandle, Thread, park, yield_now};

    /// Workers park at once: every further look adds interleavings that differ in nothing.
    pub(crate) const SPINS: u32 = 0;
    pub(crate) const LOOKS: u32 = 0;
}

mod tests {
    use loom::cell::UnsafeCell;

    use super::thread_pool::ThreadPool;

    /// Numbers that parts write to, each to its own; loom reports accesses that are not ordered.
    struct Numbers(Vec<UnsafeCell<usize>>);

    // SAFETY: loom checks the accesses.
    unsafe impl Sync for Numbers {}

    impl Numbers {
        fn zero(count: usize) -> Numbers {
            Numbers((0..count).map(|_| UnsafeCell::new(0)).collect())
        }

        fn increment(&self, part: usize) {
            // SAFETY: loom checks that no other access is concurrent.
            self.0[part].with_mut(|number| unsafe { *number += 1 });
        }

        fn all(&self, value: usize) -> bool {
            // SAFETY: as above.
            self.0.iter().all(|number| number.with(|number| unsafe { *number == value }))
        }
    }

    fn check(test: impl Fn() + Send + Sync + 'static) {
        let mut model = loom::model::Builder::new();
        model.preemption_bound = Some(3);
        model.check(test);
    }

    #[test]
    fn every_part_is_done_once_and_seen_by_the_caller() {
        check(|| {
            let pool = ThreadPool::new(2);
            let numbers = Numbers::zero(2);
            pool.each(2, |part| numbers.increment(part));
            assert!(numbers.all(1));
        });
    }

    #[test]
    fn a_worker_of_one_task_never_takes_parts_of_the_next_twice() {
        check(|| {
            let pool = ThreadPool::new(2);
            let first = Numbers::zero(2);
            pool.each(2, |part| first.increment(part));
            let second = Numbers::zero(2);
            pool.each(2, |part| second.increment(part));
            assert!(first.all(1) && second.all(1));
        });
    }

    #[test]
    fn a_pool_without_a_task_ends_its_workers() {
        check(|| drop(ThreadPool::new(2)));
    }
}
