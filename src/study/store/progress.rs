//! The folder of a study that is not complete: its page, and the result of one that was stopped.
//!
//! It stands beside the results, which are complete or not at all. What it holds belongs to droptower and is replaced.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::StoreError;
use super::evaluations::Share;
use base::diagnostic::folder_of;
use base::file;

/// The folder of all studies beside their results.
const ALL: &str = ".progress";

/// The page of a study while it runs; afterwards it leads to the report.
const PAGE: &str = "progress.html";

/// Beginning and end of the name of the page of one of several processes.
const PART: [&str; 2] = ["progress-", ".html"];

/// The result of a study that was stopped.
pub const STOPPED: &str = "stopped.json";

/// The runs that are done of a sweep that was stopped.
pub const STOPPED_TABLE: &str = "table.csv";

/// The folder `.progress/<results>` beside the results, of one process: a page that is open there leads to the report.
#[derive(Clone, Debug)]
pub struct ProgressFolder {
    results: PathBuf,
    folder: PathBuf,
    page: PathBuf,
    /// The folder above, where there was none before.
    made: Option<PathBuf>,
}

impl ProgressFolder {
    /// The folder of a process with this share of the study whose results go to `results`.
    pub fn new(results: &Path, share: Share) -> ProgressFolder {
        let folder = folder_of(results).join(ALL).join(results.file_name().unwrap_or_default());
        let [first, last] = PART;
        let name = match share {
            Share::WHOLE => PAGE.to_owned(),
            Share { number, of } => format!("{first}{number}-of-{of}{last}"),
        };
        let made = folder_of(results).to_owned();
        let made = (!made.exists()).then_some(made);
        ProgressFolder { results: results.into(), page: folder.join(name), folder, made }
    }

    /// Path of the page.
    pub fn page(&self) -> &Path {
        &self.page
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Writes the page in one piece.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_page(&self, html: &str) -> io::Result<()> {
        self.make()?;
        file::replace(&self.page, html.as_bytes()).inspect_err(|_| {
            // Of a full disk no empty folder is left.
            let _ = fs::remove_dir(&self.folder);
        })
    }

    /// Makes the folder; neither it nor the one above is a link.
    fn make(&self) -> io::Result<()> {
        file::own_folder(folder_of(&self.folder))?;
        file::own_folder(&self.folder)
    }

    /// Writes a file of the result of a study that was stopped.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, name: &str, content: &[u8]) -> Result<(), StoreError> {
        let path = self.folder.join(name);
        let written = self.make().and_then(|()| file::replace(&path, content));
        written.map_err(|source| StoreError::write(path, source))
    }

    /// Removes the result of an earlier stop.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn forget_stop(&self) -> io::Result<()> {
        [STOPPED, STOPPED_TABLE].iter().try_for_each(|name| file::remove(&self.folder.join(name)))
    }

    /// Replaces the page by one that leads to the results, which are stored now, where there is a page; pages of parts
    /// and the result of an earlier stop are removed. `leads` makes the page of the address of the report.
    ///
    /// # Errors
    /// Something cannot be written or removed.
    pub fn end(&self, leads: impl FnOnce(&str) -> String) -> io::Result<()> {
        self.forget_stop()?;
        let Some(names) = self.names()? else { return Ok(()) };
        for name in names.iter().filter(|name| is_part(name)) {
            file::remove(&self.folder.join(name))?;
        }
        let name = self.results.file_name().unwrap_or_default();
        self.write_page(&leads(&format!("../../{}/{}", address(name), super::run_files::REPORT)))
    }

    /// Removes the page, and the folders above where nothing else is in them.
    ///
    /// # Errors
    /// The page cannot be removed.
    pub fn discard(&self) -> io::Result<()> {
        file::remove(&self.page)?;
        // What else is in them stays.
        let _ = fs::remove_dir(&self.folder);
        for above in [folder_of(&self.folder)].into_iter().chain(self.made.as_deref()) {
            let _ = fs::remove_dir(above);
        }
        Ok(())
    }

    /// Names of the files in the folder; none where there is no folder.
    fn names(&self) -> io::Result<Option<Vec<String>>> {
        match file::entries(&self.folder) {
            Ok(entries) => {
                Ok(Some(entries.iter().filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect()))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }
}

fn is_part(name: &str) -> bool {
    let [first, last] = PART;
    let part = name.strip_prefix(first).and_then(|rest| rest.strip_suffix(last));
    let share = part.and_then(|part| part.split_once("-of-"));
    share.is_some_and(|(number, of)| number.parse::<usize>().is_ok() && of.parse::<usize>().is_ok())
}

/// A name as a part of a relative address.
fn address(name: &OsStr) -> String {
    let letter = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => char::from(byte).to_string(),
        other => format!("%{other:02X}"),
    };
    name.as_encoded_bytes().iter().copied().map(letter).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::names;
    use super::*;

    #[test]
    fn the_page_of_an_ended_study_leads_to_its_results_and_nothing_else_is_left() {
        let root = tempfile::tempdir().unwrap();
        let results = root.path().join("a b%");
        let whole = ProgressFolder::new(&results, Share::WHOLE);
        whole.write_page("runs").unwrap();
        ProgressFolder::new(&results, Share { number: 2, of: 3 }).write_page("a part").unwrap();
        whole.write(STOPPED, b"{}").unwrap();
        fs::write(whole.path().join("progress-of-mine.html"), "a user's").unwrap();
        assert_eq!(fs::read_to_string(whole.page()).unwrap(), "runs");
        whole.end(|address| format!("to {address}")).unwrap();
        assert_eq!(names(whole.path()), ["progress-of-mine.html", "progress.html"]);
        assert_eq!(fs::read_to_string(whole.page()).unwrap(), "to ../../a%20b%25/report.html");
    }

    #[test]
    fn without_a_page_there_is_no_folder() {
        let root = tempfile::tempdir().unwrap();
        let folder = ProgressFolder::new(&root.path().join("a"), Share::WHOLE);
        folder.end(|_| "to".into()).unwrap();
        assert_eq!(names(root.path()), Vec::<String>::new());
        folder.write_page("runs").unwrap();
        folder.discard().unwrap();
        assert_eq!(names(root.path()), Vec::<String>::new());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_place_of_the_folder_is_not_followed() {
        let root = tempfile::tempdir().unwrap();
        let elsewhere = tempfile::tempdir().unwrap();
        let folder = ProgressFolder::new(&root.path().join("a"), Share::WHOLE);
        fs::create_dir(root.path().join(ALL)).unwrap();
        std::os::unix::fs::symlink(elsewhere.path(), folder.path()).unwrap();
        assert!(folder.write_page("runs").is_err());
        assert_eq!(names(elsewhere.path()), Vec::<String>::new());
    }
}
