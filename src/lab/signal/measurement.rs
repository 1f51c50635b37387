//! How a file is read, what its reading gives, and refusals that are alike in files of every format.

use std::collections::{HashMap, HashSet};

use super::column_name::{ColumnName, TIME};
use super::{Annotations, Channel, Recording, Series, Warning};
use crate::error::{Error, Kind, refusal};
use base::diagnostic::{closest, listed};
use base::units::{Dimension, Strain, Unit};

/// One channel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredChannel {
    /// Its name without the unit (`accel` of `accel [g]`), or its channel code.
    pub name: String,
    /// The name as the file writes it (`accel [g]`), or the long name of a channel code; it is found by this too.
    pub label: String,
    /// The unit that the file gives or the caller stated; none where neither is known.
    pub unit: Option<Unit>,
    /// The channel frequency class that it was filtered with before, as the file states.
    pub filtered: Option<f64>,
    /// Values in the SI unit where the unit is known, as written where it is not; `NaN` where nothing was measured.
    /// Time in s.
    pub series: Series,
}

impl MeasuredChannel {
    /// The series in the SI unit of `dimension`.
    ///
    /// # Errors
    /// The channel has another dimension, or no known unit.
    pub fn quantity(&self, dimension: Dimension) -> Result<&Series, Error> {
        check_dimension(&self.name, self.unit.as_ref(), dimension).map(|_| &self.series)
    }

    /// The unit of the values: SI where the unit is known.
    pub fn value_unit(&self) -> Option<String> {
        self.unit.as_ref().map(Unit::si_symbol)
    }

    /// The name with the SI unit, as droptower names columns: `accel_m_s2`, or else `accel [m/s2]`. A name that the
    /// file writes with its unit stays as it is where that is the SI unit, or one that is not known.
    pub fn column_name(&self) -> String {
        let name = &self.name;
        let says_it = self.label.starts_with(name);
        let written = ColumnName::read(if says_it { &self.label } else { name });
        let Some(unit) = &self.unit else {
            return written.label;
        };
        if unit.is_si() && written.unit.as_ref() == Some(unit) {
            return written.label;
        }
        match unit.si_suffix() {
            Some(suffix) => format!("{name}_{suffix}"),
            None => format!("{name} [{}]", column_unit(unit)),
        }
    }

    /// The name as the file writes it, before the SI unit: keeps channels apart that differ in their written units
    /// alone.
    fn labelled_column_name(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} [{}]", self.label, column_unit(unit)),
            None => self.label.clone(),
        }
    }
}

/// The unit of the channel `name`, if it measures `dimension`.
pub(crate) fn check_dimension<'u>(name: &str, unit: Option<&'u Unit>, dimension: Dimension) -> Result<&'u Unit, Error> {
    match unit {
        Some(unit) if unit.measures(dimension) => Ok(unit),
        Some(unit) => Err(refusal!("`{name}` is in {}, which is not {}", unit.symbol(), dimension.name)),
        None => {
            let kind = Kind::NoUnit { name: name.to_owned(), unit: dimension.unit };
            Err(refusal!("the unit of `{name}` is not known").with_kind(kind))
        }
    }
}

/// The refusal of a channel without a unit, with how to give one: in the header, or by an `option` for its name and its unit.
pub(crate) fn with_unit(error: Error, option: impl Fn(&str, &str) -> String) -> Error {
    let Kind::NoUnit { name, unit } = error.kind() else { return error };
    let hint = format!("write its unit into the header, e.g. `{name} [{unit}]`, or give {}", option(name, unit));
    error.with_hint(hint)
}

/// The SI unit in brackets; a number without unit is a dash.
fn column_unit(unit: &Unit) -> String {
    if unit.measures(Strain::DIMENSION) { "-".into() } else { unit.si_symbol() }
}

/// The channels of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// In the order of the file.
    pub channels: Vec<MeasuredChannel>,
    /// Comments of the file, and what its reading reports.
    pub annotations: Annotations,
}

impl Measurement {
    /// The channel called `name`: as the file writes it, by its name without the unit, or by its long name.
    pub fn channel(&self, name: &str) -> Result<&MeasuredChannel, Error> {
        let index = find(name, self.channels.iter().map(|channel| (channel.name.as_str(), channel.label.as_str())))?;
        Ok(&self.channels[index])
    }

    /// All channels over the time axis of the first, named with their SI units, each differently; none where they do
    /// not share one.
    pub fn recording(&self) -> Option<Recording> {
        let time = self.channels.first().map_or(&[][..], |channel| channel.series.time());
        let shared = self.channels.iter().all(|channel| same_axis(channel.series.time(), time));
        let channels = self.column_names().into_iter().zip(&self.channels);
        let channels = channels.map(|(name, measured)| Channel { name, values: measured.series.values().to_vec() });
        shared.then(|| Recording { time: time.to_vec(), channels: channels.collect() })
    }

    /// Names of columns of which no two are equal, and none is that of the time.
    fn column_names(&self) -> Vec<String> {
        let short: Vec<String> = self.channels.iter().map(MeasuredChannel::column_name).collect();
        let mut uses: HashMap<&str, usize> = HashMap::from([(TIME, 1)]);
        short.iter().for_each(|name| *uses.entry(name).or_default() += 1);
        let mut taken: HashSet<String> = HashSet::from([TIME.to_owned()]);
        let mut distinct = |(measured, short): (&MeasuredChannel, &String)| {
            let name = if uses[short.as_str()] == 1 { short.clone() } else { measured.labelled_column_name() };
            let numbered = (2..).map(|number| format!("{number} {name}"));
            let name = std::iter::once(name.clone()).chain(numbered).find(|name| !taken.contains(name)).unwrap_or(name);
            taken.insert(name.clone());
            name
        };
        self.channels.iter().zip(&short).map(&mut distinct).collect()
    }
}

/// Times that differ by less than this share of a step are the same: one channel has them written out, another by start
/// and step.
const SAME_TIME: f64 = 1e-3;

fn same_axis(a: &[f64], b: &[f64]) -> bool {
    let step = match b {
        [first, .., last] => (last - first) / (b.len() - 1) as f64,
        _ => 0.0,
    };
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME_TIME * step)
}

/// Place of the one pair of name and label that `wanted` asks for: the label itself, or else the name, with its group or without.
pub(super) fn find<'a>(wanted: &str, known: impl Iterator<Item = (&'a str, &'a str)> + Clone) -> Result<usize, Error> {
    let places = |hit: &dyn Fn(&str, &str) -> bool| -> Vec<usize> {
        known.clone().enumerate().filter(|(_, (name, label))| hit(name, label)).map(|(place, _)| place).collect()
    };
    let exact = places(&|_, label| label == wanted);
    let found = if exact.len() == 1 { exact } else { places(&|name, label| is_called(wanted, name, label)) };
    match found[..] {
        [place] => Ok(place),
        [] => {
            let names: Vec<String> = known.map(|(name, label)| titled(name, label)).collect();
            Err(missing(wanted, &names))
        }
        _ => {
            let found: Vec<(&str, &str)> =
                known.enumerate().filter(|(place, _)| found.contains(place)).map(|(_, pair)| pair).collect();
            if found.iter().all(|pair| *pair == found[0]) {
                return Err(refusal!("{} channels are called `{wanted}`, with equal labels", found.len())
                    .with_hint("read the file of that channel alone, or correct the names"));
            }
            let labels: Vec<String> = found.iter().map(|(_, label)| (*label).into()).collect();
            Err(ambiguous(wanted, &labels))
        }
    }
}

/// Whether `wanted` is a channel's name, with its group or without, or its label.
fn is_called(wanted: &str, name: &str, label: &str) -> bool {
    name == wanted || label == wanted || titled(name, label) == wanted
}

/// The name, with the group that the label has before it: `GROUP/NAME` of `GROUP/NAME [N]`.
fn titled(name: &str, label: &str) -> String {
    let title = ColumnName::read(label).name;
    if title.strip_suffix(name).is_some_and(|group| group.ends_with('/')) { title } else { name.to_owned() }
}

/// Refuses a name that no channel has.
pub(crate) fn missing(name: &str, known: &[String]) -> Error {
    let error = refusal!("no channel `{name}` among {}", listed(known));
    match closest(name, known.iter().map(String::as_str)) {
        Some(close) => error.with_hint(format!("did you mean `{close}`?")),
        None => error,
    }
}

/// Refuses a name that several channels have, with these labels.
pub(crate) fn ambiguous(name: &str, labels: &[String]) -> Error {
    let error = refusal!("several channels are called `{name}`: {}", listed(labels));
    error.with_hint("ask for one of these")
}

/// Which channels of a file are read, and what the caller states about them.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// The channels to read; the others are not held in memory.
    pub channels: ChannelSelection,
    /// The column of a table that holds the time; where none is given, the one with such a name.
    pub time: Option<String>,
    /// Units by channel name where the file states none; a unit that contradicts the file is an error.
    pub units: Vec<(String, Unit)>,
    /// The unit of every channel except the time where the file states none; one that contradicts the file is an error.
    pub unit: Option<Unit>,
    /// Column names of a table, which replace those of its header, time included; with units as in a header,
    /// `accel [g]`.
    pub names: Vec<String>,
    /// Words in the cells of a table that mean that nothing was measured, in lower case; an empty cell always does.
    pub gaps: &'static [&'static str],
}

/// Which channels of a file are read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ChannelSelection {
    /// All of them.
    #[default]
    All,
    /// The channels with these names; a missing one is an error.
    Named(Vec<String>),
    /// The only one of the file; several are an error.
    Only,
}

impl ReadOptions {
    /// The unit of the channel with this name and label: that of the `file`, or the one that the caller states of the
    /// channel, or else of `others`. A refusal, of the channel as it is `shown`, where file and caller differ.
    pub(super) fn unit(
        &self,
        [name, label]: [&str; 2],
        file: Option<&Unit>,
        others: Option<&Unit>,
        shown: &str,
    ) -> Result<Option<Unit>, Error> {
        let named = self.units.iter().find(|(wanted, _)| is_called(wanted, name, label));
        match (file, named.map(|(_, unit)| unit).or(others)) {
            (Some(file), Some(given)) if file != given => {
                let (file, given) = (file.symbol(), given.symbol());
                Err(refusal!("mixed units: the file states `{file}` of `{shown}`, but `{given}` is given"))
            }
            (file, given) => Ok(file.or(given).cloned()),
        }
    }

    /// The one channel called `name`, or the only one.
    pub fn one(name: Option<&str>) -> ReadOptions {
        let channels = name.map_or(ChannelSelection::Only, |name| ChannelSelection::Named(vec![name.into()]));
        ReadOptions { channels, ..ReadOptions::default() }
    }
}

/// Whether the text of a cell means that nothing was measured, which these words do, too.
pub(super) fn is_gap(text: &str, words: &[&str]) -> bool {
    text.is_empty() || words.iter().any(|word| text.eq_ignore_ascii_case(word))
}

/// Most values that are held of a file; more is a mistake or an attack.
pub const MOST_VALUES: usize = 50_000_000;

/// One channel is wanted, none is named, and these are there; a channel is named by this `word`.
pub(super) fn not_one(found: &[&str], word: &str) -> Error {
    refusal!("one channel is wanted, found {}: {}", found.len(), listed(found))
        .with_hint(format!("name the channel: --column {word}"))
}

/// The text in place of a number of the channel `name`.
pub(super) fn not_a_number(name: &str, found: &str) -> Error {
    refusal!("expected a number for `{name}`, found `{found}`")
}

/// A value that is infinite or `NaN`.
pub(super) fn not_finite(name: &str) -> Error {
    refusal!("`{name}` is not finite")
}

/// A time that is not later than the one before, both as the file writes them.
pub(super) fn not_increasing(time: f64, previous: f64) -> Error {
    refusal!("time does not increase: {time} after {previous}")
}

/// A unit of the time that is unknown or of another dimension.
pub(super) fn not_a_time(name: &str, unit: &str) -> Error {
    refusal!("time (`{name}`) cannot be in `{unit}`")
}

/// The warning of a channel without a known unit; the text in the place of its unit, where there is one, is `unknown`.
pub(super) fn no_unit(channel: &str, unknown: Option<&str>) -> Warning {
    let channel = channel.to_owned();
    match unknown {
        Some(unit) => Warning::UnknownUnit { channel, unit: unit.to_owned() },
        None => Warning::NoUnit { channel },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, label: &str, symbol: Option<&str>) -> MeasuredChannel {
        let series = Series::new(vec![0.0, 1.0], vec![1.0, 2.0]);
        let unit = symbol.map(|symbol| Unit::parse(symbol).unwrap());
        MeasuredChannel { name: name.into(), label: label.into(), unit, filtered: None, series }
    }

    #[test]
    fn a_column_is_named_with_its_unit() {
        for (name, label, unit, expected) in [
            ("11HEAD0000H3ACXP", "11HEAD0000H3ACXP", Some("m/s2"), "11HEAD0000H3ACXP_m_s2"),
            ("11HEAD0000H3ACXP", "Head", Some("g"), "11HEAD0000H3ACXP_m_s2"),
            ("accel", "accel", Some("m/s2"), "accel_m_s2"),
            ("accel", "accel [g]", Some("g"), "accel_m_s2"),
            ("accel", "accel_m_s2", Some("m/s2"), "accel_m_s2"),
            ("accel", "accel [m/s2]", Some("m/s2"), "accel [m/s2]"),
            ("strain", "strain [%]", Some("%"), "strain [-]"),
            ("T", "T [°C]", None, "T [°C]"),
            ("count", "count", None, "count"),
        ] {
            let measured = channel(name, label, unit);
            let column = measured.column_name();
            assert_eq!(column, expected);
            let read = ColumnName::read(&column).unit.map(|unit| unit.si_symbol());
            assert_eq!(read, measured.value_unit(), "{column}");
        }
    }

    #[test]
    fn a_channel_is_found_by_its_group_and_name() {
        let channels = vec![channel("a", "S1/a [N]", Some("N")), channel("a", "S2/a [N]", Some("N"))];
        let both = Measurement { channels, ..Measurement::default() };
        for (name, expected) in [
            ("S2/a", "S2/a [N]"),
            ("S1/a [N]", "S1/a [N]"),
            ("a", "several channels are called `a`: `S1/a [N]`, `S2/a [N]`"),
            ("S3/a", "no channel `S3/a` among `S1/a`, `S2/a`"),
        ] {
            let found = both.channel(name).map_or_else(|error| error.to_string(), |found| found.label.clone());
            assert_eq!(found, expected, "{name}");
        }
        let options =
            ReadOptions { units: vec![("S1/a".into(), Unit::parse("kN").unwrap())], ..ReadOptions::default() };
        let unit =
            |label: &str| options.unit(["a", label], None, None, label).unwrap().map(|unit| unit.symbol().to_owned());
        assert_eq!((unit("S1/a [N]").as_deref(), unit("S2/a [N]").as_deref()), (Some("kN"), None));
    }

    #[test]
    fn no_two_columns_have_one_name() {
        let channels = vec![
            channel("accel", "accel_g", Some("g")),
            channel("accel", "accel_m_s2", Some("m/s2")),
            channel("force", "force [kN]", Some("kN")),
            channel("A", "a", None),
            channel("A", "a", None),
            channel("time", "time [ms]", Some("ms")),
        ];
        let recording = Measurement { channels, ..Measurement::default() }.recording().unwrap();
        let names: Vec<&str> = recording.channels.iter().map(|channel| channel.name.as_str()).collect();
        let expected = ["accel_g [m/s2]", "accel_m_s2 [m/s2]", "force_N", "a", "2 a", "time [ms] [s]"];
        assert_eq!(names, expected);
    }

    #[test]
    fn channels_of_one_name_are_found_by_their_labels_or_refused() {
        let twice = [("a", "a [g]"), ("a", "a [m/s2]"), ("b", "b"), ("b", "b")];
        let found = |wanted: &str| find(wanted, twice.into_iter());
        assert_eq!(found("a [g]"), Ok(0));
        let refused = |wanted: &str| found(wanted).unwrap_err().to_string();
        assert_eq!(refused("a"), "several channels are called `a`: `a [g]`, `a [m/s2]`");
        assert_eq!(refused("b"), "2 channels are called `b`, with equal labels");
    }

    #[test]
    fn times_written_out_and_times_by_step_are_one_axis() {
        let channel = |name: &str, time: Vec<f64>| {
            let values = vec![1.0; time.len()];
            MeasuredChannel { series: Series::new(time, values), ..channel(name, name, None) }
        };
        let by_step: Vec<f64> = (0..20).map(|i| -5e-4 + f64::from(i) * 1e-4).collect();
        let written: Vec<f64> = by_step.iter().map(|t| format!("{t:.6}").parse().unwrap()).collect();
        assert_ne!(by_step, written);
        let late: Vec<f64> = by_step.iter().map(|t| t + 1e-5).collect();
        let with = |other: Vec<f64>| {
            let channels = vec![channel("a", by_step.clone()), channel("b", other)];
            Measurement { channels, ..Measurement::default() }.recording()
        };
        assert_eq!(with(written).unwrap().time, by_step);
        assert_eq!(with(late), None);
        assert_eq!(with(by_step[1..].to_vec()), None);
    }
}
