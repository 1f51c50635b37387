//! Errors of the modules as diagnostics.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use base::diagnostic::{Diagnostic, Source, Span, shown_path};
use base::file;
use lab::error::{Error, Kind};
use study::post::{EvaluateError, PrepareError, ReferenceError};
use study::script::{Fault, ReadError};
use study::store::StoreError;

/// A script fault at its place in the script.
pub(super) fn script(fault: &Fault) -> Diagnostic {
    let source = Source::file(&fault.file, fault.text.to_string());
    let mistake = Diagnostic::new(fault.message.as_str()).at(&Span::position(&source, fault.line, fault.column));
    Diagnostic { hint: fault.hint.clone(), ..mistake }
}

/// A script that cannot start.
pub(super) fn reading(error: &ReadError) -> Vec<Diagnostic> {
    match error {
        ReadError::Faults(faults) => faults.iter().map(script).collect(),
        ReadError::Open { source, .. } if source.hint().is_some() => {
            vec![Diagnostic { hint: source.hint().map(str::to_owned), ..Diagnostic::new(error.to_string()) }]
        }
        other => vec![Diagnostic::new(other.to_string())],
    }
}

/// A reference or post script that cannot be used after the run.
pub(super) fn preparing(error: &PrepareError) -> Vec<Diagnostic> {
    match error {
        PrepareError::Script(error) => reading(error),
        PrepareError::Reference(ReferenceError::Read(error)) => vec![recording(error)],
        other => vec![Diagnostic::new(other.to_string())],
    }
}

/// A measurement or post script that failed after the run.
pub(super) fn evaluating(error: &EvaluateError) -> Diagnostic {
    match error {
        EvaluateError::Script(fault) => script(fault),
        other => Diagnostic::new(other.to_string()),
    }
}

/// Results that cannot be stored.
pub(super) fn storing(error: &StoreError) -> Diagnostic {
    Diagnostic::new(error.to_string())
}

/// A refusal of the laboratory, with the line at fault of a recording that cannot be read.
pub(super) fn recording(error: &Error) -> Diagnostic {
    let located = error.place().and_then(|(path, line, column)| Some((path, line, column, line_of(path, line)?)));
    let mistake = match located {
        Some((path, line, column, text)) => {
            let source = Source::excerpt(path, line, text);
            Diagnostic::new(error.message()).at(&Span::position(&source, 1, column))
        }
        None => Diagnostic::new(error.to_string()),
    };
    Diagnostic { hint: error.hint().map(str::to_owned), ..mistake }
}

/// A refusal of what was read of the file at `path`.
pub(super) fn content(path: &Path, error: &Error) -> Diagnostic {
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
