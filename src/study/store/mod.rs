//! The run folder: written under a temporary name beside its target and renamed when complete.

mod origin;
mod stored_run;
pub mod checkpoints;
pub mod evaluations;
mod progress;
pub mod run_files;

use std::collections::HashSet;
use std::ffi::OsString;
use std::fmt::Display;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use serde_json::Value;
use thiserror::Error;

use base::diagnostic::folder_of;
use base::file;
use base::scratch::ScratchFolder;

pub use checkpoints::CheckpointStore;
pub use evaluations::EvaluationStore;
pub use origin::{Origin, path_from};
pub use progress::{ProgressFolder, STOPPED, STOPPED_TABLE};
pub use stored_run::{StoredRun, StoredRunError};

/// Why results cannot be stored; nothing that was there before is lost.
#[derive(Debug, Error)]
#[error("{message}")]
pub struct StoreError {
    message: String,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A folder is not replaced for what it holds.
    Kept,
    /// A file or folder cannot be written.
    Write,
    Other,
}

impl StoreError {
    fn other(message: String) -> StoreError {
        StoreError { message, kind: Kind::Other }
    }

    /// What is at `path` is not replaced, because it is or holds something.
    fn kept(path: &Path, what: impl Display) -> StoreError {
        StoreError { message: format!("{} {what}", path.display()), kind: Kind::Kept }
    }

    /// The file at `path` could not be written.
    pub fn write(path: impl AsRef<Path>, source: io::Error) -> StoreError {
        StoreError { message: format!("cannot write {}: {source}", path.as_ref().display()), kind: Kind::Write }
    }

    /// The error of listing `path`.
    fn list(path: &Path, source: &io::Error) -> StoreError {
        match source.kind() {
            io::ErrorKind::NotADirectory => StoreError::kept(path, "is not a folder"),
            _ => StoreError { message: format!("cannot read {}: {source}", path.display()), kind: Kind::Kept },
        }
    }

    /// The path ends without a name, as `.` and `..` do.
    fn no_name(path: &Path) -> StoreError {
        let (path, example) = (path.display(), path.join("results"));
        let example = example.display();
        StoreError::other(format!("`{path}` does not name a run folder; give --out a new folder, such as {example}"))
    }

    /// A link has the name of the run folder, or of one that it lies in and that nobody named.
    fn link(path: &Path) -> StoreError {
        StoreError::kept(path, "is a link, which is not followed; remove it, or give --out the folder that it leads to")
    }
}

/// Folder of results where no other is given.
const RUNS: &str = "runs";

/// Folder of evaluations that are never computed twice, where no other is given.
pub const EVALUATIONS: &str = "runs/.evaluations";

/// Path of the run called `name` where no output folder is given.
///
/// # Errors
/// [`place`]'s, or the folder of all runs is a link.
pub fn default_place(name: &str) -> Result<PathBuf, StoreError> {
    let root = Path::new(RUNS);
    refuse_link(root)?;
    place(root, name)
}

fn refuse_link(path: &Path) -> Result<(), StoreError> {
    file::refuse_link(path).map_err(|_| StoreError::link(path))
}

/// Path below `root` of the run called `name` (`/` between its parts).
///
/// # Errors
/// The name leaves `root`, or a folder between is a link.
pub fn place(root: &Path, name: &str) -> Result<PathBuf, StoreError> {
    let parts = Path::new(name);
    let plain = |part: Component| matches!(part, Component::Normal(_));
    if name.is_empty() || name.contains('\\') || !parts.components().all(plain) {
        let expected = "expected plain folder names below the output folder";
        return Err(StoreError::other(format!("`{name}` cannot name a run folder: {expected}")));
    }
    let place = root.join(parts);
    place.ancestors().skip(1).take_while(|folder| *folder != root).try_for_each(refuse_link)?;
    Ok(place)
}

/// Checks that each of `places` is free or a run folder of droptower, and none is given twice.
pub fn check_places(places: &[PathBuf]) -> Result<(), StoreError> {
    let mut seen = HashSet::new();
    for path in places {
        check_moved(path, path)?;
        if !seen.insert(path) {
            return Err(StoreError::other(format!("two runs would be stored in {}", path.display())));
        }
    }
    Ok(())
}

/// Whether `folder` holds the results of a run, complete or failed.
pub fn is_run(folder: &Path) -> bool {
    [run_files::SUMMARY, run_files::FAILURE].iter().any(|name| folder.join(name).is_file())
}

/// Results to be stored in the folder `target`; a draft that is dropped unpublished leaves nothing.
#[derive(Debug)]
pub struct Draft {
    folder: ScratchFolder,
    target: PathBuf,
    origin: Origin,
    force: bool,
}

impl Draft {
    /// An empty draft beside `target` of results made from `origin`; by `force` it replaces those of any other.
    pub fn begin(target: &Path, origin: Origin, force: bool) -> Result<Draft, StoreError> {
        if target.file_name().is_none() {
            return Err(StoreError::no_name(target));
        }
        Ok(Draft { folder: sibling(target)?, target: target.into(), origin, force })
    }

    /// The temporary folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Writes one file of the draft; `name` may contain folders.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), StoreError> {
        let path = place(self.path(), name)?;
        let folder = path.parent().unwrap_or(self.path());
        fs::create_dir_all(folder).map_err(|error| StoreError::write(folder, error))?;
        fs::write(&path, content).map_err(|error| StoreError::write(&path, error))
    }

    /// Renames the draft to its target and removes what it replaces.
    ///
    /// # Errors
    /// The target meanwhile holds files of the user or results of another scenario or script: the results are stored under the
    /// next free name, `<target>-2` and so on.
    pub fn publish(mut self) -> Result<PathBuf, StoreError> {
        let target = self.target.clone();
        match self.publish_at(&target, self.force, fs::rename) {
            Ok(()) => {
                self.discard_failed();
                Ok(target)
            }
            Err(reason) if reason.kind == Kind::Kept => {
                let names = (2..).map(|number| sibling_name(&target, &format!("-{number}")));
                let place = self.publish_first(names)?;
                Err(StoreError::other(format!("{reason}; the results are in {}", place.display())))
            }
            Err(error) => Err(error),
        }
    }

    /// Renames the draft of a failed run to `<target>.failed`, or `<target>.failed-2` and so on where a file or folder
    /// of the user, or a failed run of another scenario, has that name.
    ///
    /// A complete run at `target` stays.
    pub fn publish_failed(mut self) -> Result<PathBuf, StoreError> {
        let target = self.target.clone();
        self.publish_first(failed(&target))
    }

    /// Renames the draft to the first of `places` that is free or holds results of its own origin.
    fn publish_first(&mut self, places: impl Iterator<Item = PathBuf>) -> Result<PathBuf, StoreError> {
        for place in places {
            match self.publish_at(&place, false, fs::rename) {
                Err(error) if error.kind == Kind::Kept => {}
                published => return published.map(|()| place),
            }
        }
        Err(StoreError::no_name(&self.target))
    }

    /// Checks that the draft may replace what is in `folder` and was moved there from `place`.
    fn check(&self, folder: &Path, place: &Path, force: bool) -> Result<(), StoreError> {
        check_moved(folder, place)?;
        if force { Ok(()) } else { self.origin.check_moved(folder, place) }
    }

    /// Moves the draft to `target`, and what was there away before, by `rename`.
    ///
    /// What was there is checked again once it is moved away, when no other process replaces it.
    fn publish_at(
        &mut self,
        target: &Path,
        force: bool,
        rename: impl Fn(PathBuf, PathBuf) -> io::Result<()>,
    ) -> Result<(), StoreError> {
        let write = |error| StoreError::write(target, error);
        loop {
            self.check(target, target, force)?;
            let former = sibling(target)?;
            let former_run = former.former(target).map_err(write)?;
            // A rename is the only step that cannot be half done, and of two processes it lets one come first.
            let replaced = match rename(target.into(), former_run.clone()) {
                Ok(()) => true,
                Err(error) if error.kind() == io::ErrorKind::NotFound => false,
                Err(error) => return Err(write(error)),
            };
            let moved = if replaced { self.check(&former_run, target, force) } else { Ok(()) };
            let moved = moved.and_then(|()| rename(self.path().into(), target.into()).map_err(write));
            let Err(error) = moved else {
                // The temporary folder was renamed: there is nothing left to remove.
                self.folder.renamed();
                return Ok(());
            };
            // Another process may have stored its results there since; both are checked by the next turn.
            let taken = error.kind == Kind::Write && target.exists();
            if taken {
                continue;
            }
            if replaced && let Err(source) = rename(former_run.clone(), target.into()) {
                // Dropping the temporary folder would delete the former run.
                let inner = former_run.strip_prefix(former.path()).map(Path::to_owned).unwrap_or_default();
                let former = former.keep().join(inner);
                let reason = StoreError::write(target, source);
                return Err(StoreError::other(format!("{reason}; the run that was there is in {}", former.display())));
            }
            return Err(error);
        }
    }

    /// Removes the folder of an earlier failure of the same origin, which a complete run makes obsolete.
    fn discard_failed(&self) {
        if let Some(place) = failed(&self.target).find(|place| self.check(place, place, false).is_ok())
            && place.is_dir()
        {
            let _ = fs::remove_dir_all(place);
        }
    }
}

/// The names of a failed run beside `target`, in the order in which they are tried.
fn failed(target: &Path) -> impl Iterator<Item = PathBuf> {
    let first = std::iter::once(sibling_name(target, ".failed"));
    first.chain((2..).map(|number: usize| sibling_name(target, &format!(".failed-{number}"))))
}

/// `target` with `suffix` appended to its name.
fn sibling_name(target: &Path, suffix: &str) -> PathBuf {
    let mut name = target.file_name().map_or_else(OsString::new, OsString::from);
    name.push(suffix);
    target.with_file_name(name)
}

fn sibling(target: &Path) -> Result<ScratchFolder, StoreError> {
    let parent = folder_of(target);
    let error = |source| StoreError::write(parent, source);
    fs::create_dir_all(parent).map_err(error)?;
    ScratchFolder::new(parent).map_err(error)
}

/// Checks that what is in `folder`, and was moved there from `target`, is nothing or a run folder of droptower.
fn check_moved(folder: &Path, target: &Path) -> Result<(), StoreError> {
    // A folder is renamed by its name, which `.`, `..` and `/` do not have.
    if target.file_name().is_none() {
        return Err(StoreError::no_name(target));
    }
    match fs::symlink_metadata(folder) {
        Err(_) => return Ok(()),
        Ok(found) if found.is_symlink() => return Err(StoreError::link(target)),
        Ok(_) => {}
    }
    let entries = fs::read_dir(folder).map_err(|source| StoreError::list(target, &source))?;
    let names: Vec<String> = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    if !names.is_empty() && !names.iter().any(|name| run_files::MARKERS.contains(&name.as_str())) {
        let why = "is not a run folder of droptower and is not replaced; give another --out";
        return Err(StoreError::kept(target, why));
    }
    let listed = listed(folder);
    let is_ours = |name: &String| run_files::is_written_by_run(name) || listed.contains(name);
    match files(folder).into_iter().find(|name| !is_ours(name)) {
        Some(found) => {
            let why = format!("holds `{found}`, which droptower did not write; move it or give another --out");
            Err(StoreError::kept(target, why))
        }
        None => Ok(()),
    }
}

/// The tables and files of a script in `folder`, as its summary lists them.
fn listed(folder: &Path) -> HashSet<String> {
    let text = file::read(&folder.join(run_files::SUMMARY), run_files::MOST_BYTES).unwrap_or_default();
    let summary: Value = serde_json::from_slice(&text).unwrap_or_default();
    let tables = summary["tables"]
        .as_object()
        .into_iter()
        .flatten()
        .map(|(name, _)| format!("{}/{name}.csv", run_files::TABLES));
    let files = summary["files"].as_array().into_iter().flatten().filter_map(|name| Some(name.as_str()?.to_owned()));
    tables.chain(files).collect()
}

/// Every file and every empty folder below `folder`, by its path in it with `/` between the parts.
fn files(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let inner = if entry.file_type().is_ok_and(|kind| kind.is_dir()) { files(&entry.path()) } else { Vec::new() };
        if inner.is_empty() {
            found.push(name);
        } else {
            found.extend(inner.into_iter().map(|inner| format!("{name}/{inner}")));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names in a folder, in alphabetical order.
    pub fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().flatten();
        let mut names: Vec<String> = entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// A draft of results that do not state what they were made from.
    fn begun(target: &Path) -> Draft {
        Draft::begin(target, Origin::of_comparison(&[]), false).unwrap()
    }

    fn stored(target: &Path, text: &str) -> Result<PathBuf, StoreError> {
        let draft = begun(target);
        draft.write("summary.json", text)?;
        draft.publish()
    }

    /// A draft of a run of `scenario` beside the folder `target`.
    fn run_of(scenario: &str, target: &Path) -> Draft {
        let origin = Origin::of_run(&target.with_file_name(scenario));
        let line = origin.line(target);
        let draft = Draft::begin(target, origin, false).unwrap();
        draft.write("summary.json", "{}").unwrap();
        draft.write("scenario.toml", line).unwrap();
        draft
    }

    #[test]
    fn a_published_run_replaces_the_one_before() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("drop/1008");
        stored(&target, "1").unwrap();
        stored(&target, "2").unwrap();
        assert_eq!(fs::read_to_string(target.join("summary.json")).unwrap(), "2");
        assert_eq!(names(&root.path().join("drop")), ["1008"]);
    }

    #[test]
    fn a_folder_that_may_not_be_read_is_a_folder() {
        for (kind, expected) in [
            (io::ErrorKind::PermissionDenied, "cannot read runs/a: permission denied"),
            (io::ErrorKind::NotADirectory, "runs/a is not a folder"),
        ] {
            assert_eq!(StoreError::list(Path::new("runs/a"), &kind.into()).to_string(), expected);
        }
    }

    #[test]
    fn an_abandoned_draft_leaves_nothing() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("1008");
        stored(&target, "1").unwrap();
        let draft = begun(&target);
        draft.write("summary.json", "half").unwrap();
        drop(draft);
        assert_eq!(fs::read_to_string(target.join("summary.json")).unwrap(), "1");
        assert_eq!(names(root.path()), ["1008"]);
    }

    #[test]
    fn a_failed_run_is_stored_beside_and_removed_by_a_complete_one() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("1008");
        let draft = begun(&target);
        draft.write("failure.txt", "at 3 ms").unwrap();
        assert_eq!(draft.publish_failed().unwrap(), root.path().join("1008.failed"));
        assert_eq!(names(root.path()), ["1008.failed"]);
        stored(&target, "1").unwrap();
        assert_eq!(names(root.path()), ["1008"]);
    }

    #[test]
    fn a_failed_run_replaces_nothing_of_the_user() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("1008");
        fs::write(root.path().join("1008.failed"), "mine").unwrap();
        for text in ["at 3 ms", "at 4 ms"] {
            let draft = begun(&target);
            draft.write("failure.txt", text).unwrap();
            let place = draft.publish_failed().unwrap();
            assert_eq!(place, root.path().join("1008.failed-2"));
            assert_eq!(fs::read_to_string(place.join("failure.txt")).unwrap(), text);
        }
        stored(&target, "1").unwrap();
        assert_eq!(names(root.path()), ["1008", "1008.failed"]);
    }

    #[test]
    fn a_failed_run_of_another_scenario_stays() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("out");
        let draft = |scenario: &str| run_of(scenario, &target);
        let fail = |scenario: &str| {
            let draft = draft(scenario);
            draft.write("failure.txt", "at 3 ms").unwrap();
            draft.publish_failed().unwrap()
        };
        assert_eq!(fail("a.toml"), root.path().join("out.failed"));
        assert_eq!(fail("b.toml"), root.path().join("out.failed-2"));
        draft("b.toml").publish().unwrap();
        assert_eq!(names(root.path()), ["out", "out.failed"]);
        Draft { force: true, ..draft("a.toml") }.publish().unwrap();
        assert_eq!(names(root.path()), ["out"]);
    }

    #[test]
    fn of_two_runs_with_one_folder_the_later_is_stored_beside() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("out");
        let [first, second, again] = ["a.toml", "b.toml", "a.toml"].map(|scenario| run_of(scenario, &target));
        let text = |place: &Path| fs::read_to_string(place.join("scenario.toml")).unwrap();
        assert_eq!(first.publish().unwrap(), target);
        let (told, place) = (second.publish().unwrap_err().to_string(), root.path().join("out-2"));
        assert!(told.contains("holds the run of") && told.ends_with(&format!("in {}", place.display())), "{told}");
        assert_eq!(text(&place), "# scenario: ../b.toml\n");
        assert_eq!(text(&target), "# scenario: ../a.toml\n");
        again.publish().unwrap();
        let forced = Draft { force: true, ..run_of("b.toml", &target) };
        forced.publish().unwrap();
        assert_eq!(text(&target), "# scenario: ../b.toml\n");
        assert_eq!(names(root.path()), ["out", "out-2"]);
    }

    #[test]
    fn what_another_process_stores_between_two_renames_stays() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("out");
        let text = |place: &Path| fs::read_to_string(place.join("scenario.toml")).unwrap();
        let mut draft = run_of("a.toml", &target);
        let found_free = std::cell::Cell::new(true);
        let refused = draft.publish_at(&target, false, |from, to| {
            // Another run is stored as soon as the folder was found free.
            if found_free.replace(false) {
                run_of("b.toml", &target).publish().unwrap();
            }
            fs::rename(from, to)
        });
        let refused = refused.unwrap_err();
        assert!(refused.kind == Kind::Kept && refused.to_string().contains("holds the run of"), "{refused}");
        assert_eq!(text(&target), "# scenario: ../b.toml\n");
        drop(draft);
        assert_eq!(names(root.path()), ["out"]);
    }

    #[test]
    fn a_former_run_survives_renames_that_fail() {
        for (renames_that_work, stays) in [(1, false), (0, true)] {
            let root = tempfile::tempdir().unwrap();
            let target = root.path().join("1008");
            stored(&target, "1").unwrap();
            let mut draft = begun(&target);
            draft.write("summary.json", "2").unwrap();
            let done = std::cell::Cell::new(0);
            let error = draft.publish_at(&target, false, |from, to| {
                done.set(done.get() + 1);
                if done.get() > renames_that_work { Err(io::Error::other("no")) } else { fs::rename(from, to) }
            });
            let told = error.unwrap_err().to_string();
            let former = told.split_once("; the run that was there is in ").map(|(_, former)| PathBuf::from(former));
            assert_eq!(former.is_none(), stays, "{told}");
            let place = former.unwrap_or(target);
            assert_eq!(fs::read_to_string(place.join("summary.json")).unwrap(), "1");
        }
    }

    #[test]
    fn files_of_the_user_are_not_replaced() {
        let root = tempfile::tempdir().unwrap();
        let theirs = root.path().join("theirs");
        fs::create_dir(&theirs).unwrap();
        stored(&theirs, "an empty folder may be taken").unwrap();
        fs::write(theirs.join("notes.txt"), "mine").unwrap();
        let refusal = |target: &Path| {
            let told = stored(target, "1").unwrap_err().to_string();
            let (reason, place) = told.split_once("; the results are in ").unwrap();
            assert_eq!(fs::read_to_string(Path::new(place).join("summary.json")).unwrap(), "1");
            reason.to_owned()
        };
        assert!(refusal(&theirs).contains("holds `notes.txt`, which droptower did not write"));
        fs::remove_file(theirs.join("summary.json")).unwrap();
        assert!(refusal(&theirs).contains("is not a run folder of droptower"));
        let file = theirs.join("notes.txt");
        assert!(refusal(&file).ends_with("notes.txt is not a folder"));
        assert_eq!(fs::read_to_string(file).unwrap(), "mine");
    }

    #[test]
    fn files_that_the_summary_lists_are_replaced_and_others_are_not() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("virtual");
        let summary = r#"{"tables":{"drops":[]},"files":["1008.csv","coupons/md.csv"]}"#;
        for _ in 0..2 {
            let draft = begun(&target);
            for name in ["1008.csv", "coupons/md.csv", "tables/drops.csv"] {
                draft.write(name, "x").unwrap();
            }
            draft.write("summary.json", summary).unwrap();
            draft.publish().unwrap();
        }
        for theirs in ["notes.md", "coupons/mine.csv", "tables/mine.csv"] {
            fs::write(target.join(theirs), "mine").unwrap();
            let refused = check_places(std::slice::from_ref(&target)).unwrap_err().to_string();
            assert!(refused.contains(&format!("holds `{theirs}`")), "{refused}");
            fs::remove_file(target.join(theirs)).unwrap();
        }
    }

    #[test]
    fn a_target_has_a_name() {
        for nameless in [".", "..", "/", "runs/.."] {
            let refused = check_places(&[nameless.into()]).unwrap_err().to_string();
            assert!(refused.contains("does not name a run folder"), "{nameless}: {refused}");
        }
    }

    #[test]
    fn names_stay_below_the_root() {
        let root = Path::new("runs");
        assert_eq!(place(root, "drop/1008").unwrap(), Path::new("runs/drop/1008"));
        for name in ["", "..", "../x", "a/../../x", "/etc", "a\\..\\b"] {
            assert!(place(root, name).unwrap_err().to_string().contains("cannot name a run folder"), "{name}");
        }
    }

    #[test]
    fn two_runs_do_not_share_a_target() {
        let places = [PathBuf::from("no/such"), PathBuf::from("no/such")];
        assert_eq!(check_places(&places).unwrap_err().to_string(), "two runs would be stored in no/such");
    }
}
