//! The folder of a deck: written complete or not at all. It is given to a solver, so it has none of the files by which
//! `study::store` knows its own folders.

use std::fs;
use std::io;
use std::path::Path;

use crate::{Failure, output};
use ::card::deck::{FILES, File};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::scratch::ScratchFolder;

/// Refuses a folder that holds anything, unless `force` is given and it is a deck.
pub(super) fn check(out: &Path, force: bool) -> Result<(), Failure> {
    let shown = shown_path(out);
    let refused = |message: String, hint: &str| Err(Failure::from(Diagnostic::new(message).hint(hint)));
    if out.file_name().is_none() {
        return refused(format!("{shown} does not name a folder of its own"), "give a new folder, such as deck");
    }
    let entries = match fs::read_dir(out) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
            return refused(format!("{shown} is not a folder"), "give another name");
        }
        Err(error) => return Err(output::failed(out, &error)),
    };
    let mut is_empty = true;
    for entry in entries {
        let name = entry.map_err(|error| output::failed(out, &error))?.file_name();
        let name = name.to_string_lossy();
        if !FILES.contains(&&*name) {
            return refused(format!("{shown} holds `{name}`, which is no file of a deck"), "give another folder");
        }
        is_empty = false;
    }
    if is_empty || force {
        return Ok(());
    }
    refused(format!("{shown} holds a deck and is not replaced"), "give another folder, or --force")
}

/// Writes a folder beside `out` that replaces it when it is complete.
pub(super) fn write(out: &Path, files: &[File]) -> Result<(), Failure> {
    let written = || -> io::Result<()> {
        let parent = folder_of(out);
        fs::create_dir_all(parent)?;
        let mut draft = ScratchFolder::new(parent)?;
        let deck = draft.path().to_path_buf();
        for File { name, text } in files {
            fs::write(deck.join(name), text)?;
        }
        let former = ScratchFolder::new(parent)?;
        let replaced = if out.exists() { Some(former.former(out)?) } else { None };
        if let Some(place) = &replaced {
            fs::rename(out, place)?;
        }
        if let Err(error) = fs::rename(&deck, out) {
            // Dropping the temporary folder would delete the former deck.
            if replaced.is_some_and(|place| fs::rename(place, out).is_err()) {
                former.keep();
            }
            return Err(error);
        }
        draft.renamed();
        Ok(())
    };
    written().map_err(|error| output::failed(out, &error))
}
