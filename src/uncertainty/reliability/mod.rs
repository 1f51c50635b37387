//! Probability of failure: that a limit state g of standard normal inputs is below zero.
//!
//! A limit state is given as a closure over a batch of points, so that its caller may evaluate them in parallel and
//! record them; all points of a batch are known before any of its outputs. Inputs of other distributions are reached by
//! quantile(Φ(u)) (iso-probabilistic transformation; Rosenblatt 1952, Nataf 1962).

mod subset;

use thiserror::Error;

pub use subset::{SubsetOptions, SubsetResult, subset_simulation};

use crate::random::Stream;
use crate::statistics::{self, Interval, wilson};

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
#[derive(Clone, Debug, PartialEq)]
pub struct Probability {
    /// The estimate.
    pub value: f64,
    /// Coefficient of variation of the estimate; none where no sample failed.
    pub variation: Option<f64>,
    /// Confidence interval.
    pub interval: Interval,
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
}

fn normal_point(stream: &mut Stream, inputs: usize) -> Vec<f64> {
    (0..inputs).map(|_| stream.normal()).collect()
}

/// Share of independent points that fail, with the interval by Wilson (1927), which also bounds the probability where
/// none failed (crude Monte Carlo).
///
/// Points whose output is missing are left out and counted: where failure itself makes a run give no output, the
/// estimate is low. A larger sample begins with the points of a smaller.
///
/// # Errors
/// See [`ReliabilityError`].
pub fn monte_carlo(
    inputs: usize,
    options: &SamplingOptions,
    limit_state: &mut LimitState,
) -> Result<Probability, ReliabilityError> {
    if inputs == 0 {
        return Err(ReliabilityError::NoInputs);
    }
    if options.samples == 0 {
        return Err(ReliabilityError::NoSamples);
    }
    let mut stream = Stream::new(options.seed);
    let mut counted = Counted::new(limit_state);
    let mut failures = 0;
    while counted.evaluations < options.samples {
        let batch = (options.samples - counted.evaluations).min(options.batch.max(1));
        let points: Vec<Vec<f64>> = (0..batch).map(|_| normal_point(&mut stream, inputs)).collect();
        failures += counted.evaluate(&points)?.into_iter().flatten().filter(|g| *g < 0.0).count() as u64;
    }
    let Counted { evaluations, missing, .. } = counted;
    if missing == evaluations {
        return Err(ReliabilityError::AllMissing { evaluations });
    }
    let valid = (evaluations - missing) as u64;
    let value = failures as f64 / valid as f64;
    Ok(Probability {
        value,
        // √((1 − p)/(p n)) with p n = failures.
        variation: (failures > 0).then(|| ((1.0 - value) / failures as f64).sqrt()),
        interval: wilson(failures, valid, options.confidence),
        evaluations,
        missing,
    })
}

/// Interval of an estimate whose logarithm is taken for normal: of a small probability neither end is negative.
fn log_normal(value: f64, variation: f64, confidence: f64) -> Interval {
    let deviation = libm::log1p(variation * variation).sqrt();
    let factor = libm::exp(statistics::normal_factor(confidence) * deviation);
    Interval { low: value / factor, high: (value * factor).min(1.0) }
}

#[cfg(test)]
mod tests;
