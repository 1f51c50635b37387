//! Findings on the terminal.

use std::fmt::Write;

use base::finding::{Finding, Severity};
use study::codes;
use study::script::{RunFindings, Warning};

/// The finding of a study whose runs have warnings; that recordings are virtual is a finding of its own.
pub(super) fn of_runs(found: &RunFindings) -> Option<Finding> {
    let is_warning = |code: &str| {
        let severity = codes::find(code).map_or(Severity::Warning, |code| code.severity);
        severity == Severity::Warning && !code.starts_with("virtual-")
    };
    Warning::of_runs(found, is_warning).map(|warning| Finding::new(&warning))
}

/// One line a finding, with its severity and code, each after `indent` and ending with a line break.
pub(super) fn lines<'f>(indent: &str, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    findings.into_iter().fold(String::new(), |mut text, finding| {
        let _ = writeln!(text, "{indent}{finding}");
        text
    })
}
