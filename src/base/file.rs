//! Files as a whole: one bounded read of a regular file, and the checksums of what files hold.

use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use thiserror::Error;

use crate::diagnostic::{Diagnostic, folder_of, shown_path};
use crate::scratch;

pub use crc32fast::Hasher as Crc32;

/// Why a file is not read.
#[derive(Debug, Error)]
pub enum FileError {
    /// The path names nothing.
    #[error("there is no such file")]
    NotFound,
    /// The path names a folder, a device or a pipe.
    #[error("it is not a file")]
    NotAFile,
    /// The file holds more bytes than the caller reads.
    #[error("it is larger than {limit} bytes")]
    TooLarge {
        /// Most bytes that are read.
        limit: u64,
    },
    /// The bytes are not UTF-8.
    #[error("it is not UTF-8 text")]
    NotText,
    /// The text is encoded in UTF-16, as some editors for Windows save it.
    #[error("it is UTF-16 text")]
    Utf16,
    /// The operating system refused.
    #[error("{0}")]
    Io(io::Error),
}

impl FileError {
    /// A remedy, where one follows from the error.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            FileError::NotText | FileError::Utf16 => Some("save it as UTF-8, with or without a byte order mark"),
            _ => None,
        }
    }
}

impl From<io::Error> for FileError {
    fn from(error: io::Error) -> FileError {
        match error.kind() {
            io::ErrorKind::NotFound => FileError::NotFound,
            _ => FileError::Io(error),
        }
    }
}

/// Opens the regular file at `path`.
pub fn open(path: &Path) -> Result<File, FileError> {
    // Checked first: opening a device may act on it.
    if !fs::metadata(path)?.is_file() {
        return Err(FileError::NotAFile);
    }
    let mut options = OpenOptions::new();
    options.read(true);
    // A pipe that has taken the place of the file since would wait for its writer, and some regular files of the system
    // (`/proc/kmsg`) for what the kernel may say next.
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    let file = options.open(path)?;
    if file.metadata()?.is_file() { Ok(file) } else { Err(FileError::NotAFile) }
}

/// The bytes of the regular file at `path`, at most `limit`.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    // One byte more than allowed: a file may grow while it is read.
    open(path)?.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit { Err(FileError::TooLarge { limit }) } else { Ok(bytes) }
}

/// The text of the regular file at `path`, at most `limit` bytes of UTF-8, without its byte order mark.
pub fn read_text(path: &Path, limit: u64) -> Result<String, FileError> {
    let mut bytes = read(path, limit)?;
    if is_utf16(&bytes) {
        return Err(FileError::Utf16);
    }
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    String::from_utf8(bytes).map_err(|_| FileError::NotText)
}

/// Whether the bytes are text in UTF-16: by its byte order mark, or because one byte of nearly every pair is zero.
fn is_utf16(bytes: &[u8]) -> bool {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return true;
    }
    let start = &bytes[..bytes.len().min(512)];
    let zeros = |offset: usize| start.iter().skip(offset).step_by(2).filter(|byte| **byte == 0).count();
    let (even, odd) = (zeros(0), zeros(1));
    start.len() >= 4 && 10 * even.max(odd) > 4 * start.len() && 10 * even.min(odd) < start.len()
}

/// Refuses a link at `path`, a name that the program made up: whoever packed the project could have it lead anywhere.
///
/// # Errors
/// There is a link.
pub fn refuse_link(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => Err(io::Error::other("it is a link, which is not followed; remove it")),
        _ => Ok(()),
    }
}

/// Creates the folder at `path`, a name that the program made up, where there is none.
///
/// # Errors
/// There is a link, or the folder cannot be created.
pub fn own_folder(path: &Path) -> io::Result<()> {
    refuse_link(path)?;
    fs::create_dir_all(path)
}

/// Creates the file at `path`, a name that the program made up, in place of what has it; a link there is removed, not
/// followed.
///
/// # Errors
/// What is there cannot be removed, or the file cannot be created.
pub fn create_own(path: &Path) -> io::Result<File> {
    remove(path)?;
    // Exclusively: a link that is made meanwhile is not followed either.
    File::create_new(path)
}

/// Writes `bytes` to `path` in one piece: a reader finds what was there before or all of them.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut draft = scratch::file(folder_of(path))?;
    draft.write_all(bytes)?;
    draft.persist(path).map(drop).map_err(|error| error.error)
}

/// Removes a file, which may be gone already: another process may remove it, too.
///
/// # Errors
/// It is there and cannot be removed.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// CRC-32 (ISO 3309) of `bytes`.
pub fn checksum(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}

/// The identity of a file's content: its length and its checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Digest {
    length: u64,
    checksum: u32,
}

impl Digest {
    /// Of `bytes`.
    pub fn from_bytes(bytes: &[u8]) -> Digest {
        Digest { length: bytes.len() as u64, checksum: checksum(bytes) }
    }

    /// Of the regular file at `path`, of which one buffer is held in memory.
    pub fn of_file(path: &Path) -> Result<Digest, FileError> {
        let (mut sum, mut length) = (Crc32::new(), 0);
        for_each_block(path, |block| {
            sum.update(block);
            length += block.len() as u64;
        })?;
        Ok(Digest { length, checksum: sum.finalize() })
    }
}

/// Hands the bytes of the regular file at `path` to `take`, one buffer after the other: recordings are not held as a whole.
fn for_each_block(path: &Path, mut take: impl FnMut(&[u8])) -> Result<(), FileError> {
    let mut file = open(path)?;
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(()),
            count => take(&buffer[..count]),
        }
    }
}

/// What is in a folder, in the order of the names.
///
/// # Errors
/// The folder cannot be listed.
pub fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    entries.sort();
    Ok(entries)
}

/// SHA-256 of regular files, one behind the other, in hexadecimal digits.
///
/// # Errors
/// One of them cannot be read, which the mistake names.
pub fn sha256(files: impl IntoIterator<Item: AsRef<Path>>) -> Result<String, Diagnostic> {
    let mut digest = Sha256::new();
    for path in files {
        let path = path.as_ref();
        for_each_block(path, |block| digest.update(block))
            .map_err(|error| Diagnostic::new(format!("{}: {error}", shown_path(path))))?;
    }
    Ok(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes, checksum {:08x}", self.length, self.checksum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "1234").unwrap();
        assert_eq!(read_text(&path, 4).unwrap(), "1234");
        assert!(matches!(read_text(&path, 3), Err(FileError::TooLarge { limit: 3 })));
        fs::write(&path, b"\xff").unwrap();
        assert!(matches!(read_text(&path, 4), Err(FileError::NotText)));
        assert!(matches!(read(folder.path(), 4), Err(FileError::NotAFile)));
        assert!(matches!(read(&folder.path().join("b.txt"), 4), Err(FileError::NotFound)));
    }

    #[test]
    fn utf_16_is_named_and_a_byte_order_mark_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let text = "title = \"Größe\"\n";
        let units = || text.encode_utf16();
        let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        for bytes in [[&b"\xff\xfe"[..], &little].concat(), [&b"\xfe\xff"[..], &big].concat(), little, big] {
            fs::write(&path, bytes).unwrap();
            let error = read_text(&path, 100).unwrap_err();
            assert!(matches!(error, FileError::Utf16) && error.hint().is_some_and(|hint| hint.contains("UTF-8")));
        }
        fs::write(&path, format!("\u{feff}{text}")).unwrap();
        assert_eq!(read_text(&path, 100).unwrap(), text);
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_not_read() {
        assert!(matches!(read(Path::new("/dev/zero"), 4), Err(FileError::NotAFile)));
    }

    #[test]
    fn the_digest_of_a_file_is_that_of_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        let bytes: Vec<u8> = (0..100_000_u32).map(|i| i.to_le_bytes()[0]).collect();
        fs::write(&path, &bytes).unwrap();
        assert_eq!(Digest::of_file(&path).unwrap(), Digest::from_bytes(&bytes));
        assert_eq!(Digest::from_bytes(b"123456789").to_string(), "9 bytes, checksum cbf43926");
    }
}
