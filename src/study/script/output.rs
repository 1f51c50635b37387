//! The output of a script: figures, tables, plots, files, findings and a log.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::Value;
use thiserror::Error;

use super::ConvergenceHistory;
use super::files::{File, FileError, Files};
use super::plots::{self, PlotError};
use super::warning::Warning;
use crate::store::run_files::RESERVED_NAMES;
use base::finding::{Finding, is_code};
use plot::{Correlation, Plot};

/// One row of a table: column name and value, in order.
pub type Row = serde_json::Map<String, Value>;

/// Most entries of each kind.
const MOST_ENTRIES: usize = 10_000;

/// Most searches and correlations whose plots are stored.
const MOST_SEARCHES: usize = 100;

/// Figures, tables, plots, files, findings and lines of the log, in the order in which the script gave them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScriptOutput {
    /// What it answers, in a sentence.
    pub answer: Option<String>,
    /// Figures by name.
    pub measures: Row,
    /// Tables: name and rows.
    pub tables: Vec<(String, Vec<Row>)>,
    /// Plots.
    pub plots: Vec<Plot>,
    /// The convergence histories of its searches.
    pub searches: Vec<ConvergenceHistory>,
    /// The correlations of what its searches found.
    pub correlations: Vec<Correlation>,
    /// Files.
    pub files: Files,
    /// Lines of the log.
    pub log: Vec<String>,
    /// Findings that it reported with `warn`, and other warnings about its output.
    pub findings: Vec<Finding>,
}

/// Why a figure, a table, a line or a warning of a script is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum OutputError {
    /// The name has other characters, none or too many.
    #[error("`{name}` is not a name for a figure or a table: use letters, digits and _")]
    Letters {
        /// Name of the figure or table, as the script gives it.
        name: String,
    },
    /// The name belongs to the summary.
    #[error("`{name}` is a field of the summary and cannot be replaced: {}", remedy(name))]
    Reserved {
        /// Name of the figure, a field of the summary.
        name: String,
    },
    /// The code is not one, see [`is_code`].
    #[error("`{code}` is not the code of a warning: use lower-case words joined by hyphens, such as `coarse-mesh`")]
    Code {
        /// Code of the warning, as the script gives it.
        code: String,
    },
    /// There are `MOST_ENTRIES` of a kind.
    #[error("a script leaves at most {MOST_ENTRIES} figures, tables, rows, lines or warnings")]
    TooMany,
}

fn remedy(reserved: &str) -> &'static str {
    match reserved {
        "warning" | "warnings" | "findings" => "report a warning with `warn(code, text)`",
        _ => "choose another name",
    }
}

/// A report of a script while it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message<'a> {
    /// A line of its log.
    Line(&'a str),
    /// A finding, by `warn` or of the host.
    Finding(&'a Finding),
}

impl fmt::Display for Message<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Message::Line(line) => f.write_str(line),
            Message::Finding(finding) => finding.fmt(f),
        }
    }
}

/// Called with each message of a script at once.
type Listener = dyn Fn(Message<'_>) + Send + Sync;

/// Collects the output of a script while it runs. Cheap to clone.
#[derive(Clone)]
pub struct OutputCollector {
    output: Arc<Mutex<ScriptOutput>>,
    reserved: Arc<[String]>,
    listener: Arc<Listener>,
}

impl OutputCollector {
    /// An empty collector; figures and tables cannot have a `reserved` name.
    pub fn new(reserved: Vec<String>) -> OutputCollector {
        OutputCollector { output: Arc::default(), reserved: reserved.into(), listener: Arc::new(|_| {}) }
    }

    /// The collector, which also calls `listener` with each message.
    pub fn with_listener(self, listener: impl Fn(Message<'_>) + Send + Sync + 'static) -> OutputCollector {
        OutputCollector { listener: Arc::new(listener), ..self }
    }

    /// The output that was collected so far.
    pub fn output(&self) -> ScriptOutput {
        self.lock().clone()
    }

    /// Adds the convergence history of a search; where there are too many, a finding says so once.
    pub fn add_search(&self, convergence: ConvergenceHistory) {
        // The phases of a search are one search.
        let before = if convergence.continues { self.lock().searches.pop() } else { None };
        let whole = match before {
            Some(before) => convergence.behind(before),
            None => convergence,
        };
        self.add(whole, |output| &mut output.searches);
    }

    /// Adds the correlation of what a search found; where there are too many, a finding says so once.
    pub fn add_correlation(&self, correlation: Correlation) {
        self.add(correlation, |output| &mut output.correlations);
    }

    fn add<T>(&self, item: T, list: impl FnOnce(&mut ScriptOutput) -> &mut Vec<T>) {
        let mut output = self.lock();
        let list = list(&mut output);
        if list.len() < MOST_SEARCHES {
            return list.push(item);
        }
        let finding = Finding::new(&Warning::SearchesNotShown { shown: MOST_SEARCHES });
        if !output.findings.contains(&finding) {
            output.findings.push(finding.clone());
            drop(output);
            (self.listener)(Message::Finding(&finding));
        }
    }

    /// Sets the answer, in place of an earlier one.
    pub fn answer(&self, sentence: &str) {
        self.lock().answer = Some(sentence.into());
    }

    /// Adds a figure, or replaces the one of this name.
    ///
    /// # Errors
    /// The name is not one, is reserved, or there are too many.
    pub fn measure(&self, name: &str, value: Value) -> Result<(), OutputError> {
        self.check(name)?;
        let measures = &mut self.lock().measures;
        if measures.len() >= MOST_ENTRIES {
            return Err(OutputError::TooMany);
        }
        measures.insert(name.into(), value);
        Ok(())
    }

    /// Adds a table, or replaces the one of this name.
    ///
    /// # Errors
    /// The name is not one, is reserved, or there are too many tables or rows.
    pub fn table(&self, name: &str, rows: Vec<Row>) -> Result<(), OutputError> {
        self.check(name)?;
        let tables = &mut self.lock().tables;
        if tables.len() >= MOST_ENTRIES || rows.len() > MOST_ENTRIES {
            return Err(OutputError::TooMany);
        }
        // One file a table: two names must differ on every file system.
        tables.retain(|(other, _)| !other.eq_ignore_ascii_case(name));
        tables.push((name.into(), rows));
        Ok(())
    }

    /// Whether there is a table of this name.
    pub fn has_table(&self, name: &str) -> bool {
        self.lock().tables.iter().any(|(other, _)| other.eq_ignore_ascii_case(name))
    }

    /// Adds a line to the log.
    ///
    /// # Errors
    /// There are too many.
    pub fn log(&self, line: &str) -> Result<(), OutputError> {
        if self.lock().log.len() >= MOST_ENTRIES {
            return Err(OutputError::TooMany);
        }
        (self.listener)(Message::Line(line));
        self.lock().log.push(line.into());
        Ok(())
    }

    /// Adds a warning with the script's own code.
    ///
    /// # Errors
    /// The code is not one, or there are too many warnings.
    pub fn warn(&self, code: &str, text: &str) -> Result<(), OutputError> {
        self.report(Finding::of_script(code, text))
    }

    /// Adds a finding as it is.
    ///
    /// # Errors
    /// Its code is not one, or there are too many findings.
    pub fn report(&self, finding: Finding) -> Result<(), OutputError> {
        if !is_code(&finding.code) {
            return Err(OutputError::Code { code: finding.code.chars().take(80).collect() });
        }
        if self.lock().findings.len() >= MOST_ENTRIES {
            return Err(OutputError::TooMany);
        }
        (self.listener)(Message::Finding(&finding));
        self.lock().findings.push(finding);
        Ok(())
    }

    /// Adds a finding of the host, unless there is one of the same code and key, or there are too many.
    pub(super) fn report_once(&self, finding: Finding) {
        let same =
            |other: &Finding| other.code == finding.code && other.figures.get("key") == finding.figures.get("key");
        if !self.lock().findings.iter().any(same) {
            // Too many findings are an error of the script that gives them.
            let _ = self.report(finding);
        }
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

    fn check(&self, name: &str) -> Result<(), OutputError> {
        let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if name.is_empty() || name.len() > 80 || !name.chars().all(letter) {
            return Err(OutputError::Letters { name: name.chars().take(80).collect() });
        }
        if self.reserved.iter().any(|reserved| reserved == name) {
            return Err(OutputError::Reserved { name: name.into() });
        }
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, ScriptOutput> {
        self.output.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::Iterate;

    #[test]
    fn searches_without_plots_are_reported_once() {
        let messages = Arc::new(Mutex::new(Vec::new()));
        let collected = Arc::clone(&messages);
        let collector = OutputCollector::new(vec![]);
        let collector = collector.with_listener(move |message| collected.lock().unwrap().push(message.to_string()));
        let search = ConvergenceHistory {
            title: "a".into(),
            unknowns: vec![],
            objectives: vec![],
            history: vec![],
            fits: vec![],
            is_virtual: false,
            continues: false,
        };
        let phase = |iteration: usize, continues| ConvergenceHistory {
            continues,
            history: vec![Iterate { iteration, f: 1.0, x: vec![] }],
            objectives: vec![vec![(iteration, 1.0)]],
            ..search.clone()
        };
        let phases = OutputCollector::new(vec![]);
        [phase(3, false), phase(2, true), phase(1, false)].into_iter().for_each(|phase| phases.add_search(phase));
        let found = phases.output().searches;
        let iterations = |search: &ConvergenceHistory| search.history.iter().map(|at| at.iteration).collect::<Vec<_>>();
        assert_eq!(
            found.iter().map(iterations).collect::<Vec<_>>(),
            [vec![3, 5], vec![1]],
            "two phases are one search"
        );
        assert_eq!(found[0].objectives, [[(5, 1.0)]]);

        (0..MOST_SEARCHES + 2).for_each(|_| collector.add_search(search.clone()));
        let output = collector.output();
        assert_eq!(output.searches.len(), MOST_SEARCHES);
        let [finding] = &output.findings[..] else { panic!("{:?}", output.findings) };
        assert_eq!((finding.code.as_str(), &finding.figures["shown"]), ("searches-not-shown", &MOST_SEARCHES.into()));
        let expected =
            "note[searches-not-shown]: the report shows the first 100 searches of a script; later ones have no plots";
        assert_eq!(*messages.lock().unwrap(), [expected]);
    }
}
