//! The trials of a search on disk: a search that was killed resumes without repeating one.
//!
//! One file for each search, `<results>.history/<number>-<checksum>.jsonl`. Its first line holds what determines the
//! values of the trials: version, script, arguments, `--set`, and the files read so far with their checksums. Each
//! other line is one trial, in readable figures and in bits. A search whose first line differs has another file.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use thiserror::Error;

use super::trial_record::Record;
use crate::identify::objective::Evaluation;
use crate::identify::warning::Warning;
use crate::script;
use base::file::{self, Digest, checksum};

/// The identity of a search: all that determines the values of the trials of a script, beside the files that it reads
/// and the number of the search.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Identity {
    /// The text of the script.
    pub script: String,
    /// Arguments and changes of scenarios.
    pub given: Map<String, Value>,
}

/// The history of one search, locked against other processes.
#[derive(Debug)]
pub struct History {
    path: PathBuf,
    file: File,
    trials: Vec<(Vec<f64>, Evaluation)>,
    inputs: BTreeMap<PathBuf, String>,
    /// Warnings of opening the file.
    warnings: Vec<Warning>,
}

/// Why a history cannot be read or written.
#[derive(Debug, Error)]
pub enum HistoryError {
    /// The file cannot be written.
    #[error("cannot write the history {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// Another process holds the lock.
    #[error("another search is writing the history {}: wait for it, or give another --out", path.display())]
    Locked {
        /// The file.
        path: PathBuf,
    },
    /// A line cannot be read.
    #[error("line {line} of the history {} is not a trial; move the file away to start a new search", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Number of the line, from one.
        line: usize,
    },
    /// The first line is of another search.
    #[error("the history {} is of another search; move the file away to start a new search", path.display())]
    Other {
        /// The file.
        path: PathBuf,
    },
}

impl History {
    /// Opens the history of search `number` of a script in `folder`, and reads its trials. `inputs` are the files read
    /// so far, each with a description of its content.
    ///
    /// An incomplete last line is dropped. A history whose files have changed is renamed, and a new one is begun.
    ///
    /// # Errors
    /// The file cannot be written, another process writes it, or it is damaged.
    pub fn open(
        folder: &Path,
        identity: &Identity,
        number: usize,
        inputs: BTreeMap<PathBuf, String>,
    ) -> Result<History, HistoryError> {
        let head = head(identity, number, &inputs);
        let path = folder.join(format!("{number}-{:08x}.jsonl", checksum(head.as_bytes())));
        let failed = |source| HistoryError::Write { path: path.clone(), source };
        file::own_folder(folder).map_err(failed)?;
        let mut history = History::lock(&path, inputs.clone())?;
        let mut text = history.whole_lines().map_err(failed)?;
        if let Some(changed) = changed_input(&text) {
            let renamed = set_aside(&path).map_err(failed)?;
            let warning = Warning::HistorySetAside { input: changed, renamed: renamed.display().to_string() };
            history = History { warnings: vec![warning], ..History::lock(&path, inputs)? };
            text.clear();
        }
        if text.is_empty() {
            history.append(&head)?;
        } else {
            history.read(&text, &head)?;
        }
        if !history.trials.is_empty() {
            let (trials, path) = (history.trials.len(), history.path.display().to_string());
            history.warnings.push(Warning::TrialsRead { trials, path });
        }
        Ok(history)
    }

    /// Opens and locks the file at `path`.
    fn lock(path: &Path, inputs: BTreeMap<PathBuf, String>) -> Result<History, HistoryError> {
        let failed = |source| HistoryError::Write { path: path.into(), source };
        file::refuse_link(path).map_err(failed)?;
        let file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => Ok(History { path: path.into(), file, trials: vec![], inputs, warnings: vec![] }),
            Err(TryLockError::WouldBlock) => Err(HistoryError::Locked { path: path.into() }),
            Err(TryLockError::Error(source)) => Err(failed(source)),
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Warnings of opening the file: of trials that were set aside, and of those that were read.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// The trials in the file when it was opened, each with its point.
    pub fn trials(&self) -> &[(Vec<f64>, Evaluation)] {
        &self.trials
    }

    /// Appends the outcome at `x`, which took `seconds`; a fatal error is not stored.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, x: &[f64], found: &Evaluation, seconds: f64) -> Result<(), HistoryError> {
        // A mistake in the script is corrected before the search is resumed, and its trial repeated.
        Record::of_trial(x, found, seconds).map_or(Ok(()), |record| self.add_record(&record))
    }

    /// Appends the files that are not yet in the history, each with a description of its content.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add_inputs(&mut self, inputs: Vec<(PathBuf, String)>) -> Result<(), HistoryError> {
        for (input, content) in inputs {
            // Each file once: every trial comes with all that were read so far.
            if self.inputs.insert(input.clone(), content.clone()).is_none() {
                self.add_record(&Record::Input { input, content })?;
            }
        }
        Ok(())
    }

    fn add_record(&mut self, record: &Record) -> Result<(), HistoryError> {
        let text = serde_json::to_string(record).map_err(|error| self.failed(error.into()))?;
        self.append(&text)
    }

    /// Appends a line with one write: whenever the process ends, all lines but the last are complete.
    fn append(&mut self, line: &str) -> Result<(), HistoryError> {
        self.file.write_all(format!("{line}\n").as_bytes()).map_err(|error| self.failed(error))
    }

    fn failed(&self, source: io::Error) -> HistoryError {
        HistoryError::Write { path: self.path.clone(), source }
    }

    /// The complete lines of the file; the rest is cut off.
    fn whole_lines(&mut self) -> io::Result<String> {
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(0))?;
        self.file.read_to_end(&mut bytes)?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        if whole < bytes.len() {
            self.file.set_len(whole as u64)?;
            bytes.truncate(whole);
        }
        // Bytes that are not UTF-8 make a damaged line.
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn read(&mut self, text: &str, head: &str) -> Result<(), HistoryError> {
        let mut lines = text.lines();
        if lines.next() != Some(head) {
            return Err(HistoryError::Other { path: self.path.clone() });
        }
        for (index, line) in lines.enumerate() {
            let damaged = || HistoryError::Damaged { path: self.path.clone(), line: index + 2 };
            match serde_json::from_str(line).map_err(|_| damaged())? {
                Record::Input { input, content } => drop(self.inputs.insert(input, content)),
                trial => self.trials.push(trial.trial().ok_or_else(damaged)?),
            }
        }
        Ok(())
    }
}

/// The first line: what determines the values of the trials.
fn head(identity: &Identity, number: usize, inputs: &BTreeMap<PathBuf, String>) -> String {
    let inputs: Map<String, Value> =
        inputs.iter().map(|(path, content)| (path.display().to_string(), json!(content))).collect();
    let script = Digest::from_bytes(identity.script.as_bytes()).to_string();
    let head = json!({
        "droptower": env!("CARGO_PKG_VERSION"),
        "search": number,
        "script": script,
        "given": identity.given,
        "inputs": inputs,
    });
    head.to_string()
}

/// A file in the history whose content has changed.
fn changed_input(text: &str) -> Option<String> {
    let records = text.lines().skip(1).filter_map(|line| serde_json::from_str(line).ok());
    records.into_iter().find_map(|record| match record {
        Record::Input { input, content } if script::fingerprint(&input) != content => Some(input.display().to_string()),
        _ => None,
    })
}

fn set_aside(path: &Path) -> io::Result<PathBuf> {
    let numbered = |number: usize| path.with_extension(format!("{number}.old"));
    let mut number = 1;
    while numbered(number).exists() {
        number += 1;
    }
    fs::rename(path, numbered(number))?;
    Ok(numbered(number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::objective::ObjectiveValue;

    fn open(folder: &Path) -> Result<History, HistoryError> {
        History::open(folder, &Identity::default(), 1, BTreeMap::new())
    }

    fn trials() -> Vec<(Vec<f64>, Evaluation)> {
        let residuals = Evaluation::Value(ObjectiveValue::Residuals(vec![0.1 + 0.2, -7.5]));
        vec![
            (vec![0.1, 1.0 / 3.0], Evaluation::Value(ObjectiveValue::Scalar(std::f64::consts::PI))),
            (vec![-0.0, 5e-324], residuals),
            (vec![1.0, 2.0], Evaluation::failed("the film broke")),
            (vec![1.0, 3.0], Evaluation::Failed { cause: "not a number".into(), numerical: true }),
        ]
    }

    fn written(folder: &Path) -> PathBuf {
        let mut history = open(folder).unwrap();
        for (x, found) in trials() {
            history.add(&x, &found, 0.25).unwrap();
        }
        history.path().into()
    }

    fn bits(trials: &[(Vec<f64>, Evaluation)]) -> String {
        format!("{trials:?}")
    }

    #[test]
    fn trials_are_restored_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        written(folder.path());
        assert_eq!(bits(open(folder.path()).unwrap().trials()), bits(&trials()));
    }

    #[test]
    fn an_incomplete_last_line_is_dropped() {
        for cut in [1, 5, 40] {
            let folder = tempfile::tempdir().unwrap();
            let path = written(folder.path());
            let bytes = fs::read(&path).unwrap();
            fs::write(&path, &bytes[..bytes.len() - cut]).unwrap();
            let mut history = open(folder.path()).unwrap();
            assert_eq!(bits(history.trials()), bits(&trials()[..3]));
            history.add(&[1.0, 3.0], &trials()[3].1, 0.25).unwrap();
            drop(history);
            assert_eq!(bits(open(folder.path()).unwrap().trials()), bits(&trials()));
        }
    }

    #[test]
    fn a_damaged_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path());
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let no_bits = r#"{"x":[1],"f":1,"seconds":1,"bits":"AAAA"}"#;
        for (wrong, line) in [("{}", 3), ("nonsense", 2), (no_bits, 4)] {
            let mut lines = lines.clone();
            lines[line - 1] = wrong;
            fs::write(&path, lines.join("\n") + "\n").unwrap();
            assert!(matches!(open(folder.path()), Err(HistoryError::Damaged { line: found, .. }) if found == line));
        }
    }

    #[test]
    fn a_history_is_locked() {
        let folder = tempfile::tempdir().unwrap();
        let history = open(folder.path()).unwrap();
        assert!(matches!(open(folder.path()), Err(HistoryError::Locked { .. })));
        drop(history);
        assert!(open(folder.path()).is_ok());
    }

    #[test]
    fn other_searches_have_other_files() {
        let folder = tempfile::tempdir().unwrap();
        written(folder.path());
        let script = Identity { script: "let a = 1;".into(), ..Identity::default() };
        let input = BTreeMap::from([(PathBuf::from("/a"), "1 bytes".to_owned())]);
        let empty = |identity: &Identity, number, inputs| {
            History::open(folder.path(), identity, number, inputs).unwrap().trials().is_empty()
        };
        assert!(empty(&script, 1, BTreeMap::new()));
        assert!(empty(&Identity::default(), 2, BTreeMap::new()));
        assert!(empty(&Identity::default(), 1, input));
        assert!(!empty(&Identity::default(), 1, BTreeMap::new()));
    }

    #[test]
    fn trials_of_a_file_that_has_changed_are_set_aside() {
        let folder = tempfile::tempdir().unwrap();
        let read = folder.path().join("read.csv");
        fs::write(&read, "1").unwrap();
        let path = written(folder.path());
        open(folder.path()).unwrap().add_inputs(vec![(read.clone(), script::fingerprint(&read))]).unwrap();
        let history = open(folder.path()).unwrap();
        assert_eq!(history.trials().len(), 4);
        assert_eq!(history.warnings(), [Warning::TrialsRead { trials: 4, path: path.display().to_string() }]);
        drop(history);
        fs::write(&read, "2").unwrap();
        let history = open(folder.path()).unwrap();
        let (input, renamed) = (read.display().to_string(), path.with_extension("1.old"));
        assert!(history.trials().is_empty() && renamed.exists());
        assert_eq!(history.warnings(), [Warning::HistorySetAside { input, renamed: renamed.display().to_string() }]);
    }
}
