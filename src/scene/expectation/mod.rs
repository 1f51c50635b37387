//! Demands on the results of a run: expectations as they are written, checked, and how a run differs from them.

mod check;
mod difference;
mod figures;
mod findings;
mod signals;
mod verdict;

use std::path::Path;

use serde_json::{Map, Value};

use base::diagnostic::{Diagnostic, shown_path};
use base::file::{self, FileError};
pub use check::{Expectations, FigureBounds, SignalBounds};
pub use difference::Difference;
use lab::signal::{Recording, csv};
pub use verdict::{Entry, Outside, Verdict};

/// Most bytes of recorded figures.
const MOST_BYTES: u64 = 64 << 20;

/// The results of a run that are compared.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// Its signals.
    pub signals: &'a Recording,
    /// The fields of its summary.
    pub figures: &'a Map<String, Value>,
}

/// The record of an earlier run.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// Its signals, where they were recorded.
    pub signals: Option<Recording>,
    /// The figures that are bounded by their recorded values.
    pub figures: Map<String, Value>,
}

impl Recorded {
    /// Reads the files of an earlier run; one that is not there records nothing.
    ///
    /// # Errors
    /// A file cannot be read or holds something else.
    pub fn read(signals: &Path, figures: &Path) -> Result<Recorded, Diagnostic> {
        let signals = match signals.exists() {
            true => Some(csv::read(signals).map_err(|error| Diagnostic::new(error.to_string()))?),
            false => None,
        };
        let refused = |what: String| Diagnostic::new(format!("{}: {what}", shown_path(figures)));
        let figures = match file::read_text(figures, MOST_BYTES) {
            Ok(text) => match serde_json::from_str(&text) {
                Ok(Value::Object(figures)) => figures,
                Ok(_) => return Err(refused("expected an object".into())),
                Err(error) => return Err(refused(error.to_string())),
            },
            Err(FileError::NotFound) => Map::new(),
            Err(error) => return Err(refused(error.to_string())),
        };
        Ok(Recorded { signals, figures })
    }
}

impl Expectations {
    /// How a run differs from what is expected, signals first; nothing where it does not.
    pub fn differences(&self, recorded: &Recorded, given: &Given<'_>) -> Vec<Difference> {
        let signals = signals::differences(self, recorded.signals.as_ref(), given.signals);
        let figures = figures::differences(self, &recorded.figures, given.figures);
        [signals, figures, findings::differences(self, given.figures)].concat()
    }

    /// The record that can be made of a run.
    pub fn recorded(&self, given: &Given<'_>) -> Recorded {
        let is_compared = |name: &str| self.signal(name).is_some_and(SignalBounds::needs_recording);
        let mut signals = given.signals.clone();
        signals.channels.retain(|channel| is_compared(&channel.name));
        let is_bound = |name: &str| self.figures.iter().any(|(own, bounds)| own == name && bounds.needs_recording());
        let figures = given.figures.iter().filter(|(name, _)| is_bound(name));
        Recorded {
            signals: (!signals.channels.is_empty()).then_some(signals),
            figures: figures.map(|(name, value)| (name.clone(), value.clone())).collect(),
        }
    }
}
