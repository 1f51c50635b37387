//! Signals into a file that is whole or not there.

use std::fs;
use std::io;
use std::path::Path;

use crate::diagnostic::{Diagnostic, shown_path};
use crate::signal::{Recording, csv};

/// Refuses to replace the recording that signals are made `from`.
pub fn check(path: &Path, from: &Path) -> Result<(), Diagnostic> {
    let same = |a: &Path, b: &Path| fs::canonicalize(a).ok().zip(fs::canonicalize(b).ok()).is_some_and(|(a, b)| a == b);
    if same(path, from) {
        return Err(Diagnostic::new(format!("{} is the recording itself and is not replaced", shown_path(path))));
    }
    Ok(())
}

/// Writes `recording` beside `path` and then moves it there.
pub fn write(recording: &Recording, path: &Path) -> Result<(), Diagnostic> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let written = || -> io::Result<()> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".droptower-");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut draft = builder.tempfile_in(folder)?;
        csv::write(recording, io::BufWriter::new(draft.as_file_mut()))?;
        draft.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    written().map_err(|error| Diagnostic::new(format!("cannot write {}: {error}", shown_path(path))))
}
