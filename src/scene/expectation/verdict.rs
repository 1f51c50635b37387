//! The outcome of a case: a scenario and the demands on its run.

use serde::{Serialize, Serializer};

use super::{Difference, Expectations, Recorded};
use lab::signal::Recording;

/// The outcome of a case.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// Its path from the working folder.
    pub name: String,
    /// The demands on its run.
    pub expectations: Expectations,
    /// How its run differs from that; nothing where it does not.
    pub differences: Vec<Difference>,
    /// The record of an earlier run.
    pub recorded: Recorded,
    /// The signals of its run; none where it failed.
    pub signals: Option<Recording>,
    /// Wall time, s.
    pub seconds: f64,
    /// Whether its records were renewed.
    pub blessed: bool,
}

/// A verdict as `summary.json` has it.
#[derive(Debug, Serialize)]
pub struct Entry<'a> {
    name: &'a str,
    passed: bool,
    blessed: bool,
    seconds: f64,
    #[serde(serialize_with = "rows")]
    differences: &'a [Difference],
}

/// A difference and its message.
#[derive(Debug, Serialize)]
struct Row<'a> {
    #[serde(flatten)]
    difference: &'a Difference,
    message: String,
}

/// How a run differs from another one by more than is allowed.
#[derive(Clone, Debug, Serialize)]
pub struct Outside {
    /// Name of the run.
    pub run: String,
    /// The differences; nothing where it is within.
    #[serde(serialize_with = "rows")]
    pub differences: Vec<Difference>,
}

impl Verdict {
    /// Whether the run is what is expected.
    pub fn has_passed(&self) -> bool {
        self.differences.is_empty()
    }

    /// Its entry in `summary.json`.
    pub fn entry(&self) -> Entry<'_> {
        Entry {
            name: &self.name,
            passed: self.has_passed(),
            blessed: self.blessed,
            seconds: self.seconds,
            differences: &self.differences,
        }
    }
}

fn rows<S: Serializer>(differences: &impl AsRef<[Difference]>, serializer: S) -> Result<S::Ok, S::Error> {
    let rows = differences.as_ref().iter();
    serializer.collect_seq(rows.map(|difference| Row { difference, message: difference.to_string() }))
}
