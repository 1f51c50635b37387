//! Faults in a table, and where they are.

use thiserror::Error;

use crate::signal::channel_fault::{ChannelFault, MOST_VALUES};
use crate::signal::text::{self, TextError};
use base::diagnostic::listed;

/// Why a file is no table of channels, and where.
pub type ReadError = text::ReadError<Fault>;

pub(super) type Mistake = text::Mistake<Fault>;

/// A fault of a table.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read as text.
    #[error(transparent)]
    Text(#[from] TextError),
    /// A fault of a channel that files of every format can have.
    #[error(transparent)]
    Channel(#[from] ChannelFault),
    /// The file is empty.
    #[error("no samples: the file is empty")]
    Empty,
    /// There is a header and no row of numbers.
    #[error("no samples: no line below the header starts with a number")]
    NoRows,
    /// The header is longer than any that is read.
    #[error("no samples: none of the first {lines} lines starts with a number")]
    NoNumbers {
        /// Lines that were read.
        lines: usize,
    },
    /// The header does not have a name for each column.
    #[error("{} ({}) over {}", counted(names.len(), "name"), listed(names), counted(*columns, "column"))]
    NamesAndColumns {
        /// Names in the header.
        names: Vec<String>,
        /// Columns of the first row.
        columns: usize,
    },
    /// No column is named like a time.
    #[error("no column of time among {}", listed(found))]
    NoTime {
        /// The columns.
        found: Vec<String>,
    },
    /// Several columns are named like a time.
    #[error("several columns of time among {}", listed(found))]
    SeveralTimes {
        /// The columns.
        found: Vec<String>,
    },
    /// The header leaves a name empty.
    #[error("column {column} has no name")]
    Unnamed {
        /// Counted from one.
        column: usize,
    },
    /// Two columns have the same name and unit.
    #[error("two columns are called `{name}`")]
    Duplicate {
        /// Their name.
        name: String,
    },
    /// Time is the only column.
    #[error("no channel beside the time")]
    NoChannel,
    /// A unit stands in the cell of a number.
    #[error("expected a number for `{name}`, found `{found}`, which carries a unit of its own")]
    UnitInCell {
        /// The column.
        name: String,
        /// The cell.
        found: String,
    },
    /// Some numbers have a decimal point, others a decimal comma.
    #[error("decimal point and decimal comma in one file: `{found}` for `{name}`")]
    MixedMarks {
        /// The column.
        name: String,
        /// The cell.
        found: String,
    },
    /// The cell of the time is empty.
    #[error("the sample has no time")]
    NoTimeValue,
    /// A row has fewer or more cells than the header.
    #[error("expected {expected} cells, found {found}")]
    RowLength {
        /// Cells of the header.
        expected: usize,
        /// Cells of the row.
        found: usize,
    },
    /// The last line has no end and too few cells.
    #[error("the file is truncated: its last line has {found} of {expected} cells")]
    Truncated {
        /// Cells of the header.
        expected: usize,
        /// Cells of the last line.
        found: usize,
    },
    /// Header and line of units disagree.
    #[error("mixed units: the header states `{header}` of `{name}`, the line of units `{row}`")]
    MixedUnits {
        /// The column.
        name: String,
        /// Its unit in the header.
        header: String,
        /// Its unit in the line below.
        row: String,
    },
    /// The wanted columns have more than [`MOST_VALUES`] cells.
    #[error("more than {MOST_VALUES} cells")]
    TooLarge,
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            Fault::Channel(ChannelFault::Name(error)) => return error.hint(),
            Fault::Channel(ChannelFault::NotOne { .. }) => "name the channel: --column NAME",
            Fault::Channel(ChannelFault::NotFinite { .. }) => "leave the cell empty where nothing was measured",
            Fault::NamesAndColumns { .. } => "give the names of the columns: --columns time,a,b",
            Fault::NoTime { .. } | Fault::SeveralTimes { .. } => "name the column of time: --time NAME",
            Fault::Duplicate { .. } => {
                "rename one; several specimens side by side are read by `droptower reduce coupon`"
            }
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
