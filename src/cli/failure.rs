//! Why a command fails, its exit status, and errors of the modules as diagnostics.

use std::fmt::Display;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::ExitCode;

use serde_json::json;

use crate::{DiagnosticFormat, has_printed, print_diagnostics, print_drawing, print_json, print_records};
use base::diagnostic::{Diagnostic, Record, Source, Span, shown_path};
use base::file;
use lab::error::{Error, Kind};
use study::post::{EvaluateError, PrepareError};
use study::script::{Fault, ReadError};
use study::store::StoreError;

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
    /// Results could not be stored.
    pub(crate) fn unstored(error: &StoreError) -> Failure {
        Failure::output(Diagnostic::new(error.to_string()))
    }

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

    /// Prints the diagnostics, as an object on standard output too where `json` is asked for and nothing is there yet, and gives
    /// the exit status.
    pub(crate) fn report(&self, format: DiagnosticFormat, json: bool) -> ExitCode {
        if json && !has_printed() {
            let errors: Vec<Record<'_>> = self.diagnostics.iter().map(Diagnostic::record).collect();
            // With standard output closed, the exit status is left.
            let _ = print_json(&json!({ "errors": errors }));
        }
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

/// Results that cannot be stored.
impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Failure {
        Diagnostic::new(error.to_string()).into()
    }
}

/// Both values, or the failures of both.
pub(crate) fn both<A, B>(
    a: Result<A, impl Into<Failure>>,
    b: Result<B, impl Into<Failure>>,
) -> Result<(A, B), Failure> {
    match (a, b) {
        (Ok(a), Ok(b)) => Ok((a, b)),
        (a, b) => {
            let failures = [a.err().map(Into::into), b.err().map(Into::into)];
            Err(Failure::all(failures.into_iter().flatten()).unwrap_or_else(Failure::quiet))
        }
    }
}

/// All values, or all failures.
pub(crate) fn all<T, E: Into<Failure>>(results: impl IntoIterator<Item = Result<T, E>>) -> Result<Vec<T>, Failure> {
    let (values, failure) = split(results);
    failure.map_or(Ok(values), Err)
}

/// The values, and one failure of all that there are.
pub(crate) fn split<T, E: Into<Failure>>(results: impl IntoIterator<Item = Result<T, E>>) -> (Vec<T>, Option<Failure>) {
    let (mut values, mut failures) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(error) => failures.push(error.into()),
        }
    }
    (values, Failure::all(failures))
}

/// Refuses what has mistakes.
pub(crate) fn refuse(mistakes: impl IntoIterator<Item = Diagnostic>) -> Result<(), Failure> {
    let mistakes: Vec<Diagnostic> = mistakes.into_iter().collect();
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes.into()) }
}

/// An error with its hint, where there is one.
pub(crate) fn hinted(error: &(impl Display + ?Sized), hint: Option<impl Into<String>>) -> Diagnostic {
    Diagnostic { hint: hint.map(Into::into), ..Diagnostic::new(error.to_string()) }
}

/// A script fault at its place in the script.
pub(crate) fn script(fault: &Fault) -> Diagnostic {
    let source = Source::file(&fault.file, fault.text.to_string());
    let mistake = Diagnostic::new(fault.message.as_str()).at(&Span::position(&source, fault.line, fault.column));
    Diagnostic { hint: fault.hint.clone(), ..mistake }
}

/// A script that cannot start.
pub(crate) fn reading(error: &ReadError) -> Vec<Diagnostic> {
    match error {
        ReadError::Faults(faults) => faults.iter().map(script).collect(),
        ReadError::Refused(error) => vec![hinted(error, error.hint())],
    }
}

/// A reference or post script that cannot be used after the run.
pub(crate) fn preparing(error: &PrepareError) -> Vec<Diagnostic> {
    match error {
        PrepareError::Script(error) => reading(error),
        PrepareError::Recording(error) => vec![recording(error)],
        other => vec![Diagnostic::new(other.to_string())],
    }
}

/// A measurement or post script that failed after the run.
pub(crate) fn evaluating(error: &EvaluateError) -> Diagnostic {
    match error {
        EvaluateError::Script(fault) => script(fault),
        other => Diagnostic::new(other.to_string()),
    }
}

/// A refusal of the laboratory, with the line at fault of a recording that cannot be read.
pub(crate) fn recording(error: &Error) -> Diagnostic {
    let place = error.place().and_then(|(path, line, column)| Some((line_of(path, line)?, path, line, column)));
    let mistake = match place {
        Some((text, path, line, column)) => {
            let source = Source::excerpt(path, line, text);
            Diagnostic::new(error.message()).at(&Span::position(&source, 1, column))
        }
        None => Diagnostic::new(error.to_string()),
    };
    Diagnostic { hint: error.hint().map(str::to_owned), ..mistake }
}

/// A refusal of what was read of the file at `path`.
pub(crate) fn content(path: &Path, error: &Error) -> Diagnostic {
    let mistake = Diagnostic::new(format!("{}: {error}", shown_path(path)));
    match error.kind() {
        Kind::NoUnit { unit, .. } => mistake.hint(format!("give it: --unit {unit}")),
        _ => Diagnostic { hint: error.hint().map(str::to_owned), ..mistake },
    }
}

/// Most of a line that a diagnostic shows, bytes.
const LONGEST_SHOWN: u64 = 4096;

/// The line `number` of a file that may be large; the lines before it are not held in memory.
fn line_of(path: &Path, number: usize) -> Option<String> {
    let mut file = BufReader::new(file::open(path).ok()?);
    for _ in 1..number {
        file.skip_until(b'\n').ok()?;
    }
    let mut line = Vec::new();
    file.take(LONGEST_SHOWN).read_until(b'\n', &mut line).ok()?;
    let text = String::from_utf8_lossy(&line);
    let text = text.trim_start_matches('\u{feff}').trim_end_matches(['\r', '\n']);
    Some(text.replace(char::is_control, " "))
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
