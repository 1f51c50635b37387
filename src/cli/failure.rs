//! Why a command fails, and its exit status.

use std::process::ExitCode;

use super::{DiagnosticFormat, print_diagnostics, print_drawing, print_records};
use base::diagnostic::Diagnostic;

/// The exit status of a command that fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum ExitStatus {
    /// Results could not be written or are incomplete, or another program failed.
    OutputFailed = 1,
    /// A mistake in a scenario, a script, a recording or the arguments; nothing was written but the page that shows why a
    /// recording cannot be reduced.
    BadInput = 2,
    /// A run failed numerically; what was computed before is stored.
    NumericalFailure = 3,
}

/// Why a command fails.
#[derive(Clone, Debug)]
pub(crate) struct Failure {
    /// The status that the command exits with.
    pub status: ExitStatus,
    /// The messages for standard error; empty where standard output has them already.
    pub diagnostics: Vec<Diagnostic>,
    /// What the messages are about, drawn in characters, for a person who reads them.
    pub drawing: Option<String>,
}

impl Failure {
    /// A file or folder could not be written, or another program failed.
    pub(crate) fn output(diagnostic: Diagnostic) -> Failure {
        Failure { status: ExitStatus::OutputFailed, diagnostics: vec![diagnostic], drawing: None }
    }

    /// A failure without a message, as standard output has told it already.
    pub(crate) fn quiet() -> Failure {
        Failure { status: ExitStatus::OutputFailed, diagnostics: vec![], drawing: None }
    }

    /// A run failed numerically.
    pub(crate) fn numerical(diagnostic: Diagnostic) -> Failure {
        Failure { status: ExitStatus::NumericalFailure, diagnostics: vec![diagnostic], drawing: None }
    }

    /// One failure of many, with the highest exit status; none where there are none.
    pub(crate) fn all(failures: impl IntoIterator<Item = Failure>) -> Option<Failure> {
        failures.into_iter().reduce(|mut all, failure| {
            all.status = all.status.max(failure.status);
            all.diagnostics.extend(failure.diagnostics);
            all
        })
    }

    /// Prints the diagnostics and gives the exit status.
    pub(crate) fn report(&self, format: DiagnosticFormat) -> ExitCode {
        match format {
            _ if self.diagnostics.is_empty() => {}
            DiagnosticFormat::Text => {
                print_drawing(self.drawing.as_deref().unwrap_or_default());
                print_diagnostics(&self.diagnostics);
            }
            DiagnosticFormat::Json => print_records(&self.diagnostics),
        }
        ExitCode::from(self.status as u8)
    }
}

/// A mistake of the user's.
impl From<Diagnostic> for Failure {
    fn from(diagnostic: Diagnostic) -> Failure {
        Failure::from(vec![diagnostic])
    }
}

/// Mistakes of the user's.
impl From<Vec<Diagnostic>> for Failure {
    fn from(diagnostics: Vec<Diagnostic>) -> Failure {
        Failure { status: ExitStatus::BadInput, diagnostics, drawing: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_failures_exit_with_the_highest_status() {
        let mistake = || Diagnostic::new("no");
        let failures = [Failure::output(mistake()), Failure::numerical(mistake()), mistake().into()];
        let all = Failure::all(failures).unwrap();
        assert_eq!((all.status, all.diagnostics.len()), (ExitStatus::NumericalFailure, 3));
        assert!(Failure::all([]).is_none());
    }
}
