//! Recordings as tables in text: a header of names, then a row a sample.
//!
//! Separator (comma, semicolon, tab, blanks), decimal mark, encoding, header, units and the column of time are
//! detected. Lines that start with `#` are comments; those before the numbers become notes. An empty cell means that
//! nothing was measured. Lines are read one by one with their place, for which the crate `csv` is not suited: it needs
//! the separator beforehand and supports neither blanks nor positions within a line.

mod cell;
mod layout;

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

use ::csv::WriterBuilder;

use crate::error::{Error, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::measurement::{MOST_VALUES, not_increasing, not_one};
use crate::signal::text::{self, Line, Lines};
use crate::signal::{
    Annotations, ChannelSelection, MeasuredChannel, Measurement, ReadOptions, Recording, Series, Warning,
};
use base::budget::Numbers;
use base::number::clean_time;
use base::units::Unit;
use cell::at_cell;
use layout::{Layout, trimmed_to};

pub use super::column_name::TIME;
pub(in crate::signal) use cell::{Mark, Separator};

/// A column of a table, which need not have a time axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Without the unit.
    pub name: String,
    /// As the file writes it.
    pub label: String,
    /// Unit that the file or the caller states.
    pub unit: Option<Unit>,
    /// SI where the unit is known, as written where it is not; `NaN` where nothing was measured.
    pub values: Vec<f64>,
}

/// Columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// In the order of the file, or in the order in which they were asked for.
    pub columns: Vec<Column>,
    /// Comments of the file, and what its reading reports.
    pub annotations: Annotations,
}

impl Table {
    /// The columns as channels over the sample number, in place of a time.
    pub fn over_samples(self) -> Measurement {
        let rows = self.columns.first().map_or(0, |column| column.values.len());
        let number: Numbers = (0..rows).map(|row| row as f64).collect();
        let channel = |Column { name, label, unit, values }: Column| {
            let series = Series::new(number.clone(), values);
            MeasuredChannel { name, label, unit, filtered: None, series }
        };
        let channels = self.columns.into_iter().map(channel).collect();
        Measurement { channels, annotations: self.annotations }
    }
}

/// Reads the columns of the table at `path` for which no time is needed, e.g. stress over strain.
///
/// Holds one line and the wanted columns: 8 bytes a value.
///
/// # Errors
/// The file is no table, a channel or a unit is missing, or a cell is no number.
pub fn columns(path: &Path, options: &ReadOptions) -> Result<Table, Error> {
    with_lines(path, |lines| {
        let mut layout = Layout::read(lines, options)?;
        let places = selected(&layout, options, None)?;
        let units = places.iter().map(|place| layout.unit(*place, options)).collect::<Result<Vec<_>, _>>()?;
        let values = Rows::new(&layout, &places, None).with_gaps(options).read(&mut layout, lines)?;
        let columns = places.iter().zip(units).zip(values).map(|((place, unit), values)| {
            let column = &layout.columns[*place];
            let values = in_si(values, unit.as_ref());
            Column { name: column.name.clone(), label: column.label.clone(), unit, values }
        });
        Ok(Table { columns: columns.collect(), annotations: layout.annotations })
    })
}

/// Reads the channels of the table at `path` over its column of time.
///
/// Holds one line, the time and the wanted columns: 8 bytes a value.
pub fn measure(path: &Path, options: &ReadOptions) -> Result<Measurement, Error> {
    with_lines(path, |lines| {
        let mut layout = Layout::read(lines, options)?;
        let time = layout.time(options)?;
        let time_unit = layout.time_unit(time, options)?;
        let places = selected(&layout, options, Some(time))?;
        let units = places.iter().map(|place| layout.unit(*place, options)).collect::<Result<Vec<_>, _>>()?;
        let wanted: Vec<usize> = std::iter::once(time).chain(places.iter().copied()).collect();
        let rows = Rows::new(&layout, &wanted, Some(time)).with_gaps(options);
        let mut values = rows.read(&mut layout, lines)?.into_iter();
        let time: Numbers = in_si(values.next().unwrap_or_default(), time_unit.as_ref()).into();
        let channels = places.iter().zip(units).zip(values).map(|((place, unit), values)| {
            let column = &layout.columns[*place];
            let series = Series::new(time.clone(), in_si(values, unit.as_ref()));
            let filtered = layout.annotations.filter_class(&column.name);
            MeasuredChannel { name: column.name.clone(), label: column.label.clone(), unit, filtered, series }
        });
        Ok(Measurement { channels: channels.collect(), annotations: layout.annotations })
    })
}

/// Reads the table at `path` as a recording: all its channels, called by the names of the file where they are in the SI
/// unit, and by their name with the SI unit where they were not.
pub fn read(path: &Path) -> Result<Recording, Error> {
    measure(path, &ReadOptions::default()).map(|measurement| measurement.recording().unwrap_or_default())
}

/// A table in lines that are no file, with its columns as they are written.
pub(in crate::signal) struct Lined {
    pub columns: Vec<ColumnName>,
    pub has_header: bool,
    pub rows: usize,
    pub annotations: Annotations,
}

impl Lined {
    /// Reads all but the values.
    pub fn read(lines: &mut Lines<impl BufRead>) -> Result<Lined, Error> {
        let layout = Layout::read(lines, &ReadOptions::default())?;
        let mut rows = layout.rows.len();
        while let Some(line) = lines.line()? {
            let text = line.text.trim_start();
            rows += usize::from(!text.is_empty() && !text.starts_with('#'));
        }
        let Layout { columns, header, annotations, .. } = layout;
        Ok(Lined { columns, has_header: header.is_some(), rows, annotations })
    }

    /// Reads the values of the columns at these places, as they are written.
    pub fn values(lines: &mut Lines<impl BufRead>, places: &[usize]) -> Result<Vec<Vec<f64>>, Error> {
        let mut layout = Layout::read(lines, &ReadOptions::default())?;
        Rows::new(&layout, places, None).read(&mut layout, lines)
    }
}

/// Opens the file and adds its path to every mistake.
fn with_lines<T>(path: &Path, read: impl FnOnce(&mut Lines<BufReader<File>>) -> Result<T, Error>) -> Result<T, Error> {
    text::open(path).and_then(|mut lines| read(&mut lines)).map_err(|error| error.in_file(path))
}

/// Places of the wanted columns; the time is none of them unless it is asked for by name.
fn selected(layout: &Layout, options: &ReadOptions, time: Option<usize>) -> Result<Vec<usize>, Error> {
    let all: Vec<usize> = (0..layout.columns.len()).filter(|place| Some(*place) != time).collect();
    let names = || all.iter().map(|place| layout.columns[*place].label.clone()).collect::<Vec<_>>();
    match &options.channels {
        _ if all.is_empty() => Err(layout.at_header(refusal!("no channel beside the time"))),
        ChannelSelection::All => Ok(all),
        ChannelSelection::Named(names) => names.iter().map(|name| layout.find(name)).collect(),
        ChannelSelection::Only if all.len() == 1 => Ok(all),
        ChannelSelection::Only => Err(layout.at_header(not_one(&names(), "NAME"))),
    }
}

fn in_si(mut values: Vec<f64>, unit: Option<&Unit>) -> Vec<f64> {
    if let Some(unit) = unit.filter(|unit| !unit.is_si()) {
        values.iter_mut().for_each(|value| *value = unit.to_si(*value));
    }
    values
}

/// The columns while they are being read.
struct Rows {
    /// For every column of the file the places of its values; none where they are not stored.
    slots: Vec<Vec<usize>>,
    values: Vec<Vec<f64>>,
    /// Place of the time among the columns of the file, where time is needed.
    time: Option<usize>,
    latest: f64,
    mark: Mark,
    gaps: &'static [&'static str],
}

impl Rows {
    fn new(layout: &Layout, wanted: &[usize], time: Option<usize>) -> Rows {
        let mut slots = vec![Vec::new(); layout.columns.len()];
        wanted.iter().enumerate().for_each(|(slot, place)| slots[*place].push(slot));
        Rows {
            slots,
            values: vec![Vec::new(); wanted.len()],
            time,
            latest: f64::NEG_INFINITY,
            mark: Mark::between(layout.separator),
            gaps: &[],
        }
    }

    /// The rows with the words for gaps of `options`.
    fn with_gaps(self, options: &ReadOptions) -> Rows {
        Rows { gaps: options.gaps, ..self }
    }

    fn read(mut self, layout: &mut Layout, lines: &mut Lines<impl BufRead>) -> Result<Vec<Vec<f64>>, Error> {
        while let Some(line) = layout.rows.pop_front() {
            self.push(&line, layout)?;
        }
        let [mut comments, mut blanks, mut ending] = [Passed::default(); 3];
        while let Some(line) = lines.line()? {
            let text = line.text.trim_start();
            if text.starts_with('#') {
                comments.join(Passed { first: line.number, count: 1 });
            } else if text.is_empty() {
                ending.join(Passed { first: line.number, count: 1 });
            } else {
                blanks.join(std::mem::take(&mut ending));
                self.push(&line, layout)?;
            }
        }
        let warnings = &mut layout.annotations.warnings;
        warnings.extend(comments.any().map(|[count, first]| Warning::SkippedComments { count, first }));
        warnings.extend(blanks.any().map(|[count, first]| Warning::SkippedBlanks { count, first }));
        Ok(self.values)
    }

    fn push(&mut self, line: &Line, layout: &Layout) -> Result<(), Error> {
        self.check_end(line, layout)?;
        let mut found = 0;
        for (place, cell) in layout.separator.cells(&line.text).enumerate() {
            found += 1;
            let Some(slots) = self.slots.get(place).filter(|slots| !slots.is_empty()) else { continue };
            let at = |error| at_cell(line, layout.separator, place, error);
            let name = &layout.columns[place].name;
            let value = match cell.text.as_ref() {
                "" => f64::NAN,
                text if self.gaps.iter().any(|gap| text.eq_ignore_ascii_case(gap)) => f64::NAN,
                text => self.mark.number(text, name).map_err(at)?,
            };
            if self.time == Some(place) {
                self.latest = later(value, self.latest).map_err(at)?;
            }
            for slot in slots {
                self.values[*slot].push(value);
            }
        }
        let expected = self.slots.len();
        if found != expected && trimmed_to(layout.separator.cells(&line.text), expected).count() != expected {
            return Err(refusal!("expected {expected} cells, found {found}").at(line.number, 1));
        }
        let rows = self.values.first().map_or(0, Vec::len);
        if rows * self.values.len() > MOST_VALUES {
            let error = refusal!("more than {MOST_VALUES} cells").with_hint("name the channels that are needed");
            return Err(error.at(line.number, 1));
        }
        Ok(())
    }

    /// A last line without end and with too few cells was cut off, within its last cell or before the next: what is
    /// wrong with its numbers follows from that.
    fn check_end(&self, line: &Line, layout: &Layout) -> Result<(), Error> {
        let expected = self.slots.len();
        if line.ended {
            return Ok(());
        }
        let found = layout.separator.cells(&line.text).count();
        if found >= expected {
            return Ok(());
        }
        Err(refusal!("the file is truncated: its last line has {found} of {expected} cells").at(line.number, 1))
    }
}

/// Comments or blank lines among the rows.
#[derive(Clone, Copy, Default)]
struct Passed {
    first: usize,
    count: usize,
}

impl Passed {
    fn join(&mut self, later: Passed) {
        if self.count == 0 {
            self.first = later.first;
        }
        self.count += later.count;
    }

    /// Their number and the first, where there is one.
    fn any(self) -> Option<[usize; 2]> {
        (self.count > 0).then_some([self.count, self.first])
    }
}

/// `time`, if it comes after `previous`.
fn later(time: f64, previous: f64) -> Result<f64, Error> {
    if time.is_nan() {
        return Err(refusal!("the sample has no time"));
    }
    if time > previous { Ok(time) } else { Err(not_increasing(time, previous)) }
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

fn cell(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    #[test]
    fn comments_and_blank_lines_among_rows_have_a_warning() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.csv");
        for (text, expected) in [
            ("time_s,a\n0,1\n1,2\n\n\n", &[][..]),
            ("time_s,a\n0,1\n\n\n1,2\n\n3,4\n\n", &["are blank are left out: 3, the first is line 3"]),
            ("time_s,a\n0,1\n#1,2\n2,3\n# end\n", &["start with `#` are left out: 2, the first is line 3"]),
        ] {
            std::fs::write(&path, text).unwrap();
            let notes = measure(&path, &ReadOptions::default()).unwrap().annotations.notes();
            assert_eq!(notes.len(), expected.len(), "{notes:?}");
            assert!(notes.iter().zip(expected).all(|(note, expected)| note.ends_with(expected)), "{notes:?}");
        }
    }

    fn read_text(text: &str) -> Result<Recording, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.csv");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn a_written_recording_reads_back_to_the_same_bits() {
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
}
