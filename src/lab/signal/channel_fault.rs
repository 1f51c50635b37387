//! Refusals of channels, alike in files of every format.

use crate::error::{Error, refusal};
use base::diagnostic::listed;

/// Most values that are held of a file; more is a mistake or an attack.
pub const MOST_VALUES: usize = 50_000_000;

/// One channel is wanted, none is named, and these are there; a channel is named by this `word`.
pub(super) fn not_one(found: &[String], word: &str) -> Error {
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

/// A unit of the file that is not the one that the caller gives.
pub(super) fn other_unit(name: &str, file: &str, given: &str) -> Error {
    refusal!("mixed units: the file states `{file}` of `{name}`, but `{given}` is given")
}
