//! The recordings in a folder.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::format::{FORMATS, Support};

/// What a folder holds, without hidden files; both in the order of the names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FolderContents {
    /// Files with the ending of a format that is read, and tests of ISO-MME.
    pub recordings: Vec<PathBuf>,
    /// Other files and folders.
    pub others: Vec<PathBuf>,
}

/// The recordings in `folder`, by their endings: what is in its folders is not looked at, unless such a folder, or
/// `folder` itself, is a test of ISO-MME.
///
/// # Errors
/// The folder cannot be listed.
pub fn contents(folder: &Path) -> io::Result<FolderContents> {
    if is_test(folder) {
        return Ok(FolderContents { recordings: vec![folder.to_owned()], others: vec![] });
    }
    let is_hidden = |path: &PathBuf| path.file_name().is_none_or(|name| name.as_encoded_bytes().starts_with(b"."));
    let entries = fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path()));
    let mut entries: Vec<PathBuf> = entries.collect::<io::Result<_>>()?;
    entries.retain(|path| !is_hidden(path));
    entries.sort();
    let is_recording = |path: &PathBuf| if path.is_dir() { is_test(path) } else { has_known_ending(path) };
    let (recordings, others) = entries.into_iter().partition(is_recording);
    Ok(FolderContents { recordings, others })
}

/// Whether a folder is one test of ISO-MME: it has one `.mme` file.
fn is_test(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_own = |path: &PathBuf| ending(path).is_some_and(|ending| ending == "mme");
    entries.map(|entry| entry.path()).filter(is_own).count() == 1
}

/// Whether the name of a file ends as those of a format that is read. Channels of ISO-MME are no recordings of their own.
fn has_known_ending(path: &Path) -> bool {
    let endings = FORMATS.iter().filter(|format| matches!(format.support, Support::Read(_)));
    let mut endings = endings.flat_map(|format| format.endings.split(", ")).filter_map(|ending| {
        let ending = ending.split(' ').next()?.strip_prefix('.')?;
        Some(ending).filter(|ending| *ending != "chn" && ending.parse::<u32>().is_err())
    });
    ending(path).is_some_and(|own| endings.any(|known| known == own))
}

fn ending(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_are_known_by_their_endings_and_tests_by_their_head() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        for name in ["b.TDMS", "a.csv", "notes.md", ".hidden.csv", "channel.001", "test.chn", "c.mat", "noending"] {
            fs::write(place(name), "x").expect("a file");
        }
        for name in ["test", "other"] {
            fs::create_dir(place(name)).expect("a folder");
        }
        fs::write(place("test/7.mme"), "x").expect("a file");
        let FolderContents { recordings, others } = contents(folder.path()).expect("its contents");
        let expected = ["a.csv", "b.TDMS", "c.mat", "test"].map(place);
        assert_eq!((recordings, others.len()), (expected.to_vec(), 5));
        let own = contents(&place("test")).expect("its contents");
        assert_eq!(own.recordings, [place("test")]);
        assert!(contents(&place("nowhere")).is_err());
    }
}
