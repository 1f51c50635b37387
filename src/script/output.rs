//! What a script leaves behind: figures, tables, plots, files, and a log.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::Value;
use thiserror::Error;

use super::ConvergenceHistory;
use super::files::{File, FileError, Files};
use super::plots::{self, PlotError};
use crate::diagnostic::shown_path;
use crate::plot::{Correlation, Plot};
use crate::store::run_files::RESERVED_NAMES;

/// One row of a table: column name and value, in order.
pub type Row = serde_json::Map<String, Value>;

/// Most entries of each kind that are kept.
const MOST_ENTRIES: usize = 10_000;

/// Most searches and correlations whose pictures are kept.
const MOST_PICTURES: usize = 100;

/// Most virtual recordings that are named one by one.
const MOST_NAMED: usize = 6;

/// Figures, tables, plots, files and log lines in the order in which the script gave them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScriptOutput {
    pub measures: Row,
    pub tables: Vec<(String, Vec<Row>)>,
    pub plots: Vec<Plot>,
    /// How its searches came to their results.
    pub searches: Vec<ConvergenceHistory>,
    /// Of what its searches found.
    pub correlations: Vec<Correlation>,
    pub files: Files,
    pub log: Vec<String>,
    /// Recordings that it read, or that its scenarios are compared with, and that say they are virtual.
    pub virtual_recordings: Vec<PathBuf>,
}

impl ScriptOutput {
    /// What a reader must know before anything else: that recordings behind it are virtual.
    pub fn warning(&self) -> Option<String> {
        let named: Vec<String> = self.virtual_recordings.iter().take(MOST_NAMED).map(|path| shown_path(path)).collect();
        let more = match self.virtual_recordings.len().saturating_sub(MOST_NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        (!named.is_empty()).then(|| format!("VIRTUAL recordings, nothing was measured: {}{more}", named.join(", ")))
    }

    /// The lines of the log in two: those that the script began with `warning: `, without that word, and the others.
    pub fn warned_and_said(&self) -> (Vec<String>, Vec<String>) {
        let (mut warned, mut said) = (Vec::new(), Vec::new());
        for line in &self.log {
            match line.strip_prefix("warning: ") {
                Some(warning) => warned.push(warning.to_owned()),
                None => said.push(line.clone()),
            }
        }
        (warned, said)
    }
}

/// Why a name cannot be given to a figure or a table.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NameError {
    #[error("`{name}` is not a name for a figure or a table: use letters, digits and _")]
    Letters { name: String },
    #[error("`{name}` is a figure of every run and cannot be replaced")]
    Reserved { name: String },
    #[error("a script leaves at most {MOST_ENTRIES} figures, tables, rows or lines")]
    TooMany,
}

/// A picture that is not kept.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("report and recording show the first {MOST_PICTURES} searches of a script, and none behind them")]
pub struct TooManyPictures;

/// Where host functions write output down while a script runs.
#[derive(Clone)]
pub struct OutputCollector {
    output: Arc<Mutex<ScriptOutput>>,
    reserved: Arc<[String]>,
    listener: Arc<dyn Fn(&str) + Send + Sync>,
}

impl OutputCollector {
    /// An empty collector; `reserved` names cannot be given, `listener` hears every log line at once.
    pub fn new(reserved: Vec<String>, listener: impl Fn(&str) + Send + Sync + 'static) -> OutputCollector {
        OutputCollector { output: Arc::default(), reserved: reserved.into(), listener: Arc::new(listener) }
    }

    /// What was written down so far.
    pub fn output(&self) -> ScriptOutput {
        self.lock().clone()
    }

    /// Keeps how a search came to its result.
    ///
    /// # Errors
    /// There are too many.
    pub fn searched(&self, convergence: ConvergenceHistory) -> Result<(), TooManyPictures> {
        keep(&mut self.lock().searches, convergence)
    }

    /// Keeps how what was found hangs together.
    ///
    /// # Errors
    /// There are too many.
    pub fn correlated(&self, correlation: Correlation) -> Result<(), TooManyPictures> {
        keep(&mut self.lock().correlations, correlation)
    }

    /// Adds a figure, or replaces the one of this name.
    ///
    /// # Errors
    /// The name is not one, is reserved, or there are too many.
    pub fn measure(&self, name: &str, value: Value) -> Result<(), NameError> {
        self.check(name)?;
        let measures = &mut self.lock().measures;
        if measures.len() >= MOST_ENTRIES {
            return Err(NameError::TooMany);
        }
        measures.insert(name.into(), value);
        Ok(())
    }

    /// Adds a table, or replaces the one of this name.
    ///
    /// # Errors
    /// The name is not one, is reserved, or there are too many tables or rows.
    pub fn table(&self, name: &str, rows: Vec<Row>) -> Result<(), NameError> {
        self.check(name)?;
        let tables = &mut self.lock().tables;
        if tables.len() >= MOST_ENTRIES || rows.len() > MOST_ENTRIES {
            return Err(NameError::TooMany);
        }
        // One file a table: two names must differ on every file system.
        tables.retain(|(other, _)| !other.eq_ignore_ascii_case(name));
        tables.push((name.into(), rows));
        Ok(())
    }

    /// Adds a line to the log.
    ///
    /// # Errors
    /// There are too many.
    pub fn log(&self, line: &str) -> Result<(), NameError> {
        if self.lock().log.len() >= MOST_ENTRIES {
            return Err(NameError::TooMany);
        }
        (self.listener)(line);
        self.lock().log.push(line.into());
        Ok(())
    }

    /// Adds a file, or replaces the one of this name.
    ///
    /// # Errors
    /// The name cannot name a file, is reserved for the results, or the files together are too large.
    pub fn file(&self, file: File) -> Result<(), FileError> {
        self.lock().files.put(file, &RESERVED_NAMES)
    }

    /// Adds a plot, or replaces the one of this title.
    ///
    /// # Errors
    /// A text is empty or too long, it has no curves or too many, or the plots together are too large.
    pub fn plot(&self, plot: Plot) -> Result<(), PlotError> {
        plots::put(&mut self.lock().plots, plot)
    }

    fn check(&self, name: &str) -> Result<(), NameError> {
        let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if name.is_empty() || name.len() > 80 || !name.chars().all(letter) {
            return Err(NameError::Letters { name: name.chars().take(80).collect() });
        }
        if self.reserved.iter().any(|reserved| reserved == name) {
            return Err(NameError::Reserved { name: name.into() });
        }
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, ScriptOutput> {
        self.output.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn keep<T>(pictures: &mut Vec<T>, picture: T) -> Result<(), TooManyPictures> {
    if pictures.len() >= MOST_PICTURES {
        return Err(TooManyPictures);
    }
    pictures.push(picture);
    Ok(())
}
