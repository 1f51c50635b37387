//! Cancellation of runs, and of computations that have no way to report it.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    /// What ends the work of this thread at its next [`stop_if_cancelled`].
    static CURRENT: RefCell<Option<Cancellation>> = const { RefCell::new(None) };
}

/// With what a cancelled computation unwinds.
struct Cancelled;

/// Whether a run is cancelled, shared between its caller and the run. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Cancellation(Arc<AtomicBool>);

impl Cancellation {
    /// Cancels the run.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the run was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Whether both are of the same run.
    pub fn is(&self, other: &Cancellation) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Does `work` on this thread, which ends at its next [`stop_if_cancelled`] once this is cancelled; `None` then.
    ///
    /// # Panics
    /// Where `work` does.
    pub fn stops<T>(&self, work: impl FnOnce() -> T) -> Option<T> {
        let before = CURRENT.replace(Some(self.clone()));
        let done = catch_unwind(AssertUnwindSafe(work));
        CURRENT.set(before);
        match done {
            Ok(value) => Some(value),
            Err(payload) if payload.is::<Cancelled>() => None,
            Err(payload) => resume_unwind(payload),
        }
    }
}

/// Ends the computation within [`Cancellation::stops`] if it was cancelled; does nothing elsewhere.
///
/// For loops that may take seconds and whose callers have no use for half a result. It unwinds, so that what they hold is
/// released, without the message of a panic.
pub fn stop_if_cancelled() {
    if CURRENT.with_borrow(|current| current.as_ref().is_some_and(Cancellation::is_cancelled)) {
        resume_unwind(Box::new(Cancelled));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cancelled_computation_ends_at_its_next_step() {
        let (outer, inner) = (Cancellation::default(), Cancellation::default());
        let mut steps = 0;
        let ended = outer.stops(|| {
            inner.cancel();
            let ended = inner.stops(|| {
                steps += 1;
                stop_if_cancelled();
                steps += 1;
            });
            stop_if_cancelled();
            (ended, "outer")
        });
        assert_eq!((ended, steps), (Some((None, "outer")), 1));
        stop_if_cancelled();
    }

    #[test]
    #[should_panic(expected = "a mistake")]
    fn a_panic_stays_one() {
        Cancellation::default().stops(|| panic!("a mistake"));
    }
}
