//! Panics of functions that a script calls are errors of the script, and so is that they were cancelled.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};

use rhai::{EvalAltResult, Position};

use super::{HostResult, Session};
use base::cancellation::Cancellation;

thread_local! {
    /// Whether this thread interprets a script, which reports what panics.
    static INTERPRETS: Cell<bool> = const { Cell::new(false) };
}

/// Lets panics within scripts, which become errors with a line, print nothing. For programs: the hook is that of the whole
/// process.
pub fn silence_panics() {
    let print = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if !INTERPRETS.get() {
            print(info);
        }
    }));
}

/// What ends a script that was cancelled.
pub(crate) const STOPPED: &str = "stopped";

/// Checks that a run or a trial of a script may begin.
///
/// # Errors
/// The script was stopped; no `try` of it catches that.
pub(crate) fn check_stop(session: &Session) -> HostResult<()> {
    match session.is_stopped() {
        true => Err(EvalAltResult::ErrorTerminated(STOPPED.into(), Position::NONE).into()),
        false => Ok(()),
    }
}

/// Does `work`, which interprets a script; that `cancellation` stopped it, or a panic in it, is an error at `place`.
pub(crate) fn catch<T>(
    cancellation: &Cancellation,
    place: impl Fn() -> Position,
    work: impl FnOnce() -> HostResult<T>,
) -> HostResult<T> {
    let before = INTERPRETS.replace(true);
    let done = panic::catch_unwind(AssertUnwindSafe(|| cancellation.stops(work)));
    INTERPRETS.set(before);
    let error = match done {
        Ok(Some(result)) => return result,
        Ok(None) => EvalAltResult::ErrorTerminated(STOPPED.into(), place()),
        Err(panic) => {
            let text = message(&*panic);
            let text = format!("a function of droptower failed, which is a mistake in droptower: {text}");
            EvalAltResult::ErrorRuntime(text.into(), place())
        }
    };
    Err(error.into())
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message")
}
