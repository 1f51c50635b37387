//! A zip archive that holds a container as a folder does. Nothing of it is written to the disk.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use thiserror::Error;
use zip::ZipArchive;
use zip::result::ZipError;

use base::file::{self, FileError};

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

/// Why an archive is not read.
#[derive(Debug, Error)]
pub enum ArchiveFault {
    /// It cannot be opened.
    #[error("cannot be read: {0}")]
    Open(FileError),
    /// It is no archive, or damaged.
    #[error("not a readable zip archive: {0}")]
    Zip(Box<ZipError>),
    /// It holds more files than any test.
    #[error("the archive holds {count} files, more than the {MOST_FILES} of the largest test")]
    TooManyFiles {
        /// Number of its files.
        count: usize,
    },
    /// The archive itself is larger than that of any test.
    #[error("the archive has {bytes} bytes, more than {MOST_BYTES_PACKED}")]
    TooManyBytes {
        /// Its bytes, packed.
        bytes: u64,
    },
    /// A file, or all of them, have more bytes than are unpacked.
    #[error("`{name}` would unpack to {bytes} bytes, more than {limit}")]
    TooLarge {
        /// Name of the file, or of the archive.
        name: String,
        /// As the archive states them.
        bytes: u64,
        /// Most that are unpacked.
        limit: u64,
    },
    /// A name begins at the root, or leads out of the archive.
    #[error("the archive holds a file outside of itself: `{name}`")]
    Outside {
        /// The name.
        name: String,
    },
    /// A file lies in more folders than those of any test.
    #[error("the archive holds a file in {folders} folders, one within the other, more than {MOST_FOLDERS}")]
    TooDeep {
        /// Number of folders.
        folders: usize,
    },
    /// A file is encrypted.
    #[error("`{name}` is encrypted")]
    Encrypted {
        /// Name of the file.
        name: String,
    },
    /// Two files have one name.
    #[error("the archive holds several files `{name}`")]
    Twice {
        /// The name.
        name: String,
    },
}

impl ArchiveFault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            ArchiveFault::Encrypted { .. } => Some("unpack it with its password, and read the folder"),
            ArchiveFault::Zip(error) if matches!(**error, ZipError::CompressionMethodNotSupported(_)) => {
                Some("unpack it and read the folder, or pack it by deflation")
            }
            _ => None,
        }
    }
}

/// An archive whose names and sizes were checked.
#[derive(Debug)]
pub(super) struct Archive {
    /// Place of each file in the archive.
    files: BTreeMap<PathBuf, usize>,
    zip: Mutex<ZipArchive<File>>,
}

impl Archive {
    /// Reads the directory of the archive at `path`.
    pub fn open(path: &Path) -> Result<Archive, ArchiveFault> {
        let damaged = |error| ArchiveFault::Zip(Box::new(error));
        let packed = file::open(path).map_err(ArchiveFault::Open)?;
        let bytes = packed.metadata().map_err(|error| ArchiveFault::Open(error.into()))?.len();
        if bytes > MOST_BYTES_PACKED {
            return Err(ArchiveFault::TooManyBytes { bytes });
        }
        let zip = ZipArchive::new(packed).map_err(damaged)?;
        if zip.len() > MOST_FILES {
            return Err(ArchiveFault::TooManyFiles { count: zip.len() });
        }
        let (mut files, mut total) = (BTreeMap::new(), 0_u64);
        let directory = zip.metadata();
        for index in 0..directory.len() {
            let entry = directory.entry(index).map_err(damaged)?;
            let name = entry.name().map_err(damaged)?.into_owned();
            let place = inner_path(&name).ok_or_else(|| ArchiveFault::Outside { name: name.clone() })?;
            let folders = place.components().count().saturating_sub(1);
            if folders > MOST_FOLDERS {
                return Err(ArchiveFault::TooDeep { folders });
            }
            if entry.is_dir() || place.starts_with(ATTRIBUTES) {
                continue;
            }
            if entry.encrypted() {
                return Err(ArchiveFault::Encrypted { name });
            }
            check_size(&name, entry.size(), MOST_BYTES_OF_FILE)?;
            total = total.saturating_add(entry.size());
            if files.insert(place, index).is_some() {
                return Err(ArchiveFault::Twice { name });
            }
        }
        check_size(&path.file_name().unwrap_or_default().to_string_lossy(), total, MOST_BYTES)?;
        Ok(Archive { files, zip: Mutex::new(zip) })
    }

    /// Whether it holds files below `path`.
    pub fn is_folder(&self, path: &Path) -> bool {
        self.files.keys().any(|file| file != path && file.starts_with(path))
    }

    /// Whether `path` is one of its files.
    pub fn is_file(&self, path: &Path) -> bool {
        self.files.contains_key(path)
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

/// The path that a name stands for, however its parts are separated; none where it leads out of the archive.
fn inner_path(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(name.replace('\\', "/"));
    let is_inside = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let has_drive = name.as_bytes().get(1) == Some(&b':');
    (is_inside && !has_drive).then(|| path.components().filter(|part| *part != Component::CurDir).collect())
}

fn check_size(name: &str, bytes: u64, limit: u64) -> Result<(), ArchiveFault> {
    if bytes > limit { Err(ArchiveFault::TooLarge { name: name.into(), bytes, limit }) } else { Ok(()) }
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
