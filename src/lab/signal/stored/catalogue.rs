//! The wanted channels of a file that lists its channels, over their times.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use super::{Axis, Entry, Fault, ReadError};
use crate::signal::channel_fault::{ChannelFault, MOST_VALUES};
use crate::signal::measurement::find;
use crate::signal::{Annotations, ChannelSelection, MeasuredChannel, Measurement, ReadOptions, Series, Warning, csv};
use base::budget::Numbers;
use base::units::{Time, Unit};

/// A file that lists its channels.
pub trait Catalogue {
    /// Its channels, in the order of the file.
    fn entries(&self) -> &[Entry];

    /// Comments of the file, and what its listing reports.
    fn annotations(&self) -> Annotations;

    /// The values of the channel at a place of the list, in the unit of the file; `NaN` where nothing was measured.
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Fault>;
}

/// Reads the wanted channels, each over its times.
///
/// Holds them and nothing else of the file: 8 bytes a value, and as much again for one channel while it is finished.
pub fn measure(file: &mut dyn Catalogue, path: &Path, options: &ReadOptions) -> Result<Measurement, ReadError> {
    measured(file, options).map_err(|fault| ReadError::new(path, fault))
}

/// Reads the wanted channels without their times, as columns of one length.
pub fn columns(file: &mut dyn Catalogue, path: &Path, options: &ReadOptions) -> Result<csv::Table, ReadError> {
    tabled(file, options).map_err(|fault| ReadError::new(path, fault))
}

fn measured(file: &mut dyn Catalogue, options: &ReadOptions) -> Result<Measurement, Fault> {
    let mut annotations = file.annotations();
    let entries = file.entries().to_vec();
    let given = options.time.as_ref().map(|name| find_entry(&entries, name)).transpose()?;
    let named = named_times(&entries);
    let axes: Vec<Result<Axis, Fault>> = entries.iter().map(|entry| axis(&entries, entry, given, &named)).collect();
    let of_channel = |axis: &Result<Axis, Fault>| match axis {
        Ok(Axis::Channel(time)) => Some(*time),
        _ => None,
    };
    let times: HashSet<usize> = axes.iter().filter_map(of_channel).chain(given).collect();
    let wanted = selected(&entries, options, |place| times.contains(&place), &mut annotations.warnings)?;
    let mut times = Times { entries: &entries, known: BTreeMap::new() };
    let (mut channels, mut untimed) = (Vec::new(), None);
    for place in wanted {
        let entry = &entries[place];
        let axis = match &axes[place] {
            Ok(axis) => axis.clone(),
            Err(_) => {
                untimed.get_or_insert(place);
                let why = "it has no time".to_owned();
                annotations.warnings.push(Warning::ChannelNotRead { channel: entry.label().to_owned(), why });
                continue;
            }
        };
        let unit = unit(entry, options, &mut annotations.warnings)?;
        let time = times.read(file, place, &axis, &mut annotations.warnings)?;
        let values = values(file, entry, place, unit.as_ref())?;
        let filtered = annotations.filter_class(&entry.column.name);
        let (name, label) = (entry.column.name.clone(), entry.label().to_owned());
        channels.push(MeasuredChannel { name, label, unit, filtered, series: Series::new(time, values) });
    }
    // Some channels, such as figures beside the recording, may have no time; one that is asked for needs it.
    match untimed {
        Some(place) if channels.is_empty() || options.channels != ChannelSelection::All => {
            axes.into_iter().nth(place).transpose()?;
        }
        _ => {}
    }
    Ok(Measurement { channels, annotations })
}

fn tabled(file: &mut dyn Catalogue, options: &ReadOptions) -> Result<csv::Table, Fault> {
    let mut annotations = file.annotations();
    let entries = file.entries().to_vec();
    let wanted = selected(&entries, options, |_| false, &mut annotations.warnings)?;
    if let Some(first) = wanted.first().map(|first| &entries[*first])
        && let Some(other) = wanted.iter().map(|place| &entries[*place]).find(|other| other.samples != first.samples)
    {
        let [first_label, channel] = [first, other].map(|entry| entry.label().to_owned());
        return Err(Fault::Lengths { first: first_label, length: first.samples, channel, found: other.samples });
    }
    let mut columns = Vec::new();
    for place in wanted {
        let entry = &entries[place];
        let unit = unit(entry, options, &mut annotations.warnings)?;
        let values = values(file, entry, place, unit.as_ref())?;
        let (name, label) = (entry.column.name.clone(), entry.label().to_owned());
        columns.push(csv::Column { name, label, unit, values });
    }
    Ok(csv::Table { columns, annotations })
}

/// The place of the one channel called `name`, with its group or without.
fn find_entry(entries: &[Entry], name: &str) -> Result<usize, Fault> {
    let names = entries.iter().map(|entry| (entry.column.name.as_str(), entry.label()));
    Ok(find(name, names).map_err(ChannelFault::Name)?)
}

/// Places of the channels that are named like a time, by their group.
fn named_times(entries: &[Entry]) -> HashMap<&str, Vec<usize>> {
    let is_time = |entry: &Entry| entry.column.is_time() && entry.unread.is_none() && entry.axis == Axis::Unknown;
    let mut found: HashMap<&str, Vec<usize>> = HashMap::new();
    for (place, entry) in entries.iter().enumerate().filter(|(_, entry)| is_time(entry)) {
        found.entry(&entry.group).or_default().push(place);
    }
    found
}

/// The times of the channel `entry`: those of the channel that is `given`, those that the file states, or those of the
/// channel of its group that is named like a time.
fn axis(
    entries: &[Entry],
    entry: &Entry,
    given: Option<usize>,
    named: &HashMap<&str, Vec<usize>>,
) -> Result<Axis, Fault> {
    match given.map_or_else(|| entry.axis.clone(), Axis::Channel) {
        Axis::Unknown => {}
        Axis::Channel(time) => {
            let (channel, why) = (entries[time].label().to_owned(), entries[time].unread.clone());
            return why.map_or(Ok(Axis::Channel(time)), |why| Err(Fault::NotRead { channel, why }));
        }
        steps => return Ok(steps),
    }
    let times = named.get(entry.group.as_str()).map_or(&[][..], Vec::as_slice);
    match *times {
        [time] => Ok(Axis::Channel(time)),
        [] => Err(Fault::NoTime { channel: entry.label().to_owned() }),
        _ => Err(Fault::SeveralTimes { found: times.iter().map(|time| entries[*time].label().to_owned()).collect() }),
    }
}

/// Places of the wanted channels; a time is none of them unless it is asked for by name.
fn selected(
    entries: &[Entry],
    options: &ReadOptions,
    is_time: impl Fn(usize) -> bool,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<usize>, Fault> {
    if !options.names.is_empty() {
        return Err(Fault::NoTable);
    }
    options.units.iter().try_for_each(|(name, _)| find_entry(entries, name).map(|_| ()))?;
    let fault = |entry: &Entry| {
        let channel = || entry.label().to_owned();
        let unread = entry.unread.clone().map(|why| Fault::NotRead { channel: channel(), why });
        unread.or_else(|| (entry.samples == 0).then(|| Fault::NoSamples { channel: channel() }))
    };
    let usable = || (0..entries.len()).filter(|place| !is_time(*place) && fault(&entries[*place]).is_none());
    let wanted = match &options.channels {
        ChannelSelection::Named(names) => {
            names.iter().map(|name| find_entry(entries, name)).collect::<Result<Vec<_>, _>>()?
        }
        ChannelSelection::Only if usable().nth(1).is_some() => {
            let found = usable().map(|place| entries[place].label().to_owned()).collect();
            return Err(ChannelFault::NotOne { found }.into());
        }
        _ => usable().collect(),
    };
    match &options.channels {
        ChannelSelection::Named(_) => {
            wanted.iter().try_for_each(|place| fault(&entries[*place]).map_or(Ok(()), Err))?
        }
        _ => warnings.extend(entries.iter().filter_map(|entry| {
            let why = entry.unread.clone().or_else(|| (entry.samples == 0).then(|| "it has no samples".to_owned()))?;
            Some(Warning::ChannelNotRead { channel: entry.label().to_owned(), why })
        })),
    }
    if wanted.is_empty() {
        return Err(Fault::NoChannel);
    }
    let samples = wanted.iter().fold(0, |sum: u64, place| sum.saturating_add(entries[*place].samples));
    if samples > MOST_VALUES as u64 { Err(Fault::TooLarge) } else { Ok(wanted) }
}

/// The unit of the file or of the caller; both where they agree. A warning where it is not known.
fn unit(entry: &Entry, options: &ReadOptions, warnings: &mut Vec<Warning>) -> Result<Option<Unit>, Fault> {
    let column = &entry.column;
    let named = options.units.iter().find(|(name, _)| *name == column.name || *name == column.label);
    match (&column.unit, named.map(|(_, unit)| unit).or(options.unit.as_ref())) {
        (Some(file), Some(given)) if file != given => {
            let [file, given] = [file, given].map(|unit| unit.symbol().to_owned());
            Err(ChannelFault::GivenUnit { name: column.label.clone(), file, given }.into())
        }
        (Some(unit), _) | (None, Some(unit)) => Ok(Some(unit.clone())),
        (None, None) => {
            let channel = column.label.clone();
            warnings.push(match &column.unknown_unit {
                Some(unit) => Warning::UnknownUnit { channel, unit: unit.clone() },
                None => Warning::NoUnit { channel },
            });
            Ok(None)
        }
    }
}

/// The values of a channel, in SI where its unit is known.
fn values(file: &mut dyn Catalogue, entry: &Entry, place: usize, unit: Option<&Unit>) -> Result<Vec<f64>, Fault> {
    let mut values = file.values(place)?;
    if values.iter().any(|value| value.is_infinite()) {
        return Err(ChannelFault::NotFinite { name: entry.label().to_owned() }.into());
    }
    if let Some(unit) = unit.filter(|unit| !unit.is_si()) {
        values.iter_mut().for_each(|value| *value = unit.to_si(*value));
    }
    Ok(values)
}

/// The times of channels; those that several share are read once.
struct Times<'a> {
    entries: &'a [Entry],
    known: BTreeMap<(Option<usize>, [u64; 3]), Numbers>,
}

impl Times<'_> {
    fn read(
        &mut self,
        file: &mut dyn Catalogue,
        place: usize,
        axis: &Axis,
        warnings: &mut Vec<Warning>,
    ) -> Result<Numbers, Fault> {
        let entry = &self.entries[place];
        let key = match axis {
            Axis::Steps { start, step } => (None, [start.to_bits(), step.to_bits(), entry.samples]),
            Axis::Channel(time) => (Some(*time), [0; 3]),
            Axis::Unknown => return Err(Fault::NoTime { channel: entry.label().to_owned() }),
        };
        if let Axis::Channel(time) = axis {
            let time = &self.entries[*time];
            if time.samples != entry.samples {
                let [channel, name] = [entry, time].map(|entry| entry.label().to_owned());
                return Err(Fault::TimeLength { channel, time: name, found: entry.samples, times: time.samples });
            }
        }
        if let Some(times) = self.known.get(&key) {
            return Ok(times.clone());
        }
        let times: Numbers = match axis {
            Axis::Channel(time) => channel_times(file, &self.entries[*time], *time, warnings)?.into(),
            Axis::Steps { start, step } => stepped(entry, *start, *step)?.into(),
            Axis::Unknown => Vec::new().into(),
        };
        self.known.insert(key, times.clone());
        Ok(times)
    }
}

fn stepped(entry: &Entry, start: f64, step: f64) -> Result<Vec<f64>, Fault> {
    let at = |index: u64| start + step * index as f64;
    let last = at(entry.samples.saturating_sub(1));
    // Two samples at the end differ where all do: the digits are fewest at an end.
    let distinct = entry.samples < 2 || (at(entry.samples - 2) < last && start < at(1));
    if !(step > 0.0 && start.is_finite() && last.is_finite() && distinct) {
        return Err(Fault::Increment { channel: entry.label().to_owned(), start, step });
    }
    Ok((0..entry.samples).map(at).collect())
}

fn channel_times(
    file: &mut dyn Catalogue,
    entry: &Entry,
    place: usize,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<f64>, Fault> {
    let wrong = |unit: &str| ChannelFault::TimeUnit { name: entry.label().to_owned(), unit: unit.to_owned() };
    let column = &entry.column;
    match (&column.unit, &column.unknown_unit) {
        (Some(unit), _) if !unit.measures(Time::DIMENSION) => return Err(wrong(unit.symbol()).into()),
        (None, Some(unit)) => return Err(wrong(unit).into()),
        (None, None) => warnings.push(Warning::TimeUnitAssumed { channel: entry.label().to_owned() }),
        (Some(_), _) => {}
    }
    let times = values(file, entry, place, column.unit.as_ref())?;
    if times.iter().any(|time| time.is_nan()) {
        return Err(Fault::TimeGap { channel: entry.label().to_owned() });
    }
    match times.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => Err(ChannelFault::TimeNotIncreasing { time: pair[1], previous: pair[0] }.into()),
        None => Ok(times),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Listed(Vec<Entry>);

    impl Catalogue for Listed {
        fn entries(&self) -> &[Entry] {
            &self.0
        }

        fn annotations(&self) -> Annotations {
            Annotations::default()
        }

        fn values(&mut self, place: usize) -> Result<Vec<f64>, Fault> {
            Ok(vec![place as f64])
        }
    }

    /// A cost quadratic in the channels would take minutes.
    #[test]
    fn the_cost_of_many_channels_is_linear() {
        let entry = |place: usize| {
            let name = if place == 0 { "time [s]".to_owned() } else { format!("a{place}") };
            Ok(Entry { samples: 1, ..Entry::new("G", &name, None)? })
        };
        let entries = (0..100_000).map(entry).collect::<Result<Vec<_>, Fault>>().unwrap();
        let found = measure(&mut Listed(entries), Path::new("a"), &ReadOptions::default()).unwrap();
        assert_eq!(found.channels.len(), 99_999);
        assert!(found.channels.iter().all(|channel| channel.series.time() == [0.0]));
    }
}
