//! The outcomes of the trials of one search by point, written to its history as they end.

use std::collections::HashMap;

use super::history::{History, HistoryError};
use crate::identify::objective::{Evaluation, Objective};

/// A point by its bits.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Point(Vec<u64>);

/// The trials of one search.
pub(super) struct TrialCache<'a> {
    trials: HashMap<Point, Evaluation>,
    history: Option<&'a mut History>,
}

impl Point {
    pub(super) fn new(x: &[f64]) -> Point {
        // Bits can be hashed, and a point gets no value of one that differs from it by rounding.
        Point(x.iter().map(|x| x.to_bits()).collect())
    }

    pub(super) fn x(&self) -> Vec<f64> {
        self.0.iter().map(|bits| f64::from_bits(*bits)).collect()
    }
}

impl<'a> TrialCache<'a> {
    /// A cache with the trials of `history`.
    pub(super) fn new(history: Option<&'a mut History>) -> TrialCache<'a> {
        let trials = history.iter().flat_map(|history| history.trials());
        TrialCache { trials: trials.map(|(x, found)| (Point::new(x), found.clone())).collect(), history }
    }

    pub(super) fn contains(&self, point: &Point) -> bool {
        self.trials.contains_key(point)
    }

    /// The trials of the history, in its order.
    pub(super) fn known(&self) -> Vec<(Vec<f64>, Evaluation)> {
        self.history.iter().flat_map(|history| history.trials()).cloned().collect()
    }

    pub(super) fn evaluation(&self, point: &Point) -> Option<Evaluation> {
        self.trials.get(point).cloned()
    }

    /// Stores the outcome at `point`, which took `seconds`; it is in the cache also where its history cannot be written.
    pub(super) fn insert(
        &mut self,
        point: Point,
        found: Evaluation,
        seconds: f64,
        objective: &dyn Objective,
    ) -> Result<(), HistoryError> {
        let written = self.write(&point.x(), &found, seconds, objective);
        self.trials.insert(point, found);
        written
    }

    fn write(
        &mut self,
        x: &[f64],
        found: &Evaluation,
        seconds: f64,
        objective: &dyn Objective,
    ) -> Result<(), HistoryError> {
        let Some(history) = &mut self.history else { return Ok(()) };
        history.add_inputs(objective.inputs())?;
        history.add(x, found, seconds)
    }
}
