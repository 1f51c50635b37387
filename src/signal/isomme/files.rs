//! Where the files of a container are.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::fault::{Fault, Mistake, ReadError};
use crate::diagnostic::folder_of;
use crate::file::FileError;
use crate::signal::text::TextError;

/// Whether the file at `path` is part of a container, by its name: a folder, `.mme`, `.chn` or `.001`, ….
pub fn is_part(path: &Path) -> bool {
    let Some(extension) = path.extension().and_then(|extension| extension.to_str()) else {
        return path.is_dir();
    };
    path.is_dir() || ["mme", "chn"].iter().any(|known| extension.eq_ignore_ascii_case(known)) || number(path).is_some()
}

/// The files of a container.
pub(super) struct Files {
    pub test: Option<PathBuf>,
    pub list: Option<PathBuf>,
    /// In the order of their numbers.
    pub channels: Vec<PathBuf>,
}

impl Files {
    pub fn locate(path: &Path) -> Result<Files, ReadError> {
        let fail = |fault| Mistake::whole(fault).of(path);
        if path.is_dir() {
            return Files::locate(&test_in(path)?);
        }
        if !path.is_file() {
            let missing = io::Error::new(ErrorKind::NotFound, "no such file or folder");
            return Err(fail(Fault::Text(TextError::Open(FileError::Io(missing)))));
        }
        let is_test = has_extension(path, "mme");
        let folder = if is_test { channel_folder(path)? } else { folder_of(path).to_owned() };
        let stem = stem_of(path);
        let files: Vec<PathBuf> = entries(&folder)?.into_iter().filter(|file| stem_of(file) == stem).collect();
        let list = files.iter().find(|file| has_extension(file, "chn")).cloned();
        let mut channels: Vec<(u64, PathBuf)> =
            files.into_iter().filter_map(|file| Some((number(&file)?, file))).collect();
        if channels.is_empty() {
            return Err(fail(Fault::NoChannelFiles { stem }));
        }
        channels.sort();
        let channels = channels.into_iter().map(|(_, file)| file).collect();
        Ok(Files { test: is_test.then(|| path.to_owned()), list, channels })
    }
}

/// The test in a folder, or else its list of channels.
fn test_in(folder: &Path) -> Result<PathBuf, ReadError> {
    let fail = |fault| Mistake::whole(fault).of(folder);
    let files = entries(folder)?;
    let of_kind = |kind| files.iter().filter(|file| has_extension(file, kind)).collect::<Vec<_>>();
    let (tests, lists) = (of_kind("mme"), of_kind("chn"));
    match (&tests[..], &lists[..]) {
        ([one], _) | ([], [one]) => Ok((*one).clone()),
        ([], []) => Err(fail(Fault::NoTest)),
        ([], several) | (several, _) => {
            Err(fail(Fault::SeveralTests { found: several.iter().map(|file| name_of(file)).collect() }))
        }
    }
}

/// The folder `Channel` beside a test.
fn channel_folder(test: &Path) -> Result<PathBuf, ReadError> {
    let is_it = |entry: &PathBuf| entry.is_dir() && name_of(entry).eq_ignore_ascii_case("channel");
    let found = entries(folder_of(test))?.into_iter().find(is_it);
    found.ok_or_else(|| Mistake::whole(Fault::NoChannelFolder).of(test))
}

/// The entries of a folder, in the order of their names.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let failed = |error| Mistake::whole(Fault::Text(TextError::Open(FileError::from(error)))).of(folder);
    let entries = fs::read_dir(folder).map_err(failed)?;
    let mut paths =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>().map_err(failed)?;
    paths.sort();
    Ok(paths)
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn stem_of(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().to_lowercase())
}

/// The number of a channel file: its extension of three digits or more.
pub(super) fn number(path: &Path) -> Option<u64> {
    let extension = path.extension().and_then(OsStr::to_str)?;
    let digits = extension.len() >= 3 && extension.bytes().all(|letter| letter.is_ascii_digit());
    digits.then(|| extension.parse().ok()).flatten()
}
