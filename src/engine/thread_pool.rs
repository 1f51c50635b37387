//! Threads that work on the parts of a step together.
//!
//! A step of some thousand elements takes tens of microseconds, less than waking a sleeping thread does. Members of a pool
//! therefore look for work for a while before they sleep. Each starts with its own share of the parts, the same ones in every
//! step, so that what they work on stays in its cache; then it takes what others have left. Nobody waits for a member that
//! has not come: where the processor is busy with other things, those who are there do the work.

use std::cell::UnsafeCell;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::{JoinHandle, Thread};

use crate::lane::Width;

/// Looks for work before a member lets others have its processor, and before it sleeps.
const PATIENCE: (u32, u32) = (200, 2_000);

/// Threads that share the parts of one task after the other. Which thread does which part is left to chance; parts must
/// not depend on it.
pub struct ThreadPool {
    width: Width,
    board: Arc<Board>,
    members: Vec<(Thread, Option<JoinHandle<()>>)>,
}

/// Work for all of the part numbers up to a count, by whoever takes one next.
#[derive(Clone, Copy)]
struct Task {
    work: *const (dyn Fn(usize) + Sync),
    count: usize,
}

/// A number on a cache line of its own.
#[derive(Default)]
#[repr(align(128))]
struct Counter(AtomicUsize);

/// Where members find their work.
struct Board {
    /// The present task; changed by the leader alone while the gate is closed and nobody is at work.
    task: UnsafeCell<Option<Task>>,
    /// Twice the number of the task, and one more while it may be joined.
    gate: AtomicUsize,
    /// The next part of each share that nobody has taken.
    next: Vec<Counter>,
    /// Members that have joined the present task.
    at_work: AtomicUsize,
    asleep: Vec<AtomicBool>,
    dissolved: AtomicBool,
    /// Whether a task is going on.
    leading: AtomicBool,
    /// A part panicked in a member.
    failed: AtomicBool,
}

// SAFETY: a task is read only by members counted in `at_work` who then still saw the gate open; the leader closes the gate and
// waits for that count to reach zero before it touches the task again.
unsafe impl Send for Board {}
// SAFETY: as above.
unsafe impl Sync for Board {}

impl ThreadPool {
    /// A pool of `threads`, the caller among them.
    pub fn new(threads: usize) -> ThreadPool {
        let others = threads.saturating_sub(1);
        let board = Arc::new(Board {
            task: UnsafeCell::new(None),
            gate: AtomicUsize::new(0),
            next: (0..=others).map(|_| Counter::default()).collect(),
            at_work: AtomicUsize::new(0),
            asleep: (0..others).map(|_| AtomicBool::new(false)).collect(),
            dissolved: AtomicBool::new(false),
            leading: AtomicBool::new(false),
            failed: AtomicBool::new(false),
        });
        let member = |number: usize| {
            let board = Arc::clone(&board);
            let thread = std::thread::Builder::new().name(format!("film {number}"));
            // Where the system gives no more threads, those that there are do the work.
            let handle = thread.spawn(move || board.serve(number)).ok()?;
            Some((handle.thread().clone(), Some(handle)))
        };
        let members = (1..=others).map_while(member).collect();
        ThreadPool { width: Width::best(), board, members }
    }

    /// The same pool with other vector instructions, as far as the processor has them.
    pub fn at_width(self, width: Width) -> ThreadPool {
        let mut pool = self;
        pool.width = if width as u8 <= Width::best() as u8 { width } else { Width::best() };
        pool
    }

    /// Number of threads, the caller among them.
    pub fn threads(&self) -> usize {
        self.members.len() + 1
    }

    /// The vector instructions that kernels are run with.
    pub fn width(&self) -> Width {
        self.width
    }

    /// Runs `work` once for each number below `count`; comes back when all are done.
    ///
    /// # Panics
    /// Where a part does, and where a task is still going on: a part cannot set another one.
    pub fn each(&self, count: usize, work: impl Fn(usize) + Sync) {
        if self.members.is_empty() || count < 2 {
            return (0..count).for_each(work);
        }
        let work: &(dyn Fn(usize) + Sync) = &work;
        // SAFETY: members are through with it before this function ends, so that it may be said to live for ever.
        let work = unsafe {
            std::mem::transmute::<*const (dyn Fn(usize) + Sync + '_), *const (dyn Fn(usize) + Sync + 'static)>(work)
        };
        let board = &*self.board;
        assert!(!board.leading.swap(true, Ordering::SeqCst), "a pool works on one task at a time");
        // SAFETY: there is one leader, the gate is closed and nobody is at work: nobody looks.
        unsafe { *board.task.get() = Some(Task { work, count }) };
        for (share, next) in board.next.iter().enumerate() {
            next.0.store(board.share(share, count).start, Ordering::Relaxed);
        }
        board.gate.fetch_add(1, Ordering::SeqCst);
        for (asleep, (thread, _)) in board.asleep.iter().zip(&self.members) {
            if asleep.load(Ordering::SeqCst) {
                thread.unpark();
            }
        }
        // Members must be through with the task even where a part of the leader's panics.
        let close = Close(board);
        board.take_parts(0, Task { work, count });
        drop(close);
        assert!(!board.failed.load(Ordering::Relaxed), "a part of a step panicked");
    }
}

/// Closes the gate and waits for those at work when dropped.
struct Close<'a>(&'a Board);

impl Drop for Close<'_> {
    fn drop(&mut self) {
        self.0.gate.fetch_add(1, Ordering::SeqCst);
        let mut looks = 0;
        while self.0.at_work.load(Ordering::SeqCst) > 0 {
            wait(&mut looks);
        }
        self.0.leading.store(false, Ordering::SeqCst);
    }
}

/// Spins for a moment, then lets others have the processor.
fn wait(looks: &mut u32) {
    *looks += 1;
    if *looks < PATIENCE.0 { std::hint::spin_loop() } else { std::thread::yield_now() }
}

impl Board {
    /// The parts with which a member starts.
    fn share(&self, member: usize, count: usize) -> Range<usize> {
        let cut = |member: usize| member * count / self.next.len();
        cut(member)..cut(member + 1)
    }

    /// Takes the parts of a member's own share, then what is left of those of the others.
    fn take_parts(&self, member: usize, task: Task) {
        let members = self.next.len();
        for share in (0..members).map(|k| (member + k) % members) {
            let end = self.share(share, task.count).end;
            loop {
                let part = self.next[share].0.fetch_add(1, Ordering::Relaxed);
                if part >= end {
                    break;
                }
                // SAFETY: the leader keeps the work alive until all members are through.
                unsafe { (*task.work)(part) };
            }
        }
    }

    fn serve(&self, number: usize) {
        let mut seen = 0;
        while let Some(open) = self.await_task(number, seen) {
            seen = open;
            self.at_work.fetch_add(1, Ordering::SeqCst);
            if self.gate.load(Ordering::SeqCst) == open {
                // SAFETY: counted, and the gate is open.
                if let Some(task) = unsafe { *self.task.get() } {
                    let work = std::panic::AssertUnwindSafe(|| self.take_parts(number, task));
                    if std::panic::catch_unwind(work).is_err() {
                        self.failed.store(true, Ordering::Relaxed);
                    }
                }
            }
            self.at_work.fetch_sub(1, Ordering::SeqCst);
        }
    }

    /// Waits for an open gate other than the one `seen` last; none once the pool is dissolved.
    fn await_task(&self, number: usize, seen: usize) -> Option<usize> {
        let open = || Some(self.gate.load(Ordering::SeqCst)).filter(|gate| gate % 2 == 1 && *gate != seen);
        let mut looks = 0;
        loop {
            if self.dissolved.load(Ordering::SeqCst) {
                return None;
            }
            if let Some(gate) = open() {
                return Some(gate);
            }
            if looks < PATIENCE.1 {
                wait(&mut looks);
                continue;
            }
            self.asleep[number - 1].store(true, Ordering::SeqCst);
            if open().is_none() && !self.dissolved.load(Ordering::SeqCst) {
                std::thread::park();
            }
            self.asleep[number - 1].store(false, Ordering::SeqCst);
            looks = 0;
        }
    }
}

impl Drop for ThreadPool {
    fn drop(&mut self) {
        self.board.dissolved.store(true, Ordering::SeqCst);
        for (thread, handle) in &mut self.members {
            thread.unpark();
            if let Some(handle) = handle.take() {
                let _ = handle.join();
            }
        }
    }
}

/// A slice whose parts several threads write at the same time, each its own.
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
    pub(super) fn new(slice: &'a mut [T]) -> Disjoint<'a, T> {
        Disjoint { start: slice.as_mut_ptr(), len: slice.len(), borrowed: PhantomData }
    }

    /// Part of the slice.
    ///
    /// # Safety
    /// Nobody else may hold a part that overlaps with it.
    #[allow(clippy::mut_from_ref)]
    pub(super) unsafe fn range(&self, range: Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.len);
        // SAFETY: it lies within the slice, and the caller keeps others from it.
        unsafe { std::slice::from_raw_parts_mut(self.start.add(range.start), range.end - range.start) }
    }

    /// One entry of the slice.
    ///
    /// # Safety
    /// Nobody else may hold it.
    #[allow(clippy::mut_from_ref)]
    pub(super) unsafe fn at(&self, index: usize) -> &mut T {
        assert!(index < self.len);
        // SAFETY: it lies within the slice, and the caller keeps others from it.
        unsafe { &mut *self.start.add(index) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_done_once_by_teams_of_any_size() {
        for threads in [1, 2, 3, 5] {
            let pool = ThreadPool::new(threads);
            for count in [0, 1, 2, 7, 100] {
                let mut done = vec![0; count];
                let parts = Disjoint::new(&mut done);
                for _ in 0..50 {
                    // SAFETY: every number comes up once.
                    pool.each(count, |part| unsafe { *parts.at(part) += 1 });
                }
                assert!(done.iter().all(|times| *times == 50), "{threads} threads, {count} parts");
            }
        }
    }

    #[test]
    #[should_panic(expected = "a part of a step panicked")]
    fn a_panic_in_a_part_reaches_the_leader() {
        let pool = ThreadPool::new(2);
        for _ in 0..1000 {
            pool.each(64, |_| {
                std::thread::sleep(std::time::Duration::from_micros(20));
                let member = std::thread::current().name().is_some_and(|name| name.starts_with("film"));
                assert!(!member, "a part of a member");
            });
        }
        panic!("a part was never taken by the member");
    }

    /// Sleeping members wake up again.
    #[test]
    fn a_team_works_after_a_rest() {
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
}
