//! The folder of the checkpoints of an unfinished run.
//!
//! Each is a file that ends in a checksum, written under a temporary name and renamed when complete. The one before
//! stays as well, so that there is a checkpoint to resume from whenever the machine stops.

use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};

use super::{StoreError, sibling_name};
use base::file::{self, Crc32};

/// Appended to the name of the run folder.
const SUFFIX: &str = ".checkpoint";

/// Extension of checkpoints.
const EXTENSION: &str = "state";

/// Name of a checkpoint that is being written.
const UNFINISHED: &str = "unfinished";

/// How many of the newest are stored.
const STORED: usize = 2;

/// Buffers of files, bytes.
const BUFFER: usize = 1 << 20;

/// The checkpoints of the run whose results go to one place.
#[derive(Clone, Debug)]
pub struct CheckpointStore {
    folder: PathBuf,
}

/// The newest complete checkpoint.
#[derive(Clone, Debug)]
pub struct NewestCheckpoint {
    /// Its file.
    pub path: PathBuf,
    /// Newer checkpoints that are damaged.
    pub damaged: Vec<PathBuf>,
}

impl CheckpointStore {
    /// The store beside the run folder `target`.
    pub fn beside(target: &Path) -> CheckpointStore {
        CheckpointStore { folder: sibling_name(target, SUFFIX) }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Its checkpoints, complete or damaged, the newest first.
    pub fn checkpoints(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let numbered = entries.filter_map(|entry| {
            let path = entry.path();
            let ours = path.extension().is_some_and(|extension| extension == EXTENSION);
            let number = path.file_stem()?.to_str()?.parse::<u64>().ok()?;
            ours.then_some((number, path))
        });
        let mut numbered: Vec<(u64, PathBuf)> = numbered.collect();
        numbered.sort_by(|a, b| b.cmp(a));
        numbered.into_iter().map(|(_, path)| path).collect()
    }

    /// The newest checkpoint whose checksum is right, if there is one.
    pub fn newest(&self) -> Option<NewestCheckpoint> {
        let mut damaged = Vec::new();
        for path in self.checkpoints() {
            match is_whole(&path) {
                Ok(true) => return Some(NewestCheckpoint { path, damaged }),
                _ => damaged.push(path),
            }
        }
        None
    }

    /// Creates the folder: one that cannot be written is reported before the run.
    pub fn create_folder(&self) -> Result<(), StoreError> {
        file::own_folder(&self.folder).map_err(|error| StoreError::write(&self.folder, error))
    }

    /// Writes the checkpoint `number`, larger than all before, with `content`; then removes all but the newest.
    pub fn put(&self, number: u64, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), StoreError> {
        let path = self.folder.join(format!("{number:012}.{EXTENSION}"));
        self.write(&path, content).map_err(|error| StoreError::write(&path, error))?;
        for old in self.checkpoints().into_iter().skip(STORED) {
            // A file that cannot be removed takes space only.
            let _ = fs::remove_file(old);
        }
        Ok(())
    }

    fn write(&self, path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        // Under another name until it is whole: a process that is killed here leaves the checkpoints before it.
        let unfinished = self.folder.join(UNFINISHED);
        let file = Summed { inner: file::create_own(&unfinished)?, sum: Crc32::new() };
        let mut buffered = BufWriter::with_capacity(BUFFER, file);
        content(&mut buffered)?;
        let Summed { inner: mut file, sum } = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.write_all(&sum.finalize().to_le_bytes())?;
        // Before the rename, or the name could reach the disk without the content.
        file.sync_all()?;
        fs::rename(&unfinished, path)?;
        // The name has to reach the disk as well; systems that cannot open a folder write it themselves.
        if let Ok(folder) = File::open(&self.folder) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    /// Removes all checkpoints; other files in the folder stay.
    pub fn clear(&self) {
        for path in self.checkpoints() {
            let _ = fs::remove_file(path);
        }
        let _ = fs::remove_file(self.folder.join(UNFINISHED));
        let _ = fs::remove_dir(&self.folder);
    }
}

/// Opens a checkpoint to read its content.
pub fn open(path: &Path) -> io::Result<impl Read> {
    let file = File::open(path)?;
    let length = content_length(&file)?;
    Ok(BufReader::with_capacity(BUFFER, file).take(length))
}

fn content_length(file: &File) -> io::Result<u64> {
    let length = file.metadata()?.len().checked_sub(4);
    length.ok_or_else(|| io::Error::new(io::ErrorKind::UnexpectedEof, "too short for a checkpoint"))
}

/// Whether the checksum at the end of the file is that of its content.
fn is_whole(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let length = content_length(&file)?;
    let mut sum = Crc32::new();
    let mut buffer = vec![0; BUFFER];
    let mut left = length;
    while left > 0 {
        let part = &mut buffer[..left.min(BUFFER as u64) as usize];
        file.read_exact(part)?;
        sum.update(part);
        left -= part.len() as u64;
    }
    let mut expected = [0; 4];
    file.seek(io::SeekFrom::Start(length))?;
    file.read_exact(&mut expected)?;
    Ok(sum.finalize().to_le_bytes() == expected)
}

/// A writer that computes the checksum of what is written.
struct Summed<W> {
    inner: W,
    sum: Crc32,
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.sum.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn empty() -> (tempfile::TempDir, CheckpointStore) {
        let root = tempfile::tempdir().unwrap();
        let store = CheckpointStore::beside(&root.path().join("drop"));
        store.create_folder().unwrap();
        (root, store)
    }

    fn content(path: &Path) -> Vec<u8> {
        let mut content = Vec::new();
        open(path).unwrap().read_to_end(&mut content).unwrap();
        content
    }

    #[test]
    fn the_two_newest_are_stored() {
        let (root, store) = empty();
        for number in [7_u64, 12, 130] {
            store.put(number, |out| out.write_all(&number.to_le_bytes())).unwrap();
        }
        let found = store.newest().unwrap();
        assert_eq!(content(&found.path), 130_u64.to_le_bytes());
        assert_eq!(store.checkpoints().len(), 2);
        assert!(found.damaged.is_empty());
        store.clear();
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }

    #[test]
    fn the_one_before_a_damaged_one_is_found() {
        for damage in [0, 3, 4, 12, 99] {
            let (_root, store) = empty();
            store.put(1, |out| out.write_all(b"the first")).unwrap();
            store.put(2, |out| out.write_all(&[b'x'; 200])).unwrap();
            let newest = store.newest().unwrap().path;
            let whole = fs::read(&newest).unwrap();
            let mut turned = whole.clone();
            turned[damage] ^= 1;
            for damaged in [turned, whole[..damage].to_vec()] {
                fs::write(&newest, damaged).unwrap();
                let found = store.newest().unwrap();
                assert_eq!(content(&found.path), b"the first");
                assert_eq!(found.damaged, std::slice::from_ref(&newest));
            }
            fs::write(store.path().join("000000000001.state"), "").unwrap();
            assert!(store.newest().is_none());
        }
    }

    #[test]
    fn a_failed_write_leaves_the_one_before() {
        let (_root, store) = empty();
        store.put(1, |out| out.write_all(b"the first")).unwrap();
        let full = |out: &mut dyn Write| {
            out.write_all(&[b'x'; 300])?;
            Err(io::Error::other("no space left"))
        };
        assert!(store.put(2, full).unwrap_err().to_string().starts_with("cannot write "));
        assert_eq!(content(&store.newest().unwrap().path), b"the first");
    }

    #[test]
    fn files_of_the_user_stay() {
        let (_root, store) = empty();
        fs::write(store.path().join("notes.txt"), "mine").unwrap();
        store.put(1, |out| out.write_all(b"the first")).unwrap();
        store.clear();
        assert_eq!(fs::read_to_string(store.path().join("notes.txt")).unwrap(), "mine");
        assert!(store.checkpoints().is_empty());
    }
}
