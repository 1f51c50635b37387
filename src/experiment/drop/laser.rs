//! What a laser saw of a moving impactor.

use crate::signal::Series;

/// Samples of one value in a row that no laser reads over a moving impactor: out of range it holds its last value, or writes
/// the end of its range, or zero.
const HELD: usize = 20;

/// A laser without what it held while it saw nothing.
pub(super) struct Seen {
    pub series: Series,
    /// Samples that it held.
    held: usize,
}

/// `laser` with its held samples as not measured.
pub(super) fn seen(laser: &Series) -> Seen {
    let runs = || laser.values().chunk_by(|a, b| a == b);
    let still = |run: &&[f64]| run.len() >= HELD;
    let values = runs().flat_map(|run| run.iter().map(move |value| if still(&run) { f64::NAN } else { *value }));
    let series = laser.with_values(values.collect());
    Seen { series, held: runs().filter(still).map(<[f64]>::len).sum() }
}

impl Seen {
    /// What is said of held samples.
    pub(super) fn note(&self) -> Option<String> {
        let held = self.held;
        (held > 0).then(|| {
            format!("laser: {held} samples that stand still, {HELD} or more in a row, count as out of its range")
        })
    }
}
