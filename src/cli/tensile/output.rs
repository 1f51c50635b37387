//! The material file and the shear curve beside it: written whole, and never over what a user wrote.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::diagnostic::{Diagnostic, shown_path};
/// What stands before the checksum in the last line of every file that is written here.
const SEAL: &str = "# Replaced by the next reduction only while it is unchanged: ";

/// Where the material and its shear curve go: `film.toml` and `film-shear.csv`.
pub fn places(material: &Path) -> Result<[PathBuf; 2], Diagnostic> {
    let shown = shown_path(material);
    if material.extension().is_none_or(|extension| extension != "toml") {
        return Err(Diagnostic::new(format!("a material file ends in .toml, and {shown} does not")));
    }
    let stem = material.file_stem().unwrap_or_default().to_string_lossy();
    let shear = material.with_file_name(format!("{stem}-shear.csv"));
    let places = [material.to_path_buf(), shear];
    match places.iter().find(|place| !is_replaceable(place)) {
        Some(place) => {
            let mistake =
                Diagnostic::new(format!("{} was not written from coupon tests and is not replaced", shown_path(place)));
            Err(mistake.hint("give another name, or remove it first"))
        }
        None => Ok(places),
    }
}

/// Free, or written by this command before and left as it was.
fn is_replaceable(place: &Path) -> bool {
    match fs::read_to_string(place) {
        Ok(content) => is_sealed(&content),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    }
}

/// The text with a last line that tells whether it is still the same.
fn sealed(text: &str) -> String {
    format!("{text}{SEAL}{:08x}\n", crc32fast::hash(text.as_bytes()))
}

fn is_sealed(content: &str) -> bool {
    content.rfind(SEAL).is_some_and(|place| sealed(&content[..place]) == content)
}

/// Puts every file in its place, none before all of them are written.
pub fn write(texts: &[(PathBuf, String)]) -> Result<(), Diagnostic> {
    let fault = |path: &Path, error: &io::Error| Diagnostic::new(format!("cannot write {}: {error}", shown_path(path)));
    let mut drafts = Vec::new();
    for (path, text) in texts {
        drafts.push((path, draft(path, text).map_err(|error| fault(path, &error))?));
    }
    for (path, draft) in drafts {
        draft.persist(path).map_err(|error| fault(path, &error.error))?;
    }
    Ok(())
}

fn draft(path: &Path, text: &str) -> io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".droptower-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut draft = builder.tempfile_in(folder)?;
    draft.write_all(sealed(text).as_bytes())?;
    Ok(draft)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_was_changed_is_not_sealed() {
        let text = sealed("density = 915\n");
        assert!(is_sealed(&text));
        for changed in
            [text.replace("915", "920"), text.replace("density", "# mine\ndensity"), format!("{text}\n"), String::new()]
        {
            assert!(!is_sealed(&changed), "{changed}");
        }
    }
}
