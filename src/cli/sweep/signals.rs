//! Termination by a signal.

use crate::cli::Failure;
use crate::diagnostic::Diagnostic;
use crate::simulate::Cancellation;

/// Cancels the runs of this process on SIGTERM, SIGINT and SIGHUP.
pub(super) fn cancel_on_termination(cancellation: &Cancellation) -> Result<(), Failure> {
    let cancellation = cancellation.clone();
    let handled = ctrlc::set_handler(move || cancellation.cancel());
    handled.map_err(|error| Failure::output(Diagnostic::new(format!("cannot handle signals: {error}"))))
}
