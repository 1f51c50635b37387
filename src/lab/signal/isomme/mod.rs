//! Recordings as ISO-MME (ISO/TS 13499): a text file a channel, headers of keys and values, a list of the channels, and
//! a file about the test. They are read, not written.
//!
//! A whole container is `<test>.mme` beside a folder `Channel` with `<test>.chn` and `<test>.001`, …; files are found
//! however their names are capitalised. Read are also a list without its test, a channel on its own, and a zip archive
//! that holds a container, at its top or in a folder.

mod channel;
mod files;

use std::collections::BTreeMap;
use std::path::Path;

use super::measurement::{find, no_unit, not_one};
use super::warning::Extreme;
use super::{Annotations, ChannelSelection, MeasuredChannel, Measurement, ReadOptions, Series, Warning};
use crate::error::{Error, refusal};
use base::budget::Numbers;
use base::number::significant;
use base::units::Unit;
use channel::{ChannelHead, read_header};
use files::{Files, Member, number};

pub use channel::{Entry, Header};
pub use files::is_part;

/// Reads the channels of the container that the file or folder at `path` belongs to; of a channel file that one alone.
///
/// Holds all headers and the wanted channels: 8 bytes a value, and as much again for one channel while it is finished.
///
/// Where a header does not state how its time is given, an implicit time axis is assumed, with a warning.
pub fn measure(path: &Path, options: &ReadOptions) -> Result<Measurement, Error> {
    if options.time.is_some() || !options.names.is_empty() {
        let error = refusal!("column names are given, but the file is not a table");
        return Err(error.with_hint("ISO-MME channels have their own time and names; leave them out").in_file(path));
    }
    let Container { heads, single, comments, mut warnings } = Container::open(path)?;
    let places = selected(&heads, single, options).map_err(|error| error.in_file(path))?;
    let mut axes = Axes { heads: &heads, known: BTreeMap::new() };
    let mut channels = Vec::new();
    for place in places {
        channels.push(measured(&heads[place], &mut axes, options, &mut warnings)?);
    }
    let mut annotations = Annotations::new(comments);
    annotations.warnings = warnings;
    Ok(Measurement { channels, annotations })
}

/// A container of which only the headers were read.
struct Container {
    heads: Vec<ChannelHead>,
    /// The one channel that was named, where a channel file was.
    single: Option<usize>,
    /// Of the test.
    comments: Vec<String>,
    warnings: Vec<Warning>,
}

impl Container {
    fn open(path: &Path) -> Result<Container, Error> {
        let files = Files::locate(path)?;
        let named = number(path);
        let mut container = Container { heads: Vec::new(), single: None, comments: Vec::new(), warnings: Vec::new() };
        for file in &files.channels {
            let is_named = named.is_some() && number(&file.path) == named;
            match ChannelHead::read(file) {
                Ok(head) => {
                    container.single = container.single.or(is_named.then_some(container.heads.len()));
                    container.heads.push(head);
                }
                // A single channel is read even if others are not readable.
                Err(error) if named.is_some() && !is_named => {
                    container.warnings.push(Warning::UnreadableChannel { error: error.to_string() });
                }
                Err(error) => return Err(error),
            }
        }
        let single = container.single;
        match &files.test {
            Some(test) => {
                let header = read_header(test, &mut container.warnings)?;
                let comments = header.entries().iter().filter(|entry| entry.key.eq_ignore_ascii_case("Comments"));
                container.comments.extend(comments.filter_map(|entry| entry.value.clone()));
            }
            None if single.is_none() => container.warnings.push(Warning::NoTestFile),
            None => {}
        }
        match (&files.list, single) {
            (Some(list), None) => container.compare(list)?,
            (None, None) => container.warnings.push(Warning::NoChannelList),
            (_, Some(_)) => {}
        }
        Ok(container)
    }

    /// Compares the list of channels with the channel files, by their codes.
    fn compare(&mut self, list: &Member) -> Result<(), Error> {
        let header = read_header(list, &mut self.warnings)?;
        let names = header.entries().iter().filter(|entry| entry.key.to_lowercase().starts_with("name of channel"));
        let listed: Vec<(&str, Option<&str>)> =
            names.filter_map(|entry| entry.value.as_deref()).map(code_and_name).collect();
        let stated = header.number("Number of channels");
        let stated = stated.map_err(|error| error.in_file(&list.path))?;
        if let Some(stated) = stated.filter(|stated| *stated != listed.len() as f64) {
            self.warnings.push(Warning::ChannelCountDiffers { stated, listed: listed.len() });
        }
        let is_there = |code: &str| self.heads.iter().any(|head| head.name == code);
        let absent: Vec<&str> = listed.iter().map(|(code, _)| *code).filter(|code| !is_there(code)).collect();
        if let [first, ..] = absent[..] {
            let (count, listed, first) = (absent.len(), listed.len(), first.to_owned());
            self.warnings.push(Warning::ListedChannelsMissing { count, listed, first });
        }
        for head in &mut self.heads {
            match listed.iter().find(|(code, _)| *code == head.name) {
                Some((_, Some(long))) if head.label == head.name => head.label = (*long).to_owned(),
                Some(_) => {}
                None => self.warnings.push(Warning::UnlistedChannel { channel: head.name.clone() }),
            }
        }
        Ok(())
    }
}

/// `CODE / long name`.
fn code_and_name(value: &str) -> (&str, Option<&str>) {
    value.split_once('/').map_or((value.trim(), None), |(code, long)| (code.trim(), Some(long.trim())))
}

/// Places of the wanted channels; time axes are none unless asked for by name.
fn selected(heads: &[ChannelHead], single: Option<usize>, options: &ReadOptions) -> Result<Vec<usize>, Error> {
    let axes: Vec<&str> = heads.iter().filter_map(|head| head.header.text("Reference channel name")).collect();
    let is_axis = |head: &ChannelHead| head.is_time() || axes.contains(&head.name.as_str());
    let all: Vec<usize> = match single {
        Some(single) => vec![single],
        None => (0..heads.len()).filter(|place| !is_axis(&heads[*place])).collect(),
    };
    let known = heads.iter().map(|head| (head.name.as_str(), head.label.as_str()));
    for (name, _) in &options.units {
        find(name, known.clone())?;
    }
    match &options.channels {
        _ if all.is_empty() => Err(refusal!("no channel but time axes")),
        ChannelSelection::All => Ok(all),
        ChannelSelection::Named(names) => names.iter().map(|name| find(name, known.clone())).collect(),
        ChannelSelection::Only if all.len() == 1 => Ok(all),
        ChannelSelection::Only => {
            let found: Vec<String> = all.iter().map(|place| heads[*place].name.clone()).collect();
            Err(not_one(&found, "CODE"))
        }
    }
}

fn measured(
    head: &ChannelHead,
    axes: &mut Axes,
    options: &ReadOptions,
    warnings: &mut Vec<Warning>,
) -> Result<MeasuredChannel, Error> {
    let unit = unit(head, options, warnings)?;
    let mut values = head.values()?;
    if head.header.text("Number of samples").is_none() {
        warnings.push(Warning::SampleCountMissing { channel: head.name.clone() });
    }
    let filtered = head.class(warnings);
    let time = axes.read_times(head, values.len(), warnings)?;
    check_extremes(head, &time, &values, warnings)?;
    if let Some(unit) = unit.as_ref().filter(|unit| !unit.is_si()) {
        values.iter_mut().for_each(|value| *value = unit.to_si(*value));
    }
    let series = Series::new(time, values);
    Ok(MeasuredChannel { name: head.name.clone(), label: head.label.clone(), unit, filtered, series })
}

/// The unit from the header or the caller; both where they agree. A warning where it is not known.
fn unit(head: &ChannelHead, options: &ReadOptions, warnings: &mut Vec<Warning>) -> Result<Option<Unit>, Error> {
    let symbol = head.header.text("Unit");
    let file = symbol.and_then(|symbol| Unit::parse(symbol).ok());
    let unit = options.unit([&head.name, &head.label], file.as_ref(), options.unit.as_ref(), &head.name);
    let unit = unit.map_err(|error| head.fault_at("Unit", error))?;
    if unit.is_none() {
        warnings.push(no_unit(&head.name, symbol));
    }
    Ok(unit)
}

/// Time axes; those that several channels share are read once.
struct Axes<'a> {
    heads: &'a [ChannelHead],
    known: BTreeMap<String, Numbers>,
}

impl Axes<'_> {
    /// The times of the `samples` of a channel.
    fn read_times(
        &mut self,
        head: &ChannelHead,
        samples: usize,
        warnings: &mut Vec<Warning>,
    ) -> Result<Numbers, Error> {
        let kind = head.header.text("Reference channel").map(str::to_lowercase);
        let reference = head.header.text("Reference channel name");
        match (kind.as_deref(), reference) {
            (Some("explicit"), Some(reference)) => self.explicit(head, reference, samples, warnings),
            (Some("explicit"), None) => Err(no_time_axis(head)),
            (Some("implicit"), _) => implicit(head, samples, warnings),
            _ => {
                warnings.push(Warning::TimeAxisAssumed { channel: head.name.clone() });
                implicit(head, samples, warnings)
            }
        }
    }

    fn explicit(
        &mut self,
        head: &ChannelHead,
        reference: &str,
        samples: usize,
        warnings: &mut Vec<Warning>,
    ) -> Result<Numbers, Error> {
        let channel = &head.name;
        let time = match self.known.get(reference) {
            Some(time) => time.clone(),
            None => {
                let missing = || refusal!("the time of `{channel}` is in `{reference}`, which is missing");
                let axis = self.heads.iter().find(|axis| axis.name == reference);
                let axis = axis.ok_or_else(|| head.fault_at("Reference channel name", missing()))?;
                let time: Numbers = axis.times(warnings)?.into();
                self.known.insert(reference.into(), time.clone());
                time
            }
        };
        if time.len() == samples {
            return Ok(time);
        }
        let times = time.len();
        let error = refusal!("`{channel}` has {samples} samples over {times} times of `{reference}`");
        Err(head.fault_at("Reference channel name", error))
    }
}

/// Refuses a header that does not state the times of its values.
fn no_time_axis(head: &ChannelHead) -> Error {
    let name = &head.name;
    let error = refusal!("`{name}` has neither a sampling interval nor a reference channel for its time");
    head.fault_at("Reference channel", error)
}

/// First sample, interval and count.
fn implicit(head: &ChannelHead, samples: usize, warnings: &mut Vec<Warning>) -> Result<Numbers, Error> {
    let channel = || head.name.clone();
    let interval = head.number("Sampling interval")?.ok_or_else(|| no_time_axis(head))?;
    let wrong = || {
        let error = refusal!("the sampling interval of `{}` is {} s", head.name, significant(interval, 9));
        head.fault_at("Sampling interval", error)
    };
    if interval <= 0.0 {
        return Err(wrong());
    }
    let start = head.number("Time of first sample")?.unwrap_or_else(|| {
        warnings.push(Warning::FirstTimeAssumed { channel: channel() });
        0.0
    });
    let times: Numbers = (0..samples).map(|sample| start + sample as f64 * interval).collect();
    let increases = times.windows(2).all(|pair| pair[0] < pair[1]);
    if increases { Ok(times) } else { Err(wrong()) }
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
