//! Files that a script writes beside its figures and tables: curves, recordings, materials.

use std::collections::BTreeMap;

use thiserror::Error;

/// Extensions that a file may have, all of text files.
const ENDINGS: [&str; 7] = ["csv", "json", "md", "obj", "svg", "toml", "txt"];

/// Most files of one script.
const MOST_FILES: usize = 10_000;

/// Most bytes of all files together.
pub(crate) const MOST_BYTES: usize = 256 << 20;

/// Longest name of a file, bytes.
const LONGEST_NAME: usize = 200;

/// A file that a script writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its path in the folder of the results, separated by `/`.
    pub name: String,
    /// Its text.
    pub content: String,
}

/// Why a file is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FileError {
    /// The name is not one of a file.
    #[error("`{name}` cannot name a file: folders and names of letters, digits, `-`, `_` and `.`, ending in .{}", ENDINGS.join(", ."))]
    Name {
        /// The name, cut to the longest that is allowed.
        name: String,
    },
    /// The name is one of the files of a run folder.
    #[error("`{name}` is a file of droptower's own results")]
    Reserved {
        /// Path of the file, as the script gives it.
        name: String,
    },
    /// The name of one file is the folder of another.
    #[error("`{name}` would be a file and a folder at once, because of `{other}`")]
    Folder {
        /// Path of the file, as the script gives it.
        name: String,
        /// Path of the file that was written before it.
        other: String,
    },
    /// Too many files, or too large ones.
    #[error("a script leaves at most {MOST_FILES} files of {} MB together", MOST_BYTES >> 20)]
    TooMuch,
}

/// The files of one script; their names differ on every file system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    files: Vec<File>,
    /// Index of the file by its name in lower case.
    places: BTreeMap<String, usize>,
    /// Bytes of all files together.
    bytes: usize,
}

impl Files {
    /// The files in the order in which they were first written.
    pub fn iter(&self) -> impl Iterator<Item = &File> {
        self.files.iter()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Their paths in the folder of the results.
    pub fn names(&self) -> Vec<String> {
        self.files.iter().map(|file| file.name.clone()).collect()
    }

    /// Adds the file, or replaces the one of this name; `reserved` names, and files in folders of such a name, are
    /// refused.
    pub(super) fn put(&mut self, file: File, reserved: &[&str]) -> Result<(), FileError> {
        check_name(&file.name, reserved)?;
        let lower = file.name.to_ascii_lowercase();
        if let Some(place) = self.clash(&lower) {
            return Err(FileError::Folder { name: file.name, other: self.files[place].name.clone() });
        }
        let same = self.places.get(&lower).copied();
        let others = self.bytes - same.map_or(0, |place| self.files[place].content.len());
        let bytes = others + file.content.len();
        if bytes > MOST_BYTES || (same.is_none() && self.files.len() >= MOST_FILES) {
            return Err(FileError::TooMuch);
        }
        self.bytes = bytes;
        match same {
            Some(place) => self.files[place] = file,
            None => {
                self.places.insert(lower, self.files.len());
                self.files.push(file);
            }
        }
        Ok(())
    }

    /// Index of a file that is a folder of the path `lower`, or lies below it.
    fn clash(&self, lower: &str) -> Option<usize> {
        let above = lower.match_indices('/').find_map(|(end, _)| self.places.get(&lower[..end]));
        let within = format!("{lower}/");
        let first = self.places.range(within.clone()..).next();
        let below = first.filter(|(name, _)| name.starts_with(&within)).map(|(_, place)| place);
        above.or(below).copied()
    }
}

fn check_name(name: &str, reserved: &[&str]) -> Result<(), FileError> {
    let letter = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let plain = |part: &str| !part.is_empty() && !part.starts_with('.') && part.chars().all(letter);
    let ending = name.rsplit_once('.').map(|(_, ending)| ending);
    if name.len() > LONGEST_NAME || !name.split('/').all(plain) || !ending.is_some_and(|end| ENDINGS.contains(&end)) {
        return Err(FileError::Name { name: name.chars().take(LONGEST_NAME).collect() });
    }
    let first = name.split('/').next().unwrap_or(name);
    if reserved.iter().any(|reserved| reserved.eq_ignore_ascii_case(first)) {
        return Err(FileError::Reserved { name: name.into() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(files: &mut Files, name: &str) -> Result<(), FileError> {
        files.put(File { name: name.into(), content: "x".into() }, &["summary.json", "tables"])
    }

    #[test]
    fn names_outside_the_folder_and_names_of_results_are_refused() {
        for name in ["../x.csv", "/x.csv", "a/../x.csv", "a//x.csv", ".x.csv", "x", "x.exe", "a b.csv", "C:\\x.csv", ""]
        {
            assert!(matches!(put(&mut Files::default(), name), Err(FileError::Name { .. })), "{name}");
        }
        for name in ["summary.json", "Summary.json", "tables/x.csv"] {
            assert!(matches!(put(&mut Files::default(), name), Err(FileError::Reserved { .. })), "{name}");
        }
    }

    #[test]
    fn a_name_is_not_a_file_and_a_folder_at_once() {
        let mut files = Files::default();
        for name in ["a.csv", "A.csv", "b/c.csv", "b/d.csv"] {
            put(&mut files, name).unwrap();
        }
        assert_eq!(files.iter().count(), 3);
        assert!(matches!(put(&mut files, "a.csv/x.csv"), Err(FileError::Folder { .. })));
        put(&mut files, "e.txt/f.csv").unwrap();
        assert!(matches!(put(&mut files, "e.txt"), Err(FileError::Folder { .. })));
    }

    #[test]
    fn a_replaced_file_does_not_count_towards_the_limit() {
        let half = "x".repeat(MOST_BYTES / 2 + 1);
        let mut files = Files::default();
        let mut put = |name: &str| files.put(File { name: name.into(), content: half.clone() }, &[]);
        put("a.csv").unwrap();
        put("A.csv").unwrap();
        assert_eq!(put("b.csv"), Err(FileError::TooMuch));
    }
}
