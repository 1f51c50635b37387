//! Recordings in files that list their channels before the values: each with a group, a unit, and a time of its own or
//! one that several share.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

use crate::error::{Error, Kind, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::measurement::{MOST_VALUES, find, no_unit, not_a_time, not_finite, not_increasing, not_one};
use crate::signal::{Annotations, ChannelSelection, MeasuredChannel, Measurement, ReadOptions, Series, Warning, csv};
use base::budget::Numbers;
use base::diagnostic::listed;
use base::number::significant;
use base::units::{Time, Unit};

/// A channel as its file lists it, before its values are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Group in which it is; empty where the file has none.
    pub group: String,
    /// Name and unit; its label has the group before it: `GROUP/CHANNEL`.
    pub column: ColumnName,
    /// Number of samples.
    pub samples: u64,
    /// Times of the samples.
    pub axis: Axis,
    /// Why its values cannot be read, where they cannot.
    pub unread: Option<String>,
}

/// How a file gives the times of a channel.
#[derive(Clone, Debug, PartialEq)]
pub enum Axis {
    /// By their start and increment, s.
    Steps {
        /// Time of the first sample, s.
        start: f64,
        /// From sample to sample, s.
        step: f64,
    },
    /// By another channel, at this place in the list.
    Channel(usize),
    /// Not at all; a channel of its group may be named like a time.
    Unknown,
}

impl Entry {
    /// The channel `name` of a `group`, with the unit that the file states of it; without samples and times as yet.
    ///
    /// # Errors
    /// Its name states another unit.
    pub fn new(group: &str, name: &str, unit: Option<&str>) -> Result<Entry, Error> {
        let mut column = ColumnName::read(name);
        column.label = if group.is_empty() { name.to_owned() } else { format!("{group}/{name}") };
        match unit.map(str::trim).filter(|unit| !unit.is_empty()).map(|unit| (unit, Unit::parse(unit))) {
            Some((stated, Ok(unit))) => {
                if let Some(named) = column.unit.as_ref().filter(|named| **named != unit) {
                    let (label, named) = (&column.label, named.symbol());
                    return Err(refusal!(
                        "mixed units: the name of `{label}` states `{named}`, its properties `{stated}`"
                    ));
                }
                column.unit = Some(unit);
                column.unknown_unit = None;
            }
            Some((stated, Err(_))) if column.unit.is_none() => column.unknown_unit = Some(stated.to_owned()),
            _ => {}
        }
        Ok(Entry { group: group.to_owned(), column, samples: 0, axis: Axis::Unknown, unread: None })
    }

    /// The name with the group before it.
    pub fn label(&self) -> &str {
        &self.column.label
    }
}

/// Channels and the arrays that they are columns of.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// The channels.
    pub entries: Vec<Entry>,
    /// Array and column of each.
    pub places: Vec<(usize, usize)>,
}

/// Most columns of an array that become channels.
const MOST_COLUMNS: u64 = 10_000;

impl Columns {
    /// Adds an array of so many rows and columns, or the reason why its values cannot be read.
    pub fn push(
        &mut self,
        [group, name]: [&str; 2],
        unit: Option<&str>,
        array: usize,
        shape: Result<[u64; 2], String>,
    ) -> Result<(), Error> {
        let (rows, columns, unread) = match shape {
            Ok([_, columns]) if columns > MOST_COLUMNS => (0, 1, Some(format!("it has {columns} columns"))),
            Ok([rows, columns]) => (rows, columns, None),
            Err(why) => (0, 1, Some(why)),
        };
        for column in 0..columns {
            let own = if columns > 1 { format!("{name}(:,{})", column + 1) } else { name.to_owned() };
            let mut entry = Entry::new(group, &own, unit)?;
            entry.samples = rows;
            entry.unread.clone_from(&unread);
            self.entries.push(entry);
            self.places.push((array, column as usize));
        }
        Ok(())
    }
}

/// How the bytes of a number are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    /// A whole number, in two's complement.
    Signed,
    /// A whole number that is not negative.
    Unsigned,
    /// Of IEEE 754.
    Float,
}

impl Binary {
    /// The number in one to eight `bytes`, of a fraction in four or eight; none in others.
    pub fn number(self, bytes: &[u8], is_big: bool) -> Option<f64> {
        let size = bytes.len();
        let mut own = [0; 8];
        own.get_mut(..size)?.copy_from_slice(bytes);
        if is_big {
            own[..size].reverse();
        }
        let bits = u64::from_le_bytes(own);
        match (self, size) {
            (Binary::Float, 4) => Some(f32::from_bits(bits as u32).into()),
            (Binary::Float, 8) => Some(f64::from_bits(bits)),
            (_, 0) | (Binary::Float, _) => None,
            (Binary::Signed, _) => {
                let unused = 64 - 8 * size as u32;
                Some(((bits << unused) as i64 >> unused) as f64)
            }
            (Binary::Unsigned, _) => Some(bits as f64),
        }
    }
}

/// A file that lists its channels.
pub trait Catalogue {
    /// Its channels, in the order of the file.
    fn entries(&self) -> &[Entry];

    /// Comments of the file, and what its listing reports.
    fn annotations(&self) -> Annotations;

    /// The values of the channel at a place of the list, in the unit of the file; `NaN` where nothing was measured.
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error>;
}

/// Reads the wanted channels, each over its times.
///
/// Holds them and nothing else of the file: 8 bytes a value, and as much again for one channel while it is finished.
pub fn measure(file: &mut dyn Catalogue, path: &Path, options: &ReadOptions) -> Result<Measurement, Error> {
    measured(file, options).map_err(|error| error.in_file(path))
}

/// Reads the wanted channels without their times, as columns of one length.
pub fn columns(file: &mut dyn Catalogue, path: &Path, options: &ReadOptions) -> Result<csv::Table, Error> {
    tabled(file, options).map_err(|error| error.in_file(path))
}

fn measured(file: &mut dyn Catalogue, options: &ReadOptions) -> Result<Measurement, Error> {
    let mut annotations = file.annotations();
    let entries = file.entries().to_vec();
    let given = options.time.as_ref().map(|name| find_entry(&entries, name)).transpose()?;
    let named = named_times(&entries);
    let axes: Vec<Result<Axis, Error>> = entries.iter().map(|entry| axis(&entries, entry, given, &named)).collect();
    let of_channel = |axis: &Result<Axis, Error>| match axis {
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

fn tabled(file: &mut dyn Catalogue, options: &ReadOptions) -> Result<csv::Table, Error> {
    let mut annotations = file.annotations();
    let entries = file.entries().to_vec();
    let wanted = selected(&entries, options, |_| false, &mut annotations.warnings)?;
    if let Some(first) = wanted.first().map(|first| &entries[*first])
        && let Some(other) = wanted.iter().map(|place| &entries[*place]).find(|other| other.samples != first.samples)
    {
        let ([name, other_name], [length, found]) = ([first, other].map(Entry::label), [first.samples, other.samples]);
        return Err(refusal!(
            "without a time, all channels need one length: `{name}` has {length} samples, `{other_name}` {found}"
        )
        .with_hint(BELONG_TOGETHER));
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
fn find_entry(entries: &[Entry], name: &str) -> Result<usize, Error> {
    let names = entries.iter().map(|entry| (entry.column.name.as_str(), entry.label()));
    find(name, names)
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
) -> Result<Axis, Error> {
    match given.map_or_else(|| entry.axis.clone(), Axis::Channel) {
        Axis::Unknown => {}
        Axis::Channel(time) => {
            let unread = entries[time].unread.as_ref();
            return unread.map_or(Ok(Axis::Channel(time)), |why| Err(not_read(&entries[time], why)));
        }
        steps => return Ok(steps),
    }
    let times = named.get(entry.group.as_str()).map_or(&[][..], Vec::as_slice);
    match *times {
        [time] => Ok(Axis::Channel(time)),
        [] => Err(no_time(entry)),
        _ => {
            let found: Vec<String> = times.iter().map(|time| entries[*time].label().to_owned()).collect();
            Err(refusal!("several channels of time: {}", listed(&found)).with_hint(NAME_THE_TIME))
        }
    }
}

/// What helps where channels have no common time or length.
const BELONG_TOGETHER: &str = "name the channels that belong together: --column GROUP/CHANNEL";
const NAME_THE_TIME: &str = "name the channel of time: --time GROUP/CHANNEL";

fn no_time(entry: &Entry) -> Error {
    let label = entry.label();
    refusal!("no time of `{label}`: it has neither a start and an increment nor a channel of time beside it")
        .with_hint(NAME_THE_TIME)
        .with_kind(Kind::NoTime)
}

fn not_read(entry: &Entry, why: &str) -> Error {
    refusal!("`{}` cannot be read: {why}", entry.label())
}

/// Places of the wanted channels; a time is none of them unless it is asked for by name.
fn selected(
    entries: &[Entry],
    options: &ReadOptions,
    is_time: impl Fn(usize) -> bool,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<usize>, Error> {
    if !options.names.is_empty() {
        let error = refusal!("column names are given, but the file is not a table");
        return Err(error.with_hint("its channels have their own names; leave the names out"));
    }
    options.units.iter().try_for_each(|(name, _)| find_entry(entries, name).map(|_| ()))?;
    let fault = |entry: &Entry| match &entry.unread {
        Some(why) => Some(not_read(entry, why)),
        None => (entry.samples == 0).then(|| refusal!("`{}` has no samples", entry.label())),
    };
    let usable = || (0..entries.len()).filter(|place| !is_time(*place) && fault(&entries[*place]).is_none());
    let wanted = match &options.channels {
        ChannelSelection::Named(names) => {
            names.iter().map(|name| find_entry(entries, name)).collect::<Result<Vec<_>, _>>()?
        }
        ChannelSelection::Only if usable().nth(1).is_some() => {
            let found: Vec<String> = usable().map(|place| entries[place].label().to_owned()).collect();
            return Err(not_one(&found, "GROUP/CHANNEL"));
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
        return Err(no_channel());
    }
    let samples = wanted.iter().fold(0, |sum: u64, place| sum.saturating_add(entries[*place].samples));
    if samples <= MOST_VALUES as u64 {
        return Ok(wanted);
    }
    Err(refusal!("more than {MOST_VALUES} samples").with_hint("name the channels that are needed"))
}

/// Refuses a file that lists no channel, or none that has numbers.
pub fn no_channel() -> Error {
    refusal!("no channel with numbers")
}

/// The unit of the file or of the caller; both where they agree. A warning where it is not known.
fn unit(entry: &Entry, options: &ReadOptions, warnings: &mut Vec<Warning>) -> Result<Option<Unit>, Error> {
    let ColumnName { name, label, unit, unknown_unit } = &entry.column;
    let unit = options.unit([name, label], unit.as_ref(), options.unit.as_ref(), label)?;
    if unit.is_none() {
        warnings.push(no_unit(label, unknown_unit.as_deref()));
    }
    Ok(unit)
}

/// The values of a channel, in SI where its unit is known.
fn values(file: &mut dyn Catalogue, entry: &Entry, place: usize, unit: Option<&Unit>) -> Result<Vec<f64>, Error> {
    let mut values = file.values(place)?;
    if values.iter().any(|value| value.is_infinite()) {
        return Err(not_finite(entry.label()));
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
    ) -> Result<Numbers, Error> {
        let entry = &self.entries[place];
        let key = match axis {
            Axis::Steps { start, step } => (None, [start.to_bits(), step.to_bits(), entry.samples]),
            Axis::Channel(time) => (Some(*time), [0; 3]),
            Axis::Unknown => return Err(no_time(entry)),
        };
        if let Axis::Channel(time) = axis {
            let time = &self.entries[*time];
            if time.samples != entry.samples {
                let ([channel, name], [found, times]) =
                    ([entry, time].map(Entry::label), [entry.samples, time.samples]);
                return Err(refusal!("`{channel}` has {found} samples over {times} times of `{name}`")
                    .with_hint(BELONG_TOGETHER));
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

fn stepped(entry: &Entry, start: f64, step: f64) -> Result<Vec<f64>, Error> {
    let at = |index: u64| start + step * index as f64;
    let last = at(entry.samples.saturating_sub(1));
    // Two samples at the end differ where all do: the digits are fewest at an end.
    let distinct = entry.samples < 2 || (at(entry.samples - 2) < last && start < at(1));
    if !(step > 0.0 && start.is_finite() && last.is_finite() && distinct) {
        let (label, [start, step]) = (entry.label(), [start, step].map(|time| significant(time, 9)));
        return Err(refusal!("`{label}` begins at {start} s and has the increment {step} s"));
    }
    Ok((0..entry.samples).map(at).collect())
}

fn channel_times(
    file: &mut dyn Catalogue,
    entry: &Entry,
    place: usize,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<f64>, Error> {
    let wrong = |unit: &str| not_a_time(entry.label(), unit);
    let column = &entry.column;
    match (&column.unit, &column.unknown_unit) {
        (Some(unit), _) if !unit.measures(Time::DIMENSION) => return Err(wrong(unit.symbol())),
        (None, Some(unit)) => return Err(wrong(unit)),
        (None, None) => warnings.push(Warning::TimeUnitAssumed { channel: entry.label().to_owned() }),
        (Some(_), _) => {}
    }
    let times = values(file, entry, place, column.unit.as_ref())?;
    if times.iter().any(|time| time.is_nan()) {
        return Err(refusal!("a sample of the time `{}` was not measured", entry.label()));
    }
    match times.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => Err(not_increasing(pair[1], pair[0])),
        None => Ok(times),
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod cost {
    use super::*;

    struct Listed(Vec<Entry>);

    impl Catalogue for Listed {
        fn entries(&self) -> &[Entry] {
            &self.0
        }

        fn annotations(&self) -> Annotations {
            Annotations::default()
        }

        fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
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
        let entries = (0..100_000).map(entry).collect::<Result<Vec<_>, Error>>().unwrap();
        let found = measure(&mut Listed(entries), Path::new("a"), &ReadOptions::default()).unwrap();
        assert_eq!(found.channels.len(), 99_999);
        assert!(found.channels.iter().all(|channel| channel.series.time() == [0.0]));
    }
}
