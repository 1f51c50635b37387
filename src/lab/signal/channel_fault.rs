//! Faults in the channels of a file, whatever its format.

use thiserror::Error;

use super::measurement::ChannelError;
use base::diagnostic::listed;

/// Most values that are held of a file; more is a mistake or an attack.
pub const MOST_VALUES: usize = 50_000_000;

/// A fault of a channel of a file.
#[derive(Debug, Error)]
pub enum ChannelFault {
    /// A channel that is named does not exist, or is not the only one of its name.
    #[error(transparent)]
    Name(#[from] ChannelError),
    /// One channel is wanted and none is named.
    #[error("one channel is wanted, found {}: {}", found.len(), listed(found))]
    NotOne {
        /// The channels of the file.
        found: Vec<String>,
    },
    /// A value is not a number.
    #[error("expected a number for `{name}`, found `{found}`")]
    NotANumber {
        /// The channel.
        name: String,
        /// Text in place of the number.
        found: String,
    },
    /// A value is infinite or `NaN`.
    #[error("`{name}` is not finite")]
    NotFinite {
        /// The channel.
        name: String,
    },
    /// A time is not later than the one before.
    #[error("time does not increase: {time} after {previous}")]
    TimeNotIncreasing {
        /// As the file writes it.
        time: f64,
        /// The time before, likewise.
        previous: f64,
    },
    /// The unit of the time is unknown or of another dimension.
    #[error("time (`{name}`) cannot be in `{unit}`")]
    TimeUnit {
        /// The channel.
        name: String,
        /// Its unit.
        unit: String,
    },
    /// The unit of the file is not the one that the caller gives.
    #[error("mixed units: the file states `{file}` of `{name}`, but `{given}` is given")]
    GivenUnit {
        /// The channel.
        name: String,
        /// Its unit in the file.
        file: String,
        /// The caller's.
        given: String,
    },
}
