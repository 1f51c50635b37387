//! A task that is repeated while something else is done.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, Thread};
use std::time::Duration;

/// Ends the repetition when dropped, also where the work panics: its thread would otherwise never end.
struct End<'a> {
    is_over: &'a AtomicBool,
    thread: &'a Thread,
}

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.thread.unpark();
    }
}

/// The result of `work`, while another thread does `task` at once and then after every `period`.
///
/// # Panics
/// Where `work` or `task` does; both have then ended.
pub fn during<T>(period: Duration, mut task: impl FnMut() + Send, work: impl FnOnce() -> T) -> T {
    let is_over = AtomicBool::new(false);
    let repeat = || {
        while !is_over.load(Ordering::Relaxed) {
            task();
            thread::park_timeout(period);
        }
    };
    thread::scope(|scope| {
        let repeating = scope.spawn(repeat);
        let _end = End { is_over: &is_over, thread: repeating.thread() };
        work()
    })
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::mpsc;

    use super::*;

    #[test]
    fn a_task_is_repeated_until_the_work_ends() {
        let (told, count) = mpsc::channel();
        let found = during(Duration::from_millis(1), || told.send(()).unwrap(), || count.iter().take(3).count());
        assert_eq!(found, 3);
    }

    #[test]
    fn a_panic_of_the_work_ends_the_task() {
        let (told, ended) = mpsc::channel();
        thread::spawn(move || {
            let work = || during(Duration::from_millis(1), || {}, || panic!("of the work"));
            told.send(catch_unwind(AssertUnwindSafe(work)).is_err()).unwrap();
        });
        assert_eq!(ended.recv_timeout(Duration::from_secs(20)), Ok(true));
    }
}
