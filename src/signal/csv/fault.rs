//! What is wrong with a table, and where.

use thiserror::Error;

use crate::diagnostic::listed;
use crate::signal::measurement::ChannelError;
use crate::signal::text::{self, TextError};

/// Most cells that are kept; more is a mistake or an attack.
pub const MOST_CELLS: usize = 50_000_000;

/// Why a file is no table of channels, and where.
pub type ReadError = text::ReadError<Fault>;

pub(super) type Mistake = text::Mistake<Fault>;

/// What is wrong with a table.
#[derive(Debug, Error)]
pub enum Fault {
    #[error(transparent)]
    Text(#[from] TextError),
    #[error("no samples: the file is empty")]
    Empty,
    #[error("no samples: no line below the header starts with a number")]
    NoRows,
    #[error("no samples: none of the first {lines} lines starts with a number")]
    NoNumbers { lines: usize },
    #[error("{} ({}) over {}", counted(names.len(), "name"), listed(names), counted(*columns, "column"))]
    NamesAndColumns { names: Vec<String>, columns: usize },
    #[error("no column of time among {}", listed(found))]
    NoTime { found: Vec<String> },
    #[error("several columns of time among {}", listed(found))]
    SeveralTimes { found: Vec<String> },
    #[error("column {column} has no name")]
    Unnamed { column: usize },
    #[error("two columns are called `{name}`")]
    Duplicate { name: String },
    #[error(transparent)]
    Channel(ChannelError),
    #[error("no channel beside the time")]
    NoChannel,
    #[error("one channel is wanted, found {}: {}", found.len(), listed(found))]
    NotOne { found: Vec<String> },
    #[error("expected a number for `{name}`, found `{found}`")]
    NotANumber { name: String, found: String },
    #[error("expected a number for `{name}`, found `{found}`, which carries a unit of its own")]
    UnitInCell { name: String, found: String },
    #[error("decimal point and decimal comma in one file: `{found}` for `{name}`")]
    MixedMarks { name: String, found: String },
    #[error("`{name}` is not finite")]
    NotFinite { name: String },
    #[error("the sample has no time")]
    NoTimeValue,
    #[error("time does not increase: {time} after {previous}")]
    TimeNotIncreasing { time: f64, previous: f64 },
    #[error("expected {expected} cells, found {found}")]
    RowLength { expected: usize, found: usize },
    #[error("the file is truncated: its last line has {found} of {expected} cells")]
    Truncated { expected: usize, found: usize },
    #[error("mixed units: the header states `{header}` of `{name}`, the line of units `{row}`")]
    MixedUnits { name: String, header: String, row: String },
    #[error("mixed units: the file states `{file}` of `{name}`, but `{given}` is given")]
    GivenUnit { name: String, file: String, given: String },
    #[error("time (`{name}`) cannot be in `{unit}`")]
    TimeUnit { name: String, unit: String },
    #[error("more than {MOST_CELLS} cells")]
    TooLarge,
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            Fault::Channel(error) => return error.hint(),
            Fault::NamesAndColumns { .. } => "give the names of the columns: --columns time,a,b",
            Fault::NoTime { .. } | Fault::SeveralTimes { .. } => "name the column of time: --time NAME",
            Fault::NotOne { .. } => "name the channel: --column NAME",
            Fault::NotFinite { .. } => "leave the cell empty where nothing was measured",
            Fault::UnitInCell { .. } => "units belong into the header: `accel [g]`",
            Fault::Text(TextError::NotText) => "save it as UTF-8",
            Fault::TooLarge => "name the channels that are needed",
            _ => return None,
        };
        Some(hint.into())
    }
}

/// `1 name`, `2 names`.
fn counted(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}
