//! Tables that commands make from recordings.

use std::path::Path;

use crate::output;
use base::diagnostic::{Diagnostic, shown_path};
use lab::signal::{Recording, csv, isomme};

use crate::Failure;

/// Refuses a table whose name does not end in .csv, that would replace the input or, without `force`, anything that is
/// there.
pub(crate) fn check_table(out: &Path, input: &Path, force: bool) -> Result<(), Failure> {
    if isomme::is_part(out) {
        let message = format!("{} is the name of ISO-MME, but a table is written", shown_path(out));
        return Err(Diagnostic::new(message).hint("name it .csv").into());
    }
    output::check(out, "csv", Some(input), Some(force))
}

/// Writes `recording` with `comments` before it, whole or not at all.
pub(crate) fn write_csv(out: &Path, comments: &[String], recording: &Recording) -> Result<(), Failure> {
    output::write(out, |text| {
        for line in comments {
            writeln!(text, "# {}", line.replace(char::is_control, " "))?;
        }
        csv::write(recording, text)
    })
}
