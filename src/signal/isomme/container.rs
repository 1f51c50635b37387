//! The files of a container, and the measurement in them.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::channel::{ChannelHead, read_header};
use super::header::Header;
use super::{Fault, Mistake, ReadError};
use crate::diagnostic::folder_of;
use crate::signal::measurement::find;
use crate::signal::text::TextError;
use crate::signal::{ChannelSelection, MeasuredChannel, Measurement, ReadOptions, Series};
use crate::units::Unit;

/// Reads the channels of the container that the file or folder at `path` belongs to; of a channel file that one alone.
///
/// Holds all headers and the wanted channels: 8 bytes a value, and as much again for one channel while it is finished.
///
/// Where a header does not say how its time is given, an implicit time axis is assumed, and a note says so.
pub fn measure(path: &Path, options: &ReadOptions) -> Result<Measurement, ReadError> {
    let failed = |fault| Mistake::whole(fault).of(path);
    if options.time.is_some() || !options.names.is_empty() {
        return Err(failed(Fault::NoTable));
    }
    let Container { heads, single, mut notes, comments } = Container::open(path)?;
    let places = selected(&heads, single, options).map_err(failed)?;
    let mut axes = Axes { heads: &heads, known: BTreeMap::new() };
    let mut channels = Vec::new();
    for place in places {
        channels.push(measured(&heads[place], &mut axes, options, &mut notes)?);
    }
    Ok(Measurement { channels, notes, comments })
}

/// What the files of a container say in their headers, to be said again when it is written anew.
#[derive(Clone, Debug, Default)]
pub struct Headers {
    /// Of the test; empty where there is none.
    pub test: Header,
    /// Of the list of channels; empty where there is none.
    pub list: Header,
    channels: Vec<ChannelHead>,
}

impl Headers {
    /// Reads the headers of the container that the file or folder at `path` belongs to.
    pub fn read(path: &Path) -> Result<Headers, ReadError> {
        let files = Files::locate(path)?;
        // What is odd about them was noted when the recording was read.
        let read = |file: Option<PathBuf>| {
            file.map_or_else(|| Ok(Header::default()), |file| read_header(&file, &mut Vec::new()))
        };
        let channels = Container::open(path)?.heads;
        Ok(Headers { test: read(files.test)?, list: read(files.list)?, channels })
    }

    /// The header that `channel` was read with; none where it is of another container.
    pub fn of(&self, channel: &MeasuredChannel) -> Option<&Header> {
        let named = || self.channels.iter().filter(|head| head.name == channel.name);
        let head = named().find(|head| head.label == channel.label).or_else(|| named().next());
        head.map(|head| &head.header)
    }
}

/// A container of which only the headers were read.
struct Container {
    heads: Vec<ChannelHead>,
    /// The one channel that was named, where a channel file was.
    single: Option<usize>,
    notes: Vec<String>,
    /// Those of the notes that the test says.
    comments: Vec<String>,
}

impl Container {
    fn open(path: &Path) -> Result<Container, ReadError> {
        let files = Files::locate(path)?;
        let named = number(path);
        let mut container = Container { heads: Vec::new(), single: None, notes: Vec::new(), comments: Vec::new() };
        for file in &files.channels {
            let is_named = named.is_some() && number(file) == named;
            match ChannelHead::read(file) {
                Ok(head) => {
                    container.single = container.single.or(is_named.then_some(container.heads.len()));
                    container.heads.push(head);
                }
                // Who asks for one channel gets it whatever is wrong with the others.
                Err(error) if named.is_some() && !is_named => {
                    container.notes.push(format!("a channel beside it cannot be read: {error}"));
                }
                Err(error) => return Err(error),
            }
        }
        let single = container.single;
        match &files.test {
            Some(test) => {
                let header = read_header(test, &mut container.notes)?;
                let comments = header.entries().iter().filter(|entry| entry.key.eq_ignore_ascii_case("Comments"));
                container.comments.extend(comments.filter_map(|entry| entry.value.clone()));
                container.notes.extend(container.comments.iter().cloned());
            }
            None if single.is_none() => container.notes.push("there is no test (.mme)".into()),
            None => {}
        }
        match (&files.list, single) {
            (Some(list), None) => container.compare(list)?,
            (None, None) => container.notes.push("there is no list of the channels (.chn)".into()),
            (_, Some(_)) => {}
        }
        Ok(container)
    }

    /// Lays the list of channels beside the files that are there; they are the same where their codes are.
    fn compare(&mut self, list: &Path) -> Result<(), ReadError> {
        let header = read_header(list, &mut self.notes)?;
        let names = header.entries().iter().filter(|entry| entry.key.to_lowercase().starts_with("name of channel"));
        let listed: Vec<(&str, Option<&str>)> =
            names.filter_map(|entry| entry.value.as_deref()).map(code_and_name).collect();
        let stated = header.number("Number of channels");
        let stated = stated.map_err(|(line, fault)| Mistake { line, column: 1, fault }.of(list))?;
        if let Some(stated) = stated.filter(|stated| *stated != listed.len() as f64) {
            self.notes.push(format!("the list of channels says {stated} and has {}", listed.len()));
        }
        let is_there = |code: &str| self.heads.iter().any(|head| head.name == code);
        let absent: Vec<&str> = listed.iter().map(|(code, _)| *code).filter(|code| !is_there(code)).collect();
        if let [first, ..] = absent[..] {
            let count = absent.len();
            self.notes.push(format!("{count} of {} listed channels are not there; the first is {first}", listed.len()));
        }
        for head in &mut self.heads {
            match listed.iter().find(|(code, _)| *code == head.name) {
                Some((_, Some(long))) if head.label == head.name => head.label = (*long).to_owned(),
                Some(_) => {}
                None => self.notes.push(format!("{} is there but not in the list of channels", head.name)),
            }
        }
        Ok(())
    }
}

/// `CODE / long name`.
fn code_and_name(value: &str) -> (&str, Option<&str>) {
    value.split_once('/').map_or((value.trim(), None), |(code, long)| (code.trim(), Some(long.trim())))
}

/// Where the files of a container are.
struct Files {
    test: Option<PathBuf>,
    list: Option<PathBuf>,
    /// In the order of their numbers.
    channels: Vec<PathBuf>,
}

impl Files {
    fn locate(path: &Path) -> Result<Files, ReadError> {
        let fail = |fault| Mistake::whole(fault).of(path);
        if path.is_dir() {
            return Files::locate(&test_in(path)?);
        }
        if !path.is_file() {
            let missing = io::Error::new(ErrorKind::NotFound, "no such file or folder");
            return Err(fail(Fault::Text(TextError::Open(missing))));
        }
        let is_test = has_extension(path, "mme");
        let folder = if is_test { channel_folder(path)? } else { folder_of(path).to_owned() };
        let stem = stem_of(path);
        let files: Vec<PathBuf> = entries(&folder)?.into_iter().filter(|file| stem_of(file) == stem).collect();
        let list = files.iter().find(|file| has_extension(file, "chn")).cloned();
        let mut channels: Vec<(u64, PathBuf)> =
            files.into_iter().filter_map(|file| Some((number(&file)?, file))).collect();
        if channels.is_empty() {
            return Err(fail(Fault::NoChannelFiles { stem }));
        }
        channels.sort();
        let channels = channels.into_iter().map(|(_, file)| file).collect();
        Ok(Files { test: is_test.then(|| path.to_owned()), list, channels })
    }
}

/// The test in a folder, or else its list of channels.
fn test_in(folder: &Path) -> Result<PathBuf, ReadError> {
    let fail = |fault| Mistake::whole(fault).of(folder);
    let files = entries(folder)?;
    let of_kind = |kind| files.iter().filter(|file| has_extension(file, kind)).collect::<Vec<_>>();
    let (tests, lists) = (of_kind("mme"), of_kind("chn"));
    match (&tests[..], &lists[..]) {
        ([one], _) | ([], [one]) => Ok((*one).clone()),
        ([], []) => Err(fail(Fault::NoTest)),
        ([], several) | (several, _) => {
            Err(fail(Fault::SeveralTests { found: several.iter().map(|file| name_of(file)).collect() }))
        }
    }
}

/// The folder `Channel` beside a test.
fn channel_folder(test: &Path) -> Result<PathBuf, ReadError> {
    let is_it = |entry: &PathBuf| entry.is_dir() && name_of(entry).eq_ignore_ascii_case("channel");
    let found = entries(folder_of(test))?.into_iter().find(is_it);
    found.ok_or_else(|| Mistake::whole(Fault::NoChannelFolder).of(test))
}

/// What a folder holds, in the order of the names.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let failed = |error| Mistake::whole(Fault::Text(TextError::Open(error))).of(folder);
    let entries = fs::read_dir(folder).map_err(failed)?;
    let mut paths =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>().map_err(failed)?;
    paths.sort();
    Ok(paths)
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

fn stem_of(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().to_lowercase())
}

/// The number of a channel file: its extension of three digits or more.
pub fn number(path: &Path) -> Option<u64> {
    let extension = path.extension().and_then(OsStr::to_str)?;
    let digits = extension.len() >= 3 && extension.bytes().all(|letter| letter.is_ascii_digit());
    digits.then(|| extension.parse().ok()).flatten()
}

/// Places of the wanted channels; time axes are none unless asked for by name.
fn selected(heads: &[ChannelHead], single: Option<usize>, options: &ReadOptions) -> Result<Vec<usize>, Fault> {
    let axes: Vec<&str> = heads.iter().filter_map(|head| head.header.text("Reference channel name")).collect();
    let is_axis = |head: &ChannelHead| head.is_time() || axes.contains(&head.name.as_str());
    let all: Vec<usize> = match single {
        Some(single) => vec![single],
        None => (0..heads.len()).filter(|place| !is_axis(&heads[*place])).collect(),
    };
    let known = heads.iter().map(|head| (head.name.as_str(), head.label.as_str()));
    for (name, _) in &options.units {
        find(name, known.clone()).map_err(Fault::Channel)?;
    }
    match &options.channels {
        _ if all.is_empty() => Err(Fault::OnlyTime),
        ChannelSelection::All => Ok(all),
        ChannelSelection::Named(names) => {
            names.iter().map(|name| find(name, known.clone()).map_err(Fault::Channel)).collect()
        }
        ChannelSelection::Only if all.len() == 1 => Ok(all),
        ChannelSelection::Only => {
            Err(Fault::NotOne { found: all.iter().map(|place| heads[*place].name.clone()).collect() })
        }
    }
}

fn measured(
    head: &ChannelHead,
    axes: &mut Axes,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<MeasuredChannel, ReadError> {
    let unit = unit(head, options, notes)?;
    let mut values = head.values()?;
    if head.header.text("Number of samples").is_none() {
        notes.push(format!("{}: the number of samples is not stated; whether some are missing is not seen", head.name));
    }
    let filtered = head.class(notes);
    let time = axes.of(head, values.len(), notes)?;
    check_extremes(head, &time, &values, notes)?;
    if let Some(unit) = unit.as_ref().filter(|unit| !unit.is_si()) {
        values.iter_mut().for_each(|value| *value = unit.to_si(*value));
    }
    let series = Series::new(time, values);
    Ok(MeasuredChannel { name: head.name.clone(), label: head.label.clone(), unit, filtered, series })
}

/// The unit from the header or the caller; both where they agree. What is not known is noted.
fn unit(head: &ChannelHead, options: &ReadOptions, notes: &mut Vec<String>) -> Result<Option<Unit>, ReadError> {
    let named = options.units.iter().find(|(name, _)| *name == head.name || *name == head.label);
    let given = named.map(|(_, unit)| unit).or(options.unit.as_ref());
    let symbol = head.header.text("Unit");
    let file = symbol.and_then(|symbol| Unit::parse(symbol).ok());
    match (file, given) {
        (Some(file), Some(given)) if file != *given => {
            let [file, given] = [&file, given].map(|unit| unit.symbol().to_owned());
            Err(head.at("Unit", Fault::GivenUnit { channel: head.name.clone(), file, given }))
        }
        (Some(file), _) => Ok(Some(file)),
        (None, Some(given)) => Ok(Some(given.clone())),
        (None, None) => {
            let symbol =
                symbol.map_or("no unit is stated".into(), |symbol| format!("the unit `{symbol}` is not known"));
            notes.push(format!("{}: {symbol}; its values are as written", head.name));
            Ok(None)
        }
    }
}

/// Time axes; those that several channels share are read once.
struct Axes<'a> {
    heads: &'a [ChannelHead],
    known: BTreeMap<String, Arc<[f64]>>,
}

impl Axes<'_> {
    /// The times of the `samples` of a channel.
    fn of(&mut self, head: &ChannelHead, samples: usize, notes: &mut Vec<String>) -> Result<Arc<[f64]>, ReadError> {
        let kind = head.header.text("Reference channel").map(str::to_lowercase);
        let reference = head.header.text("Reference channel name");
        match (kind.as_deref(), reference) {
            (Some("explicit"), Some(reference)) => self.explicit(head, reference, samples, notes),
            (Some("explicit"), None) => {
                Err(head.at("Reference channel", Fault::NoTimeAxis { channel: head.name.clone() }))
            }
            (Some("implicit"), _) => implicit(head, samples, notes),
            _ => {
                notes.push(format!("{}: how its time is given is not stated; implicit is assumed", head.name));
                implicit(head, samples, notes)
            }
        }
    }

    fn explicit(
        &mut self,
        head: &ChannelHead,
        reference: &str,
        samples: usize,
        notes: &mut Vec<String>,
    ) -> Result<Arc<[f64]>, ReadError> {
        let channel = || head.name.clone();
        let time = match self.known.get(reference) {
            Some(time) => Arc::clone(time),
            None => {
                let missing = || Fault::NoReference { channel: channel(), reference: reference.into() };
                let axis = self.heads.iter().find(|axis| axis.name == reference);
                let axis = axis.ok_or_else(|| head.at("Reference channel name", missing()))?;
                let time: Arc<[f64]> = axis.times(notes)?.into();
                self.known.insert(reference.into(), Arc::clone(&time));
                time
            }
        };
        if time.len() == samples {
            return Ok(time);
        }
        let fault =
            Fault::TimeLength { channel: channel(), reference: reference.into(), found: samples, times: time.len() };
        Err(head.at("Reference channel name", fault))
    }
}

/// First sample, interval and count.
fn implicit(head: &ChannelHead, samples: usize, notes: &mut Vec<String>) -> Result<Arc<[f64]>, ReadError> {
    let channel = || head.name.clone();
    let interval = head.number("Sampling interval")?;
    let interval = interval.ok_or_else(|| head.at("Reference channel", Fault::NoTimeAxis { channel: channel() }))?;
    if interval <= 0.0 {
        return Err(head.at("Sampling interval", Fault::Interval { channel: channel(), interval }));
    }
    let start = head.number("Time of first sample")?.unwrap_or_else(|| {
        notes.push(format!("{}: the time of the first sample is not stated; 0 is assumed", head.name));
        0.0
    });
    let times: Arc<[f64]> = (0..samples).map(|sample| start + sample as f64 * interval).collect();
    let increases = times.windows(2).all(|pair| pair[0] < pair[1]);
    if increases {
        Ok(times)
    } else {
        Err(head.at("Sampling interval", Fault::Interval { channel: channel(), interval }))
    }
}

/// Lays the extremes that the header states beside those of the samples; what differs is noted.
fn check_extremes(
    head: &ChannelHead,
    time: &Arc<[f64]>,
    values: &[f64],
    notes: &mut Vec<String>,
) -> Result<(), ReadError> {
    let series = Series::new(Arc::clone(time), values);
    let scale = values.iter().filter(|value| value.is_finite()).fold(0.0, |scale: f64, value| scale.max(value.abs()));
    let step = time.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    for (word, found) in [("maximum", series.largest()), ("minimum", series.smallest())] {
        let Some([at, extreme]) = found else { continue };
        let value = head.number(&format!("First global {word} value"))?;
        if let Some(value) = value.filter(|value| (value - extreme).abs() > 1e-6 * scale) {
            notes.push(format!("{}: the header states the {word} {value}, the samples have {extreme}", head.name));
        }
        let when = head.number(&format!("Time of {word} value"))?;
        if let Some(when) = when.filter(|when| (when - at).abs() > 0.5 * step + 1e-6 * at.abs()) {
            notes.push(format!("{}: the header states the {word} at {when} s, the samples at {at} s", head.name));
        }
    }
    Ok(())
}
