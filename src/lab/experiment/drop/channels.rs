//! What a recording holds of a drop: which channels are the accelerometer and the laser, and what its header states about
//! the tower.

use super::reduce::reduce;
use super::result::Drop;
use super::{Class, Reduction, Tower};
use crate::error::{Error, refusal};
use crate::experiment::Warning;
use crate::signal::{self, Annotations, MeasuredChannel, Measurement, Series, annotations};
use base::diagnostic::listed;
use base::units::{Acceleration, Dimension, Length, Mass, UnitError};

/// Channels as the user names them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelNames {
    /// The accelerometer; the only channel that is an acceleration where none is named.
    pub acceleration: Option<String>,
    /// The laser; the only channel that is a length where none is named.
    pub laser: Option<String>,
}

/// The readings of the sensors on a drop tower.
#[derive(Clone, Debug, PartialEq)]
pub struct DropChannels {
    /// m/s².
    pub acceleration: Series,
    /// The channel frequency class that the acceleration was filtered with before, as its file states.
    pub class: Option<f64>,
    /// m; none where the recording has no laser.
    pub laser: Option<Series>,
    /// Comments of the file, and what its reading reports.
    pub annotations: Annotations,
}

impl DropChannels {
    /// The channels of `measurement` that are named, or the only ones of their kind.
    pub fn find(measurement: &Measurement, names: &ChannelNames) -> Result<DropChannels, Error> {
        let acceleration = sought(measurement, names.acceleration.as_deref(), Acceleration::DIMENSION)?;
        let acceleration = acceleration.ok_or_else(|| {
            let names: Vec<String> = measurement.channels.iter().map(|channel| channel.name.clone()).collect();
            refusal!("none of the channels {} is an acceleration", listed(&names))
                .with_hint("--unit gives the unit of channels without one")
        })?;
        let laser = sought(measurement, names.laser.as_deref(), Length::DIMENSION)?;
        let mut annotations = measurement.annotations.clone();
        annotations.warnings.extend(laser.is_none().then(|| laser_unit_missing(measurement)).flatten());
        Ok(DropChannels {
            acceleration: acceleration.series.clone(),
            class: acceleration.filtered,
            laser: laser.map(|channel| channel.series.clone()),
            annotations,
        })
    }

    /// The class that the acceleration is still to be filtered with where `class` is asked for: a filter is used once.
    pub fn class_to_apply(&self, class: Class) -> Class {
        if self.class.is_none() { class } else { Class::None }
    }

    /// The report of the file's own filter beside the `class` of the reduction.
    fn filtered_before(&self, class: Option<f64>) -> Option<Warning> {
        self.class.map(|before| match class {
            Some(again) => Warning::FilteredAgain { class: before, again },
            None => Warning::FilteredAlready { class: before },
        })
    }

    /// The drop that was recorded, as [`reduce`].
    pub fn reduce(&self, tower: &Tower, reduction: &Reduction) -> Result<Drop, Error> {
        let mut drop = reduce(&self.acceleration, self.laser.as_ref(), tower, reduction)?;
        drop.warnings.extend(self.filtered_before(drop.class));
        Ok(drop)
    }
}

/// Channels without unit in a recording without a length: one of them may be the laser.
fn laser_unit_missing(measurement: &Measurement) -> Option<signal::Warning> {
    let unknown = measurement.channels.iter().filter(|channel| channel.unit.is_none());
    let channels: Vec<String> = unknown.map(|channel| channel.name.clone()).collect();
    (!channels.is_empty()).then_some(signal::Warning::LaserUnitMissing { channels })
}

fn sought<'a>(
    measurement: &'a Measurement,
    name: Option<&str>,
    dimension: Dimension,
) -> Result<Option<&'a MeasuredChannel>, Error> {
    if let Some(name) = name {
        let channel = measurement.channel(name)?;
        channel.quantity(dimension)?;
        return Ok(Some(channel));
    }
    let is_one = |channel: &&MeasuredChannel| channel.quantity(dimension).is_ok();
    let found: Vec<&MeasuredChannel> = measurement.channels.iter().filter(is_one).collect();
    match found[..] {
        [] => Ok(None),
        [only] => Ok(Some(only)),
        _ => {
            let names: Vec<String> = found.iter().map(|channel| channel.name.clone()).collect();
            let is_laser = dimension == Length::DIMENSION;
            let error = refusal!("the channels {} are each {}: name one", listed(&names), dimension.name);
            Err(error.with_hint(if is_laser { "--laser NAME, or --without-laser" } else { "--column NAME" }))
        }
    }
}

/// Mass of the impactor and height of fall, as far as they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stated {
    /// kg.
    pub mass: Option<f64>,
    /// m.
    pub height: Option<f64>,
}

impl Stated {
    /// What the lines of a `header` state: `mass: 10.72 kg`, `height: 1 m`. A line whose value is `given` otherwise is
    /// not refused.
    pub fn of_header(header: &[String], given: Stated) -> Result<Stated, Error> {
        let parsed = |key: &str, dimension: Dimension, example: &str| {
            let refused = |error: UnitError| refusal!("its header: {error}; write `{key}: {example}`");
            annotations::stated(header, key).map(|text| dimension.parse(text).map_err(refused))
        };
        let (mass, height) = (parsed("mass", Mass::DIMENSION, "10.72 kg"), parsed("height", Length::DIMENSION, "1 m"));
        Ok(Stated { mass: unless_given(mass, given.mass)?, height: unless_given(height, given.height)? })
    }
}

/// The value of a line, or its fault where nothing takes its place.
fn unless_given(line: Option<Result<f64, Error>>, given: Option<f64>) -> Result<Option<f64>, Error> {
    match line.transpose() {
        Err(_) if given.is_some() => Ok(None),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::finding::Report;
    use base::units::Unit;

    fn measurement(channels: &[(&str, &str)]) -> Measurement {
        let channel = |(name, unit): &(&str, &str)| MeasuredChannel {
            name: (*name).into(),
            label: (*name).into(),
            filtered: None,
            unit: Unit::parse(unit).ok().filter(|_| !unit.is_empty()),
            series: Series::new(vec![0.0], vec![name.len() as f64]),
        };
        Measurement { channels: channels.iter().map(channel).collect(), ..Measurement::default() }
    }

    #[test]
    fn the_only_channel_of_a_kind_needs_no_name() {
        let both = measurement(&[("force", "N"), ("accel", "g"), ("laser head", "mm")]);
        let found = DropChannels::find(&both, &ChannelNames::default()).unwrap();
        assert_eq!((found.acceleration.values()[0], found.laser.unwrap().values()[0]), (5.0, 10.0));
        let alone = measurement(&[("accel", "g")]);
        assert_eq!(DropChannels::find(&alone, &ChannelNames::default()).unwrap().laser, None);
    }

    #[test]
    fn a_second_filter_is_a_warning_and_none_a_note() {
        let mut filtered = measurement(&[("accel", "g")]);
        filtered.channels[0].filtered = Some(1000.0);
        let channels = DropChannels::find(&filtered, &ChannelNames::default()).unwrap();
        let code = |class| channels.filtered_before(class).map(|warning| warning.code().name);
        assert_eq!((code(Some(60.0)), code(None)), (Some("filtered-before"), Some("not-filtered-again")));
        let class = |class| channels.filtered_before(class).unwrap().figures()["class"].clone();
        assert_eq!((class(Some(60.0)), class(None)), (1000.0.into(), 1000.0.into()));
    }

    #[test]
    fn named_channels_are_used_and_mistakes_are_reported() {
        let two = measurement(&[("a1", "g"), ("head", "m/s2"), ("force", "N"), ("volts", "")]);
        let named = |name: &str| ChannelNames { acceleration: Some(name.into()), laser: None };
        assert_eq!(DropChannels::find(&two, &named("head")).unwrap().acceleration.values(), [4.0]);
        for (names, expected) in [
            (ChannelNames::default(), "the channels `a1`, `head` are each an acceleration: name one"),
            (named("haed"), "no channel `haed` among"),
            (named("force"), "`force` is in N, which is not an acceleration"),
            (named("volts"), "the unit of `volts` is not known"),
        ] {
            let error = DropChannels::find(&two, &names).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        let none = DropChannels::find(&measurement(&[("force", "N")]), &ChannelNames::default()).unwrap_err();
        assert_eq!(none.to_string(), "none of the channels `force` is an acceleration");
    }

    #[test]
    fn a_header_states_mass_and_height() {
        let of = |lines: &[&str], given: Stated| {
            let header: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
            Stated::of_header(&header, given).map_err(|error| error.to_string())
        };
        let none = Stated::default();
        let both = Stated { mass: Some(10.72), height: Some(1.5) };
        assert_eq!(of(&["test 7", "Mass: 10.72 kg", "# height: 150 cm"], none), Ok(both));
        assert_eq!(of(&["massive: 3 kg", "a height of 2 m"], none), Ok(none));
        let wrong = ["mass: heavy", "height: 3 kg"];
        assert!(of(&wrong[..1], none).expect_err("no mass").starts_with("its header: expected a mass"));
        assert_eq!(
            of(&wrong[1..], none).expect_err("no height"),
            "its header: expected a length, found \"3 kg\"; write `height: 1 m`"
        );
        assert_eq!(of(&wrong, both), Ok(none), "what is given takes the place of both");
    }
}
