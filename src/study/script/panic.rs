//! Panics of functions that a script calls are errors of the script.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};

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

/// Does `work`, which interprets a script; a panic in it as its message.
pub(crate) fn catch<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    let before = INTERPRETS.replace(true);
    let done = panic::catch_unwind(AssertUnwindSafe(work));
    INTERPRETS.set(before);
    done.map_err(|panic| {
        format!("a function of droptower failed, which is a mistake in droptower: {}", message(&*panic))
    })
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message")
}
