//! What puts a curve in doubt that was read out of a picture.

use serde::Serialize;
use thiserror::Error;

use base::codes;
use base::finding::{Code, Report};

codes! {
    INTERRUPTED = "curve-interrupted", Warning,
        "the curve is missing over a part of its length; values there are interpolated by whoever reads the table",
        "look at --overlay: another curve may cover it, or `colour` and `tolerance` may not be those of the picture";
    ELSEWHERE = "colour-elsewhere", Warning,
        "much of what has the colour of the curve is not on it, so that the curve may be another one",
        "leave legends and letters out by `curve.without`, narrow `curve.area`, or lower `curve.tolerance`; look at --overlay";
    SHORT = "curve-short", Warning,
        "the curve covers a small part of the axis",
        "look at --overlay: `colour`, `tolerance` and `area` may not be those of the curve";
}

/// A doubt about a curve.
#[derive(Clone, Copy, Debug, PartialEq, Error, Serialize)]
#[serde(untagged)]
pub enum Warning {
    /// The curve is missing over parts.
    #[error("the curve is missing over {:.1} % of its length, at most between {from:.4} and {to:.4}", 100.0 * share)]
    Interrupted {
        /// Share of its length.
        share: f64,
        /// Where the longest gap begins, in the unit of the x axis.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// Its colour is elsewhere too.
    #[error("{:.0} % of what has the colour of the curve is not on it", 100.0 * share)]
    Elsewhere {
        /// Share of the coloured pixels.
        share: f64,
    },
    /// It covers little of the axis.
    #[error("the curve covers {:.0} % of the x axis", 100.0 * share)]
    Short {
        /// Share of the width that is looked at.
        share: f64,
    },
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::Interrupted { .. } => &INTERRUPTED,
            Warning::Elsewhere { .. } => &ELSEWHERE,
            Warning::Short { .. } => &SHORT,
        }
    }
}
