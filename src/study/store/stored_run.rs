//! A run read from its folder, or a recording from its file.

use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};
use thiserror::Error;

use super::run_files::{self, MOST_BYTES};
use base::file::{self, FileError};
use lab::error::Kind;
use lab::signal::file::ReadOptions;
use lab::signal::{self, Recording};

/// The stored results of a run; those without a file are empty.
#[derive(Clone, Debug, Default)]
pub struct StoredRun {
    /// Folder or file, as it was given.
    pub place: PathBuf,
    /// The channels of `signals.csv`, or of the recording.
    pub signals: Recording,
    /// `summary.json`; empty of a recording and of a run that failed before it could be measured.
    pub summary: Map<String, Value>,
    /// The resolved scenario; empty of a recording.
    pub scenario: String,
    /// Why the run failed; `None` of a complete one.
    pub failure: Option<String>,
    /// Whether it is a recording that its file marks as virtual.
    pub is_virtual: bool,
}

/// Why a stored run cannot be read.
#[derive(Debug, Error)]
pub enum StoredRunError {
    /// The signals cannot be read.
    #[error(transparent)]
    Signals(#[from] lab::Error),
    /// The run failed before its first sample.
    #[error(transparent)]
    NoSamples(crate::Error),
    /// It is no run folder, or damaged.
    #[error(transparent)]
    Refused(#[from] crate::Error),
}

/// What helps where nothing was run, and where a file is damaged.
const RUN: &str = "`droptower run` writes run folders, such as runs/drop/1008";
const RUN_AGAIN: &str = "run the scenario again, or compare its signals.csv alone";

/// A file or folder that is refused.
fn refused(path: &Path, why: impl Display) -> crate::Error {
    crate::Error::new(format!("{}{why}", path.display()))
}

impl StoredRun {
    /// Reads the run folder, or the file of signals, at `place`.
    ///
    /// # Errors
    /// It is neither, or damaged.
    pub fn read(place: &Path) -> Result<StoredRun, StoredRunError> {
        if !place.exists() {
            return Err(crate::Error::new(format!("there is no {}", place.display())).with_hint(RUN).into());
        }
        let table = place.join(run_files::SIGNALS);
        if place.is_dir() && table.is_file() {
            return StoredRun::of_folder(place, &table);
        }
        // A folder may be a recording in ISO-MME.
        let is_test = || fs::read_dir(place).into_iter().flatten().flatten().any(|entry| is_mme(&entry.path()));
        if place.is_dir() && !is_test() {
            let why = " is not a run folder of droptower: it has no signals.csv";
            return Err(refused(place, why).with_hint(RUN).into());
        }
        let (signals, is_virtual) = signals(place)?;
        Ok(StoredRun { place: place.into(), signals, is_virtual, ..StoredRun::default() })
    }

    fn of_folder(place: &Path, table: &Path) -> Result<StoredRun, StoredRunError> {
        let failure = text(&place.join(run_files::FAILURE))?.map(|cause| cause.trim().to_owned());
        let (signals, is_virtual) = signals(table).map_err(|error| match (error, &failure) {
            (StoredRunError::Signals(error), Some(cause)) if *error.kind() == Kind::NoRows => {
                let why = format!(" has no samples: the run failed before the first: {cause}");
                StoredRunError::NoSamples(refused(place, why))
            }
            (error, _) => error,
        })?;
        Ok(StoredRun {
            place: place.into(),
            signals,
            summary: summary(&place.join(run_files::SUMMARY))?,
            scenario: scenario(&place.join(run_files::SCENARIO))?,
            failure,
            is_virtual,
        })
    }
}

fn is_mme(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mme"))
}

fn signals(path: &Path) -> Result<(Recording, bool), StoredRunError> {
    let measurement = signal::file::read(path, &ReadOptions::default())?;
    let recording = measurement.recording();
    let recording = recording.ok_or_else(|| refused(path, ": its channels do not share one time axis"))?;
    Ok((recording, measurement.annotations.is_virtual()))
}

/// The text of a file; `None` where there is no such file.
fn text(path: &Path) -> Result<Option<String>, crate::Error> {
    match file::read_text(path, MOST_BYTES) {
        Ok(text) => Ok(Some(text)),
        Err(FileError::NotFound) => Ok(None),
        Err(source) => Err(refused(path, format!(": {source}"))),
    }
}

fn scenario(path: &Path) -> Result<String, crate::Error> {
    let scenario = text(path)?.unwrap_or_default();
    match scenario.parse::<toml::Table>() {
        Ok(_) => Ok(scenario),
        Err(source) => Err(refused(path, format!(": {source}")).with_hint(RUN_AGAIN)),
    }
}

fn summary(path: &Path) -> Result<Map<String, Value>, crate::Error> {
    let Some(text) = text(path)? else { return Ok(Map::new()) };
    match serde_json::from_str(&text) {
        Ok(Value::Object(summary)) => Ok(summary),
        Ok(_) => Err(refused(path, " holds no figures: expected an object of names and values").with_hint(RUN_AGAIN)),
        Err(source) => Err(refused(path, format!(": {source}")).with_hint(RUN_AGAIN)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_a_recording() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("test.csv");
        fs::write(&path, "# virtual: nothing fell\ntime [ms],force [kN]\n0,1\n1,2\n").unwrap();
        let run = StoredRun::read(&path).unwrap();
        assert!(run.is_virtual);
        assert_eq!(run.signals.channel("force_N"), Some([1e3, 2e3].as_slice()));
    }
}
