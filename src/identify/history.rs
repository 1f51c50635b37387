//! The trials of a search, written down as they end: a search that was killed goes on without repeating one.
//!
//! One file a search, `<results>.history/<number>-<checksum>.jsonl`. Its first line says what decides the trials' values:
//! version, script, arguments, `--set`, and the files that had been read with their checksums. Every other line is one trial
//! as a person reads it, and its bits. A search whose first line differs has another file, so nothing is mixed and nothing
//! is lost.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use thiserror::Error;

use super::objective::{Answer, Evaluation, Observed};
use crate::file::{Digest, checksum};
use crate::script::{self, Compared, Over, Target};

/// What decides the values of a script's trials, files and the number of the search apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Identity {
    /// The script's text.
    pub script: String,
    /// Everything else that was given: changes, arguments.
    pub given: Map<String, Value>,
}

/// The history of one search, locked against others.
#[derive(Debug)]
pub struct History {
    path: PathBuf,
    file: File,
    trials: Vec<(Vec<f64>, Observed)>,
    /// References that trials were held against, in the order of the file.
    targets: Vec<Arc<Target>>,
    inputs: BTreeMap<PathBuf, String>,
    /// What the user should know about it.
    pub notes: Vec<String>,
}

/// Why a history cannot be read or written.
#[derive(Debug, Error)]
pub enum HistoryError {
    #[error("cannot write the history {}: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    #[error("another search is writing the history {}: wait for it, or give another --out", path.display())]
    Locked { path: PathBuf },
    #[error("line {line} of the history {} is no trial; move the file away to search anew", path.display())]
    Damaged { path: PathBuf, line: usize },
    #[error("the history {} is of another search; move the file away to search anew", path.display())]
    Other { path: PathBuf },
}

/// A line of the file but the first.
#[derive(Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Logged {
    /// One trial.
    Trial {
        x: Vec<f64>,
        /// Value of the objective; none where it failed.
        f: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        failed: Option<String>,
        /// Whether a simulation went wrong numerically.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        numerical: bool,
        /// Wall time.
        seconds: f64,
        /// Bits of x, then those of the value or of the residuals: little-endian doubles in base64.
        bits: String,
        /// Whether the objective gave residuals.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        residuals: bool,
        /// What was held against references, for pictures.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        compared: Vec<Sketch>,
    },
    /// A file that a trial was the first to read, and what it held.
    Input { input: PathBuf, content: String },
    /// A reference that the next trial is the first to be held against; little-endian floats in base64.
    Target { target: usize, over: Over, places: String, values: String },
}

/// A simulated curve: the number of its target, from zero, and its values, little-endian floats in base64.
#[derive(Debug, Serialize, Deserialize)]
pub struct Sketch {
    target: usize,
    values: String,
}

impl History {
    /// The history in `folder` of search `number` of a script, with the trials that are in it.
    ///
    /// A half-written last line is dropped. A history whose files have changed since is set aside under another name.
    ///
    /// # Errors
    /// It cannot be written, another search is writing it, or it is damaged.
    pub fn open(
        folder: &Path,
        identity: &Identity,
        number: usize,
        inputs: BTreeMap<PathBuf, String>,
    ) -> Result<History, HistoryError> {
        let head = head(identity, number, &inputs);
        let path = folder.join(format!("{number}-{:08x}.jsonl", checksum(head.as_bytes())));
        let failed = |source| HistoryError::Write { path: path.clone(), source };
        fs::create_dir_all(folder).map_err(failed)?;
        let mut history = History::of(&path, inputs.clone())?;
        let mut text = history.whole_lines().map_err(failed)?;
        if let Some(changed) = changed_input(&text) {
            let aside = set_aside(&path).map_err(failed)?;
            let note = format!("{changed} has changed since: the trials so far are set aside in {}", aside.display());
            history = History { notes: vec![note], ..History::of(&path, inputs)? };
            text.clear();
        }
        if text.is_empty() {
            history.append(&head)?;
        } else {
            history.take(&text, &head)?;
        }
        Ok(history)
    }

    /// Opens and locks the file at `path`.
    fn of(path: &Path, inputs: BTreeMap<PathBuf, String>) -> Result<History, HistoryError> {
        let failed = |source| HistoryError::Write { path: path.into(), source };
        let file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => Ok(History { path: path.into(), file, trials: vec![], targets: vec![], inputs, notes: vec![] }),
            Err(TryLockError::WouldBlock) => Err(HistoryError::Locked { path: path.into() }),
            Err(TryLockError::Error(source)) => Err(failed(source)),
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The trials that were in it when it was opened.
    pub fn trials(&self) -> &[(Vec<f64>, Observed)] {
        &self.trials
    }

    /// The references that they were held against.
    pub fn targets(&self) -> &[Arc<Target>] {
        &self.targets
    }

    /// Writes a trial down.
    pub fn add(
        &mut self,
        x: &[f64],
        Observed { found, compared }: &Observed,
        seconds: f64,
    ) -> Result<(), HistoryError> {
        let (values, failed, residuals) = match found {
            Evaluation::Answer(Answer::Value(value)) => (vec![*value], None, false),
            Evaluation::Answer(Answer::Residuals(residuals)) => (residuals.clone(), None, true),
            Evaluation::Failed { cause, .. } => (vec![], Some(cause.clone()), false),
            Evaluation::Broken(_) => return Ok(()),
        };
        let numerical = matches!(found, Evaluation::Failed { numerical: true, .. });
        let f = match found {
            Evaluation::Answer(answer) => Some(answer.value()),
            _ => None,
        };
        let bytes: Vec<u8> = x.iter().chain(&values).flat_map(|value| value.to_le_bytes()).collect();
        let bits = BASE64_STANDARD.encode(bytes);
        let compared = compared.iter().map(|one| self.sketch(one)).collect::<Result<_, _>>()?;
        self.add_line(&Logged::Trial { x: x.into(), f, failed, numerical, seconds, bits, residuals, compared })
    }

    /// A simulated curve, its target written down before it where it is a new one.
    fn sketch(&mut self, Compared { target, values }: &Compared) -> Result<Sketch, HistoryError> {
        let known = self.targets.iter().position(|other| Arc::ptr_eq(other, target) || other == target);
        let number = known.unwrap_or(self.targets.len());
        if known.is_none() {
            let (places, values) = (packed(&target.places), packed(&target.values));
            self.add_line(&Logged::Target { target: number, over: target.over, places, values })?;
            self.targets.push(Arc::clone(target));
        }
        Ok(Sketch { target: number, values: packed(values) })
    }

    /// Writes down files that were not known to be read before.
    pub fn add_inputs(&mut self, inputs: Vec<(PathBuf, String)>) -> Result<(), HistoryError> {
        for (input, content) in inputs {
            if self.inputs.insert(input.clone(), content.clone()).is_none() {
                self.add_line(&Logged::Input { input, content })?;
            }
        }
        Ok(())
    }

    fn add_line(&mut self, line: &Logged) -> Result<(), HistoryError> {
        let text = serde_json::to_string(line).map_err(|error| self.failed(error.into()))?;
        self.append(&text)
    }

    /// In one piece: whenever the process ends, all lines but the last are whole.
    fn append(&mut self, line: &str) -> Result<(), HistoryError> {
        self.file.write_all(format!("{line}\n").as_bytes()).map_err(|error| self.failed(error))
    }

    fn failed(&self, source: io::Error) -> HistoryError {
        HistoryError::Write { path: self.path.clone(), source }
    }

    /// The text of the file; what stands behind its last line end is cut off.
    fn whole_lines(&mut self) -> io::Result<String> {
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(0))?;
        self.file.read_to_end(&mut bytes)?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |place| place + 1);
        if whole < bytes.len() {
            self.file.set_len(whole as u64)?;
            bytes.truncate(whole);
        }
        // Bytes that are no text make a line that is no trial.
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn take(&mut self, text: &str, head: &str) -> Result<(), HistoryError> {
        let mut lines = text.lines();
        if lines.next() != Some(head) {
            return Err(HistoryError::Other { path: self.path.clone() });
        }
        for (place, line) in lines.enumerate() {
            let damaged = || HistoryError::Damaged { path: self.path.clone(), line: place + 2 };
            match serde_json::from_str(line).map_err(|_| damaged())? {
                Logged::Input { input, content } => drop(self.inputs.insert(input, content)),
                Logged::Target { target, over, places, values } => {
                    let read = unpacked(&places).zip(unpacked(&values)).filter(|_| target == self.targets.len());
                    let (places, values) = read.ok_or_else(damaged)?;
                    self.targets.push(Arc::new(Target { over, places, values }));
                }
                trial => {
                    let trial = observed(trial, &self.targets).ok_or_else(damaged)?;
                    self.trials.push(trial);
                }
            }
        }
        Ok(())
    }
}

/// The first line: what decides the values of the trials.
fn head(identity: &Identity, number: usize, inputs: &BTreeMap<PathBuf, String>) -> String {
    let inputs: Map<String, Value> =
        inputs.iter().map(|(path, content)| (path.display().to_string(), json!(content))).collect();
    let script = Digest::of(identity.script.as_bytes()).to_string();
    let head = json!({
        "droptower": env!("CARGO_PKG_VERSION"),
        "search": number,
        "script": script,
        "given": identity.given,
        "inputs": inputs,
    });
    head.to_string()
}

/// A file that a trial was the first to read and that holds something else now.
fn changed_input(text: &str) -> Option<String> {
    let logged = text.lines().skip(1).filter_map(|line| serde_json::from_str(line).ok());
    logged.into_iter().find_map(|logged| match logged {
        Logged::Input { input, content } if script::fingerprint(&input) != content => Some(input.display().to_string()),
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

fn observed(trial: Logged, targets: &[Arc<Target>]) -> Option<(Vec<f64>, Observed)> {
    let Logged::Trial { x, failed, numerical, bits, residuals, compared, .. } = trial else {
        return None;
    };
    let bytes = BASE64_STANDARD.decode(bits).ok()?;
    let (numbers, rest) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let values = numbers.get(x.len()..).filter(|_| rest.is_empty())?;
    let found = match (failed, values) {
        (Some(cause), []) => Evaluation::Failed { cause, numerical },
        (None, values) if residuals => Evaluation::Answer(Answer::Residuals(values.into())),
        (None, [value]) => Evaluation::Answer(Answer::Value(*value)),
        _ => return None,
    };
    let compared = compared.into_iter().map(|sketch| {
        let target = targets.get(sketch.target)?;
        let values = unpacked(&sketch.values).filter(|values| values.len() == target.places.len())?;
        Some(Compared { target: Arc::clone(target), values })
    });
    Some((numbers[..x.len()].into(), Observed { found, compared: compared.collect::<Option<_>>()? }))
}

fn packed(values: &[f32]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    BASE64_STANDARD.encode(bytes)
}

fn unpacked(text: &str) -> Option<Vec<f32>> {
    let bytes = BASE64_STANDARD.decode(text).ok()?;
    let (values, rest) = bytes.as_chunks::<4>();
    rest.is_empty().then(|| values.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(folder: &Path) -> Result<History, HistoryError> {
        History::open(folder, &Identity::default(), 1, BTreeMap::new())
    }

    fn trials() -> Vec<(Vec<f64>, Observed)> {
        let target = |last| Arc::new(Target { over: Over::Time, places: vec![0.0, 0.1], values: vec![1.0, last] });
        let compared = |last, values: [f32; 2]| Compared { target: target(last), values: values.into() };
        let pictured = |found, compared| Observed { found, compared };
        let residuals = Evaluation::Answer(Answer::Residuals(vec![0.1 + 0.2, -7.5]));
        vec![
            (
                vec![0.1, 1.0 / 3.0],
                pictured(
                    Evaluation::Answer(Answer::Value(std::f64::consts::PI)),
                    vec![compared(f32::NAN, [0.3, f32::NAN]), compared(2.0, [1e-30, 7.0])],
                ),
            ),
            (vec![-0.0, 5e-324], pictured(residuals, vec![compared(2.0, [0.1, 0.2])])),
            (vec![1.0, 2.0], Evaluation::failed("the film broke").into()),
            (vec![1.0, 3.0], Evaluation::Failed { cause: "not a number".into(), numerical: true }.into()),
        ]
    }

    fn written(folder: &Path) -> PathBuf {
        let mut history = open(folder).unwrap();
        for (x, found) in trials() {
            history.add(&x, &found, 0.25).unwrap();
        }
        history.path().into()
    }

    fn bits(trials: &[(Vec<f64>, Observed)]) -> String {
        format!("{trials:?}")
    }

    #[test]
    fn trials_come_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        written(folder.path());
        assert_eq!(bits(open(folder.path()).unwrap().trials()), bits(&trials()));
    }

    #[test]
    fn a_half_written_line_is_dropped_and_the_next_one_is_whole() {
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

    /// As older versions of this one wrote them.
    #[test]
    fn trials_without_curves_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path());
        let text = fs::read_to_string(&path).unwrap();
        let old: String =
            text.lines().filter(|line| !line.contains("target")).map(|line| format!("{line}\n")).collect();
        fs::write(&path, old).unwrap();
        assert_eq!(bits(open(folder.path()).unwrap().trials()), bits(&trials()[2..]));
    }

    #[test]
    fn a_damaged_line_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path());
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let no_bits = r#"{"x":[1],"f":1,"seconds":1,"bits":"AAAA"}"#;
        let no_target = lines[3].replace("\"target\":0", "\"target\":7");
        for (wrong, line) in [("{}", 3), ("nonsense", 2), (no_bits, 4), (&no_target, 4)] {
            let mut lines = lines.clone();
            lines[line - 1] = wrong;
            fs::write(&path, lines.join("\n") + "\n").unwrap();
            assert!(matches!(open(folder.path()), Err(HistoryError::Damaged { line: found, .. }) if found == line));
        }
    }

    #[test]
    fn one_search_at_a_time() {
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
        assert_eq!(open(folder.path()).unwrap().trials().len(), 4);
        fs::write(&read, "2").unwrap();
        let history = open(folder.path()).unwrap();
        assert!(history.trials().is_empty() && history.notes[0].contains("read.csv has changed"));
        assert!(path.with_extension("1.old").exists());
    }
}
