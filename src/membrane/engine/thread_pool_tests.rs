//! The thread pool with the threads of the system; `loom` has its interleavings.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::disjoint::Disjoint;
use super::thread_pool::ThreadPool;

#[test]
fn every_part_is_done_once_by_pools_of_any_size() {
    for threads in [1, 2, 3, 5] {
        let pool = ThreadPool::new(threads);
        for count in [0, 1, 2, 7, 100] {
            let mut done = vec![0; count];
            let parts = Disjoint::new(&mut done);
            for _ in 0..50 {
                // SAFETY: every number comes up once.
                pool.each(count, |part| unsafe { *parts.entry(part) += 1 });
            }
            assert!(done.iter().all(|times| *times == 50), "{threads} threads, {count} parts");
        }
    }
}

#[test]
#[should_panic(expected = "a part of a step panicked")]
fn a_panic_in_a_part_reaches_the_caller() {
    let pool = ThreadPool::new(2);
    for _ in 0..1000 {
        pool.each(64, |_| {
            std::thread::sleep(std::time::Duration::from_micros(20));
            let worker = std::thread::current().name().is_some_and(|name| name.starts_with("film"));
            assert!(!worker, "a part in a worker");
        });
    }
    panic!("no part was taken by the worker");
}

/// Parked workers are unparked.
#[test]
fn a_pool_works_after_its_workers_have_parked() {
    let pool = ThreadPool::new(3);
    let sum = AtomicUsize::new(0);
    for _ in 0..3 {
        std::thread::sleep(std::time::Duration::from_millis(20));
        pool.each(10, |part| {
            sum.fetch_add(part, Ordering::Relaxed);
        });
    }
    assert_eq!(sum.into_inner(), 135);
}
