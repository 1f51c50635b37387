//! The files on which results rest, and whether one of them was saved.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, SystemTime};

/// Time between two looks at the files. They are looked at, in place of waiting for the system to tell, because network
/// drives tell nothing.
pub(super) const TICK: Duration = Duration::from_millis(150);

/// The mark by which a saved file is noticed: time and length; `None` where there is no file.
type State = Option<(SystemTime, u64)>;

/// Files as they were when they were read.
#[derive(Debug)]
pub(super) struct Inputs(BTreeMap<PathBuf, State>);

impl Inputs {
    /// The scenario alone.
    pub(super) fn new(scenario: &Path) -> Inputs {
        Inputs(BTreeMap::from([(scenario.to_owned(), state(scenario))]))
    }

    /// Takes the files as they are now.
    pub(super) fn look(&mut self) {
        for (path, known) in &mut self.0 {
            *known = state(path);
        }
    }

    /// Adds files; those that are known stay as they were.
    pub(super) fn extend(&mut self, paths: Vec<PathBuf>) {
        for path in paths {
            let now = state(&path);
            self.0.entry(path).or_insert(now);
        }
    }

    /// Whether a file was saved, removed or made since.
    pub(super) fn have_changed(&self) -> bool {
        self.0.iter().any(|(path, known)| state(path) != *known)
    }

    /// Waits until a file has changed, and then until it stays as it is: an editor may write in several parts.
    pub(super) fn wait(&mut self) {
        while !self.have_changed() {
            thread::sleep(TICK);
        }
        loop {
            self.look();
            thread::sleep(TICK / 2);
            if !self.have_changed() {
                return;
            }
        }
    }
}

fn state(path: &Path) -> State {
    let about = fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_removed_and_new_files_are_seen() {
        let folder = tempfile::tempdir().unwrap();
        let [one, other] = ["one", "other"].map(|name| folder.path().join(name));
        fs::write(&one, "1").unwrap();
        let mut inputs = Inputs::new(&one);
        inputs.extend(vec![other.clone(), one.clone()]);
        assert!(!inputs.have_changed());
        fs::write(&other, "").unwrap();
        assert!(inputs.have_changed());
        inputs.look();
        fs::write(&one, "12").unwrap();
        assert!(inputs.have_changed());
        inputs.look();
        fs::remove_file(&one).unwrap();
        assert!(inputs.have_changed());
        inputs.wait();
        assert!(!inputs.have_changed());
    }
}
