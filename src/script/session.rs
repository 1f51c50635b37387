//! What the host remembers while one script runs: the files that it read, and the trial that a host function is called in.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rhai::{Dynamic, Engine, NativeCallContext};

use super::Compared;
use crate::file::{Digest, FileError};
use crate::simulate::Cancellation;

/// Most comparisons of one trial that are kept for pictures.
const MOST_COMPARED: usize = 12;

/// What host functions share while a script runs; every engine has one, as its tag. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Session {
    inputs: Arc<Mutex<BTreeMap<PathBuf, String>>>,
    recordings: Arc<Mutex<BTreeMap<PathBuf, bool>>>,
    trial: Option<Arc<Mutex<Trial>>>,
    cancellation: Cancellation,
}

/// What host functions tell about one evaluation of an objective.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trial {
    /// Scenarios whose film broke, and when.
    pub ruptures: Vec<String>,
    /// Simulations that went wrong numerically, and why.
    pub failures: Vec<String>,
    /// What was held against references, for pictures.
    pub compared: Vec<Compared>,
}

impl Session {
    /// The session of the script that calls a host function.
    pub fn of(context: &NativeCallContext) -> Session {
        context.tag().and_then(Session::in_tag).unwrap_or_default()
    }

    /// The session of the scripts that `engine` runs.
    pub fn of_engine(engine: &Engine) -> Session {
        Session::in_tag(engine.default_tag()).unwrap_or_default()
    }

    fn in_tag(tag: &Dynamic) -> Option<Session> {
        tag.read_lock::<Session>().map(|session| session.clone())
    }

    /// The same session within an evaluation of an objective, which may be cancelled.
    pub fn with_trial(&self, cancellation: &Cancellation) -> Session {
        Session { trial: Some(Arc::default()), cancellation: cancellation.clone(), ..self.clone() }
    }

    /// What ends the simulations of an evaluation that nobody waits for any more.
    pub fn cancellation(&self) -> &Cancellation {
        &self.cancellation
    }

    /// Whether an objective is being evaluated.
    pub fn is_trial(&self) -> bool {
        self.trial.is_some()
    }

    /// What was told about the evaluation so far.
    pub fn trial(&self) -> Trial {
        self.trial.as_ref().map(|trial| lock(trial).clone()).unwrap_or_default()
    }

    /// The film of `scenario` broke at `time` (s).
    pub fn ruptured(&self, scenario: &str, time: f64) {
        self.tell(|trial| trial.ruptures.push(format!("{scenario}: the film broke at {:.1} ms", 1e3 * time)));
    }

    /// A simulation went wrong numerically.
    pub fn failed(&self, cause: &str) {
        self.tell(|trial| trial.failures.push(cause.into()));
    }

    /// Something was held against a reference.
    pub(super) fn compares(&self, compared: impl FnOnce() -> Compared) {
        self.tell(|trial| {
            if trial.compared.len() < MOST_COMPARED {
                trial.compared.push(compared());
            }
        });
    }

    fn tell(&self, tell: impl FnOnce(&mut Trial)) {
        if let Some(trial) = &self.trial {
            tell(&mut lock(trial));
        }
    }

    /// Remembers that the script read the file at `path`, and what it held when it was read first.
    pub fn reads(&self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.into());
        lock(&self.inputs).entry(path).or_insert_with_key(|path| content(path));
    }

    /// Remembers the files of a recording: an ISO-MME test keeps its channels in a folder beside it.
    pub fn reads_recording(&self, path: &Path) {
        self.reads(path);
        for entry in fs::read_dir(path.with_file_name("Channel")).into_iter().flatten().flatten() {
            self.reads(&entry.path());
        }
    }

    /// Remembers whether the recording at `path` says that it is virtual.
    pub fn hears(&self, path: &Path, is_virtual: bool) {
        lock(&self.recordings).insert(path.into(), is_virtual);
    }

    /// Recordings that were read so far and say that they are virtual.
    pub fn virtual_recordings(&self) -> Vec<PathBuf> {
        let recordings = lock(&self.recordings);
        recordings.iter().filter(|(_, is_virtual)| **is_virtual).map(|(path, _)| path.clone()).collect()
    }

    /// Whether nothing that was read so far was measured: there are recordings, and all are virtual.
    pub fn is_all_virtual(&self) -> bool {
        let recordings = lock(&self.recordings);
        !recordings.is_empty() && recordings.values().all(|is_virtual| *is_virtual)
    }

    /// The files that were read so far, and what they held.
    pub fn inputs(&self) -> BTreeMap<PathBuf, String> {
        lock(&self.inputs).clone()
    }
}

impl From<Session> for Dynamic {
    fn from(session: Session) -> Dynamic {
        Dynamic::from(session)
    }
}

/// Length and checksum of the file at `path`, or that it cannot be read.
pub fn content(path: &Path) -> String {
    match Digest::of_file(path) {
        Ok(digest) => digest.to_string(),
        Err(FileError::NotAFile) => "not a file".into(),
        Err(error) => format!("unreadable: {error}"),
    }
}

fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::{Limits, engine};

    #[test]
    fn a_file_is_known_by_what_it_held_first() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "1").unwrap();
        let session = Session::default();
        session.reads(&path);
        fs::write(&path, "2").unwrap();
        session.clone().reads(&path);
        let inputs = session.inputs();
        assert_eq!(inputs.len(), 1);
        assert_ne!(inputs[&path], content(&path));
    }

    #[test]
    fn virtual_recordings_are_told_from_measured_ones() {
        let session = Session::default();
        assert!(!session.is_all_virtual());
        session.with_trial(&Cancellation::default()).hears(Path::new("b.csv"), true);
        assert!(session.is_all_virtual());
        session.hears(Path::new("a.csv"), false);
        assert!(!session.is_all_virtual());
        assert_eq!(session.virtual_recordings(), [PathBuf::from("b.csv")]);
    }

    #[test]
    fn host_functions_find_the_session_of_their_engine() {
        let mut engine = engine(Limits::POST);
        engine.register_fn("trial", |context: NativeCallContext| Session::of(&context).is_trial());
        assert!(!engine.eval::<bool>("trial()").unwrap());
        engine.set_default_tag(Session::default().with_trial(&Cancellation::default()));
        assert!(engine.eval::<bool>("[1].map(|x| trial())[0]").unwrap());
    }
}
