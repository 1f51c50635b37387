//! Faults in a file that lists its channels.

use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::signal::channel_fault::{ChannelFault, MOST_VALUES};
use crate::signal::format::{Format, Support};
use crate::signal::{export, hdf5, matlab, t01, tdms, workbook};
use base::diagnostic::listed;
use base::file::FileError;
use base::number::significant;

/// Why a file is no recording, and which file.
#[derive(Debug, Error)]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// The fault.
    pub fault: Box<Fault>,
}

impl ReadError {
    /// A fault of the file at `path`.
    pub fn new(path: &Path, fault: Fault) -> ReadError {
        ReadError { path: path.into(), fault: Box::new(fault) }
    }
}

impl Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.fault)
    }
}

/// A fault of a file that lists its channels.
#[derive(Debug, Error)]
pub enum Fault {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Open(#[from] FileError),
    /// A fault of a channel that files of every format can have.
    #[error(transparent)]
    Channel(#[from] ChannelFault),
    /// The file is of a format that is not read.
    #[error("the format {} is not read", .0.name)]
    Refused(&'static Format),
    /// The file is not as NI describes TDMS.
    #[error(transparent)]
    Tdms(#[from] tdms::Fault),
    /// The file is not as OpenRadioss writes time histories.
    #[error(transparent)]
    T01(#[from] t01::Fault),
    /// The file is not as MathWorks describes MAT-files.
    #[error(transparent)]
    Matlab(#[from] matlab::Fault),
    /// The file is not HDF5.
    #[error(transparent)]
    Hdf5(#[from] hdf5::Fault),
    /// The file is no workbook, or a sheet of it no table.
    #[error(transparent)]
    Workbook(#[from] workbook::Fault),
    /// A sheet of a workbook is no export of a machine.
    #[error("{}", .0.in_file())]
    Export(Box<export::ReadError>),
    /// The file lists no channel, or none that has numbers.
    #[error("no channel with numbers")]
    NoChannel,
    /// A channel that is asked for does not hold numbers, or none that can be computed.
    #[error("`{channel}` cannot be read: {why}")]
    NotRead {
        /// The channel.
        channel: String,
        /// Why.
        why: String,
    },
    /// A channel that is asked for has no samples.
    #[error("`{channel}` has no samples")]
    NoSamples {
        /// The channel.
        channel: String,
    },
    /// Neither does the file state the times of a channel, nor has its group a channel of times.
    #[error("no time of `{channel}`: it has neither a start and an increment nor a channel of time beside it")]
    NoTime {
        /// The channel.
        channel: String,
    },
    /// Several channels of a group are named like a time.
    #[error("several channels of time: {}", listed(found))]
    SeveralTimes {
        /// The channels.
        found: Vec<String>,
    },
    /// The increment of time is not positive, or lost in the digits of its start.
    #[error("`{channel}` begins at {} s and has the increment {} s", significant(*start, 9), significant(*step, 9))]
    Increment {
        /// The channel.
        channel: String,
        /// Time of its first sample, s.
        start: f64,
        /// From sample to sample, s.
        step: f64,
    },
    /// A channel and its times have different lengths.
    #[error("`{channel}` has {found} samples over {times} times of `{time}`")]
    TimeLength {
        /// The channel.
        channel: String,
        /// The channel of its times.
        time: String,
        /// Samples of the channel.
        found: u64,
        /// Samples of its times.
        times: u64,
    },
    /// A time was not measured.
    #[error("a sample of the time `{channel}` was not measured")]
    TimeGap {
        /// The channel of times.
        channel: String,
    },
    /// Channels without a time have different lengths, so they are no table.
    #[error("without a time, all channels need one length: `{first}` has {length} samples, `{channel}` {found}")]
    Lengths {
        /// The first channel.
        first: String,
        /// Its samples.
        length: u64,
        /// Another.
        channel: String,
        /// Its samples.
        found: u64,
    },
    /// The name of a channel states another unit than the file does.
    #[error("mixed units: the name of `{channel}` states `{named}`, its properties `{stated}`")]
    MixedUnits {
        /// The channel.
        channel: String,
        /// Unit in its name.
        named: String,
        /// Unit in its properties.
        stated: String,
    },
    /// Options of a table are given.
    #[error("column names are given, but the file is not a table")]
    NoTable,
    /// The wanted channels have more than [`MOST_VALUES`] samples.
    #[error("more than {MOST_VALUES} samples")]
    TooLarge,
}

impl Fault {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            Fault::Refused(Format { support: Support::Refused(conversion), .. }) => conversion,
            Fault::Channel(ChannelFault::Name(error)) => return error.hint(),
            Fault::Channel(ChannelFault::NotOne { .. }) => "name the channel: --column GROUP/CHANNEL",
            Fault::Matlab(fault) => return fault.hint().map(str::to_owned),
            Fault::Workbook(fault) => return fault.hint(),
            Fault::Export(error) => return error.hint().map(str::to_owned),
            Fault::Tdms(fault) => return fault.hint().map(str::to_owned),
            Fault::NoTime { .. } | Fault::SeveralTimes { .. } => "name the channel of time: --time GROUP/CHANNEL",
            Fault::TimeLength { .. } | Fault::Lengths { .. } => {
                "name the channels that belong together: --column GROUP/CHANNEL"
            }
            Fault::NoTable => "its channels have their own names; leave the names out",
            Fault::TooLarge => "name the channels that are needed",
            _ => return None,
        };
        Some(hint.into())
    }
}
