//! What is wrong with a container, and where.

use thiserror::Error;

use crate::diagnostic::listed;
use crate::signal::csv::MOST_CELLS;
use crate::signal::measurement::ChannelError;
use crate::signal::text::{self, TextError};

/// Why files are no container, and where.
pub type ReadError = text::ReadError<Fault>;

pub(super) type Mistake = text::Mistake<Fault>;

/// What is wrong with a container; channels are named by their codes.
#[derive(Debug, Error)]
pub enum Fault {
    #[error(transparent)]
    Text(#[from] TextError),
    #[error("neither a test (.mme) nor a list of channels (.chn) in the folder")]
    NoTest,
    #[error("several tests in the folder: {}", listed(found))]
    SeveralTests { found: Vec<String> },
    #[error("no folder `Channel` beside the test")]
    NoChannelFolder,
    #[error("no channel files (`{stem}.001`, …)")]
    NoChannelFiles { stem: String },
    #[error("the header is too long")]
    HeaderTooLong,
    #[error("`{key}` is not a number: `{found}`")]
    HeaderNumber { key: String, found: String },
    #[error("expected a number for `{channel}`, found `{found}`")]
    NotANumber { channel: String, found: String },
    #[error("`{channel}` is not finite")]
    NotFinite { channel: String },
    #[error("`{channel}` has no samples")]
    NoSamples { channel: String },
    #[error("`{channel}` is truncated: {found} of {stated} samples")]
    Truncated { channel: String, stated: f64, found: usize },
    #[error("`{channel}` has {found} samples, but its header states {stated}")]
    TooMany { channel: String, stated: f64, found: usize },
    #[error("`{channel}` has more than {} samples", MOST_CELLS)]
    TooLarge { channel: String },
    #[error("`{channel}` has neither a sampling interval nor a reference channel for its time")]
    NoTimeAxis { channel: String },
    #[error("the sampling interval of `{channel}` is {interval} s")]
    Interval { channel: String, interval: f64 },
    #[error("the time of `{channel}` is in `{reference}`, which is missing")]
    NoReference { channel: String, reference: String },
    #[error("`{channel}` has {found} samples over {times} times of `{reference}`")]
    TimeLength { channel: String, reference: String, found: usize, times: usize },
    #[error("time does not increase: {time} after {previous}")]
    TimeNotIncreasing { time: f64, previous: f64 },
    #[error("a sample of the time axis `{channel}` was not measured")]
    TimeGap { channel: String },
    #[error("the time axis `{channel}` cannot be in `{unit}`")]
    TimeUnit { channel: String, unit: String },
    #[error("mixed units: the file states `{file}` of `{channel}`, but `{given}` is given")]
    GivenUnit { channel: String, file: String, given: String },
    #[error(transparent)]
    Channel(ChannelError),
    #[error("one channel is wanted, found {}: {}", found.len(), listed(found))]
    NotOne { found: Vec<String> },
    #[error("no channel but time axes")]
    OnlyTime,
    #[error("a column of time or names of columns are given for what is no table")]
    NoTable,
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        match self {
            Fault::Channel(error) => error.hint(),
            Fault::NotOne { .. } => Some("name the channel: --column CODE".into()),
            Fault::SeveralTests { .. } => Some("name the .mme file".into()),
            Fault::NoTable => Some("ISO-MME channels have their own time and names; leave them out".into()),
            Fault::NotFinite { .. } => Some("write NOVALUE where nothing was measured".into()),
            _ => None,
        }
    }
}
