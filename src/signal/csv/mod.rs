//! Recordings as tables in text: a header of names, then a row a sample.
//!
//! Separator (comma, semicolon, tab, blanks), decimal mark, encoding, header, units and the column of time are found out
//! from the file. Lines that start with `#` are comments; those before the numbers are kept as notes. An empty cell means
//! that nothing was measured. Lines are read one by one with their place, which is why this is no work for the crate
//! `csv`: it wants the separator beforehand and does not know blanks or the columns of a line.

mod cell;
mod layout;
mod name;
mod table;

use std::io::{self, Write};
use std::path::Path;

use csv::WriterBuilder;
use thiserror::Error;

use super::measurement::{ChannelError, listed};
use super::text::{self, Line, TextError};
use super::{ReadOptions, Recording};
use cell::Separator;

pub(super) use name::ColumnName;
pub use table::{Column, Table, columns, measure};

/// Name of the time axis in our own recordings.
pub const TIME: &str = "time_s";

/// Most cells that are kept; more is a mistake or an attack.
pub const MOST_CELLS: usize = 50_000_000;

/// Why a file is no table of channels, and where.
pub type ReadError = text::ReadError<Fault>;

type Mistake = text::Mistake<Fault>;

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
    #[error("mixed units: the header says `{header}` of `{name}`, the line of units `{row}`")]
    MixedUnits { name: String, header: String, row: String },
    #[error("mixed units: the file says `{file}` of `{name}`, but `{given}` is given")]
    GivenUnit { name: String, file: String, given: String },
    #[error("time (`{name}`) cannot be in `{unit}`")]
    TimeUnit { name: String, unit: String },
    #[error("more than {MOST_CELLS} cells")]
    TooLarge,
}

impl Fault {
    /// What to write instead, where that can be said.
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

/// A mistake in the cell at `place` of a line.
fn at_cell(line: &Line, separator: Separator, place: usize, fault: Fault) -> Mistake {
    let offset = separator.cells(&line.text).nth(place).map_or(0, |cell| cell.offset);
    Mistake { line: line.number, column: line.text[..offset].chars().count() + 1, fault }
}

/// Reads the table at `path` as a recording: all its channels, called by the names of the file where they are in the SI
/// unit, and by their name with the SI unit where they were not.
pub fn read(path: &Path) -> Result<Recording, ReadError> {
    measure(path, &ReadOptions::default()).map(|measurement| measurement.recording().unwrap_or_default())
}

/// Writes `recording`, numbers in the shortest form that reads back to the same bits; times without the noise of their
/// last digits (see [`clean_time`]).
pub fn write(recording: &Recording, out: impl Write) -> io::Result<()> {
    let mut rows = WriterBuilder::new().from_writer(out);
    let names = recording.channels.iter().map(|channel| channel.name.as_str());
    rows.write_record(std::iter::once(TIME).chain(names))?;
    for (index, time) in recording.time.iter().enumerate() {
        let values = recording.channels.iter().map(|channel| channel.values[index]);
        rows.write_record(std::iter::once(clean_time(*time)).chain(values).map(cell))?;
    }
    rows.flush()
}

/// The time with twelve significant digits: 0.0573 where sums of steps give 0.057300000000000004.
pub fn clean_time(time: f64) -> f64 {
    format!("{time:.11e}").parse().unwrap_or(time)
}

fn cell(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    fn read_text(text: &str) -> Result<Recording, ReadError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.csv");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn what_is_written_reads_back_to_the_same_bits() {
        let recording = Recording {
            time: vec![0.0, 1e-4, 2e-4],
            channels: vec![
                Channel { name: "acceleration_m_s2".into(), values: vec![-9.81, 0.1 + 0.2, 1e-300] },
                Channel { name: "displacement_m".into(), values: vec![-0.0, 1.0 / 3.0, 6.02e23] },
            ],
        };
        let mut text = Vec::new();
        write(&recording, &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert!(text.starts_with("time_s,acceleration_m_s2,displacement_m\n0.0,-9.81,-0.0\n"), "{text}");
        assert_eq!(read_text(&text).unwrap(), recording);
    }

    #[test]
    fn times_have_no_noise() {
        for (time, expected) in [(0.057_300_000_000_000_004, 0.0573), (-0.0, 0.0), (1.0 / 3.0, 0.333_333_333_333)] {
            assert_eq!(clean_time(time), expected);
        }
    }

    #[test]
    fn an_empty_cell_means_not_measured() {
        let laser = read_text("# virtual\ntime_s, displacement_m\n0, \n1, 2.5\n").unwrap();
        let values = laser.channel("displacement_m").unwrap();
        assert!(values[0].is_nan());
        assert_eq!(values[1], 2.5);
    }

    #[test]
    fn every_mistake_is_refused_by_name_and_place() {
        for (text, expected) in [
            ("", "no samples"),
            ("time_s,a\n", "no samples"),
            ("a,b\n1,2\n", "r.csv:1:1: no column of time among `a`, `b`"),
            ("time_s,a,a\n0,1,2\n", "r.csv:1:10: two columns are called `a`"),
            ("time_s,a\n0,1\n1,x7\n", "r.csv:3:3: expected a number for `a`, found `x7`"),
            ("time_s,a\n0,1\n,2\n", "r.csv:3:1: the sample has no time"),
            ("time_s,a\n0,NaN\n", "r.csv:2:3: `a` is not finite"),
            ("time_s,a\n0,inf\n", "r.csv:2:3: `a` is not finite"),
            ("time_s,a\n0,1\n1,1\n1,1\n", "r.csv:4:1: time does not increase: 1 after 1"),
            ("time_s,a\n0,1\n1\n", "r.csv:3:1: expected 2 cells, found 1"),
        ] {
            let error = read_text(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?} gave: {error}");
        }
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = read(Path::new("no/such.csv")).unwrap_err().to_string();
        assert!(error.starts_with("no/such.csv: cannot be read: "), "{error}");
    }
}
