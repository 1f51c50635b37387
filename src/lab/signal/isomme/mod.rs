//! Recordings as ISO-MME (ISO/TS 13499): a text file a channel, headers of keys and values, a list of the channels, and
//! a file about the test. They are read, not written.
//!
//! A whole container is `<test>.mme` beside a folder `Channel` with `<test>.chn` and `<test>.001`, …; files are found
//! however their names are capitalised. Read are also a list without its test, a channel on its own, and a zip archive
//! that holds a container, at its top or in a folder.

mod channel;
mod files;

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::rc::Rc;

use super::catalogue::{Axis, Catalogue, Entry, Reader, Subject, Terms};
use super::column_name::ColumnName;
use super::warning::Extreme;
use super::{Annotations, Series, Warning};
use crate::error::{Error, refusal};
use base::budget::Numbers;
use base::number::significant;
use base::units::Unit;
use channel::{ChannelHead, read_header};
use files::{Files, Member, number};

pub use files::is_part;

/// The headers of a container, or of one channel of it.
struct IsoMme {
    heads: Vec<ChannelHead>,
}

/// Lists the channels of the container that the file or folder at `path` belongs to; of a channel file that one alone.
pub fn open(path: &Path) -> Result<Catalogue, Error> {
    let files = Files::locate(path)?;
    let named = number(path);
    let (mut heads, mut single, mut comments, mut warnings) = (Vec::new(), None, Vec::new(), Vec::new());
    for file in &files.channels {
        let is_named = named.is_some() && number(&file.path) == named;
        match ChannelHead::read(file) {
            Ok(head) => {
                single = single.or(is_named.then_some(heads.len()));
                heads.push(head);
            }
            // A single channel is read even if others are not readable.
            Err(error) if named.is_some() && !is_named => {
                warnings.push(Warning::UnreadableChannel { error: error.to_string() });
            }
            Err(error) => return Err(error),
        }
    }
    match &files.test {
        Some(test) => {
            let header = read_header(test, &mut warnings)?;
            let lines = header.lines().iter().filter(|line| line.key.eq_ignore_ascii_case("Comments"));
            comments.extend(lines.filter_map(|line| line.value.clone()));
        }
        None if single.is_none() => warnings.push(Warning::NoTestFile),
        None => {}
    }
    match (&files.list, single) {
        (Some(list), None) => compare(&mut heads, list, &mut warnings)?,
        (None, None) => warnings.push(Warning::NoChannelList),
        (_, Some(_)) => {}
    }
    let mut annotations = Annotations::new(comments);
    annotations.warnings = warnings;
    Ok(Catalogue::new(entries(&heads, single), annotations, IsoMme { heads }))
}

/// Compares the list of channels with the channel files, by their codes.
fn compare(heads: &mut [ChannelHead], list: &Member, warnings: &mut Vec<Warning>) -> Result<(), Error> {
    let header = read_header(list, warnings)?;
    let names = header.lines().iter().filter(|line| line.key.to_lowercase().starts_with("name of channel"));
    let listed: Vec<(&str, Option<&str>)> = names.filter_map(|line| line.value.as_deref()).map(code_and_name).collect();
    let stated = header.number("Number of channels");
    let stated = stated.map_err(|error| error.in_file(&list.path))?;
    if let Some(stated) = stated.filter(|stated| *stated != listed.len() as f64) {
        warnings.push(Warning::ChannelCountDiffers { stated, listed: listed.len() });
    }
    let is_there = |code: &str| heads.iter().any(|head| head.name == code);
    let absent: Vec<&str> = listed.iter().map(|(code, _)| *code).filter(|code| !is_there(code)).collect();
    if let [first, ..] = absent[..] {
        let (count, listed, first) = (absent.len(), listed.len(), first.to_owned());
        warnings.push(Warning::ListedChannelsMissing { count, listed, first });
    }
    for head in heads {
        match listed.iter().find(|(code, _)| *code == head.name) {
            Some((_, Some(long))) if head.label == head.name => head.label = (*long).to_owned(),
            Some(_) => {}
            None => warnings.push(Warning::UnlistedChannel { channel: head.name.clone() }),
        }
    }
    Ok(())
}

/// `CODE / long name`.
fn code_and_name(value: &str) -> (&str, Option<&str>) {
    value.split_once('/').map_or((value.trim(), None), |(code, long)| (code.trim(), Some(long.trim())))
}

/// The channels with these headers. Time axes are read only where they are named, and so is any but the `single` one where one
/// was asked for.
fn entries(heads: &[ChannelHead], single: Option<usize>) -> Vec<Entry> {
    let references = heads.iter().filter_map(|head| head.header.text("Reference channel name"));
    let references: HashSet<&str> = references.collect();
    let mut places = HashMap::new();
    for (place, head) in heads.iter().enumerate() {
        places.entry(head.name.as_str()).or_insert(place);
    }
    let entry = |(place, head): (usize, &ChannelHead)| {
        let symbol = head.header.text("Unit");
        let unit = symbol.and_then(|symbol| Unit::parse(symbol).ok());
        let unknown_unit = symbol.filter(|_| unit.is_none()).map(str::to_owned);
        let is_axis = head.is_time() || references.contains(head.name.as_str());
        let column = ColumnName { name: head.name.clone(), label: head.name.clone(), unit, unknown_unit };
        Entry {
            long_name: Some(head.label.clone()),
            axis: axis(head, &places).unwrap_or_else(|error| Axis::Refused(Rc::new(error))),
            filtered: head.class(),
            by_name_only: single.map_or(is_axis, |single| single != place),
            ..Entry::from_column("", column)
        }
    };
    heads.iter().enumerate().map(entry).collect()
}

/// How the times of a channel are given: explicitly by another one, at one of the `places` of codes, or implicitly by first sample
/// and interval. Where the header does not say which, the latter is assumed.
fn axis(head: &ChannelHead, places: &HashMap<&str, usize>) -> Result<Axis, Error> {
    let name = &head.name;
    let no_times = || {
        let error = refusal!("`{name}` has neither a sampling interval nor a reference channel for its time");
        head.fault_at("Reference channel", error)
    };
    if head.is_explicit() {
        let reference = head.header.text("Reference channel name").ok_or_else(no_times)?;
        let missing = || refusal!("the time of `{name}` is in `{reference}`, which is missing");
        let place = places.get(reference).ok_or_else(|| head.fault_at("Reference channel name", missing()))?;
        return Ok(Axis::Channel(*place));
    }
    let step = head.number("Sampling interval")?.ok_or_else(no_times)?;
    if step <= 0.0 {
        let error = refusal!("the sampling interval of `{name}` is {} s", significant(step, 9));
        return Err(head.fault_at("Sampling interval", error));
    }
    Ok(Axis::Steps { start: head.number("Time of first sample")?.unwrap_or(0.0), step })
}

impl Reader for IsoMme {
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        self.heads[place].values()
    }

    fn review(&self, place: usize, times: &Numbers, values: &[f64], warnings: &mut Vec<Warning>) -> Result<(), Error> {
        let head = &self.heads[place];
        let channel = || head.name.clone();
        let says = |key: &str| head.header.text(key).is_some();
        warnings.extend((!says("Number of samples")).then(|| Warning::SampleCountMissing { channel: channel() }));
        warnings.extend(head.unknown_class());
        warnings.extend((!head.has_axis_kind()).then(|| Warning::TimeAxisAssumed { channel: channel() }));
        let starts = head.is_explicit() || says("Time of first sample");
        warnings.extend((!starts).then(|| Warning::FirstTimeAssumed { channel: channel() }));
        check_extremes(head, times, values, warnings)
    }

    fn locate(&self, subject: Subject, error: Error) -> Error {
        match subject {
            Subject::List => error,
            Subject::Unit(place) => self.heads[place].fault_at("Unit", error),
            Subject::Times(place) => self.heads[place].fault_at(self.heads[place].axis_key(), error),
            Subject::Sample(place, sample) => self.heads[place].fault_in(sample, error),
        }
    }

    fn terms(&self) -> Terms {
        Terms { channel: "CODE", none: "no channel but time axes", is_table: false }
    }
}

/// Compares the extremes that the header states with those of the samples.
fn check_extremes(
    head: &ChannelHead,
    time: &Numbers,
    values: &[f64],
    warnings: &mut Vec<Warning>,
) -> Result<(), Error> {
    let series = Series::new(time.clone(), values);
    let scale = values.iter().filter(|value| value.is_finite()).fold(0.0, |scale: f64, value| scale.max(value.abs()));
    let step = time.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    for (extreme, found) in [(Extreme::Maximum, series.largest()), (Extreme::Minimum, series.smallest())] {
        let Some([at, value]) = found else { continue };
        let channel = || head.name.clone();
        let stated = head.number(&format!("First global {extreme} value"))?;
        if let Some(stated) = stated.filter(|stated| (stated - value).abs() > 1e-6 * scale) {
            warnings.push(Warning::ExtremeDiffers { channel: channel(), extreme, stated, found: value });
        }
        let stated = head.number(&format!("Time of {extreme} value"))?;
        if let Some(stated) = stated.filter(|stated| (stated - at).abs() > 0.5 * step + 1e-6 * at.abs()) {
            warnings.push(Warning::ExtremeTimeDiffers { channel: channel(), extreme, stated, found: at });
        }
    }
    Ok(())
}
