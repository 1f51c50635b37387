//! Reduction of a staircase by the formulas of Dixon and Mood.

use thiserror::Error;

use super::likelihood::information;
use super::{Outcome, Staircase};
use crate::statistics::Interval;

/// Why a staircase cannot be reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ReductionError {
    /// All specimens failed, or none.
    #[error("of {trials} specimens all had the same outcome: the level at which half fail was not passed")]
    OneOutcome {
        /// Number of specimens.
        trials: usize,
    },
}

/// Result of a staircase.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduction {
    /// Level at which half of the specimens fail, in the unit of the level: the impact failure mass of a dart test.
    pub mean: f64,
    /// Standard deviation of the specimens' strength; none where [`Reduction::variance_ratio`] is not above 0.3, below
    /// which the formula does not hold: the step is too large for it.
    pub deviation: Option<f64>,
    /// (N B − A²)/N²: variance of the counted levels over the square of the step.
    pub variance_ratio: f64,
    /// The outcome that was counted: the less frequent one, failures where both are as frequent.
    pub counted: Outcome,
    /// N: how often it occurred.
    pub count: usize,
    /// Standard error of the mean, by the expected information at mean and deviation; none without a deviation.
    pub standard_error: Option<f64>,
    /// Confidence interval of the mean, symmetric and normal; none without a deviation.
    pub interval: Option<Interval>,
}

/// Least variance ratio of the formula of the deviation (Dixon, Mood 1948).
const LEAST_RATIO: f64 = 0.3;

impl Staircase {
    /// Mean and deviation of the strength (Dixon, Mood 1948): mean = x₀ + d (A/N ∓ ½), deviation = 1.62 d ((N B −
    /// A²)/N² + 0.029), with A = Σ i nᵢ and B = Σ i² nᵢ over the N specimens of the less frequent outcome, i steps d
    /// above their lowest level x₀; − for failures, as in ISO 7765-1 and ASTM D1709, + for survivors.
    ///
    /// The standard error takes the deviation for known exactly. Of twenty specimens, the interval of 95 % so contains
    /// the mean in about nine of ten tests; [`super::probit`] gives one that allows for it.
    ///
    /// # Errors
    /// All specimens had the same outcome.
    pub fn reduce(&self, outcomes: &[Outcome], confidence: f64) -> Result<Reduction, ReductionError> {
        let failed = outcomes.iter().filter(|outcome| **outcome == Outcome::Failed).count();
        // The less frequent outcome holds all information: each of the other kind answers one of them, but for the way
        // from the first level.
        let counted = if 2 * failed <= outcomes.len() { Outcome::Failed } else { Outcome::Survived };
        let places = self.places(outcomes).into_iter().zip(outcomes);
        let of_counted: Vec<i32> = places.filter(|(_, outcome)| **outcome == counted).map(|(place, _)| place).collect();
        let Some(&lowest) = of_counted.iter().min() else {
            return Err(ReductionError::OneOutcome { trials: outcomes.len() });
        };
        let n = of_counted.len() as f64;
        // From their own lowest level, as in the formula: A and B are then small whole numbers, without round-off.
        let steps = || of_counted.iter().map(|place| f64::from(place - lowest));
        let (a, b) = (steps().sum::<f64>(), steps().map(|i| i * i).sum::<f64>());
        // Half a step back towards the other outcome: failures lie above the mean, survivors below it (methods.md,
        // equation 322).
        let half = if counted == Outcome::Failed { -0.5 } else { 0.5 };
        let mean = self.level_at(lowest) + self.step * (a / n + half);
        let variance_ratio = (n * b - a * a) / (n * n);
        let deviation = (variance_ratio > LEAST_RATIO).then_some(1.62 * self.step * (variance_ratio + 0.029));
        let standard_error = deviation.map(|deviation| {
            let [mm, md, dd] = information(&self.counts(outcomes), mean, deviation);
            // Entry of the inverse information matrix, with what the mean shares with the deviation.
            (dd / (mm * dd - md * md)).sqrt()
        });
        let interval = standard_error.map(|error| Interval::normal(mean, error, confidence));
        Ok(Reduction { mean, deviation, variance_ratio, counted, count: of_counted.len(), standard_error, interval })
    }
}
