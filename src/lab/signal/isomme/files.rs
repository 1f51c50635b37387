//! Where the files of a container are: in a folder, or in a zip archive that holds it as a folder does. Nothing of an
//! archive is written to the disk.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufRead, Cursor, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use zip::ZipArchive;
use zip::result::ZipError;

use crate::error::{Error, refusal};
use crate::signal::text::{self, Lines};
use base::diagnostic::{file_name, folder_of, listed};
use base::file::{self, FileError};

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
        file_name(&self.path)
    }

    /// Its lines. Of one in an archive, the whole text is held in memory.
    pub fn lines(&self) -> Result<MemberLines, Error> {
        match &self.place.0 {
            None => Ok(text::open(&self.path)?.boxed()),
            Some(archive) => Ok(Lines::new(Box::new(Cursor::new(archive.bytes(&self.path).map_err(FileError::Io)?)))),
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
    pub fn locate(path: &Path) -> Result<Files, Error> {
        let place = Place::from_path(path).map_err(|error| error.in_file(path))?;
        let test = if place.is_folder(path) { place.test_in(path)? } else { path.to_owned() };
        if !place.is_file(&test) {
            let missing = io::Error::new(ErrorKind::NotFound, "no such file or folder");
            return Err(Error::from(FileError::Io(missing)).in_file(&test));
        }
        let is_test = has_extension(&test, "mme");
        let folder = if is_test { place.channel_folder(&test)? } else { folder_of(&test).to_owned() };
        let stem = stem_of(&test);
        let files: Vec<PathBuf> = place.entries(&folder)?.into_iter().filter(|file| stem_of(file) == stem).collect();
        let list = files.iter().find(|file| has_extension(file, "chn")).cloned();
        let mut channels: Vec<(u64, PathBuf)> =
            files.into_iter().filter_map(|file| Some((number(&file)?, file))).collect();
        if channels.is_empty() {
            return Err(refusal!("no channel files (`{stem}.001`, …)").in_file(&test));
        }
        channels.sort();
        let member = |path: PathBuf| Member { path, place: place.clone() };
        let channels = channels.into_iter().map(|(_, file)| member(file)).collect();
        Ok(Files { test: is_test.then(|| member(test)), list: list.map(member), channels })
    }
}

/// Where paths lead to: to the disk, or into an archive.
#[derive(Clone, Debug)]
struct Place(Option<Arc<Archive>>);

impl Place {
    fn from_path(path: &Path) -> Result<Place, Error> {
        let is_archive = path.is_file() && has_extension(path, "zip");
        Ok(Place(is_archive.then(|| Archive::open(path).map(Arc::new)).transpose()?))
    }

    fn is_folder(&self, path: &Path) -> bool {
        self.0.as_ref().map_or_else(|| path.is_dir(), |archive| archive.is_folder(path))
    }

    fn is_file(&self, path: &Path) -> bool {
        self.0.as_ref().map_or_else(|| path.is_file(), |archive| archive.files.contains_key(path))
    }

    /// The entries of a folder, in the order of their names.
    fn entries(&self, folder: &Path) -> Result<Vec<PathBuf>, Error> {
        let on_disk = || file::entries(folder).map_err(|error| Error::from(FileError::from(error)).in_file(folder));
        self.0.as_ref().map_or_else(on_disk, |archive| Ok(archive.entries(folder)))
    }

    /// The test in a folder, or else its list of channels. An archive may have it in its only folder.
    fn test_in(&self, folder: &Path) -> Result<PathBuf, Error> {
        let files = self.entries(folder)?;
        let of_kind = |kind| files.iter().filter(|file| has_extension(file, kind)).collect::<Vec<_>>();
        let (tests, lists) = (of_kind("mme"), of_kind("chn"));
        let folders: Vec<&PathBuf> = files.iter().filter(|file| self.is_folder(file)).collect();
        match (&tests[..], &lists[..], &folders[..], &self.0) {
            ([one], ..) | ([], [one], ..) => Ok((*one).clone()),
            ([], [], [inner], Some(_)) => self.test_in(inner),
            ([], [], ..) => {
                Err(refusal!("neither a test (.mme) nor a list of channels (.chn) in the folder").in_file(folder))
            }
            ([], several, ..) | (several, ..) => {
                let found = listed(several.iter().map(|file| file_name(file)));
                let error = refusal!("several tests in the folder: {found}");
                Err(error.with_hint("name the .mme file").in_file(folder))
            }
        }
    }

    /// The folder `Channel` beside a test.
    fn channel_folder(&self, test: &Path) -> Result<PathBuf, Error> {
        let is_it = |entry: &PathBuf| self.is_folder(entry) && file_name(entry).eq_ignore_ascii_case("channel");
        let found = self.entries(folder_of(test))?.into_iter().find(is_it);
        found.ok_or_else(|| refusal!("no folder `Channel` beside the test").in_file(test))
    }
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
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

/// Most files in an archive: those of a test with as many channels as can be counted, and as many more.
const MOST_FILES: usize = 20_000;

/// Most bytes of all files of an archive together, unpacked.
const MOST_BYTES: u64 = 4 << 30;

/// Most bytes of one file, unpacked: it is held in memory.
const MOST_BYTES_OF_FILE: u64 = 1 << 30;

/// Most bytes of an archive as it is packed: its directory is read before its files are counted.
const MOST_BYTES_PACKED: u64 = 1 << 30;

/// Most folders that a file of an archive lies in.
const MOST_FOLDERS: usize = 16;

/// Folder of the copies of attributes that macOS puts into archives.
const ATTRIBUTES: &str = "__MACOSX";

/// An archive whose names and sizes were checked.
#[derive(Debug)]
pub(super) struct Archive {
    /// Its path, that of its outermost folder.
    path: PathBuf,
    /// Place in the archive of each file, whose path is behind that of the archive.
    files: BTreeMap<PathBuf, usize>,
    zip: Mutex<ZipArchive<File>>,
}

impl Archive {
    /// Reads the directory of the archive at `path`.
    pub fn open(path: &Path) -> Result<Archive, Error> {
        let packed = file::open(path)?;
        let bytes = packed.metadata().map_err(FileError::from)?.len();
        if bytes > MOST_BYTES_PACKED {
            return Err(refusal!("the archive has {bytes} bytes, more than {MOST_BYTES_PACKED}"));
        }
        let zip = ZipArchive::new(packed).map_err(damaged)?;
        if zip.len() > MOST_FILES {
            let count = zip.len();
            return Err(refusal!("the archive holds {count} files, more than the {MOST_FILES} of the largest test"));
        }
        let (mut files, mut total) = (BTreeMap::new(), 0_u64);
        let directory = zip.metadata();
        for index in 0..directory.len() {
            let entry = directory.entry(index).map_err(damaged)?;
            let name = entry.name().map_err(damaged)?.into_owned();
            let outside = || refusal!("the archive holds a file outside of itself: `{name}`");
            let place = inner_path(&name).ok_or_else(outside)?;
            let folders = place.components().count().saturating_sub(1);
            if folders > MOST_FOLDERS {
                return Err(refusal!(
                    "the archive holds a file in {folders} folders, one within the other, more than {MOST_FOLDERS}"
                ));
            }
            if entry.is_dir() || place.starts_with(ATTRIBUTES) {
                continue;
            }
            if entry.encrypted() {
                let error = refusal!("`{name}` is encrypted");
                return Err(error.with_hint("unpack it with its password, and read the folder"));
            }
            check_size(&name, entry.size(), MOST_BYTES_OF_FILE)?;
            total = total.saturating_add(entry.size());
            if files.insert(path.join(place), index).is_some() {
                return Err(refusal!("the archive holds several files `{name}`"));
            }
        }
        check_size(&file_name(path), total, MOST_BYTES)?;
        Ok(Archive { path: path.to_owned(), files, zip: Mutex::new(zip) })
    }

    /// Whether `path` is that of the archive, or it holds files below.
    pub fn is_folder(&self, path: &Path) -> bool {
        path == self.path || self.files.keys().any(|file| file != path && file.starts_with(path))
    }

    /// The files and folders in the folder `path`, each once, in the order of their names.
    pub fn entries(&self, path: &Path) -> Vec<PathBuf> {
        let below = self.files.keys().filter_map(|file| file.strip_prefix(path).ok());
        let mut entries: Vec<PathBuf> =
            below.filter_map(|rest| rest.components().next()).map(|first| path.join(first)).collect();
        entries.dedup();
        entries
    }

    /// The bytes of the file at `path`, with its checksum compared.
    pub fn bytes(&self, path: &Path) -> io::Result<Vec<u8>> {
        let index = *self.files.get(path).ok_or(io::ErrorKind::NotFound)?;
        let mut zip = self.zip.lock().unwrap_or_else(PoisonError::into_inner);
        let file = zip.by_index(index)?;
        // A directory may state fewer bytes than there are.
        let limit = file.size();
        let mut bytes = Vec::new();
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > limit {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "it is longer than the archive states"));
        }
        Ok(bytes)
    }
}

/// The refusal of an archive that is none, or damaged.
fn damaged(error: ZipError) -> Error {
    let packed_otherwise = matches!(error, ZipError::CompressionMethodNotSupported(_));
    let error = Error::from(error);
    match packed_otherwise {
        true => error.with_hint("unpack it and read the folder, or pack it by deflation"),
        false => error,
    }
}

/// The path that a name stands for, however its parts are separated; none where it leads out of the archive.
fn inner_path(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(name.replace('\\', "/"));
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let has_drive = name.as_bytes().get(1) == Some(&b':');
    (is_inside && !has_drive).then(|| path.components().filter(|part| *part != Component::CurDir).collect())
}

fn check_size(name: &str, bytes: u64, limit: u64) -> Result<(), Error> {
    if bytes <= limit {
        return Ok(());
    }
    Err(refusal!("`{name}` would unpack to {bytes} bytes, more than {limit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_inside() {
        for (name, expected) in [
            ("T/Channel/T.001", Some("T/Channel/T.001")),
            ("T\\Channel\\T.001", Some("T/Channel/T.001")),
            ("./T.mme", Some("T.mme")),
            ("/etc/passwd", None),
            ("../T.mme", None),
            ("T/../../T.mme", None),
            ("..\\T.mme", None),
            ("C:\\T.mme", None),
            ("C:T.mme", None),
        ] {
            assert_eq!(inner_path(name), expected.map(PathBuf::from), "{name}");
        }
    }
}
