//! Files that say what a run must give, with the codes of findings that this build knows.

use std::path::Path;

use super::codes;
use base::diagnostic::Diagnostic;
use scene::expectation::Expectations;
use scene::scenario::Document;

/// The expectations in the file at `path`. A code that no finding has would never come: it is a mistake, unless scripts may
/// report codes of their own and it is not close to a known one.
pub(super) fn read(path: &Path, scripts_report: bool) -> Result<Expectations, Vec<Diagnostic>> {
    let document = Document::read_expectations(path)?;
    let expectations = Expectations::check(&document)?;
    let lists = [("must", &expectations.must), ("must_not", &expectations.must_not)];
    let mut mistakes = Vec::new();
    for (key, codes) in lists {
        let unknown = codes.iter().filter(|code| *code != "*" && codes::find(code).is_none());
        for code in unknown.filter(|code| !scripts_report || codes::misspelt(code).is_some()) {
            let mistake =
                Diagnostic::new(format!("there is no finding `{code}`")).at(&document.span_of(&["warnings", key]));
            let hint = codes::hint(code).unwrap_or_else(|| "`droptower explain findings` lists them".into());
            mistakes.push(mistake.hint(hint));
        }
    }
    if mistakes.is_empty() { Ok(expectations) } else { Err(mistakes) }
}
