//! The samples of a laser that show a moving impactor.

use crate::experiment::Warning;
use crate::signal::Series;

/// Fewest equal samples in a row that are not a moving impactor: out of range a laser holds its last value, or writes
/// the end of its range, or zero.
const HELD: usize = 20;

/// A laser whose held samples count as not measured.
pub(super) struct Cleaned {
    pub series: Series,
    /// Number of held samples.
    held: usize,
}

impl Cleaned {
    /// The samples of the recorded `laser`, without those that it held.
    pub(super) fn from_laser(laser: &Series) -> Cleaned {
        let runs = || laser.values().chunk_by(|a, b| a == b);
        let is_held = |run: &&[f64]| run.len() >= HELD;
        let values = runs().flat_map(|run| run.iter().map(move |value| if is_held(&run) { f64::NAN } else { *value }));
        let series = laser.with_values(values.collect());
        Cleaned { series, held: runs().filter(is_held).map(<[f64]>::len).sum() }
    }

    /// The report of held samples.
    pub(super) fn warning(&self) -> Option<Warning> {
        (self.held > 0).then_some(Warning::LaserOutOfRange { samples: self.held, run: HELD })
    }
}
