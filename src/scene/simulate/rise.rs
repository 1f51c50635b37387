//! Rise of a film under pressure, and whether it is at rest.

use serde::{Deserialize, Serialize};

use super::tracks::Tracks;
use lab::signal::column;
use membrane::engine::View;

/// Rise of the film from its initial heights.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Rise {
    /// Heights of all nodes at the start, m.
    before: Vec<f64>,
}

impl Rise {
    /// Largest rise of a node, m.
    pub(super) fn largest(&mut self, view: &View<'_>) -> f64 {
        let heights = || view.nodes.position.iter().map(|x| x[2]);
        if self.before.is_empty() {
            self.before = heights().collect();
        }
        heights().zip(&self.before).map(|(now, before)| now - before).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Largest change of the rise over the last tenth of the samples, relative to the last rise; none without samples.
pub(super) fn settling(tracks: &Tracks) -> Option<f64> {
    let rises = tracks.sampled(&column::DEFLECTION);
    let last = rises.last()?;
    let held = &rises[rises.len() - rises.len().div_ceil(10)..];
    let change = held.iter().map(|rise| (rise - last).abs()).fold(0.0, f64::max);
    Some(change / last.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::tracks::Sampling;

    #[test]
    fn settling_is_the_change_in_the_last_tenth() {
        let mut tracks = Tracks::new(Sampling::new(1.0, 0.05), vec![], None);
        assert_eq!(settling(&tracks), None);
        for k in 0..=20 {
            let time = 0.05 * f64::from(k);
            let rise = if k < 19 { 5.0 * time } else { 5.0 - 0.01 * f64::from(20 - k) };
            tracks.sample(&column::DEFLECTION, time, rise);
        }
        assert!(settling(&tracks).is_some_and(|change| (change - 0.1).abs() < 1e-12), "{:?}", settling(&tracks));
    }
}
