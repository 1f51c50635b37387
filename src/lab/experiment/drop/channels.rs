//! What a recording holds of a drop: which channels are the accelerometer and the laser, and what its header states about
//! the tower; what a reading lacks: gaps, bridged by straight lines, and the end of the accelerometer's range.

use super::reduce::reduce;
use super::result::Drop;
use super::{Class, Reduction, Tower};
use crate::error::{Error, refusal};
use crate::experiment::Warning;
use crate::signal::{
    self, Annotations, MeasuredChannel, Measurement, Series, annotations, flat_top, gap, quantum, resample,
};
use base::diagnostic::listed;
use base::number::clean_time;
use base::units::{Acceleration, Dimension, Force, Length, Mass, UnitError};

/// Channels as the user names them, and how the sensor is mounted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelNames {
    /// The accelerometer; the only channel that is an acceleration where none is named.
    pub acceleration: Option<String>,
    /// The laser; the only channel that is a length where none is named.
    pub laser: Option<String>,
    /// Whether the accelerometer reads a deceleration as negative.
    pub is_inverted: bool,
}

impl ChannelNames {
    /// The reading of an accelerometer, with the other sign where it is mounted the other way round.
    pub fn upright(&self, reading: &Series) -> Series {
        match self.is_inverted {
            true => reading.with_values(reading.values().iter().map(|value| -value).collect()),
            false => reading.clone(),
        }
    }
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
            let names = listed(measurement.channels.iter().map(|channel| &channel.name));
            let has = |dimension: Dimension| {
                measurement.channels.iter().any(|channel| channel.quantity(dimension).is_ok())
            };
            let has_force = has(Force::DIMENSION);
            let is_open = measurement.channels.iter().any(|channel| channel.unit.is_none());
            refusal!("none of the channels {names} is an acceleration").with_hint(match (is_open, has_force) {
                (true, _) => "--unit gives the unit of channels without one",
                (false, true) => {
                    "a drop needs a channel in m/s2 or g; `droptower reduce coupon` reduces the force and travel of a coupon"
                }
                (false, false) => "a drop needs a channel in m/s2 or g",
            })
        })?;
        let laser = sought(measurement, names.laser.as_deref(), Length::DIMENSION)?;
        let mut annotations = measurement.annotations.clone();
        annotations.warnings.extend(laser.is_none().then(|| laser_unit_missing(measurement)).flatten());
        Ok(DropChannels {
            acceleration: names.upright(&acceleration.series),
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
            let names = listed(found.iter().map(|channel| &channel.name));
            let is_laser = dimension == Length::DIMENSION;
            let error = refusal!("the channels {names} are each {}: name one", dimension.name);
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

/// A reading without the gaps that were to be bridged.
#[derive(Clone, Debug, PartialEq)]
pub struct Bridged {
    /// On the times of the reading and, where rows were missing, on times at its usual step between them.
    pub series: Series,
    /// Report of the gaps that were bridged.
    pub warning: Option<Warning>,
}

/// Bridges gaps of `reading` that last `longest` s or less, and the samples within `masks` ([from, to], s) whatever
/// their duration: of a gap beside a mask only the part outside the masks counts. Samples without value before the
/// first measured one and after the last are left out.
pub fn bridged(reading: &Series, longest: f64, masks: &[[f64; 2]]) -> Bridged {
    let is_masked = |t: f64| masks.iter().any(|[from, to]| (*from..=*to).contains(&t));
    let measured: Vec<[f64; 2]> = reading.samples().filter(|[t, value]| value.is_finite() && !is_masked(*t)).collect();
    let step = gap::usual_step(reading.time());
    // Of each gap the time of the last measured sample before it, and the time to the next, s.
    let (mut time, mut values, mut gaps) = (Vec::new(), Vec::new(), Vec::new());
    let mut inserted = 0.0;
    for pair in measured.windows(2) {
        let [[from, first], [to, last]] = [pair[0], pair[1]];
        time.push(from);
        values.push(first);
        let steps = steps(reading.time(), [from, to], step);
        let count = missing(&steps);
        // A hole that would need too many samples stays one.
        if count == 0.0 || inserted + count > resample::MOST_SAMPLES as f64 {
            continue;
        }
        inserted += count;
        let between = between(&steps);
        let is_bridged = outside(&between, [from, to], masks) <= longest * (1.0 + 1e-9);
        gaps.extend(is_bridged.then(|| [from, clean_time(to - from)]));
        let value = |t: f64| if is_bridged { first + (last - first) * (t - from) / (to - from) } else { f64::NAN };
        values.extend(between.iter().map(|t| value(*t)));
        time.extend(between);
    }
    time.extend(measured.last().map(|[t, _]| *t));
    values.extend(measured.last().map(|[_, value]| *value));
    let longest = gaps.iter().copied().max_by(|a: &[f64; 2], b| a[1].total_cmp(&b[1]));
    let warning = longest.map(|[after, duration]| Warning::GapBridged { count: gaps.len(), after, duration });
    Bridged { series: Series::new(time, values), warning }
}

/// Duration of what is missing outside `masks` between two neighbouring measured samples, s; `missing` are the times
/// without value between them.
fn outside(missing: &[f64], [from, to]: [f64; 2], masks: &[[f64; 2]]) -> f64 {
    let mut masks: Vec<[f64; 2]> = masks.iter().copied().filter(|mask| mask[1] > from && mask[0] < to).collect();
    masks.sort_by(|a, b| a[0].total_cmp(&b[0]));
    masks.push([to, to]);
    let mut free = from;
    let stretches = masks.into_iter().map(|[start, end]| {
        let stretch = [free, start];
        free = free.max(end);
        stretch
    });
    let is_missing = |[start, end]: &[f64; 2]| missing.iter().any(|t| start < t && t < end);
    stretches.filter(is_missing).map(|[start, end]| end - start).sum()
}

/// Duration of the longest gap of `reading`, s; none without a gap between measured samples.
pub fn longest_gap(reading: &Series) -> Option<f64> {
    let measured: Vec<f64> = reading.samples().filter(|[_, value]| value.is_finite()).map(|[t, _]| t).collect();
    let step = gap::usual_step(reading.time());
    let gaps = measured.windows(2).filter(|pair| missing(&steps(reading.time(), [pair[0], pair[1]], step)) > 0.0);
    gaps.map(|pair| clean_time(pair[1] - pair[0])).max_by(f64::total_cmp)
}

/// Neighbouring samples from one that is measured to the next: times of both, and the steps between them, several where rows are
/// missing.
fn steps(time: &[f64], [from, to]: [f64; 2], step: f64) -> Vec<([f64; 2], f64)> {
    let empty = &time[time.partition_point(|t| *t <= from)..time.partition_point(|t| *t < to)];
    let ends = [&[from], empty, &[to]].concat();
    let count = |duration: f64| if gap::is_hole(duration, step) { (duration / step).round() } else { 1.0 };
    ends.windows(2).map(|pair| ([pair[0], pair[1]], count(pair[1] - pair[0]))).collect()
}

/// Number of values that are missing within `steps`.
fn missing(steps: &[([f64; 2], f64)]) -> f64 {
    steps.iter().map(|(_, count)| count).sum::<f64>() - 1.0
}

/// Their times.
fn between(steps: &[([f64; 2], f64)]) -> Vec<f64> {
    let within = |([from, to], count): &([f64; 2], f64)| {
        let (from, length, count) = (*from, to - from, *count);
        (1..count as usize).map(move |i| from + length * i as f64 / count).chain([*to])
    };
    let mut times: Vec<f64> = steps.iter().flat_map(within).collect();
    times.pop();
    times
}

/// Duration of a constant largest reading (s), and share of the pulse's width at half of it, beyond which it is the end
/// of the range.
const FLAT: f64 = 2e-3;
const FLAT_SHARE: f64 = 0.1;
/// So many times the duration for which the steps of the converter hold the reading at the top of a pulse.
const BEYOND_STEPS: f64 = 2.5;

/// Samples at the end of the range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clipping {
    /// The reading, m/s².
    pub level: f64,
    /// Time of the first of them, s.
    pub start: f64,
    /// Duration of the longest run of them, s.
    pub duration: f64,
}

impl Clipping {
    /// The clipping of an evenly sampled `reading` (m/s²) from `contact` (s) on: a largest value that stays for longer
    /// than the steps of the reading explain.
    pub(super) fn find(reading: &Series, contact: f64) -> Option<Clipping> {
        let impact = reading.window([contact, f64::INFINITY]);
        let [start, level] = impact.largest()?;
        let (time, values) = (impact.time(), impact.values());
        let [first, last] = flat_top(values)?;
        let duration = time[last] - time[first];
        let width = width(&impact, [first, last], 0.5 * level);
        let explained = width * (2.0 * quantum(reading.values()) / level).sqrt();
        (duration > FLAT.min(FLAT_SHARE * width).max(BEYOND_STEPS * explained)).then_some(Clipping {
            level,
            start,
            duration,
        })
    }
}

/// Duration for which the `pulse` stays at `level` (m/s²) or above about the samples `[first, last]`, s.
fn width(pulse: &Series, [first, last]: [usize; 2], level: f64) -> f64 {
    let (time, values) = (pulse.time(), pulse.values());
    let before = values[..first].iter().rposition(|value| *value < level).map_or(0, |below| below + 1);
    let after = values[last..].iter().position(|value| *value < level).map_or(values.len(), |below| last + below);
    time[after - 1] - time[before]
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
        let named = |name: &str| ChannelNames { acceleration: Some(name.into()), ..ChannelNames::default() };
        assert_eq!(DropChannels::find(&two, &named("head")).unwrap().acceleration.values(), [4.0]);
        let inverted = ChannelNames { is_inverted: true, ..named("head") };
        assert_eq!(DropChannels::find(&two, &inverted).unwrap().acceleration.values(), [-4.0]);
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
        let refused = of(&wrong[1..], none).expect_err("no height");
        assert_eq!(refused, "its header: expected a length, found \"3 kg\"; write `height: 1 m`");
        assert_eq!(of(&wrong, both), Ok(none), "what is given takes the place of both");
    }

    fn line(time: &[f64]) -> Series {
        Series::new(time, time.iter().map(|t| 2.0 * t).collect::<Vec<_>>())
    }

    #[test]
    fn empty_samples_and_missing_rows_are_bridged_by_a_line() {
        let whole = line(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let missing = line(&[0.0, 1.0, 2.0, 6.0]);
        let steps = line(&[0.0, 1.0, 2.0, 3.0]);
        let rows = line(&[0.0, 1.0, 2.0, 3.0, 4.0, 8.0, 9.0]);
        let empty = whole.with_values(whole.samples().map(|[t, v]| if t == 2.0 { f64::NAN } else { v }).collect());
        let spike = whole.with_values(whole.samples().map(|[t, v]| if t == 3.0 { 99.0 } else { v }).collect());
        assert_eq!(bridged(&empty, 2.0, &[]).series, whole);
        let warning = Some(Warning::GapBridged { count: 1, after: 1.0, duration: 2.0 });
        assert_eq!(bridged(&empty, 2.0, &[]).warning, warning);
        assert_eq!(bridged(&rows, 4.0, &[]).series, line(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]));
        assert_eq!(bridged(&missing, 4.0, &[]).series, whole);
        assert_eq!(bridged(&spike, 0.0, &[[2.5, 3.5]]).series, whole);
        assert_eq!(bridged(&steps, 9.0, &[]), Bridged { series: steps, warning: None });
    }

    #[test]
    fn a_mask_bridges_nothing_outside_itself() {
        let none = f64::NAN;
        let time: Vec<f64> = (0..12).map(f64::from).collect();
        let beside = Series::new(time.clone(), vec![0., 1., 2., 99., none, none, none, none, none, 9., 10., 11.]);
        let whole = line(&time).with_values(time.clone());
        let is_bridged = |longest, masks: &[[f64; 2]]| bridged(&beside, longest, masks).series == whole;
        assert!(!is_bridged(0.0, &[[2.5, 3.5]]) && !is_bridged(5.4, &[[2.5, 3.5]]));
        assert!(is_bridged(5.5, &[[2.5, 3.5]]));
        assert!(is_bridged(0.0, &[[2.5, 8.5]]) && is_bridged(0.0, &[[2.5, 5.0], [5.0, 8.5]]));
        assert!(is_bridged(0.0, &[[5.5, 8.5], [2.5, 6.5]]) && is_bridged(2.0, &[[2.5, 4.5], [6.5, 8.5]]));
        assert!(!is_bridged(1.9, &[[2.5, 4.5], [6.5, 8.5]]));
        let rows = Series::new(vec![0.0, 1.0, 2.0, 3.0, 9.0, 10.0, 11.0], vec![0.0, 1.0, 2.0, 99.0, 9.0, 10.0, 11.0]);
        assert!(gap::first(&bridged(&rows, 5.0, &[[2.5, 3.5]]).series).is_some());
        assert_eq!(bridged(&rows, 5.5, &[[2.5, 3.5]]).series, whole);
    }

    #[test]
    fn longer_gaps_stay() {
        let empty = Series::new(vec![0.0, 1.0, 2.0, 3.0, 4.0], vec![0.0, 1.0, f64::NAN, f64::NAN, 4.0]);
        assert_eq!(longest_gap(&empty), Some(3.0));
        let Bridged { series, warning } = bridged(&empty, 2.9, &[]);
        assert!(warning.is_none() && gap::first(&series).is_some());
        assert_eq!(longest_gap(&line(&[0.0, 1.0, 2.0])), None);
    }

    /// A hole of 10^11 steps.
    #[test]
    fn the_longest_hole_takes_no_memory() {
        let far = line(&[0.0, 1e-5, 2e-5, 3e-5, 1e6]);
        assert_eq!(longest_gap(&far), Some(999_999.999_97));
        for (longest, mask) in [(0.0, [0.0, 0.0]), (2e6, [0.0, 0.0]), (0.0, [2.5e-5, 0.5])] {
            let Bridged { series, warning } = bridged(&far, longest, &[mask]);
            assert!(warning.is_none() && series.len() <= far.len() && gap::first(&series).is_some());
        }
        let short_behind = bridged(&line(&[0.0, 1.0, 2.0, 3.0, 1e12, 1e12 + 3.0]), 5.0, &[]).warning;
        assert_eq!(short_behind, Some(Warning::GapBridged { count: 1, after: 1e12, duration: 3.0 }));
    }

    /// Contact of the pulses, s.
    const CONTACT: f64 = 0.1;

    /// Half a sine of 100 m/s², sampled at 10 kHz with a resolution of `step` (m/s²), after a rest that changes by one
    /// step at times.
    fn pulse(duration: f64, range: f64, step: f64) -> Series {
        let time: Vec<f64> = (0..3000).map(|i| 1e-4 * f64::from(i)).collect();
        let value = |t: f64| 100.0 * (std::f64::consts::PI * (t - CONTACT) / duration).sin();
        let rest = |t: f64| if t < CONTACT && (1e4 * t).round() % 7.0 == 0.0 { step } else { 0.0 };
        let value = |t: f64| if (CONTACT..CONTACT + duration).contains(&t) { value(t).min(range) } else { rest(t) };
        let values: Vec<f64> = time.iter().map(|t| (value(*t) / step).round() * step).collect();
        Series::new(time, values)
    }

    #[test]
    fn short_pulses_and_long_ones_are_clipped_alike() {
        for duration in [0.005, 0.02, 0.06] {
            assert_eq!(Clipping::find(&pulse(duration, 200.0, 0.25), CONTACT), None, "{duration} s");
            let clipped = Clipping::find(&pulse(duration, 90.0, 0.25), CONTACT).unwrap();
            assert!(clipped.level == 90.0 && (clipped.duration / duration - 0.287).abs() < 0.03, "{clipped:?}");
        }
    }

    #[test]
    fn the_steps_of_a_coarse_converter_are_not_the_end_of_its_range() {
        for (duration, step) in [(0.06, 1.0), (0.06, 4.0), (0.02, 5.0), (0.15, 0.5)] {
            let whole = pulse(duration, 200.0, step);
            assert_eq!(Clipping::find(&whole, CONTACT), None, "{duration} s in steps of {step} m/s²");
        }
        for (duration, step) in [(0.06, 1.0), (0.06, 2.0), (0.02, 2.0), (0.15, 0.5)] {
            let clipped = Clipping::find(&pulse(duration, 70.0, step), CONTACT).unwrap();
            assert!(clipped.level == 70.0 && clipped.start > CONTACT, "{clipped:?}");
        }
    }

    /// The magnet's knock reaches the end of the range too.
    #[test]
    fn a_knock_before_contact_hides_no_clipping() {
        let clipped = pulse(0.02, 90.0, 0.25);
        let knock = |[t, value]: [f64; 2]| if (0.05..0.051).contains(&t) { 90.0 } else { value };
        let knocked = clipped.with_values(clipped.samples().map(knock).collect());
        assert_eq!(Clipping::find(&knocked, CONTACT), Clipping::find(&clipped, CONTACT));
        assert!(Clipping::find(&knocked, CONTACT).is_some());
    }
}
