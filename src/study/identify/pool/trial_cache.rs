//! The trials of one search by point, written to its history as they end.

use std::collections::HashMap;
use std::sync::Arc;

use super::history::{History, HistoryError};
use crate::identify::objective::{Evaluation, Objective, Trial};
use crate::script::{Compared, Target};

/// Largest number of samples of all curves of one search, resumed trials included; later trials store no curves.
const MAX_SAMPLES: usize = 64 << 20;

/// A point by its bits.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Point(Vec<u64>);

/// The trials of one search.
pub(super) struct TrialCache<'a> {
    trials: HashMap<Point, Trial>,
    history: Option<&'a mut History>,
    /// References that trials were compared with.
    targets: Vec<Arc<Target>>,
    /// Number of samples of all curves.
    samples: usize,
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
        let targets = history.iter().flat_map(|history| history.targets()).cloned().collect();
        let trials = || history.iter().flat_map(|history| history.trials());
        let samples = trials().map(|(_, trial)| samples_of(&trial.compared)).sum();
        let trials = trials().map(|(x, trial)| (Point::new(x), trial.clone())).collect();
        TrialCache { trials, history, targets, samples }
    }

    pub(super) fn contains(&self, point: &Point) -> bool {
        self.trials.contains_key(point)
    }

    /// The trials of the history, in its order.
    pub(super) fn known(&self) -> Vec<(Vec<f64>, Trial)> {
        self.history.iter().flat_map(|history| history.trials()).cloned().collect()
    }

    pub(super) fn get(&self, point: &Point) -> Option<&Trial> {
        self.trials.get(point)
    }

    pub(super) fn evaluation(&self, point: &Point) -> Option<Evaluation> {
        self.get(point).map(|trial| trial.evaluation.clone())
    }

    /// Stores the trial at `point`, which took `seconds`; it is in the cache also where its history cannot be written.
    pub(super) fn insert(
        &mut self,
        point: Point,
        mut trial: Trial,
        seconds: f64,
        objective: &dyn Objective,
    ) -> Result<(), HistoryError> {
        self.share_targets(&mut trial.compared);
        let written = self.write(&point.x(), &trial, seconds, objective);
        self.trials.insert(point, trial);
        written
    }

    /// Replaces references that are in the cache already, and drops all curves beyond the largest number of samples.
    fn share_targets(&mut self, compared: &mut Vec<Compared>) {
        for one in compared.iter_mut() {
            match self.targets.iter().find(|target| **target == one.target) {
                Some(target) => one.target = Arc::clone(target),
                None => self.targets.push(Arc::clone(&one.target)),
            }
        }
        let samples = self.samples + samples_of(compared);
        if samples > MAX_SAMPLES {
            compared.clear();
        } else {
            self.samples = samples;
        }
    }

    fn write(&mut self, x: &[f64], trial: &Trial, seconds: f64, objective: &dyn Objective) -> Result<(), HistoryError> {
        let Some(history) = &mut self.history else { return Ok(()) };
        history.add_inputs(objective.inputs())?;
        history.add(x, trial, seconds)
    }
}

fn samples_of(compared: &[Compared]) -> usize {
    compared.iter().map(|one| one.values.len()).sum()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::identify::objective::ObjectiveValue;
    use crate::identify::pool::history::Identity;
    use crate::script::Over;

    #[test]
    fn samples_of_resumed_trials_count() {
        let folder = tempfile::tempdir().unwrap();
        let open = || History::open(folder.path(), &Identity::default(), 1, BTreeMap::new()).unwrap();
        let target = Arc::new(Target { over: Over::Time, places: vec![0.0, 0.1], values: vec![1.0, 2.0] });
        let compared = vec![Compared { target, values: vec![1.5, 2.5] }];
        let trial = Trial { evaluation: ObjectiveValue::Scalar(1.0).into(), compared };
        let zero = |_: &[f64]| 0.0;
        let mut history = open();
        let mut cache = TrialCache::new(Some(&mut history));
        cache.insert(Point::new(&[1.0]), trial.clone(), 0.1, &zero).unwrap();
        cache.insert(Point::new(&[2.0]), trial, 0.1, &zero).unwrap();
        assert_eq!(cache.samples, 4);
        drop(history);
        assert_eq!(TrialCache::new(Some(&mut open())).samples, 4);
    }
}
