//! Threads that share the tasks of a step.
//!
//! A pass over some thousand elements takes tens of microseconds, less than unparking a thread. Workers therefore spin
//! for a while before they park. Each begins with its own share of the parts of a task, the same in every step, so that
//! its data stay in its cache; then it takes parts of the other shares. The caller does not wait for workers that have
//! not joined the task: on a busy processor the threads that run do the work.
//!
//! `cargo test --release -p droptower-loom` runs this file under the model checker loom.

use std::ops::Range;

use super::sync::{
    Arc, AtomicBool, AtomicUsize, Builder, JoinHandle, LOOKS, Ordering, SPINS, Thread, UnsafeCell, fence, park,
    spin_loop, yield_now,
};
use crate::lane::Width;

/// Threads that share the parts of one task after another. Which thread does which part is not determined, and parts
/// must not depend on it.
pub struct ThreadPool {
    width: Width,
    shared: Arc<Shared>,
    workers: Vec<Worker>,
}

/// A thread besides the caller's.
struct Worker {
    thread: Thread,
    /// None once it is joined.
    handle: Option<JoinHandle<()>>,
}

/// Work to be done once for each number below `count`.
#[derive(Clone, Copy)]
struct Task {
    work: *const (dyn Fn(usize) + Sync),
    count: usize,
}

/// A number on a cache line of its own.
#[repr(align(128))]
struct Counter(AtomicUsize);

/// State that the caller and the workers share.
struct Shared {
    /// The present task; written by the caller alone, while the epoch is even and no worker is active.
    task: UnsafeCell<Option<Task>>,
    /// Twice the number of the task, and one more while workers may join it.
    epoch: AtomicUsize,
    /// The next part of each share that no thread has taken.
    next: Vec<Counter>,
    /// Workers that have joined the present task.
    active: AtomicUsize,
    /// Whether each worker is about to park or parked.
    parked: Vec<AtomicBool>,
    /// Whether workers are to end.
    shutdown: AtomicBool,
    /// Whether a task is under way.
    busy: AtomicBool,
    /// Whether a part panicked in a worker.
    panicked: AtomicBool,
}

// SAFETY: a task is read only by workers that are counted in `active` and saw the epoch odd after that; the caller
// makes the epoch even and waits for the count to be zero before it writes the task again.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

impl ThreadPool {
    /// A pool of `threads`, the caller's among them.
    pub fn new(threads: usize) -> ThreadPool {
        let others = threads.saturating_sub(1);
        let shared = Arc::new(Shared {
            task: UnsafeCell::new(None),
            epoch: AtomicUsize::new(0),
            next: (0..=others).map(|_| Counter(AtomicUsize::new(0))).collect(),
            active: AtomicUsize::new(0),
            parked: (0..others).map(|_| AtomicBool::new(false)).collect(),
            shutdown: AtomicBool::new(false),
            busy: AtomicBool::new(false),
            panicked: AtomicBool::new(false),
        });
        let worker = |number: usize| {
            let shared = Arc::clone(&shared);
            // The system may provide fewer threads; those that there are do the work.
            let handle = Builder::new().name(format!("film {number}")).spawn(move || shared.serve(number)).ok()?;
            Some(Worker { thread: handle.thread().clone(), handle: Some(handle) })
        };
        let workers = (1..=others).map_while(worker).collect();
        ThreadPool { width: Width::best(), shared, workers }
    }

    /// This pool with other vector instructions, as far as the processor has them.
    pub fn at_width(mut self, width: Width) -> ThreadPool {
        self.width = width.supported();
        self
    }

    /// Number of threads, the caller's among them.
    pub fn threads(&self) -> usize {
        self.workers.len() + 1
    }

    /// The vector instructions that kernels run with.
    pub fn width(&self) -> Width {
        self.width
    }

    /// Runs `work` once for each number below `count`; returns when all are done.
    ///
    /// # Panics
    /// Where a part does, and where a task is under way: a part cannot start another one.
    pub fn each(&self, count: usize, work: impl Fn(usize) + Sync) {
        // Without a hand-over, which costs more than a short task.
        if self.workers.is_empty() || count < 2 {
            return (0..count).for_each(work);
        }
        let work: &(dyn Fn(usize) + Sync) = &work;
        // SAFETY: no worker uses it after this function returns, so its lifetime may be extended.
        let work = unsafe {
            std::mem::transmute::<*const (dyn Fn(usize) + Sync + '_), *const (dyn Fn(usize) + Sync + 'static)>(work)
        };
        let (shared, task) = (&*self.shared, Task { work, count });
        assert!(!shared.busy.swap(true, Ordering::SeqCst), "a pool works on one task at a time");
        // SAFETY: there is one caller, the epoch is even and no worker is active: no other thread reads or writes.
        shared.task.with_mut(|present| unsafe { *present = Some(task) });
        for (share, next) in shared.next.iter().enumerate() {
            // Relaxed: the epoch below publishes it together with the task.
            next.0.store(shared.share(share, count).start, Ordering::Relaxed);
        }
        // Odd from here on: the task may be joined.
        shared.epoch.fetch_add(1, Ordering::SeqCst);
        // A worker that parks either sees the new epoch or is seen here.
        fence(Ordering::SeqCst);
        for (parked, worker) in shared.parked.iter().zip(&self.workers) {
            if parked.load(Ordering::SeqCst) {
                worker.thread.unpark();
            }
        }
        // Workers must be through with the task even where a part panics in this thread.
        let close = Close(shared);
        // The caller works too, so a task ends even where no worker gets a processor.
        shared.take_parts(0, task);
        drop(close);
        assert!(!shared.panicked.load(Ordering::Relaxed), "a part of a step panicked");
    }
}

/// Ends the epoch of a task and waits for its active workers when dropped.
struct Close<'a>(&'a Shared);

impl Drop for Close<'_> {
    fn drop(&mut self) {
        // Even: nobody joins any more, and the task may be replaced once those that did are through.
        self.0.epoch.fetch_add(1, Ordering::SeqCst);
        // A worker that joins either sees the new epoch or is counted here.
        fence(Ordering::SeqCst);
        let mut looks = 0;
        while self.0.active.load(Ordering::SeqCst) > 0 {
            wait(&mut looks);
        }
        self.0.busy.store(false, Ordering::SeqCst);
    }
}

/// Spins for a while, then yields the processor.
fn wait(looks: &mut u32) {
    *looks += 1;
    if *looks <= SPINS { spin_loop() } else { yield_now() }
}

impl Shared {
    /// The parts with which a thread begins.
    fn share(&self, thread: usize, count: usize) -> Range<usize> {
        let cut = |thread: usize| thread * count / self.next.len();
        cut(thread)..cut(thread + 1)
    }

    /// Takes the parts of a thread's own share, then what is left of the other shares.
    fn take_parts(&self, thread: usize, task: Task) {
        let threads = self.next.len();
        // Each thread goes round from its own share, so that those which are done early do not all take from the same
        // one.
        for share in (0..threads).map(|k| (thread + k) % threads) {
            let end = self.share(share, task.count).end;
            loop {
                // Counts beyond the end are harmless; a comparison and exchange instead would be retried under
                // contention.
                let part = self.next[share].0.fetch_add(1, Ordering::Relaxed);
                if part >= end {
                    break;
                }
                // SAFETY: the caller keeps the work alive until all workers are through.
                unsafe { (*task.work)(part) };
            }
        }
    }

    /// Loop of worker `number`: it joins one task after another.
    fn serve(&self, number: usize) {
        let mut last = 0;
        while let Some(epoch) = self.next_epoch(number, last) {
            last = epoch;
            // Counted before the epoch is looked at again: the caller either waits for this worker or the worker sees
            // that it is late.
            self.active.fetch_add(1, Ordering::SeqCst);
            fence(Ordering::SeqCst);
            if self.epoch.load(Ordering::SeqCst) == epoch {
                // SAFETY: this worker is active and the epoch is odd.
                if let Some(task) = self.task.with(|task| unsafe { *task }) {
                    let work = std::panic::AssertUnwindSafe(|| self.take_parts(number, task));
                    if std::panic::catch_unwind(work).is_err() {
                        // Caught, as a worker that unwinds would leave `active` above zero and the caller waiting for
                        // ever.
                        self.panicked.store(true, Ordering::Relaxed);
                    }
                }
            }
            self.active.fetch_sub(1, Ordering::SeqCst);
        }
    }

    /// Waits for an odd epoch other than `last`; none once the pool is shut down.
    fn next_epoch(&self, number: usize, last: usize) -> Option<usize> {
        let open = || Some(self.epoch.load(Ordering::SeqCst)).filter(|epoch| epoch % 2 == 1 && *epoch != last);
        let mut looks = 0;
        loop {
            if self.shutdown.load(Ordering::SeqCst) {
                return None;
            }
            if let Some(epoch) = open() {
                return Some(epoch);
            }
            if looks != LOOKS {
                wait(&mut looks);
                continue;
            }
            // Announced before the last look: a caller that misses it has opened the epoch which that look finds.
            self.parked[number - 1].store(true, Ordering::SeqCst);
            fence(Ordering::SeqCst);
            // `park` may return without cause, so the loop looks again in any case.
            if open().is_none() && !self.shutdown.load(Ordering::SeqCst) {
                park();
            }
            self.parked[number - 1].store(false, Ordering::SeqCst);
            looks = 0;
        }
    }
}

impl Drop for ThreadPool {
    fn drop(&mut self) {
        self.shared.shutdown.store(true, Ordering::SeqCst);
        for worker in &mut self.workers {
            worker.thread.unpark();
            if let Some(handle) = worker.handle.take() {
                let _ = handle.join();
            }
        }
    }
}
