//! Recordings as comma-separated files: a header of channel names, then a row a sample.
//!
//! The column `time_s` is the time axis. Lines that start with `#` are comments. An empty cell means
//! that nothing was measured.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, WriterBuilder};
use thiserror::Error;

use super::{Channel, Recording};

/// Name of the time axis.
pub const TIME: &str = "time_s";

/// Most cells that are read; a larger file is a mistake or an attack.
pub const MOST_CELLS: usize = 50_000_000;

/// Why a file is not a recording; lines and columns (in characters) count from one.
#[derive(Debug, Error)]
pub enum ReadError {
    #[error("cannot read {}: {source}", path.display())]
    Open { path: PathBuf, source: io::Error },
    #[error("{}: {source}", path.display())]
    Malformed { path: PathBuf, source: csv::Error },
    #[error("{}: no samples", path.display())]
    Empty { path: PathBuf },
    #[error("{}:1:1: no column `{TIME}` among {}", path.display(), listed(found))]
    NoTime { path: PathBuf, found: Vec<String> },
    #[error("{}:1:1: two columns are called `{name}`", path.display())]
    Duplicate { path: PathBuf, name: String },
    #[error("{}:{line}:{column}: expected a number for `{name}`, found `{found}`", path.display())]
    NotANumber { path: PathBuf, line: u64, column: usize, name: String, found: String },
    #[error("{}:{line}:{column}: `{name}` is not finite (leave the cell empty where nothing was measured)", path.display())]
    NotFinite { path: PathBuf, line: u64, column: usize, name: String },
    #[error("{}:{line}:1: time does not increase: {time} s after {previous} s", path.display())]
    TimeNotIncreasing { path: PathBuf, line: u64, time: f64, previous: f64 },
    #[error("{}: more than {MOST_CELLS} cells", path.display())]
    TooLarge { path: PathBuf },
}

fn listed(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// Reads the recording in the file at `path`.
pub fn read(path: &Path) -> Result<Recording, ReadError> {
    let file = File::open(path).map_err(|source| ReadError::Open { path: path.into(), source })?;
    let mut rows = ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(file);
    let malformed = |source| ReadError::Malformed { path: path.into(), source };
    let header = rows.headers().map_err(malformed)?.clone();
    let mut table = Table::new(path, &header)?;
    for row in rows.records() {
        table.push(&row.map_err(malformed)?)?;
    }
    table.finish()
}

/// The columns while they are being read.
struct Table<'a> {
    path: &'a Path,
    time: usize,
    columns: Vec<Channel>,
}

impl<'a> Table<'a> {
    fn new(path: &'a Path, header: &StringRecord) -> Result<Table<'a>, ReadError> {
        let names: Vec<String> = header.iter().map(|name| name.trim_start_matches('\u{feff}').into()).collect();
        if names.iter().all(String::is_empty) {
            return Err(ReadError::Empty { path: path.into() });
        }
        if let Some(name) = first_repeated(&names) {
            return Err(ReadError::Duplicate { path: path.into(), name });
        }
        let Some(time) = names.iter().position(|name| name == TIME) else {
            return Err(ReadError::NoTime { path: path.into(), found: names });
        };
        let columns = names.into_iter().map(|name| Channel { name, values: Vec::new() }).collect();
        Ok(Table { path, time, columns })
    }

    fn push(&mut self, row: &StringRecord) -> Result<(), ReadError> {
        let line = row.position().map_or(0, csv::Position::line);
        let previous = self.columns[self.time].values.last().copied();
        for index in 0..self.columns.len() {
            let value = self.number(row, index, line)?;
            self.columns[index].values.push(value);
        }
        let samples = &self.columns[self.time].values;
        let (time, previous) = (samples[samples.len() - 1], previous.unwrap_or(f64::NEG_INFINITY));
        if time <= previous {
            let path = self.path.into();
            return Err(ReadError::TimeNotIncreasing { path, line, time, previous });
        }
        if samples.len() * self.columns.len() > MOST_CELLS {
            return Err(ReadError::TooLarge { path: self.path.into() });
        }
        Ok(())
    }

    fn number(&self, row: &StringRecord, index: usize, line: u64) -> Result<f64, ReadError> {
        let cell = row.get(index).unwrap_or("");
        if cell.is_empty() && index != self.time {
            return Ok(f64::NAN);
        }
        let (path, name) = (self.path.to_path_buf(), self.columns[index].name.clone());
        let column = 1 + (0..index).filter_map(|i| row.get(i)).map(|cell| cell.chars().count() + 1).sum::<usize>();
        let Ok(value) = cell.parse::<f64>() else {
            let found = cell.chars().take(40).collect();
            return Err(ReadError::NotANumber { path, line, column, name, found });
        };
        if !value.is_finite() {
            return Err(ReadError::NotFinite { path, line, column, name });
        }
        Ok(value)
    }

    fn finish(mut self) -> Result<Recording, ReadError> {
        let time = self.columns.remove(self.time).values;
        if time.is_empty() {
            return Err(ReadError::Empty { path: self.path.into() });
        }
        Ok(Recording { time, channels: self.columns })
    }
}

fn first_repeated(names: &[String]) -> Option<String> {
    let repeated = |(index, name): &(usize, &String)| names[..*index].contains(name);
    names.iter().enumerate().find(repeated).map(|(_, name)| name.clone())
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
            ("a,b\n1,2\n", "r.csv:1:1: no column `time_s` among `a`, `b`"),
            ("time_s,a,a\n0,1,2\n", "r.csv:1:1: two columns are called `a`"),
            ("time_s,a\n0,1\n1,x7\n", "r.csv:3:3: expected a number for `a`, found `x7`"),
            ("time_s,a\n0,1\n,2\n", "r.csv:3:1: expected a number for `time_s`, found ``"),
            ("time_s,a\n0,NaN\n", "r.csv:2:3: `a` is not finite"),
            ("time_s,a\n0,inf\n", "r.csv:2:3: `a` is not finite"),
            ("time_s,a\n0,1\n1,1\n1,1\n", "r.csv:4:1: time does not increase: 1 s after 1 s"),
            ("time_s,a\n0,1\n1\n", "found record with 1 fields"),
        ] {
            let error = read_text(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?} gave: {error}");
        }
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = read(Path::new("no/such.csv")).unwrap_err().to_string();
        assert!(error.starts_with("cannot read no/such.csv: "), "{error}");
    }
}
