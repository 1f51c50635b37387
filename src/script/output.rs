//! What a script leaves behind: figures, tables, plots, files, and a log.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rhai::{Array, Dynamic, Engine, Map};
use serde_json::Value;
use thiserror::Error;

use super::files::{self, File, FileError, Files};
use super::plots::{self, PlotError};
use super::{ConvergenceHistory, Entry, HostResult, refuse, to_json};
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

    /// Offers `measure`, `table`, `plot`, `write_csv`, `write_text`, `log` and `print` to scripts.
    pub fn register(&self, engine: &mut Engine) {
        let collector = self.clone();
        engine.register_fn("measure", move |name: &str, value: Dynamic| collector.measure(name, &value));
        let collector = self.clone();
        engine.register_fn("table", move |name: &str, rows: Dynamic| collector.table(name, None, &rows));
        let collector = self.clone();
        engine.register_fn("table", move |name: &str, columns: Array, rows: Dynamic| {
            collector.table(name, Some(&columns), &rows)
        });
        plots::register(self, engine);
        files::register(self, engine);
        let collector = self.clone();
        engine.register_fn("log", move |line: Dynamic| collector.log(&line.to_string()));
        let collector = self.clone();
        // The interpreter's own `print` cannot answer with an error; a line too many is dropped there.
        engine.on_print(move |line| drop(collector.log(line)));
    }

    fn measure(&self, name: &str, value: &Dynamic) -> HostResult<()> {
        self.check(name).map_err(refuse)?;
        let value = to_json(value)?;
        let measures = &mut self.lock().measures;
        if measures.len() >= MOST_ENTRIES {
            return Err(refuse(NameError::TooMany));
        }
        measures.insert(name.into(), value);
        Ok(())
    }

    fn table(&self, name: &str, columns: Option<&Array>, rows: &Dynamic) -> HostResult<()> {
        self.check(name).map_err(refuse)?;
        let rows = rows_of(rows, columns)?;
        let tables = &mut self.lock().tables;
        if tables.len() >= MOST_ENTRIES || rows.len() > MOST_ENTRIES {
            return Err(refuse(NameError::TooMany));
        }
        // One file a table: two names must differ on every file system.
        tables.retain(|(other, _)| !other.eq_ignore_ascii_case(name));
        tables.push((name.into(), rows));
        Ok(())
    }

    fn log(&self, line: &str) -> HostResult<()> {
        if self.lock().log.len() >= MOST_ENTRIES {
            return Err(refuse(NameError::TooMany));
        }
        (self.listener)(line);
        self.lock().log.push(line.into());
        Ok(())
    }

    pub(super) fn file(&self, file: File) -> Result<(), FileError> {
        self.lock().files.put(file, &RESERVED_NAMES)
    }

    pub(super) fn plot(&self, plot: Plot) -> Result<(), PlotError> {
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

fn rows_of(rows: &Dynamic, columns: Option<&Array>) -> HostResult<Vec<Row>> {
    if let Some(map) = rows.read_lock::<Map>() {
        return Ok(vec![row_of(&map, columns)?]);
    }
    let Some(rows) = rows.read_lock::<Array>() else {
        return Err(refuse(format!("a table is a map or a list of maps, not {}", rows.type_name())));
    };
    let row = |row: &Dynamic| match row.read_lock::<Map>() {
        Some(map) => row_of(&map, columns),
        None => Err(refuse(format!("a row of a table is a map, not {}", row.type_name()))),
    };
    rows.iter().map(row).collect()
}

fn row_of(map: &Map, columns: Option<&Array>) -> HostResult<Row> {
    let Some(columns) = columns else {
        return map.iter().map(|(key, value)| Ok((key.to_string(), to_json(value)?))).collect();
    };
    let column = |column: &Dynamic| {
        let name = column.to_string();
        let value = map.get(name.as_str()).ok_or_else(|| refuse(format!("a row has no `{name}`")))?;
        Ok((name, to_json(value)?))
    };
    columns.iter().map(column).collect()
}

/// The reference of what a script writes down.
pub const ENTRIES: &[Entry] = &[
    Entry {
        call: "measure(name, value)",
        gives: "adds a figure to the summary; names are letters, digits and _",
        example: r#"measure("stopping_distance_m", 0.17); true"#,
    },
    Entry {
        call: "table(name, rows)",
        gives: "adds a table to the summary; rows are a map or a list of maps, columns in alphabetical order",
        example: r#"table("coefficients", #{ k1: 2.75, ke: 3.41 }); true"#,
    },
    Entry {
        call: "table(name, columns, rows)",
        gives: "the same with the columns in the order given",
        example: r#"table("tests", ["test", "k1"], [#{ k1: 2.75, test: 1008 }]); true"#,
    },
    Entry {
        call: "log(text)",
        gives: "a line for the terminal and the report; `print` does the same",
        example: r#"log("loading took " + 57 + " ms"); print("done"); true"#,
    },
];
