//! Faults in a container, and where they are.

use thiserror::Error;

use super::archive::ArchiveFault;
use crate::signal::channel_fault::{ChannelFault, MOST_VALUES};
use crate::signal::text::{self, TextError};
use base::diagnostic::listed;
use base::number::significant;

/// Why files are no container, and where.
pub type ReadError = text::ReadError<Fault>;

pub(super) type Mistake = text::Mistake<Fault>;

/// A fault of a container; channels are named by their codes.
#[derive(Debug, Error)]
pub enum Fault {
    /// A file cannot be read as text.
    #[error(transparent)]
    Text(#[from] TextError),
    /// A fault of a channel that files of every format can have.
    #[error(transparent)]
    Channel(#[from] ChannelFault),
    /// A zip archive cannot be read, or holds what no test does.
    #[error(transparent)]
    Archive(#[from] ArchiveFault),
    /// The folder holds no container.
    #[error("neither a test (.mme) nor a list of channels (.chn) in the folder")]
    NoTest,
    /// The folder holds several containers.
    #[error("several tests in the folder: {}", listed(found))]
    SeveralTests {
        /// Their files.
        found: Vec<String>,
    },
    /// The test has no channels.
    #[error("no folder `Channel` beside the test")]
    NoChannelFolder,
    /// The folder `Channel` has no file of this test.
    #[error("no channel files (`{stem}.001`, …)")]
    NoChannelFiles {
        /// Name of the test.
        stem: String,
    },
    /// A header has more lines than any that is read.
    #[error("the header is too long")]
    HeaderTooLong,
    /// A header has text where a number is expected.
    #[error("`{key}` is not a number: `{found}`")]
    HeaderNumber {
        /// Key of the header.
        key: String,
        /// Text in place of the number.
        found: String,
    },
    /// A channel has a header and no values.
    #[error("`{channel}` has no samples")]
    NoSamples {
        /// The channel.
        channel: String,
    },
    /// A channel has fewer values than its header states.
    #[error("`{channel}` is truncated: {found} of {stated} samples")]
    Truncated {
        /// The channel.
        channel: String,
        /// Samples in the header.
        stated: f64,
        /// Values in the file.
        found: usize,
    },
    /// A channel has more values than its header states.
    #[error("`{channel}` has {found} samples, but its header states {stated}")]
    TooMany {
        /// The channel.
        channel: String,
        /// Samples in the header.
        stated: f64,
        /// Values in the file.
        found: usize,
    },
    /// A channel has more than [`MOST_VALUES`] values.
    #[error("`{channel}` has more than {MOST_VALUES} samples")]
    TooLarge {
        /// The channel.
        channel: String,
    },
    /// The header does not state the times of the values.
    #[error("`{channel}` has neither a sampling interval nor a reference channel for its time")]
    NoTimeAxis {
        /// The channel.
        channel: String,
    },
    /// The sampling interval is not positive, or too small for its number of samples.
    #[error("the sampling interval of `{channel}` is {} s", significant(*interval, 9))]
    Interval {
        /// The channel.
        channel: String,
        /// As the header states it, s.
        interval: f64,
    },
    /// The channel of times that a header names is missing.
    #[error("the time of `{channel}` is in `{reference}`, which is missing")]
    NoReference {
        /// The channel.
        channel: String,
        /// The channel of its times.
        reference: String,
    },
    /// A channel and its times have different lengths.
    #[error("`{channel}` has {found} samples over {times} times of `{reference}`")]
    TimeLength {
        /// The channel.
        channel: String,
        /// The channel of its times.
        reference: String,
        /// Values of the channel.
        found: usize,
        /// Values of its times.
        times: usize,
    },
    /// A time was not measured.
    #[error("a sample of the time axis `{channel}` was not measured")]
    TimeGap {
        /// The channel of times.
        channel: String,
    },
    /// All channels are times.
    #[error("no channel but time axes")]
    OnlyTime,
    /// Options of a table are given.
    #[error("column names are given, but the file is not a table")]
    NoTable,
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            Fault::Channel(ChannelFault::Name(error)) => return error.hint(),
            Fault::Channel(ChannelFault::NotOne { .. }) => "name the channel: --column CODE",
            Fault::Channel(ChannelFault::NotFinite { .. }) => "write NOVALUE where nothing was measured",
            Fault::Archive(fault) => return fault.hint().map(str::to_owned),
            Fault::SeveralTests { .. } => "name the .mme file",
            Fault::NoTable => "ISO-MME channels have their own time and names; leave them out",
            _ => return None,
        };
        Some(hint.into())
    }
}
