//! The signals of a slow inflation.

use super::tracks::Tracks;
use crate::engine::{Inflation, View};
use crate::signal::Recording;

/// How far the film rose.
#[derive(Default)]
pub(super) struct Rise {
    /// Heights of all nodes at the start, m.
    before: Vec<f64>,
}

impl Rise {
    /// Rise of the node that rose most, m.
    pub(super) fn largest(&mut self, view: &View<'_>) -> f64 {
        let heights = || view.nodes.position.iter().map(|x| x[2]);
        if self.before.is_empty() {
            self.before = heights().collect();
        }
        heights().zip(&self.before).map(|(now, before)| now - before).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Pressure and the rise of the node that rose most.
pub(super) fn signals(tracks: &Tracks, inflation: &Inflation) -> Recording {
    let row = |(k, [rise]): (usize, &[f64; 1])| [inflation.at(k as f64 * tracks.sample), *rise];
    let rows: Vec<_> = tracks.rise.rows.iter().enumerate().map(row).collect();
    tracks.table(&["pressure_Pa", "deflection_m"], &rows)
}
