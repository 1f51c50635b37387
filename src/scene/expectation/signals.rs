//! Signals against the recorded ones.

use serde::Serialize;
use thiserror::Error;

use super::{ALL, Expectations, SignalBounds, allowed};
use base::diagnostic::closest;
use base::number::significant;
use lab::signal::rating::rate;
use lab::signal::{Recording, Series};

/// Distance of times that is round-off, s.
const SAME_TIME: f64 = 1e-9;

/// The signals that are not what is expected: those that are recorded, then others that must be.
pub(super) fn differences(
    expectations: &Expectations,
    recorded: Option<&Recording>,
    given: &Recording,
) -> Vec<Difference> {
    let names = names(expectations, recorded, given);
    let of = |recording: Option<&Recording>, name: &str| recording.and_then(|recording| recording.series(name));
    let mut found = Vec::new();
    for name in names {
        let Some(bounds) = expectations.signal(name) else { continue };
        let signal = name.to_owned();
        let Some(series) = given.series(name) else {
            let channels = given.channels.iter().map(|channel| channel.name.as_str());
            let like = closest(name, channels).map(String::from);
            found.push(Difference::NoSignal { signal, like });
            continue;
        };
        found.extend(bounds.corridor.as_ref().and_then(|corridor| outside(name, bounds, corridor, &series)));
        if !bounds.needs_recording() {
            continue;
        }
        match of(recorded, name) {
            Some(recorded) => found.extend(from_recorded(name, bounds, &recorded, &series)),
            None => found.push(Difference::NotRecorded { signal }),
        }
    }
    // One line in place of one for each signal.
    let is_none_recorded = recorded.is_none() && found.iter().all(|one| matches!(one, Difference::NotRecorded { .. }));
    if is_none_recorded && found.len() > 1 {
        return vec![Difference::NotRecorded { signal: ALL.into() }];
    }
    found
}

/// The signals that are bounded, each once: those of the run or recorded, then those that neither has.
fn names<'a>(expectations: &'a Expectations, recorded: Option<&'a Recording>, given: &'a Recording) -> Vec<&'a str> {
    let channels = recorded.into_iter().chain([given]).flat_map(|recording| &recording.channels);
    let named = expectations.signals.iter().map(|(name, _)| name.as_str()).filter(|name| *name != ALL);
    let mut names: Vec<&str> = Vec::new();
    for name in channels.map(|channel| channel.name.as_str()).chain(named) {
        if expectations.signal(name).is_some() && !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn from_recorded(name: &str, bounds: &SignalBounds, recorded: &Series, found: &Series) -> Vec<Difference> {
    let window = |series: &Series| bounds.window.map_or_else(|| series.clone(), |window| series.window(window));
    let recorded = window(recorded);
    if let Some(window) = bounds.window.filter(|_| recorded.time().is_empty()) {
        return vec![Difference::NothingWithin { signal: name.into(), window }];
    }
    if let Some(difference) = span(&recorded).and_then(|expected| too_short(name, expected, found)) {
        return vec![difference];
    }
    let mut differences = Vec::new();
    if bounds.absolute.is_some() || bounds.relative.is_some() {
        differences.extend(too_far(name, bounds, &recorded, found));
    }
    if let Some(least) = bounds.rating {
        let signal = name.to_owned();
        match rate(&recorded, &window(found)) {
            Ok(rating) if rating.overall >= least => {}
            Ok(rating) => {
                differences.push(Difference::RatedLow { signal, found: Some(rating.overall), least, cause: None });
            }
            Err(error) => {
                let cause = Some(error.to_string());
                differences.push(Difference::RatedLow { signal, found: None, least, cause });
            }
        }
    }
    differences
}

/// First and last time, s.
fn span(series: &Series) -> Option<[f64; 2]> {
    Some([*series.time().first()?, *series.time().last()?])
}

/// The signal where it does not cover the times that are expected.
fn too_short(name: &str, expected: [f64; 2], found: &Series) -> Option<Difference> {
    let covered = span(found)?;
    let is_covered = covered[0] <= expected[0] + SAME_TIME && covered[1] >= expected[1] - SAME_TIME;
    let signal = name.to_owned();
    (!is_covered).then_some(Difference::TimeRange { signal, expected, found: covered })
}

/// Where the signal is farthest from what is allowed.
fn too_far(name: &str, bounds: &SignalBounds, recorded: &Series, found: &Series) -> Option<Difference> {
    let largest = recorded.values().iter().filter(|value| value.is_finite()).fold(0.0, |a: f64, v| a.max(v.abs()));
    let allowed = allowed(bounds.absolute, bounds.relative, largest);
    let beyond = |[time, expected]: [f64; 2]| {
        let value = value_at(found, time);
        let distance = match (value.is_nan(), expected.is_nan()) {
            (true, true) => 0.0,
            (false, false) if bounds.time == 0.0 => (value - expected).abs(),
            (false, false) => distance_within(found, time, bounds.time, expected),
            _ => f64::INFINITY,
        };
        (distance > allowed).then_some((distance, time, expected, value))
    };
    let times = recorded.time().iter().zip(recorded.values());
    let (_, time_s, expected, value) =
        times.filter_map(|(time, expected)| beyond([*time, *expected])).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let number = |value: f64| value.is_finite().then_some(value);
    let (expected, found) = (number(expected), number(value));
    Some(Difference::SignalDiffers { signal: name.into(), time_s, expected, found, allowed })
}

/// The value at `time`: that of a sample there, between samples by interpolation.
fn value_at(series: &Series, time: f64) -> f64 {
    let place = series.time().partition_point(|own| *own < time - SAME_TIME);
    match series.time().get(place) {
        Some(own) if (own - time).abs() <= SAME_TIME => series.values()[place],
        _ => series.value_at(time).unwrap_or(f64::NAN),
    }
}

/// Distance of a value from those that the signal has not farther than `shift` from `time`.
fn distance_within(series: &Series, time: f64, shift: f64, value: f64) -> f64 {
    let ends = [value_at(series, time - shift), value_at(series, time), value_at(series, time + shift)];
    let near = series.window([time - shift, time + shift]);
    let values = || near.values().iter().chain(&ends).copied().filter(|value| value.is_finite());
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    (low - value).max(value - high).max(0.0)
}

/// Where the signal is farthest outside of its corridor, or what of the corridor it does not cover.
fn outside(name: &str, bounds: &SignalBounds, corridor: &[Series; 2], found: &Series) -> Option<Difference> {
    let [start, end] = span(&corridor[0])?;
    let [from, to] = bounds.window.unwrap_or([start, end]);
    let expected = [from.max(start), to.min(end)];
    if expected[0] > expected[1] {
        return Some(Difference::NothingWithin { signal: name.into(), window: [from, to] });
    }
    if let Some(difference) = too_short(name, expected, found) {
        return Some(difference);
    }
    let found = found.window(expected);
    if found.time().is_empty() {
        return Some(Difference::NothingWithin { signal: name.into(), window: expected });
    }
    let beyond = |(time, value): (&f64, &f64)| {
        let [low, high] = [corridor[0].value_at(*time)?, corridor[1].value_at(*time)?];
        let distance = if value.is_nan() { f64::INFINITY } else { (low - value).max(value - high) };
        (distance > 0.0).then_some((distance, *time, *value, [low, high]))
    };
    let times = found.time().iter().zip(found.values());
    let (_, time_s, value, between) = times.filter_map(beyond).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let value = value.is_finite().then_some(value);
    Some(Difference::OutsideCorridor { signal: name.into(), time_s, found: value, between })
}

/// Significant digits of values in messages.
const DIGITS: usize = 6;

/// One way in which a run is not what is expected.
#[derive(Clone, Debug, PartialEq, Error, Serialize)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum Difference {
    /// The run came to no end.
    #[error("the run failed: {cause}")]
    RunFailed {
        /// Why.
        cause: String,
    },
    /// A signal is not recorded.
    #[error("{}", not_recorded(signal))]
    NotRecorded {
        /// Its name; `*` where none is.
        signal: String,
    },
    /// The run has no such signal.
    #[error("the run has no signal {signal}{}", meant(like))]
    NoSignal {
        /// Its name.
        signal: String,
        /// The signal of the run that was probably meant.
        like: Option<String>,
    },
    /// The bounds of a signal hold where it has no samples.
    #[error("{signal} has no sample between {} s and {} s, where its bounds hold", number(window[0]), number(window[1]))]
    NothingWithin {
        /// Its name.
        signal: String,
        /// From when to when they hold, s.
        window: [f64; 2],
    },
    /// A signal ends before its recorded one or its corridor, or starts after it.
    #[error(
        "{signal} covers {} s to {} s, expected {} s to {} s",
        number(found[0]), number(found[1]), number(expected[0]), number(expected[1])
    )]
    TimeRange {
        /// Its name.
        signal: String,
        /// First and last time that are expected, s.
        expected: [f64; 2],
        /// First and last time of the run, s.
        found: [f64; 2],
    },
    /// A signal is too far from the recorded one.
    #[error(
        "{signal} is {} at {} s, recorded is {}; a distance of {} is allowed",
        or_gap(*found), number(*time_s), or_gap(*expected), number(*allowed)
    )]
    SignalDiffers {
        /// Its name.
        signal: String,
        /// Where it is farthest, s.
        time_s: f64,
        /// The recorded value there; none where it has a gap.
        expected: Option<f64>,
        /// The value there; none where it has a gap.
        found: Option<f64>,
        /// Distance that is allowed.
        allowed: f64,
    },
    /// A signal leaves its corridor.
    #[error(
        "{signal} is {} at {} s, expected {} to {}",
        or_gap(*found), number(*time_s), number(between[0]), number(between[1])
    )]
    OutsideCorridor {
        /// Its name.
        signal: String,
        /// Where it is farthest out, s.
        time_s: f64,
        /// The value there; none where it has a gap.
        found: Option<f64>,
        /// Lower and upper bound there.
        between: [f64; 2],
    },
    /// A signal is rated too low.
    #[error("{signal} {}", rated(*found, *least, cause))]
    RatedLow {
        /// Its name.
        signal: String,
        /// Overall rating by ISO/TS 18571; none where it cannot be rated.
        found: Option<f64>,
        /// Least rating that is allowed.
        least: f64,
        /// Why it cannot be rated.
        cause: Option<String>,
    },
    /// The run has no such figure.
    #[error("the run has no figure {figure}{}", meant(like))]
    NoFigure {
        /// Its name.
        figure: String,
        /// The figure of the run that was probably meant.
        like: Option<String>,
    },
    /// A figure is recorded nowhere.
    #[error("{figure} is not recorded; --bless records it")]
    FigureNotRecorded {
        /// Its name.
        figure: String,
    },
    /// A figure is not what is expected.
    #[error("{figure} is {}, expected {expected}", found.as_f64().map_or_else(|| found.to_string(), number))]
    FigureDiffers {
        /// Its name.
        figure: String,
        /// Its value.
        found: serde_json::Value,
        /// The expectation in words.
        expected: String,
    },
    /// A finding did not come.
    #[error("the finding {finding} did not come")]
    NoFinding {
        /// Its code.
        finding: String,
    },
    /// A finding came.
    #[error("unexpected finding {finding}: {message}")]
    UnexpectedFinding {
        /// Its code.
        finding: String,
        /// Its message.
        message: String,
    },
}

impl Difference {
    /// The signal that it is about.
    pub fn signal(&self) -> Option<&str> {
        match self {
            Difference::NoSignal { signal, .. }
            | Difference::NothingWithin { signal, .. }
            | Difference::NotRecorded { signal }
            | Difference::TimeRange { signal, .. }
            | Difference::SignalDiffers { signal, .. }
            | Difference::OutsideCorridor { signal, .. }
            | Difference::RatedLow { signal, .. } => Some(signal),
            _ => None,
        }
    }
}

fn number(value: f64) -> String {
    significant(value, DIGITS)
}

fn or_gap(value: Option<f64>) -> String {
    value.map_or_else(|| "a gap".into(), number)
}

fn meant(like: &Option<String>) -> String {
    like.as_ref().map(|name| format!("; did you mean {name}?")).unwrap_or_default()
}

fn not_recorded(signal: &str) -> String {
    match signal {
        ALL => "no signals are recorded; --bless records those of this run".to_owned(),
        _ => format!("{signal} is not recorded; --bless records it"),
    }
}

fn rated(found: Option<f64>, least: f64, cause: &Option<String>) -> String {
    match found {
        Some(found) => format!("is rated {}, expected at least {least}", significant(found, 3)),
        None => format!("cannot be rated: {}", cause.as_deref().unwrap_or("unknown")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::Channel;

    /// A recording with one channel, ten samples a second.
    fn recording(values: impl Fn(f64) -> f64) -> Recording {
        let time: Vec<f64> = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
        let values = time.iter().map(|time| values(*time)).collect();
        Recording { time, channels: vec![Channel { name: "force_N".into(), values }] }
    }

    fn found(bounds: SignalBounds, recorded: &Recording, given: &Recording) -> Vec<Difference> {
        let expectations = Expectations { signals: vec![("force_N".into(), bounds)], ..Expectations::default() };
        differences(&expectations, Some(recorded), given)
    }

    fn channel() -> Channel {
        Channel { name: "force_N".into(), values: vec![] }
    }

    fn sine(time: f64) -> f64 {
        100.0 * (10.0 * time).sin()
    }

    #[test]
    fn a_distance_is_told_where_it_is_largest() {
        let old = recording(sine);
        let new = recording(|time| sine(time) + if (0.4..0.5).contains(&time) { 10.0 * time } else { 0.5 });
        let relative = |share: f64| SignalBounds { relative: Some(share), ..SignalBounds::default() };
        assert_eq!(found(relative(0.05), &old, &new), []);
        let differences = found(relative(0.04), &old, &new);
        let [Difference::SignalDiffers { time_s, allowed, .. }] = &differences[..] else { panic!("{differences:?}") };
        assert!((time_s - 0.49).abs() < 1e-12 && (allowed - 4.0).abs() < 0.02, "{differences:?}");
        let window = SignalBounds { window: Some([0.6, 1.0]), ..relative(0.01) };
        assert_eq!(found(window, &old, &new), []);
        let elsewhere = SignalBounds { window: Some([2.0, 3.0]), ..relative(0.01) };
        let nothing = Difference::NothingWithin { signal: "force_N".into(), window: [2.0, 3.0] };
        assert_eq!(found(elsewhere, &old, &new), [nothing]);
        let absolute = SignalBounds { absolute: Some(5.0), ..relative(0.01) };
        assert_eq!(found(absolute, &old, &new), [], "the larger of both holds");
    }

    #[test]
    fn a_shift_in_time_may_be_allowed() {
        let (old, new) = (recording(sine), recording(|time| sine(time - 0.015)));
        // Up to where the later signal ends.
        let window = Some([0.0, 0.98]);
        let bounds = |time: f64| SignalBounds { relative: Some(0.02), time, window, ..SignalBounds::default() };
        assert_eq!(found(bounds(0.0), &old, &new).len(), 1);
        assert_eq!(found(bounds(0.01), &old, &new).len(), 1);
        assert_eq!(found(bounds(0.015), &old, &new), []);
    }

    #[test]
    fn gaps_and_missing_times_are_differences() {
        let (old, mut new) = (recording(sine), recording(sine));
        let bounds = || SignalBounds { relative: Some(0.02), ..SignalBounds::default() };
        new.channels[0].values[7] = f64::NAN;
        let differences = found(bounds(), &old, &new);
        assert!(matches!(differences[..], [Difference::SignalDiffers { found: None, .. }]), "{differences:?}");
        assert_eq!(found(bounds(), &new, &new), []);
        let short = Recording {
            time: old.time[..50].to_vec(),
            channels: vec![Channel { name: "force_N".into(), values: old.channels[0].values[..50].to_vec() }],
        };
        assert!(matches!(found(bounds(), &old, &short)[..], [Difference::TimeRange { .. }]));
        assert_eq!(found(bounds(), &short, &old), []);
        let other = Recording { time: old.time.clone(), channels: vec![] };
        assert!(matches!(found(bounds(), &old, &other)[..], [Difference::NoSignal { .. }]));
        assert!(matches!(found(bounds(), &other, &old)[..], [Difference::NotRecorded { .. }]));
    }

    #[test]
    fn other_sample_times_are_interpolated() {
        let old = recording(|time| 3.0 * time);
        let time: Vec<f64> = (0..=37).map(|k| f64::from(k) / 37.0).collect();
        let values = time.iter().map(|time| 3.0 * time).collect();
        let new = Recording { time, channels: vec![Channel { name: "force_N".into(), values }] };
        let bounds = SignalBounds { absolute: Some(1e-12), ..SignalBounds::default() };
        assert_eq!(found(bounds, &old, &new), []);
    }

    #[test]
    fn ratings_and_corridors() {
        let (old, new) = (recording(sine), recording(|time| 0.7 * sine(time)));
        let rating = |least: f64| SignalBounds { rating: Some(least), ..SignalBounds::default() };
        assert_eq!(found(rating(0.5), &old, &new), []);
        let differences = found(rating(0.99), &old, &new);
        assert!(matches!(differences[..], [Difference::RatedLow { found: Some(_), .. }]), "{differences:?}");
        let series = |value: f64| Series::new(vec![0.0, 1.0], vec![value, value]);
        let within =
            |high: f64| SignalBounds { corridor: Some([series(-100.0), series(high)]), ..SignalBounds::default() };
        assert_eq!(found(within(100.0), &old, &new), []);
        let differences = found(within(69.0), &old, &new);
        let [Difference::OutsideCorridor { time_s, between, .. }] = &differences[..] else { panic!("{differences:?}") };
        assert!((sine(*time_s) - 100.0).abs() < 0.5 && *between == [-100.0, 69.0]);
        // A signal that ends within its corridor has not stayed between its bounds.
        let short = Recording { time: vec![0.0, 0.1], channels: vec![Channel { values: vec![0.0; 2], ..channel() }] };
        let differences = found(within(69.0), &old, &short);
        assert!(matches!(differences[..], [Difference::TimeRange { expected: [0.0, 1.0], .. }]), "{differences:?}");
        let window = Some([0.0, 0.1]);
        assert_eq!(found(SignalBounds { window, ..within(69.0) }, &old, &short), []);
        let elsewhere = found(SignalBounds { window: Some([2.0, 3.0]), ..within(69.0) }, &old, &new);
        assert!(matches!(elsewhere[..], [Difference::NothingWithin { .. }]), "{elsewhere:?}");
    }
}
