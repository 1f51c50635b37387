//! Writing a whole container: a test with its folder `Channel`, or both in a zip archive.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufWriter, Cursor, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::container::Headers;
use super::header::{Entry, Header};
use crate::signal::channel_code::ChannelCode;
use crate::signal::{MeasuredChannel, Measurement, Series, resample};
use base::diagnostic::folder_of;
use base::number::clean_time;
use base::scratch::ScratchFolder;
use base::units::Time;

/// Why a container was not written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The path has no file name.
    #[error("{} has no name to call the files by", path.display())]
    NoName {
        /// Path of the container, `<test>.mme`.
        path: PathBuf,
    },
    /// A file of the container exists.
    #[error("{} already exists", path.display())]
    Exists {
        /// The file or folder.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A channel has no samples.
    #[error("`{name}` has no samples")]
    Empty {
        /// Name of the channel.
        name: String,
    },
    /// More channels than numbers of files.
    #[error("{count} channels, more than the {MOST_CHANNELS} that can be counted")]
    TooMany {
        /// Number of channels without those of time axes.
        count: usize,
    },
}

/// Most channels: their numbers and those of their time axes have four digits.
const MOST_CHANNELS: usize = 4_999;

/// Width of the keys.
const KEY: usize = 28;

/// Writes `measurement` as the test at `path` (`<test>.mme`) with its folder `Channel`, in SI units.
///
/// The files are written under other names and renamed when they are complete, the test last: without it there is no
/// container. Numbers are in the shortest form that reads back to the same bits. The time is implicit where its steps
/// are equal, or else a channel of its own. Channels keep their names where those are codes; others get a code that
/// counts.
///
/// # Errors
/// Nothing that exists is replaced.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), WriteError> {
    rewrite(path, measurement, &Headers::default())
}

/// Writes `measurement` as [`write()`] does, with the `headers` of the container that it was read from, in
/// their order, except for the entries that the SI units and the samples determine.
pub fn rewrite(path: &Path, measurement: &Measurement, headers: &Headers) -> Result<(), WriteError> {
    let texts = Texts::from_measurement(path, measurement, headers)?;
    let folder = folder_of(path);
    let channels = folder.join(CHANNELS);
    for place in [path, &channels] {
        if place.exists() {
            return Err(WriteError::Exists { path: place.into() });
        }
    }
    let failed = |source| WriteError::Write { path: path.into(), source };
    lay_down(path, folder, &channels, &texts).map_err(failed)
}

/// The bytes of a zip archive with `measurement` as [`rewrite`] writes it, in a folder of the archive's name; `path` is that
/// of the archive, and is not written.
///
/// Equal measurements give equal bytes: files have the earliest time of the format.
pub fn zipped(path: &Path, measurement: &Measurement, headers: &Headers) -> Result<Vec<u8>, WriteError> {
    let texts = Texts::from_measurement(path, measurement, headers)?;
    packed(&texts).map_err(|source| WriteError::Write { path: path.into(), source })
}

/// Folder of the channel files.
const CHANNELS: &str = "Channel";

/// The files of a container.
struct Texts<'a> {
    stem: String,
    test: Vec<Pair>,
    list: Vec<Pair>,
    sheets: Vec<Sheet<'a>>,
}

impl<'a> Texts<'a> {
    /// Files of a container called as the file at `path`.
    fn from_measurement(
        path: &Path,
        measurement: &'a Measurement,
        headers: &'a Headers,
    ) -> Result<Texts<'a>, WriteError> {
        let stem = path.file_stem().filter(|stem| !stem.is_empty());
        let stem = stem.ok_or_else(|| WriteError::NoName { path: path.into() })?.to_string_lossy().into_owned();
        if let Some(channel) = measurement.channels.iter().find(|channel| channel.series.is_empty()) {
            return Err(WriteError::Empty { name: channel.name.clone() });
        }
        let count = measurement.channels.len();
        if count > MOST_CHANNELS {
            return Err(WriteError::TooMany { count });
        }
        let test = test_lines(&headers.test, &stem, measurement.annotations.comments());
        Ok(Texts { stem, test, list: list_head(&headers.list), sheets: sheets(measurement, headers) })
    }

    /// Gives the path of each file and how its text is written to `file`, the test last.
    fn each(
        &self,
        mut file: impl FnMut(&str, &dyn Fn(&mut dyn Write) -> io::Result<()>) -> io::Result<()>,
    ) -> io::Result<()> {
        let Texts { stem, test, list, sheets } = self;
        for (number, sheet) in (1..).zip(sheets) {
            file(&format!("{CHANNELS}/{stem}.{number:03}"), &|out| sheet.write(out))?;
        }
        file(&format!("{CHANNELS}/{stem}.chn"), &|out| write_list(out, list, sheets))?;
        file(&format!("{stem}.mme"), &|out| write_pairs(out, test))
    }
}

fn lay_down(path: &Path, folder: &Path, channels: &Path, texts: &Texts) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let draft = ScratchFolder::new(folder)?;
    fs::create_dir(draft.path().join(CHANNELS))?;
    let mut last = PathBuf::new();
    texts.each(|name, write| {
        last = draft.path().join(name);
        let mut out = BufWriter::new(fs::File::create_new(&last)?);
        write(&mut out)?;
        out.flush()
    })?;
    fs::rename(draft.path().join(CHANNELS), channels)?;
    fs::rename(&last, path).inspect_err(|_| {
        // What is left without its test is no container; that it cannot be removed either adds nothing.
        let _ = fs::remove_dir_all(channels);
    })
}

fn packed(texts: &Texts) -> io::Result<Vec<u8>> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    texts.each(|name, write| {
        archive.start_file(format!("{}/{name}", texts.stem), options)?;
        let mut out = BufWriter::new(&mut archive);
        write(&mut out)?;
        out.flush()
    })?;
    Ok(archive.finish()?.into_inner())
}

/// One channel file.
struct Sheet<'a> {
    code: ChannelCode,
    /// Of the channel that it comes from.
    header: Option<&'a Header>,
    /// Whether the values are in another unit than that of the header.
    converted: bool,
    label: String,
    unit: Option<String>,
    class: Option<f64>,
    axis: Axis,
    time: &'a [f64],
    values: &'a [f64],
}

/// How the times of a channel are written.
enum Axis {
    /// First sample and interval, s.
    Implicit([f64; 2]),
    Explicit(ChannelCode),
    /// The channel is a time axis.
    Itself,
}

/// The channels, and the time axes of those whose steps differ, each once and before its first channel.
fn sheets<'a>(measurement: &'a Measurement, headers: &'a Headers) -> Vec<Sheet<'a>> {
    let codes = codes(&measurement.channels);
    let (mut sheets, mut axes): (Vec<Sheet>, Vec<(&[f64], ChannelCode)>) = (Vec::new(), Vec::new());
    for (channel, code) in measurement.channels.iter().zip(codes) {
        let time = channel.series.time();
        let axis = match even(time) {
            Some(even) => Axis::Implicit(even),
            None => {
                let known = axes.iter().find(|(axis, _)| *axis == time).map(|(_, code)| code.clone());
                Axis::Explicit(known.unwrap_or_else(|| {
                    let sheet = time_sheet(time, axes.len() + 1);
                    let code = sheet.code.clone();
                    sheets.push(sheet);
                    axes.push((time, code.clone()));
                    code
                }))
            }
        };
        let (header, label) = (headers.find(channel), long_name(channel, measurement));
        let converted = channel.unit.as_ref().is_some_and(|unit| !unit.is_si());
        let (unit, class, values) = (channel.value_unit(), channel.filtered, channel.series.values());
        sheets.push(Sheet { code, header, converted, label, unit, class, axis, time, values });
    }
    sheets
}

/// Name of a channel: as a comment of the table states, or without the unit that a table writes behind the name,
/// where no other channel has that name.
fn long_name(channel: &MeasuredChannel, measurement: &Measurement) -> String {
    let MeasuredChannel { name, label, .. } = channel;
    if let Some(stated) = measurement.annotations.long_name(name) {
        return stated.to_owned();
    }
    let alone = measurement.channels.iter().filter(|other| other.name == *name).count() == 1;
    let is_short = channel.unit.is_some() && label.starts_with(name.as_str()) && ChannelCode::parse(name).is_none();
    if alone && is_short { name.clone() } else { label.clone() }
}

fn time_sheet(time: &[f64], number: usize) -> Sheet<'_> {
    let unit = Some(Time::DIMENSION.unit.to_owned());
    let code = ChannelCode::time_axis(number);
    let (header, converted, label) = (None, false, "time".into());
    Sheet { code, header, converted, label, unit, class: None, axis: Axis::Itself, time, values: time }
}

/// The names of the channels where they are codes, each once; codes that count for the others.
fn codes(channels: &[MeasuredChannel]) -> Vec<ChannelCode> {
    let own = |channel: &MeasuredChannel| ChannelCode::parse(&channel.name).filter(|code| !code.is_time());
    let mut taken: BTreeSet<String> = channels.iter().filter_map(own).map(|code| code.to_string()).collect();
    let mut used = BTreeSet::new();
    let mut code = |(number, channel): (usize, &MeasuredChannel)| {
        if let Some(code) = own(channel).filter(|code| used.insert(code.to_string())) {
            return code;
        }
        let mut number = number;
        loop {
            let code = ChannelCode::counted(number, channel.unit.as_ref(), channel.filtered);
            if taken.insert(code.to_string()) {
                return code;
            }
            number += 1;
        }
    };
    (1..).zip(channels).map(&mut code).collect()
}

/// First sample and interval, if the times are `first + i·interval` to a millionth of the interval.
fn even(time: &[f64]) -> Option<[f64; 2]> {
    let first = *time.first()?;
    let interval = clean_time(resample::common_step(time)?);
    let close = |(sample, at): (usize, &f64)| (first + sample as f64 * interval - at).abs() <= 1e-6 * interval;
    time.iter().enumerate().all(close).then_some([first, interval])
}

/// A line of a header.
type Pair = (String, String);

/// Entries in the unit of the recording, which are wrong after a conversion.
const IN_THE_UNIT: [&str; 3] = ["channel amplitude class", "offset pre test", "offset post test"];

impl Sheet<'_> {
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        write_pairs(out, &self.lines())?;
        self.values.iter().try_for_each(|value| write!(out, "{}\r\n", number(*value)))
    }

    /// The lines of the original header, with the entries that the data determine replaced; then the entries that it
    /// does not have.
    fn lines(&self) -> Vec<Pair> {
        let (mut decided, mut otherwise) = (self.decided(), self.otherwise());
        let mut lines = Vec::new();
        for entry in self.header.map_or(&[][..], Header::entries) {
            let is_it = |pair: &Pair| pair.0.eq_ignore_ascii_case(&entry.key);
            if DECIDED.iter().any(|key| key.eq_ignore_ascii_case(&entry.key)) {
                lines.extend(decided.iter().position(is_it).map(|place| decided.remove(place)));
            } else if !(self.converted && IN_THE_UNIT.contains(&entry.key.to_lowercase().as_str())) {
                otherwise.retain(|pair| !is_it(pair));
                lines.push(again(entry));
            }
        }
        let unit = |pair: &Pair| pair.0 == UNIT && self.unit.is_none();
        let stated = self.header.and_then(|header| header.text(UNIT));
        decided.extend(otherwise);
        lines.extend(decided);
        // A unit that is not known is that of the values still.
        if let (Some(stated), Some(place)) = (stated, lines.iter().position(unit)) {
            lines[place].1 = stated.to_owned();
        }
        lines
    }

    /// The entries that samples, times and the SI unit determine.
    fn decided(&self) -> Vec<Pair> {
        let mut lines = vec![pair("Channel code", self.code.to_string()), pair("Name of the channel", &self.label)];
        lines.extend(match &self.axis {
            Axis::Implicit([first, interval]) => vec![
                pair("Reference channel", "implicit"),
                pair("Reference channel name", NOTHING),
                pair("Time of first sample", number(*first)),
                pair("Sampling interval", number(*interval)),
            ],
            Axis::Explicit(axis) => {
                vec![pair("Reference channel", "explicit"), pair("Reference channel name", axis.to_string())]
            }
            Axis::Itself => Vec::new(),
        });
        lines.push(pair(UNIT, self.unit.as_deref().unwrap_or(NOTHING)));
        lines.push(pair("Number of samples", self.values.len().to_string()));
        lines.extend(self.extremes());
        lines
    }

    /// Entries for what the header does not state.
    fn otherwise(&self) -> Vec<Pair> {
        let class = self.class.map_or(NOTHING.to_owned(), |class| class.to_string());
        vec![
            pair("Dimension", self.code.dimension()),
            pair("Direction", self.code.direction()),
            pair("Channel frequency class", class),
            pair("Data status", "ok"),
        ]
    }

    /// The extremes, with which a reader checks the samples.
    fn extremes(&self) -> Vec<Pair> {
        let series = Series::new(self.time, self.values);
        let extremes = [("maximum", series.largest()), ("minimum", series.smallest())];
        let lines = extremes.into_iter().flat_map(|(word, extreme)| {
            let [time, value] = extreme.unwrap_or([f64::NAN; 2]);
            [
                pair(&format!("First global {word} value"), number(value)),
                pair(&format!("Time of {word} value"), number(time)),
            ]
        });
        lines.collect()
    }
}

const NOTHING: &str = "NOVALUE";

const UNIT: &str = "Unit";

/// Entries that are written from the data, whatever the header stated.
const DECIDED: [&str; 12] = [
    "Channel code",
    "Name of the channel",
    "Reference channel",
    "Reference channel name",
    "Time of first sample",
    "Sampling interval",
    UNIT,
    "Number of samples",
    "First global maximum value",
    "Time of maximum value",
    "First global minimum value",
    "Time of minimum value",
];

fn pair(key: &str, value: impl Into<String>) -> Pair {
    (key.to_owned(), value.into())
}

/// The line of a header, as it was.
fn again(entry: &Entry) -> Pair {
    pair(&entry.key, entry.value.as_deref().unwrap_or(NOTHING))
}

/// The entries of the test, or else entries without values; then the comments that it does not contain yet.
fn test_lines(test: &Header, stem: &str, comments: &[String]) -> Vec<Pair> {
    let mut lines: Vec<Pair> = test.entries().iter().map(again).collect();
    if lines.is_empty() {
        lines.push(pair("Data format edition number", "1.6"));
        let unknown = ["Laboratory name", "Customer name", "Test date", "Type of the test"];
        lines.extend(unknown.map(|key| pair(key, NOTHING)));
    }
    if test.text("Test number").is_none() {
        lines.retain(|(key, _)| !key.eq_ignore_ascii_case("Test number"));
        lines.push(pair("Test number", stem));
    }
    let comment = |remark: &&String| test.entries().iter().all(|entry| entry.value.as_ref() != Some(*remark));
    lines.extend(comments.iter().filter(comment).map(|remark| pair("Comments", remark)));
    lines
}

/// The head of the list of channels.
fn list_head(list: &Header) -> Vec<Pair> {
    let counts = |key: &str| key == "number of channels" || key.starts_with("name of channel");
    let others = list.entries().iter().filter(|entry| !counts(&entry.key.to_lowercase()));
    let lines: Vec<Pair> = others.map(again).collect();
    if lines.is_empty() { vec![pair("Instrumentation standard", NOTHING)] } else { lines }
}

fn write_list(out: &mut dyn Write, head: &[Pair], sheets: &[Sheet]) -> io::Result<()> {
    write_pairs(out, head)?;
    let names = (1..).zip(sheets).map(|(number, sheet)| {
        pair(&format!("Name of channel {number:03}"), format!("{} / {}", sheet.code, sheet.label))
    });
    let count = pair("Number of channels", sheets.len().to_string());
    write_pairs(out, &std::iter::once(count).chain(names).collect::<Vec<_>>())
}

/// Lines of a header; what would end a line is a blank.
fn write_pairs(out: &mut dyn Write, pairs: &[Pair]) -> io::Result<()> {
    pairs.iter().try_for_each(|(key, value)| write!(out, "{key:KEY$}:{}\r\n", value.replace(char::is_control, " ")))
}

fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:E}") } else { NOTHING.into() }
}
