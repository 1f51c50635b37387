//! Files that commands write to a path of the user's: completely or not at all, and never over a file that droptower
//! did not write.

use std::fs::{self, Metadata};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::Failure;
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::file;
use base::scratch;

/// Text before the checksum in the last line of a file that may be replaced while it is unchanged.
const SEAL: &str = "# Replaced by the next reduction only while it is unchanged: ";

/// What every page of droptower has in its foot.
const PAGE_MARK: &str = "<footer>droptower ";

/// Longest page that is checked for its mark, bytes.
const LONGEST_PAGE: u64 = 1 << 30;

/// Longest file that is checked for a seal, bytes.
const LONGEST_SEALED: u64 = 16 << 20;

/// Refuses an output that does not end in `.{ending}`, is not a regular file, or is the `input`.
///
/// An existing file is refused unless it is empty, sealed and unchanged, or `force` is given; `force` is `None` where
/// the command has no such option.
pub(super) fn check(out: &Path, ending: &str, input: Option<&Path>, force: Option<bool>) -> Result<(), Failure> {
    let shown = shown_path(out);
    let refused = |message, hint: &str| Err(Failure::from(Diagnostic::new(message).hint(hint)));
    if !ends_in(out, ending) {
        return refused(format!("{shown} does not end in .{ending}"), "the ending names the format");
    }
    let Some((place, there)) = existing(out).map_err(|error| unwritable(out, &error))? else {
        return Ok(());
    };
    if !there.is_file() {
        return refused(format!("{shown} is not a file that can be replaced"), "give another name");
    }
    if input.and_then(|input| fs::canonicalize(input).ok()).is_some_and(|input| input == place) {
        return refused(format!("{shown} is the input"), "write to another file");
    }
    if there.len() == 0 || force == Some(true) {
        return Ok(());
    }
    // One that is too long or cannot be read has no seal.
    let text = file::read_text(&place, LONGEST_SEALED).unwrap_or_default();
    if has_seal(&text) {
        return Ok(());
    }
    let (why, hint) = match force {
        Some(_) => ("already exists", ", remove it first, or give --force"),
        None if text.contains(SEAL) => ("was edited since droptower wrote it", ", or remove it first"),
        None => ("already exists and was not written by droptower", ", or remove it first"),
    };
    refused(format!("{shown} {why} and is not replaced"), &format!("give another name{hint}"))
}

/// Refuses a page as [`check`] does, and one that exists and is no page of droptower: these hold nothing that is not computed
/// again.
pub(super) fn check_page(out: &Path, input: Option<&Path>) -> Result<(), Failure> {
    check(out, "html", input, Some(true))?;
    let Some((place, there)) = existing(out).map_err(|error| unwritable(out, &error))? else {
        return Ok(());
    };
    let is_ours = || file::read_text(&place, LONGEST_PAGE).is_ok_and(|text| text.contains(PAGE_MARK));
    if there.len() == 0 || is_ours() {
        return Ok(());
    }
    let message = format!("{} already exists, is no page of droptower and is not replaced", shown_path(out));
    Err(Diagnostic::new(message).hint("give another name, or remove it first").into())
}

/// Whether the name ends in `.{ending}`, however it is capitalised.
pub(super) fn ends_in(out: &Path, ending: &str) -> bool {
    out.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// Writes a temporary file that replaces `out`, or what the link `out` points to, when it is complete.
pub(super) fn write(out: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let written = || Draft::write(out, content)?.persist();
    written().map_err(|error| failed(out, &error))
}

/// Writes sealed texts, which show whether they were changed since; they are renamed to their paths once all are
/// written.
pub(super) fn write_sealed(texts: &[(PathBuf, String)]) -> Result<(), Failure> {
    let mut drafts = Vec::new();
    for (out, text) in texts {
        let draft = Draft::write(out, |file| file.write_all(sealed(text).as_bytes()));
        drafts.push((out, draft.map_err(|error| failed(out, &error))?));
    }
    drafts.into_iter().try_for_each(|(out, draft)| draft.persist().map_err(|error| failed(out, &error)))
}

/// An output that could not be written.
pub(super) fn failed(out: &Path, error: &impl std::fmt::Display) -> Failure {
    Failure::output(unwritable(out, error))
}

fn unwritable(out: &Path, error: &impl std::fmt::Display) -> Diagnostic {
    Diagnostic::new(format!("cannot write {}: {error}", shown_path(out)))
}

/// The canonical path and the metadata of what is at `out`; `None` where there is nothing.
fn existing(out: &Path) -> io::Result<Option<(PathBuf, Metadata)>> {
    match fs::symlink_metadata(out) {
        Ok(_) => {
            let place = fs::canonicalize(out)?;
            let found = fs::metadata(&place)?;
            Ok(Some((place, found)))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// A temporary file beside the path that it will replace.
struct Draft {
    file: NamedTempFile,
    place: PathBuf,
}

impl Draft {
    fn write(out: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<Draft> {
        let place = existing(out)?.map_or_else(|| out.to_owned(), |(place, _)| place);
        let folder = folder_of(&place);
        fs::create_dir_all(folder)?;
        let mut file = scratch::file(folder)?;
        let mut text = BufWriter::new(&mut file);
        content(&mut text)?;
        text.flush()?;
        drop(text);
        Ok(Draft { file, place })
    }

    fn persist(self) -> io::Result<()> {
        // A device or a pipe created there meanwhile is not unlinked.
        if existing(&self.place)?.is_some_and(|(_, found)| !found.is_file()) {
            return Err(io::Error::other("it is not a file that can be replaced"));
        }
        self.file.persist(&self.place)?;
        Ok(())
    }
}

/// The text with its seal, a last line with its checksum.
fn sealed(text: &str) -> String {
    format!("{text}{SEAL}{:08x}\n", file::checksum(text.as_bytes()))
}

/// Whether the text has a seal and is unchanged.
fn has_seal(content: &str) -> bool {
    content.rfind(SEAL).is_some_and(|place| sealed(&content[..place]) == content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure::ExitStatus;

    #[test]
    fn a_page_of_somebody_else_is_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let page = folder.path().join("film.html");
        assert!(check_page(&page, None).is_ok());
        for (text, is_ours) in [("", true), ("<h1>my notes</h1>", false), ("<p><footer>droptower 0.1.0</footer>", true)]
        {
            fs::write(&page, text).expect("a file");
            assert_eq!(check_page(&page, None).is_ok(), is_ours, "{text}");
        }
    }

    fn refusal(out: &Path, input: Option<&Path>, force: Option<bool>) -> String {
        let refused = check(out, "csv", input, force).expect_err("a refusal");
        assert_eq!(refused.status, ExitStatus::BadInput);
        refused.diagnostics[0].message.clone()
    }

    #[test]
    fn a_changed_text_has_no_valid_seal() {
        let text = sealed("density = 915\n");
        assert!(has_seal(&text));
        for changed in
            [text.replace("915", "920"), text.replace("density", "# mine\ndensity"), format!("{text}\n"), String::new()]
        {
            assert!(!has_seal(&changed), "{changed}");
        }
    }

    #[test]
    fn a_file_that_is_not_sealed_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let out = place("o.csv");
        assert!(check(&out, "csv", None, None).is_ok());
        assert!(refusal(&place("notes.toml"), None, Some(true)).contains("does not end in .csv"));
        fs::write(&out, "").unwrap();
        assert!(check(&out, "csv", None, None).is_ok(), "nothing is lost");
        fs::write(&out, "mine\n").unwrap();
        for force in [None, Some(false)] {
            assert!(refusal(&out, None, force).contains("already exists"));
        }
        assert!(check(&out, "csv", None, Some(true)).is_ok());
        assert!(refusal(&out, Some(&folder.path().join(".").join("o.csv")), Some(true)).contains("is the input"));
        write_sealed(&[(out.clone(), "a\n".into())]).unwrap();
        assert!(check(&out, "csv", None, None).is_ok());
        fs::write(&out, format!("mine\n{}", fs::read_to_string(&out).unwrap())).unwrap();
        assert!(refusal(&out, None, None).contains("was edited since droptower wrote it"));
        fs::create_dir(place("d.csv")).unwrap();
        assert!(refusal(&place("d.csv"), None, Some(true)).contains("is not a file"));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_refused() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let [link, aim, null] = ["o.csv", "aim.csv", "null.csv"].map(|name| folder.path().join(name));
        fs::write(&aim, "old").unwrap();
        symlink(&aim, &link).unwrap();
        assert!(refusal(&link, None, Some(false)).contains("already exists"));
        assert!(refusal(&link, Some(&aim), Some(true)).contains("is the input"));
        write(&link, |file| file.write_all(b"new")).unwrap();
        assert_eq!(fs::read_to_string(&aim).unwrap(), "new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        symlink("/dev/null", &null).unwrap();
        assert!(refusal(&null, None, Some(true)).contains("is not a file"));
        fs::remove_file(&aim).unwrap();
        assert!(refusal(&link, None, Some(true)).contains("cannot write"));
    }
}
