//! Files that commands make from recordings: whole, or not at all.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::cli::BAD_INPUT;
use crate::cli::faults::WRITE_FAILURE;
use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::{Recording, csv, isomme};

/// Exit status and what is to be said.
pub type Failure = (u8, Diagnostic);

/// Refuses a table that would replace an input, or a file of a container.
pub fn check_table(out: &Path, input: &Path) -> Result<(), Failure> {
    let shown = shown_path(out);
    let refused = |message, hint: &str| Err((BAD_INPUT, Diagnostic::new(message).hint(hint)));
    if isomme::is_part(out) {
        return refused(format!("{shown} is the name of ISO-MME, but a table is written"), "name it .csv");
    }
    let canonical = |path: &Path| fs::canonicalize(path).ok();
    if canonical(out).is_some_and(|out| canonical(input) == Some(out)) {
        return refused(format!("{shown} is the input"), "write to another file");
    }
    Ok(())
}

/// Writes `recording` with `comments` before it to a file of its own that takes the place of `out` when it is whole.
pub fn write_csv(out: &Path, comments: &[String], recording: &Recording) -> Result<(), Failure> {
    let written = || -> io::Result<()> {
        let folder = out.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        fs::create_dir_all(folder)?;
        let mut draft = draft(folder)?;
        let mut text = BufWriter::new(&mut draft);
        for line in comments {
            writeln!(text, "# {}", line.replace(char::is_control, " "))?;
        }
        csv::write(recording, &mut text)?;
        text.flush()?;
        drop(text);
        draft.persist(out)?;
        Ok(())
    };
    written().map_err(|error| failed(out, &error))
}

/// An output that could not be written.
pub fn failed(out: &Path, error: &impl std::fmt::Display) -> Failure {
    (WRITE_FAILURE, Diagnostic::new(format!("cannot write {}: {error}", shown_path(out))))
}

/// A temporary file is its owner's alone; what it becomes is read by whom the user's mask lets.
fn draft(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
