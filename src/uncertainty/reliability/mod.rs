//! Probability of failure: that a limit state g of standard normal inputs is below zero.
//!
//! A limit state is given as a closure over a batch of points, so that its caller may evaluate them in parallel and
//! record them; all points of a batch are known before any of its outputs. Inputs of other distributions are reached by
//! quantile(Φ(u)) (iso-probabilistic transformation; Rosenblatt 1952, Nataf 1962).

mod form;
mod importance;
mod monte_carlo;
mod subset;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use form::{DesignPoint, FormOptions, design_point};
pub use importance::{importance_sampling, importance_sampling_at};
pub use monte_carlo::monte_carlo;
pub use subset::{SubsetOptions, SubsetResult, subset_simulation};

use crate::random::Stream;
use crate::statistics::{self, Interval};

/// Limit state: one output for every point of a batch in standard normal space, none for a run that failed to give one;
/// a value that is no number counts as missing. Below zero is failure; zero itself is not, so that a figure equal to its limit is
/// not beyond it.
pub type LimitState<'a> = dyn FnMut(&[Vec<f64>]) -> Vec<Option<f64>> + 'a;

/// Why there is no probability.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ReliabilityError {
    /// There is nothing to vary.
    #[error("a limit state needs at least one input")]
    NoInputs,
    /// There is nothing to evaluate.
    #[error("at least one sample is needed")]
    NoSamples,
    /// The limit state gave another number of outputs than it was given points.
    #[error("the limit state gave {outputs} outputs for {points} points")]
    Outputs {
        /// Number of points.
        points: usize,
        /// Number of outputs.
        outputs: usize,
    },
    /// No output at all.
    #[error("all {evaluations} outputs are missing")]
    AllMissing {
        /// Evaluations so far.
        evaluations: usize,
    },
    /// The search for the design point needs an output that is missing.
    #[error(
        "the output is missing at a point that the search for the design point needs, after {evaluations} evaluations"
    )]
    Missing {
        /// Evaluations so far.
        evaluations: usize,
    },
    /// The limit state is the same all around a point.
    #[error("the limit state has no gradient: no input changes it, after {evaluations} evaluations")]
    Flat {
        /// Evaluations so far.
        evaluations: usize,
    },
    /// A level of subset simulation cannot be divided into its chains.
    #[error("the samples of a level must be a positive multiple of {chain}, found {samples}")]
    Level {
        /// Samples of a level.
        samples: usize,
        /// Length of a chain.
        chain: usize,
    },
    /// All samples of a level have the same output, short of failure.
    #[error("all samples of level {level} have the output {threshold}: nothing leads on to failure")]
    NoProgress {
        /// The level, from 0.
        level: usize,
        /// Their output.
        threshold: f64,
    },
}

/// Probability of failure, how well it is known, and what it cost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probability {
    /// The estimate.
    pub value: f64,
    /// Coefficient of variation of the estimate; none where no sample failed, or of a complement where none survived.
    pub variation: Option<f64>,
    /// Confidence interval; none where the method gives none.
    pub interval: Option<Interval>,
    /// Points that were evaluated.
    pub evaluations: usize,
    /// Of these, points whose output is missing.
    pub missing: usize,
}

/// Sampling of a given size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingOptions {
    /// Number of points.
    pub samples: usize,
    /// Most points that are given to the limit state at once.
    pub batch: usize,
    /// Probability with which the interval should contain the probability of failure, within (0, 1).
    pub confidence: f64,
    /// Seed, which decides the points.
    pub seed: u64,
}

impl Default for SamplingOptions {
    fn default() -> Self {
        Self { samples: 1000, batch: 1024, confidence: 0.95, seed: 0 }
    }
}

/// A limit state whose evaluations are counted.
struct Counted<'a, 'b> {
    limit_state: &'a mut LimitState<'b>,
    evaluations: usize,
    missing: usize,
}

impl<'a, 'b> Counted<'a, 'b> {
    fn new(limit_state: &'a mut LimitState<'b>) -> Self {
        Self { limit_state, evaluations: 0, missing: 0 }
    }

    fn evaluate(&mut self, points: &[Vec<f64>]) -> Result<Vec<Option<f64>>, ReliabilityError> {
        let outputs = (self.limit_state)(points);
        if outputs.len() != points.len() {
            return Err(ReliabilityError::Outputs { points: points.len(), outputs: outputs.len() });
        }
        let outputs: Vec<Option<f64>> = outputs.into_iter().map(|g| g.filter(|g| !g.is_nan())).collect();
        self.evaluations += outputs.len();
        self.missing += outputs.iter().filter(|g| g.is_none()).count();
        Ok(outputs)
    }

    /// Points and outputs of a sample in batches, as `each` takes them.
    fn sample(
        &mut self,
        options: &SamplingOptions,
        mut point: impl FnMut() -> Vec<f64>,
        mut each: impl FnMut(&[f64], f64),
    ) -> Result<(), ReliabilityError> {
        if options.samples == 0 {
            return Err(ReliabilityError::NoSamples);
        }
        let mut left = options.samples;
        while left > 0 {
            let batch: Vec<Vec<f64>> = (0..left.min(options.batch.max(1))).map(|_| point()).collect();
            let outputs = self.evaluate(&batch)?;
            left -= batch.len();
            batch.iter().zip(outputs).filter_map(|(u, g)| Some((u, g?))).for_each(|(u, g)| each(u, g));
        }
        if self.missing == self.evaluations {
            return Err(ReliabilityError::AllMissing { evaluations: self.evaluations });
        }
        Ok(())
    }
}

fn normal_point(stream: &mut Stream, inputs: usize) -> Vec<f64> {
    (0..inputs).map(|_| stream.normal()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Interval of an estimate whose logarithm is taken for normal: of a small probability neither end is negative.
fn log_normal(value: f64, variation: f64, confidence: f64) -> Interval {
    let deviation = libm::log1p(variation * variation).sqrt();
    let factor = libm::exp(statistics::normal_factor(confidence) * deviation);
    Interval { low: value / factor, high: (value * factor).min(1.0) }
}

#[cfg(test)]
mod tests;
