//! Where the files of a container are: in a folder, or in a zip archive.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, BufRead, Cursor, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::archive::Archive;
use super::fault::{Fault, Mistake, ReadError};
use crate::signal::text::{self, Lines, TextError};
use base::diagnostic::folder_of;
use base::file::FileError;

/// Whether the file at `path` is part of a container, by its name: a folder, `.zip`, `.mme`, `.chn` or `.001`, ….
pub fn is_part(path: &Path) -> bool {
    path.is_dir() || ["zip", "mme", "chn"].iter().any(|known| has_extension(path, known)) || number(path).is_some()
}

/// The lines of a file of a container.
pub(super) type MemberLines = Lines<Box<dyn BufRead>>;

/// A file of a container.
#[derive(Clone, Debug)]
pub(super) struct Member {
    /// Its path; of one in an archive, behind that of the archive.
    pub path: PathBuf,
    place: Place,
}

impl Member {
    /// The name of the file.
    pub fn name(&self) -> String {
        name_of(&self.path)
    }

    /// Its lines. Of one in an archive, the whole text is held in memory.
    pub fn lines(&self) -> Result<MemberLines, Mistake> {
        match &self.place {
            Place::Disk => Ok(text::open(&self.path)?.boxed()),
            Place::Archive(archive, at) => {
                let inner = self.path.strip_prefix(at).unwrap_or(&self.path);
                let failed = |error| Mistake::whole(Fault::Text(TextError::Open(FileError::Io(error))));
                Ok(Lines::new(Box::new(Cursor::new(archive.bytes(inner).map_err(failed)?))))
            }
        }
    }
}

/// The files of a container.
pub(super) struct Files {
    pub test: Option<Member>,
    pub list: Option<Member>,
    /// In the order of their numbers.
    pub channels: Vec<Member>,
}

impl Files {
    pub fn locate(path: &Path) -> Result<Files, ReadError> {
        let place = Place::from_path(path).map_err(|fault| Mistake::whole(fault).locate(path))?;
        let test = if place.is_folder(path) { place.test_in(path)? } else { path.to_owned() };
        let fail = |fault| Mistake::whole(fault).locate(&test);
        if !place.is_file(&test) {
            let missing = io::Error::new(ErrorKind::NotFound, "no such file or folder");
            return Err(fail(Fault::Text(TextError::Open(FileError::Io(missing)))));
        }
        let is_test = has_extension(&test, "mme");
        let folder = if is_test { place.channel_folder(&test)? } else { folder_of(&test).to_owned() };
        let stem = stem_of(&test);
        let files: Vec<PathBuf> = place.entries(&folder)?.into_iter().filter(|file| stem_of(file) == stem).collect();
        let list = files.iter().find(|file| has_extension(file, "chn")).cloned();
        let mut channels: Vec<(u64, PathBuf)> =
            files.into_iter().filter_map(|file| Some((number(&file)?, file))).collect();
        if channels.is_empty() {
            return Err(fail(Fault::NoChannelFiles { stem }));
        }
        channels.sort();
        let member = |path: PathBuf| Member { path, place: place.clone() };
        let channels = channels.into_iter().map(|(_, file)| member(file)).collect();
        Ok(Files { test: is_test.then(|| member(test)), list: list.map(member), channels })
    }
}

/// Where paths lead to: to the disk, or into an archive, whose path is that of its outermost folder.
#[derive(Clone, Debug)]
enum Place {
    Disk,
    Archive(Arc<Archive>, PathBuf),
}

impl Place {
    fn from_path(path: &Path) -> Result<Place, Fault> {
        if path.is_file() && has_extension(path, "zip") {
            return Ok(Place::Archive(Arc::new(Archive::open(path)?), path.to_owned()));
        }
        Ok(Place::Disk)
    }

    fn is_folder(&self, path: &Path) -> bool {
        match self {
            Place::Disk => path.is_dir(),
            Place::Archive(archive, at) => {
                path.strip_prefix(at).is_ok_and(|inner| inner.as_os_str().is_empty() || archive.is_folder(inner))
            }
        }
    }

    fn is_file(&self, path: &Path) -> bool {
        match self {
            Place::Disk => path.is_file(),
            Place::Archive(archive, at) => path.strip_prefix(at).is_ok_and(|inner| archive.is_file(inner)),
        }
    }

    /// The entries of a folder, in the order of their names.
    fn entries(&self, folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
        match self {
            Place::Disk => entries_on_disk(folder),
            Place::Archive(archive, at) => {
                let inner = folder.strip_prefix(at).unwrap_or(folder);
                Ok(archive.entries(inner).into_iter().map(|entry| at.join(entry)).collect())
            }
        }
    }

    /// The test in a folder, or else its list of channels. An archive may have it in its only folder.
    fn test_in(&self, folder: &Path) -> Result<PathBuf, ReadError> {
        let fail = |fault| Mistake::whole(fault).locate(folder);
        let files = self.entries(folder)?;
        let of_kind = |kind| files.iter().filter(|file| has_extension(file, kind)).collect::<Vec<_>>();
        let (tests, lists) = (of_kind("mme"), of_kind("chn"));
        let folders: Vec<&PathBuf> = files.iter().filter(|file| self.is_folder(file)).collect();
        match (&tests[..], &lists[..], &folders[..], self) {
            ([one], ..) | ([], [one], ..) => Ok((*one).clone()),
            ([], [], [inner], Place::Archive(..)) => self.test_in(inner),
            ([], [], ..) => Err(fail(Fault::NoTest)),
            ([], several, ..) | (several, ..) => {
                Err(fail(Fault::SeveralTests { found: several.iter().map(|file| name_of(file)).collect() }))
            }
        }
    }

    /// The folder `Channel` beside a test.
    fn channel_folder(&self, test: &Path) -> Result<PathBuf, ReadError> {
        let is_it = |entry: &PathBuf| self.is_folder(entry) && name_of(entry).eq_ignore_ascii_case("channel");
        let found = self.entries(folder_of(test))?.into_iter().find(is_it);
        found.ok_or_else(|| Mistake::whole(Fault::NoChannelFolder).locate(test))
    }
}

/// The entries of a folder on the disk, in the order of their names.
fn entries_on_disk(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let failed = |error| Mistake::whole(Fault::Text(TextError::Open(FileError::from(error)))).locate(folder);
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
