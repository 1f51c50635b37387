//! Recordings as tables in text: a header of names, then a row a sample.
//!
//! Separator (comma, semicolon, tab, blanks), decimal mark, encoding, header, units and the column of time are
//! detected. Lines that start with `#` are comments; those before the numbers become notes. An empty cell means that
//! nothing was measured. Lines are read one by one with their place, for which the crate `csv` is not suited: it needs
//! the separator beforehand and supports neither blanks nor positions within a line.

mod cell;
mod layout;

use std::io::{self, BufRead, Write};
use std::path::Path;
use std::rc::Rc;

use ::csv::WriterBuilder;

use crate::error::{Error, refusal};
use crate::signal::catalogue::{Axis, Catalogue, Entry, Loaded, Reader, Subject, Terms};
use crate::signal::column_name::ColumnName;
use crate::signal::measurement::{MOST_VALUES, is_gap, not_increasing};
use crate::signal::text::{self, Line, Lines};
use crate::signal::{Annotations, ReadOptions, Recording, Warning};
use base::number::clean_time;
use cell::at_cell;
use layout::{Layout, trimmed_to};

pub use super::column_name::TIME;
pub(in crate::signal) use cell::{Mark, Separator};

/// A table in text whose columns are listed.
pub struct TextTable<R> {
    lines: Lines<R>,
    layout: Layout,
    /// Its columns, until they are listed elsewhere.
    pub entries: Vec<Entry>,
    /// Its comments, and what its reading reports until then.
    pub annotations: Annotations,
    gaps: &'static [&'static str],
    loaded: Loaded,
}

impl<R: BufRead> TextTable<R> {
    /// Reads the `lines` of a table up to its first row. Its rows are read once, one line after the other.
    pub fn new(mut lines: Lines<R>, options: &ReadOptions) -> Result<TextTable<R>, Error> {
        let (layout, annotations) = Layout::read(&mut lines, options)?;
        let time = layout.time(options).map_err(Rc::new);
        let entry = |column: &ColumnName| Entry {
            axis: time.clone().map_or_else(Axis::Refused, Axis::Channel),
            ..Entry::from_column("", column.clone())
        };
        let entries = layout.columns.iter().map(entry).collect();
        Ok(TextTable { lines, layout, entries, annotations, gaps: options.gaps, loaded: Loaded::default() })
    }

    /// Whether it has a line of names.
    pub fn has_header(&self) -> bool {
        self.layout.header.is_some()
    }

    /// The values of these columns, in one pass; those of the `time` must increase.
    pub fn read_columns(
        &mut self,
        places: &[usize],
        time: Option<usize>,
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<Vec<f64>>, Error> {
        Rows::new(&self.layout, places, time, self.gaps).read(&mut self.layout, &mut self.lines, warnings)
    }

    /// Number of rows, which are read for it.
    pub fn count_rows(mut self) -> Result<usize, Error> {
        let mut rows = self.layout.rows.len();
        while let Some(line) = self.lines.line()? {
            let text = line.text.trim_start();
            rows += usize::from(!text.is_empty() && !text.starts_with('#'));
        }
        Ok(rows)
    }
}

/// Lists the columns of the table at `path`.
pub fn open(path: &Path, options: &ReadOptions) -> Result<Catalogue, Error> {
    let mut table = TextTable::new(text::open(path)?, options)?;
    let (entries, annotations) = (std::mem::take(&mut table.entries), std::mem::take(&mut table.annotations));
    Ok(Catalogue::new(entries, annotations, table))
}

impl<R: BufRead> Reader for TextTable<R> {
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        Ok(self.loaded.take(place))
    }

    fn load(&mut self, channels: &[usize], times: &[usize], warnings: &mut Vec<Warning>) -> Result<(), Error> {
        let wanted = [channels, times].concat();
        let values = self.read_columns(&wanted, times.first().copied(), warnings)?;
        wanted.into_iter().zip(values).for_each(|(place, values)| self.loaded.insert(place, values));
        Ok(())
    }

    fn locate(&self, subject: Subject, error: Error) -> Error {
        match subject {
            Subject::List => self.layout.at_header(error),
            Subject::Unit(place) | Subject::Times(place) => self.layout.at_column(place, error),
            Subject::Sample(..) => error,
        }
    }

    fn terms(&self) -> Terms {
        Terms { channel: "NAME", none: "no channel beside the time", is_table: true }
    }
}

/// Reads the table at `path` as a recording: all its channels, called by the names of the file where they are in the SI
/// unit, and by their name with the SI unit where they were not.
pub fn read(path: &Path) -> Result<Recording, Error> {
    let options = ReadOptions::default();
    let measurement = open(path, &options).and_then(|table| table.measure(&options));
    measurement.map(|found| found.recording().unwrap_or_default()).map_err(|error| error.in_file(path))
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
    fn new(layout: &Layout, wanted: &[usize], time: Option<usize>, gaps: &'static [&'static str]) -> Rows {
        let mut slots = vec![Vec::new(); layout.columns.len()];
        wanted.iter().enumerate().for_each(|(slot, place)| slots[*place].push(slot));
        Rows {
            slots,
            values: vec![Vec::new(); wanted.len()],
            time,
            latest: f64::NEG_INFINITY,
            mark: Mark::between(layout.separator),
            gaps,
        }
    }

    fn read(
        mut self,
        layout: &mut Layout,
        lines: &mut Lines<impl BufRead>,
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<Vec<f64>>, Error> {
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
                text if is_gap(text, self.gaps) => f64::NAN,
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
/// last digits (see [`clean_time`]), where steps keep theirs.
pub fn write(recording: &Recording, out: impl Write) -> io::Result<()> {
    let mut rows = WriterBuilder::new().from_writer(out);
    let names = recording.channels.iter().map(|channel| channel.name.as_str());
    rows.write_record(std::iter::once(TIME).chain(names))?;
    let clean: Vec<f64> = recording.time.iter().copied().map(clean_time).collect();
    // Of a clock that counts from 1970 the last digits are no noise.
    let step = |pair: &[f64]| pair[1] - pair[0];
    let mut steps = recording.time.windows(2).map(step).zip(clean.windows(2).map(step));
    let is_kept = steps.all(|(step, clean)| (clean - step).abs() <= 1e-3 * step);
    let times = if is_kept { &clean } else { &recording.time };
    for (index, time) in times.iter().enumerate() {
        let values = recording.channels.iter().map(|channel| channel.values[index]);
        rows.write_record(std::iter::once(*time).chain(values).map(cell))?;
    }
    rows.flush()
}

fn cell(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Kind;
    use crate::signal::{Channel, file};

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
            let notes = file::read(&path, &ReadOptions::default()).unwrap().annotations.notes();
            assert_eq!(notes.len(), expected.len(), "{notes:?}");
            assert!(notes.iter().zip(expected).all(|(note, expected)| note.ends_with(expected)), "{notes:?}");
        }
    }

    /// A refusal that names all columns, once for each of them, would take gigabytes.
    #[test]
    fn a_wide_table_without_a_time_is_refused_once() {
        let header: String = (0..100_000).map(|place| format!("a{place},")).collect();
        let error = read_text(&format!("{header}b\n{}1\n", "1,".repeat(100_000))).unwrap_err();
        assert_eq!(*error.kind(), Kind::NoTime);
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

    #[test]
    fn written_times_lose_their_noise_and_nothing_else() {
        for (time, expected) in [
            (&[0.057, 0.057_300_000_000_000_004][..], "0.057,0.0573"),
            (&[1.7e9, 1.7e9 + 1e-3], "1700000000.0,1700000000.001"),
        ] {
            let mut text = Vec::new();
            write(&Recording { time: time.to_vec(), channels: vec![] }, &mut text).unwrap();
            assert_eq!(String::from_utf8(text).unwrap(), format!("time_s,{expected},").replace(',', "\n"));
        }
    }
}
