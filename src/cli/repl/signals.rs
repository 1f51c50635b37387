//! Signals of a session on a terminal: Ctrl-C stops what is computed, SIGTERM and SIGHUP end the session.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{DiagnosticFormat, Failure};
use base::cancellation::Cancellation;
use base::diagnostic::Diagnostic;

/// The work that signals of the operating system stop.
#[derive(Clone, Default)]
pub(super) struct Signals(Arc<Mutex<State>>);

#[derive(Default)]
struct State {
    /// The cancellation of an input until it is answered; none while the prompt waits.
    current: Option<Cancellation>,
    is_over: bool,
}

/// The failure of a session that a signal ended.
pub(super) fn ended() -> Failure {
    Failure::output(Diagnostic::new("a signal ended the session"))
}

impl Signals {
    /// Ctrl-C stops this from now on, or nothing.
    pub fn set_current(&self, cancellation: Option<Cancellation>) {
        self.state().current = cancellation;
    }

    /// Whether a signal ends the session.
    pub fn is_over(&self) -> bool {
        self.state().is_over
    }

    /// Stops what is computed; whether the program must end here, since it does not stop. Nothing where nothing is
    /// computed: the line is the editor's.
    fn interrupt(&self) -> bool {
        match &self.state().current {
            Some(current) => is_stopping(current),
            None => false,
        }
    }

    /// Ends the session once what is computed is stopped; whether the program must end here, where nothing is computed or it
    /// does not stop.
    #[cfg(unix)]
    fn terminate(&self) -> bool {
        let mut state = self.state();
        let is_again = std::mem::replace(&mut state.is_over, true);
        match &state.current {
            Some(current) => is_stopping(current) && is_again,
            None => true,
        }
    }

    /// Handles signals from now on. Before a signal ends the program, the terminal is as it is now, and `leave` is called.
    #[cfg(unix)]
    pub fn watch(&self, format: DiagnosticFormat, leave: impl Fn() + Send + 'static) -> Result<(), Failure> {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let found = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP]);
        let mut found = found.map_err(|error| unhandled(&error))?;
        let terminal = terminal::Terminal::now();
        let signals = self.clone();
        let watch = move || {
            for signal in found.forever() {
                let must_end = if signal == SIGINT { signals.interrupt() } else { signals.terminate() };
                if must_end {
                    leave();
                    terminal.restore();
                    leave_with(&ended(), format);
                }
            }
        };
        let started = std::thread::Builder::new().name("signals".into()).spawn(watch);
        started.map(drop).map_err(|error| unhandled(&error))
    }

    /// Handles Ctrl-C from now on; `leave` is called before it ends the program.
    #[cfg(not(unix))]
    pub fn watch(&self, format: DiagnosticFormat, leave: impl Fn() + Send + 'static) -> Result<(), Failure> {
        let signals = self.clone();
        let stop = move || {
            if signals.interrupt() {
                leave();
                leave_with(&ended(), format);
            }
        };
        ctrlc::set_handler(stop).map_err(|error| unhandled(&error))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Cancels; whether that was done before.
fn is_stopping(current: &Cancellation) -> bool {
    let is_again = current.is_cancelled();
    current.cancel();
    is_again
}

fn leave_with(failure: &Failure, format: DiagnosticFormat) -> ! {
    failure.report(format);
    std::process::exit(failure.status as i32)
}

fn unhandled(error: &impl std::fmt::Display) -> Failure {
    Failure::output(Diagnostic::new(format!("cannot handle signals: {error}")))
}

#[cfg(unix)]
mod terminal {
    use std::io::{self, Write};

    use rustix::termios::{OptionalActions, Termios, tcgetattr, tcsetattr};

    /// How the terminal was before lines were edited.
    pub(super) struct Terminal(Option<Termios>);

    impl Terminal {
        pub fn now() -> Terminal {
            Terminal(tcgetattr(io::stdin()).ok())
        }

        /// Makes it so again; one that is gone needs nothing.
        pub fn restore(&self) {
            const PLAIN_PASTE: &str = "\x1b[?2004l";
            if let Some(modes) = &self.0 {
                let _ = tcsetattr(io::stdin(), OptionalActions::Now, modes);
                let mut out = io::stdout();
                let _ = writeln!(out, "{PLAIN_PASTE}").and_then(|()| out.flush());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_stops_what_is_computed_and_the_next_ends_the_program() {
        let signals = Signals::default();
        assert!(!signals.interrupt(), "the prompt waits");
        let current = Cancellation::default();
        signals.set_current(Some(current.clone()));
        assert!(!signals.interrupt() && current.is_cancelled() && !signals.is_over());
        assert!(signals.interrupt());
        signals.set_current(None);
        assert!(!signals.interrupt(), "the prompt waits again");
    }

    #[cfg(unix)]
    #[test]
    fn termination_lets_a_computation_stop_first() {
        let (signals, current) = (Signals::default(), Cancellation::default());
        signals.set_current(Some(current.clone()));
        assert!(!signals.terminate() && current.is_cancelled() && signals.is_over());
        assert!(signals.terminate());
        signals.set_current(None);
        assert!(signals.terminate(), "the prompt waits");
    }
}
