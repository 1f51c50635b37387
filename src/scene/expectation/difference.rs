//! How a run differs from what is expected.

use std::fmt;

use serde::Serialize;

use base::number::significant;

/// Significant digits of values in messages.
const DIGITS: usize = 6;

/// One way in which a run is not what is expected.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "code", rename_all = "kebab-case")]
pub enum Difference {
    /// The run came to no end.
    RunFailed {
        /// Why.
        cause: String,
    },
    /// A signal is not recorded.
    NotRecorded {
        /// Its name; `*` where none is.
        signal: String,
    },
    /// The run has no such signal.
    NoSignal {
        /// Its name.
        signal: String,
        /// The signal of the run that was probably meant.
        like: Option<String>,
    },
    /// The bounds of a signal hold where it has no samples.
    NothingWithin {
        /// Its name.
        signal: String,
        /// From when to when they hold, s.
        window: [f64; 2],
    },
    /// A signal ends before its recorded one or its corridor, or starts after it.
    TimeRange {
        /// Its name.
        signal: String,
        /// First and last time that are expected, s.
        expected: [f64; 2],
        /// First and last time of the run, s.
        found: [f64; 2],
    },
    /// A signal is too far from the recorded one.
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
    NoFigure {
        /// Its name.
        figure: String,
        /// The figure of the run that was probably meant.
        like: Option<String>,
    },
    /// A figure is recorded nowhere.
    FigureNotRecorded {
        /// Its name.
        figure: String,
    },
    /// A figure is not what is expected.
    FigureDiffers {
        /// Its name.
        figure: String,
        /// Its value.
        found: serde_json::Value,
        /// The expectation in words.
        expected: String,
    },
    /// A finding did not come.
    NoFinding {
        /// Its code.
        finding: String,
    },
    /// A finding came.
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

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Difference::RunFailed { cause } => write!(f, "the run failed: {cause}"),
            Difference::NotRecorded { signal } if signal == "*" => {
                write!(f, "no signals are recorded; --bless records those of this run")
            }
            Difference::NotRecorded { signal } => write!(f, "{signal} is not recorded; --bless records it"),
            Difference::NoSignal { signal, like } => write!(f, "the run has no signal {signal}{}", meant(like)),
            Difference::NothingWithin { signal, window } => {
                let [from, to] = window.map(number);
                write!(f, "{signal} has no sample between {from} s and {to} s, where its bounds hold")
            }
            Difference::TimeRange { signal, expected, found } => {
                let [e0, e1, f0, f1] = [expected[0], expected[1], found[0], found[1]].map(number);
                write!(f, "{signal} covers {f0} s to {f1} s, expected {e0} s to {e1} s")
            }
            Difference::SignalDiffers { signal, time_s, expected, found, allowed } => {
                let (expected, found) = (or_gap(*expected), or_gap(*found));
                let (time, allowed) = (number(*time_s), number(*allowed));
                write!(f, "{signal} is {found} at {time} s, recorded is {expected}; a distance of {allowed} is allowed")
            }
            Difference::OutsideCorridor { signal, time_s, found, between: [low, high] } => {
                let (found, time) = (or_gap(*found), number(*time_s));
                let (low, high) = (number(*low), number(*high));
                write!(f, "{signal} is {found} at {time} s, expected {low} to {high}")
            }
            Difference::RatedLow { signal, found: Some(found), least, .. } => {
                write!(f, "{signal} is rated {}, expected at least {least}", significant(*found, 3))
            }
            Difference::RatedLow { signal, cause, .. } => {
                write!(f, "{signal} cannot be rated: {}", cause.as_deref().unwrap_or("unknown"))
            }
            Difference::NoFigure { figure, like } => write!(f, "the run has no figure {figure}{}", meant(like)),
            Difference::FigureNotRecorded { figure } => write!(f, "{figure} is not recorded; --bless records it"),
            Difference::FigureDiffers { figure, found, expected } => {
                let found = found.as_f64().map_or_else(|| found.to_string(), number);
                write!(f, "{figure} is {found}, expected {expected}")
            }
            Difference::NoFinding { finding } => write!(f, "the finding {finding} did not come"),
            Difference::UnexpectedFinding { finding, message } => write!(f, "unexpected finding {finding}: {message}"),
        }
    }
}
