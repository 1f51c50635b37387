//! The channels of a file, before their values are read: each with a unit, and a time of its own or one that several share. The
//! [`Reader`] of a format reads the values; which channels are wanted, their units and their times are settled here for all formats.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use crate::error::{Error, Kind, refusal};
use crate::signal::column_name::ColumnName;
use crate::signal::measurement::{MOST_VALUES, find, no_unit, not_a_time, not_finite, not_increasing, not_one};
use crate::signal::{Annotations, ChannelSelection, MeasuredChannel, Measurement, ReadOptions, Series, Warning};
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
    /// The name that a channel code stands for, where the file states it; the channel is found by it, too.
    pub long_name: Option<String>,
    /// Number of samples; none where the values alone show it.
    pub samples: Option<u64>,
    /// Times of the samples.
    pub axis: Axis,
    /// The channel frequency class that it was filtered with before, as the file states beside it.
    pub filtered: Option<f64>,
    /// Whether it is read only where it is named: a time axis, or a channel beside the file that is asked for.
    pub by_name_only: bool,
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
    /// By statements that are wrong or missing; channels of a table share the refusal, which names all of them.
    Refused(Rc<Error>),
}

impl Entry {
    /// The channel of a `group` with this name and unit; without samples and times as yet.
    pub fn from_column(group: &str, mut column: ColumnName) -> Entry {
        if !group.is_empty() {
            column.label = format!("{group}/{}", column.label);
        }
        Entry {
            group: group.to_owned(),
            column,
            long_name: None,
            samples: None,
            axis: Axis::Unknown,
            filtered: None,
            by_name_only: false,
            unread: None,
        }
    }

    /// The channel `name` of a `group`, with the unit that the file states of it; without samples and times as yet.
    ///
    /// # Errors
    /// Its name states another unit.
    pub fn new(group: &str, name: &str, unit: Option<&str>) -> Result<Entry, Error> {
        let mut entry = Entry::from_column(group, ColumnName { label: name.to_owned(), ..ColumnName::read(name) });
        let column = &mut entry.column;
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
        Ok(entry)
    }

    /// The name with the group before it.
    pub fn label(&self) -> &str {
        &self.column.label
    }

    /// The name, with the group before it where there is one: without the unit that a header may have behind it.
    fn title(&self) -> &str {
        if self.group.is_empty() { &self.column.name } else { self.label() }
    }

    /// The names by which it is found.
    fn names(&self) -> [&str; 2] {
        [&self.column.name, self.long_name.as_deref().unwrap_or(self.label())]
    }

    /// The unit of the file or of the caller, which may also give one of all `others`; both where they agree.
    fn unit(&self, options: &ReadOptions, others: Option<&Unit>) -> Result<Option<Unit>, Error> {
        options.unit(self.names(), self.column.unit.as_ref(), others, self.title())
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

/// Most columns of an array, and of all of a file, that become channels.
const MOST_COLUMNS: u64 = 10_000;
const MOST_CHANNELS: usize = 100_000;

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
            // An array without rows takes no bytes, however many columns it has.
            Ok([0, _]) => (0, 1, None),
            Ok([rows, columns]) => (rows, columns, None),
            Err(why) => (0, 1, Some(why)),
        };
        if self.entries.len() + columns as usize > MOST_CHANNELS {
            return Err(refusal!("more than {MOST_CHANNELS} channels"));
        }
        for column in 0..columns {
            let own = if columns > 1 { format!("{name}(:,{})", column + 1) } else { name.to_owned() };
            let mut entry = Entry::new(group, &own, unit)?;
            entry.samples = Some(rows);
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

/// Values that were read before they are asked for, by the places of their channels.
#[derive(Clone, Debug, Default)]
pub struct Loaded(HashMap<usize, Vec<Vec<f64>>>);

impl Loaded {
    /// Adds the values of a channel, as often as they are asked for.
    pub fn insert(&mut self, place: usize, values: Vec<f64>) {
        self.0.entry(place).or_default().push(values);
    }

    /// The values of a channel, for the last time.
    pub fn take(&mut self, place: usize) -> Vec<f64> {
        self.0.get_mut(&place).and_then(Vec::pop).unwrap_or_default()
    }
}

/// What a mistake in a file is about, by which a format finds its place.
#[derive(Clone, Copy, Debug)]
pub enum Subject {
    /// The list of the channels.
    List,
    /// The unit of the channel at this place in the list.
    Unit(usize),
    /// The statements on the times of a channel.
    Times(usize),
    /// A sample of a channel, counted from zero.
    Sample(usize, usize),
}

/// How messages about a format speak of its channels.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// What names a channel.
    pub channel: &'static str,
    /// A list without a channel to read.
    pub none: &'static str,
    /// Whether it is a table in text, to which the caller may give names, and whose columns may do without units.
    pub is_table: bool,
}

/// A file whose channels are listed.
pub struct Catalogue {
    /// Its channels, in the order of the file.
    pub entries: Vec<Entry>,
    /// Comments of the file, and what its reading reports.
    pub annotations: Annotations,
    /// Reads the values.
    pub reader: Box<dyn Reader>,
}

/// Reads the values of a file of one format, whose channels are listed.
pub trait Reader {
    /// The values of the channel at a place of the list, in the unit of the file; `NaN` where nothing was measured.
    fn values(&mut self, place: usize) -> Result<Vec<f64>, Error>;

    /// Reads the values of these channels and `times` before they are asked for, where the file is read once from its beginning.
    fn load(&mut self, _channels: &[usize], _times: &[usize], _warnings: &mut Vec<Warning>) -> Result<(), Error> {
        Ok(())
    }

    /// Compares what the file states of a channel with its samples, in the unit of the file.
    fn review(&self, _place: usize, _times: &Numbers, _values: &[f64], _: &mut Vec<Warning>) -> Result<(), Error> {
        Ok(())
    }

    /// A mistake with its place in the file.
    fn locate(&self, _subject: Subject, error: Error) -> Error {
        error
    }

    /// How messages speak of its channels.
    fn terms(&self) -> Terms {
        Terms { channel: "GROUP/CHANNEL", none: "no channel with numbers", is_table: false }
    }
}

impl Catalogue {
    /// Of a file with these channels, comments and warnings.
    pub fn new(entries: Vec<Entry>, annotations: Annotations, reader: impl Reader + 'static) -> Catalogue {
        Catalogue { entries, annotations, reader: Box::new(reader) }
    }

    /// Reads the wanted channels, each over its times.
    ///
    /// Holds them and nothing else of the file: 8 bytes a value, and as much again for one channel while it is finished.
    pub fn measure(mut self, options: &ReadOptions) -> Result<Measurement, Error> {
        let given = options.time.as_ref().map(|name| self.find(name)).transpose()?;
        let named = named_times(&self.entries);
        let axes = self.entries.iter().map(|entry| axis(&self.entries, entry, given, &named));
        let axes: Vec<Result<Axis, Error>> = axes.collect();
        let of_channel = |axis: &Result<Axis, Error>| match axis {
            Ok(Axis::Channel(time)) => Some(*time),
            _ => None,
        };
        let times: HashSet<usize> = axes.iter().filter_map(of_channel).chain(given).collect();
        let wanted = self.selected(options, |place| times.contains(&place))?;
        let (mut timed, mut untimed, mut times) = (Vec::new(), None, Times::default());
        for place in wanted {
            match &axes[place] {
                Ok(Axis::Refused(error)) => return Err(Error::clone(error)),
                Ok(axis) => {
                    times.add(&mut self, axis, options)?;
                    timed.push((place, axis, self.unit(place, options)?));
                }
                Err(_) => {
                    untimed.get_or_insert(place);
                    let (channel, why) = (self.entries[place].label().to_owned(), "it has no time".to_owned());
                    self.annotations.warnings.push(Warning::ChannelNotRead { channel, why });
                }
            }
        }
        let places: Vec<usize> = timed.iter().map(|(place, ..)| *place).collect();
        self.reader.load(&places, &times.places(), &mut self.annotations.warnings)?;
        let mut channels = Vec::new();
        for (place, axis, unit) in timed {
            let values = self.finite(place)?;
            let time = times.read(&mut self, place, axis, values.len())?;
            self.reader.review(place, &time, &values, &mut self.annotations.warnings)?;
            let series = Series::new(time, in_si(values, unit.as_ref()));
            let entry = &self.entries[place];
            let filtered = entry.filtered.or_else(|| self.annotations.filter_class(&entry.column.name));
            let [name, label] = entry.names().map(str::to_owned);
            channels.push(MeasuredChannel { name, label, unit, filtered, series });
        }
        // Some channels, such as figures beside the recording, may have no time; one that is asked for needs it.
        match untimed {
            Some(place) if channels.is_empty() || options.channels != ChannelSelection::All => {
                axes.into_iter().nth(place).transpose()?;
            }
            _ => {}
        }
        Ok(Measurement { channels, annotations: self.annotations })
    }

    /// Reads the wanted channels as columns of one length, over the number of the sample in place of a time.
    pub fn columns(mut self, options: &ReadOptions) -> Result<Measurement, Error> {
        let wanted = self.selected(options, |_| false)?;
        let mut entries = wanted.iter().map(|place| &self.entries[*place]);
        if let Some(first) = entries.next()
            && let Some(other) = entries.find(|other| other.samples != first.samples)
        {
            let [name, other_name] = [first, other].map(Entry::label);
            let [length, found] = [first, other].map(|entry| entry.samples.unwrap_or_default());
            return Err(refusal!(
                "without a time, all channels need one length: `{name}` has {length} samples, `{other_name}` {found}"
            )
            .with_hint(BELONG_TOGETHER));
        }
        let units = wanted.iter().map(|place| self.unit(*place, options)).collect::<Result<Vec<_>, _>>()?;
        self.reader.load(&wanted, &[], &mut self.annotations.warnings)?;
        let (mut channels, mut numbers) = (Vec::new(), Numbers::from(Vec::new()));
        for (place, unit) in wanted.into_iter().zip(units) {
            let values = in_si(self.finite(place)?, unit.as_ref());
            let [name, label] = self.entries[place].names().map(str::to_owned);
            if numbers.len() != values.len() {
                numbers = (0..values.len()).map(|number| number as f64).collect();
            }
            let series = Series::new(numbers.clone(), values);
            channels.push(MeasuredChannel { name, label, unit, filtered: None, series });
        }
        Ok(Measurement { channels, annotations: self.annotations })
    }

    /// The place of the one channel called `name`, with its group or without.
    fn find(&self, name: &str) -> Result<usize, Error> {
        let names = self.entries.iter().map(|entry| entry.names().into());
        find(name, names).map_err(|error| self.reader.locate(Subject::List, error))
    }

    /// Places of the wanted channels; a time is none of them unless it is asked for by name.
    fn selected(&mut self, options: &ReadOptions, is_time: impl Fn(usize) -> bool) -> Result<Vec<usize>, Error> {
        let (terms, entries) = (self.reader.terms(), &self.entries);
        if !options.names.is_empty() && !terms.is_table {
            let error = refusal!("column names are given, but the file is not a table");
            return Err(error.with_hint("its channels have their own names; leave the names out"));
        }
        options.units.iter().try_for_each(|(name, _)| self.find(name).map(|_| ()))?;
        let fault = |entry: &Entry| match &entry.unread {
            Some(why) => Some(not_read(entry, why)),
            None => (entry.samples == Some(0)).then(|| refusal!("`{}` has no samples", entry.label())),
        };
        let is_usable = |place: &usize| {
            let entry = &entries[*place];
            !is_time(*place) && !entry.by_name_only && fault(entry).is_none()
        };
        let usable = || (0..entries.len()).filter(is_usable);
        let wanted = match &options.channels {
            ChannelSelection::Named(names) => {
                names.iter().map(|name| self.find(name)).collect::<Result<Vec<_>, _>>()?
            }
            ChannelSelection::Only if usable().nth(1).is_some() => {
                let found: Vec<&str> = usable().map(|place| entries[place].label()).collect();
                return Err(self.reader.locate(Subject::List, not_one(&found, terms.channel)));
            }
            _ => usable().collect(),
        };
        match &options.channels {
            ChannelSelection::Named(_) => {
                wanted.iter().try_for_each(|place| fault(&entries[*place]).map_or(Ok(()), Err))?
            }
            _ => self.annotations.warnings.extend(entries.iter().filter_map(|entry| {
                let is_empty = entry.samples == Some(0);
                let why = entry.unread.clone().or_else(|| is_empty.then(|| "it has no samples".to_owned()))?;
                Some(Warning::ChannelNotRead { channel: entry.label().to_owned(), why })
            })),
        }
        if wanted.is_empty() {
            return Err(self.reader.locate(Subject::List, Error::new(terms.none)));
        }
        let samples = wanted.iter().filter_map(|place| entries[*place].samples).fold(0, u64::saturating_add);
        if samples <= MOST_VALUES as u64 {
            return Ok(wanted);
        }
        Err(refusal!("more than {MOST_VALUES} samples").with_hint("name the channels that are needed"))
    }

    /// The unit of the channel at a place of the list, which the file or the caller gives; a warning where it is not known.
    fn unit(&mut self, place: usize, options: &ReadOptions) -> Result<Option<Unit>, Error> {
        let entry = &self.entries[place];
        let unit = entry.unit(options, options.unit.as_ref());
        let unit = unit.map_err(|error| self.reader.locate(Subject::Unit(place), error))?;
        let unknown = entry.column.unknown_unit.as_deref();
        if unit.is_none() && (unknown.is_some() || !self.reader.terms().is_table) {
            self.annotations.warnings.push(no_unit(entry.label(), unknown));
        }
        Ok(unit)
    }

    /// The values of a channel, in the unit of the file.
    fn finite(&mut self, place: usize) -> Result<Vec<f64>, Error> {
        let values = self.reader.values(place)?;
        if values.iter().any(|value| value.is_infinite()) {
            Err(not_finite(self.entries[place].label()))
        } else {
            Ok(values)
        }
    }
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
        other => return Ok(other),
    }
    let times = named.get(entry.group.as_str()).map_or(&[][..], Vec::as_slice);
    match *times {
        [time] => Ok(Axis::Channel(time)),
        [] => Err(no_time(entry)),
        _ => {
            let found = listed(times.iter().map(|time| entries[*time].label()));
            Err(refusal!("several channels of time: {found}").with_hint(NAME_THE_TIME))
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

fn in_si(mut values: Vec<f64>, unit: Option<&Unit>) -> Vec<f64> {
    if let Some(unit) = unit.filter(|unit| !unit.is_si()) {
        values.iter_mut().for_each(|value| *value = unit.to_si(*value));
    }
    values
}

/// The times of channels; those that several share are read once.
#[derive(Default)]
struct Times {
    /// Units of the channels of time, by their places.
    units: BTreeMap<usize, Option<Unit>>,
    known: BTreeMap<(Option<usize>, [u64; 3]), Numbers>,
}

impl Times {
    /// Adds the channel of an axis, whose unit must be one of time.
    fn add(&mut self, file: &mut Catalogue, axis: &Axis, options: &ReadOptions) -> Result<(), Error> {
        let Axis::Channel(place) = axis else { return Ok(()) };
        if self.units.contains_key(place) {
            return Ok(());
        }
        let entry = &file.entries[*place];
        let wrong = |unit: &str| file.reader.locate(Subject::Unit(*place), not_a_time(entry.title(), unit));
        let unit = match (entry.unit(options, None), &entry.column.unknown_unit) {
            (_, Some(unknown)) => return Err(wrong(unknown)),
            (Err(error), _) => return Err(file.reader.locate(Subject::Unit(*place), error)),
            (Ok(Some(unit)), _) if !unit.measures(Time::DIMENSION) => return Err(wrong(unit.symbol())),
            (Ok(unit), _) => unit,
        };
        if unit.is_none() {
            let channel = entry.label().to_owned();
            file.annotations.warnings.push(Warning::TimeUnitAssumed { channel });
        }
        self.units.insert(*place, unit);
        Ok(())
    }

    /// The places of the channels of time.
    fn places(&self) -> Vec<usize> {
        self.units.keys().copied().collect()
    }

    /// The times of the `samples` of the channel at a place of the list.
    fn read(&mut self, file: &mut Catalogue, place: usize, axis: &Axis, samples: usize) -> Result<Numbers, Error> {
        let key = match axis {
            Axis::Steps { start, step } => (None, [start.to_bits(), step.to_bits(), samples as u64]),
            Axis::Channel(time) => (Some(*time), [0; 3]),
            Axis::Unknown | Axis::Refused(_) => return Err(no_time(&file.entries[place])),
        };
        let times = match (self.known.get(&key), axis) {
            (Some(times), _) => times.clone(),
            (None, Axis::Steps { start, step }) => stepped(&file.entries[place], *start, *step, samples)
                .map_err(|error| file.reader.locate(Subject::Times(place), error))?
                .into(),
            (None, Axis::Channel(time)) => self.of_channel(file, *time)?.into(),
            (None, _) => Vec::new().into(),
        };
        if let Axis::Channel(time) = axis
            && times.len() != samples
        {
            let ([channel, name], count) = ([place, *time].map(|place| file.entries[place].label()), times.len());
            let error = refusal!("`{channel}` has {samples} samples over {count} times of `{name}`");
            return Err(file.reader.locate(Subject::Times(place), error.with_hint(BELONG_TOGETHER)));
        }
        self.known.insert(key, times.clone());
        Ok(times)
    }

    /// The values of a channel of time, s.
    fn of_channel(&self, file: &mut Catalogue, place: usize) -> Result<Vec<f64>, Error> {
        let times = file.finite(place)?;
        let label = file.entries[place].label();
        let at = |sample: usize, error: Error| Err(file.reader.locate(Subject::Sample(place, sample), error));
        if let Some(sample) = times.iter().position(|time| time.is_nan()) {
            return at(sample, refusal!("a sample of the time axis `{label}` was not measured"));
        }
        if let Some(sample) = (1..times.len()).find(|sample| times[*sample] <= times[sample - 1]) {
            return at(sample, not_increasing(times[sample], times[sample - 1]));
        }
        Ok(in_si(times, self.units.get(&place).and_then(Option::as_ref)))
    }
}

fn stepped(entry: &Entry, start: f64, step: f64, samples: usize) -> Result<Vec<f64>, Error> {
    let at = |index: usize| start + step * index as f64;
    let last = at(samples.saturating_sub(1));
    // Two samples at the end differ where all do: the digits are fewest at an end.
    let distinct = samples < 2 || (at(samples - 2) < last && start < at(1));
    if !(step > 0.0 && start.is_finite() && last.is_finite() && distinct) {
        let (label, [start, step]) = (entry.label(), [start, step].map(|time| significant(time, 9)));
        return Err(refusal!("`{label}` begins at {start} s and has the increment {step} s"));
    }
    Ok((0..samples).map(at).collect())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use serde::Deserialize;

    use super::*;
    use crate::signal::file;

    #[test]
    fn arrays_become_few_channels() {
        let mut columns = Columns::default();
        for (shape, channels) in [([0, 10_000], 1), ([2, 3], 3), ([1, 20_000], 1), ([1, 10_000], 10_000)] {
            let before = columns.entries.len();
            columns.push(["", "a"], None, 0, Ok(shape)).unwrap();
            assert_eq!(columns.entries.len() - before, channels, "{shape:?}");
        }
        let error = (0..10).find_map(|_| columns.push(["", "a"], None, 0, Ok([1, 10_000])).err()).unwrap();
        assert_eq!(error.to_string(), "more than 100000 channels");
    }

    // Files that other programs wrote or that were made after descriptions of their formats, read as those programs' readers
    // read them: `tests/formats/recordings.py` made them and what is expected of them.

    const FORMATS: [&str; 5] = ["tdms", "xlsx", "mat", "hdf5", "t01"];

    /// What another reader finds in a channel, in SI where its unit is known.
    #[derive(Deserialize)]
    struct Expected {
        time: Vec<f64>,
        /// None where nothing was measured.
        values: Vec<Option<f64>>,
    }

    fn folder(format: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/it/formats").join(format)
    }

    fn close(found: &[f64], expected: &[f64]) -> bool {
        let largest = expected.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        found.len() == expected.len()
            && found.iter().zip(expected).all(|(found, expected)| {
                (found.is_nan() && expected.is_nan()) || (found - expected).abs() <= 1e-9 * largest
            })
    }

    /// Every channel of every file of a format.
    fn check(format: &str) {
        let text = fs::read_to_string(folder(format).join("expected.json")).unwrap();
        let expected: BTreeMap<String, BTreeMap<String, Expected>> = serde_json::from_str(&text).unwrap();
        for (name, channels) in &expected {
            let path = folder(format).join(name);
            let found = file::read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
            let labels: Vec<&str> = found.channels.iter().map(|channel| channel.label.as_str()).collect();
            assert_eq!(labels.len(), channels.len(), "{name}: {labels:?}");
            for (label, expected) in channels {
                let channel = found.channel(label).unwrap_or_else(|error| panic!("{name}: {error}"));
                assert!(close(channel.series.time(), &expected.time), "{name}, {label}: {:?}", channel.series.time());
                let values: Vec<f64> = expected.values.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
                assert!(close(channel.series.values(), &values), "{name}, {label}: {:?}", channel.series.values());
                let one =
                    ReadOptions { channels: ChannelSelection::Named(vec![label.clone()]), ..ReadOptions::default() };
                let Measurement { channels, .. } = file::read(&path, &one).unwrap();
                assert!(close(channels[0].series.values(), channel.series.values()), "{name}, {label}");
            }
        }
    }

    /// Files of up to 400 bytes that are cut at every byte, and of which every byte is another, are read or refused; longer ones at some
    /// 20 places, in a thorough run 80.
    fn damage(format: &str) {
        let scratch = tempfile::tempdir().unwrap();
        for entry in
            fs::read_dir(folder(format)).unwrap().flatten().filter(|entry| !entry.file_name().eq("expected.json"))
        {
            let bytes = fs::read(entry.path()).unwrap();
            let path = scratch.path().join(entry.file_name());
            let step = if bytes.len() <= 400 { 1 } else { 1 + bytes.len() / thorough::choose(20, 80) };
            for place in (0..bytes.len()).step_by(step) {
                let mut other = bytes.clone();
                other[place] ^= 0xff;
                for damaged in [&bytes[..place], &other] {
                    fs::write(&path, damaged).unwrap();
                    for read in [
                        file::read(&path, &ReadOptions::default()).map(drop),
                        file::columns(&path, &ReadOptions::default()).map(drop),
                    ] {
                        if let Err(error) = read {
                            assert!(!error.to_string().is_empty());
                            let _ = (error.message().len(), error.hint().map(str::len), error.place());
                        }
                    }
                }
            }
        }
    }

    /// As npTDMS, pandas, SciPy and h5py read them; time histories as they were made.
    #[test]
    fn files_are_read_as_other_readers_read_them() {
        FORMATS.iter().for_each(|format| check(format));
    }

    #[test]
    fn damaged_files_are_read_or_refused() {
        FORMATS.iter().for_each(|format| damage(format));
    }

    struct Places;

    impl Reader for Places {
        fn values(&mut self, place: usize) -> Result<Vec<f64>, Error> {
            Ok(vec![place as f64])
        }
    }

    /// A cost quadratic in the channels would take minutes.
    #[test]
    fn the_cost_of_many_channels_is_linear() {
        let entry = |place: usize| {
            let name = if place == 0 { "time [s]".to_owned() } else { format!("a{place}") };
            Ok(Entry { samples: Some(1), ..Entry::new("G", &name, None)? })
        };
        let entries = (0..100_000).map(entry).collect::<Result<Vec<_>, Error>>().unwrap();
        let found = Catalogue::new(entries, Annotations::default(), Places).measure(&ReadOptions::default()).unwrap();
        assert_eq!(found.channels.len(), 99_999);
        assert!(found.channels.iter().all(|channel| channel.series.time() == [0.0]));
    }
}
