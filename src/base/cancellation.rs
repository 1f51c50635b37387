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
pub struct Cancellation {
    own: Arc<AtomicBool>,
    /// That of the work that the run is a part of.
    whole: Option<Arc<AtomicBool>>,
}

impl Cancellation {
    /// The cancellation of a run that is a part of the work that `whole` cancels.
    pub fn within(&self, whole: &Cancellation) -> Cancellation {
        Cancellation { own: Arc::clone(&self.own), whole: Some(Arc::clone(&whole.own)) }
    }

    /// Cancels the run.
    pub fn cancel(&self) {
        self.own.store(true, Ordering::Relaxed);
    }

    /// Whether the run was cancelled, alone or with the work that it is a part of.
    pub fn is_cancelled(&self) -> bool {
        let is_set = |flag: &AtomicBool| flag.load(Ordering::Relaxed);
        is_set(&self.own) || self.whole.as_deref().is_some_and(is_set)
    }

    /// Whether both are of the same run.
    pub fn is(&self, other: &Cancellation) -> bool {
        Arc::ptr_eq(&self.own, &other.own)
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
    fn a_part_is_cancelled_with_the_whole_and_not_the_other_way_round() {
        let (part, whole) = (Cancellation::default(), Cancellation::default());
        let within = part.within(&whole);
        assert!(within.is(&part) && !within.is_cancelled());
        part.cancel();
        assert!(within.is_cancelled() && !whole.is_cancelled());
        let other = Cancellation::default().within(&whole);
        whole.cancel();
        assert!(other.is_cancelled());
    }

    #[test]
    #[should_panic(expected = "a mistake")]
    fn a_panic_stays_one() {
        Cancellation::default().stops(|| panic!("a mistake"));
    }
}
