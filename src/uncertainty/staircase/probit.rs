//! Maximum-likelihood fit of a normal strength to failures by level.

use thiserror::Error;

use super::Counts;
use super::likelihood::Likelihood;
use crate::normal;
use crate::statistics::{Estimate, Interval, normal_factor};

/// Why there is no fit.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ProbitError {
    /// More failures than trials, or a level that is no number.
    #[error("at level {level} {failures} of {trials} specimens failed: not counts at a level")]
    Counts {
        /// Level.
        level: f64,
        /// Number of specimens.
        trials: u64,
        /// Number of failures.
        failures: u64,
    },
    /// All specimens failed, or none.
    #[error("all {trials} specimens had the same outcome")]
    OneOutcome {
        /// Number of specimens.
        trials: u64,
    },
    /// No specimen failed at a lower level than another survived: any deviation near zero fits, whatever the mean
    /// between.
    #[error(
        "specimens survive up to level {survived} and fail from level {failed} on: \
         outcomes that do not overlap tell no deviation"
    )]
    NoOverlap {
        /// Highest level at which one survived.
        survived: f64,
        /// Lowest level at which one failed.
        failed: f64,
    },
    /// The share of failures does not rise with the level.
    #[error("failures do not become more frequent with the level")]
    NotIncreasing,
}

/// Normal distribution of the strength: P(failure at x) = Φ((x − mean)/deviation).
#[derive(Clone, Debug, PartialEq)]
pub struct ProbitFit {
    /// Level at which half fail, and its profile-likelihood interval, of which an end is infinite where the outcomes do
    /// not exclude that failures are as frequent at every level.
    pub mean: Estimate,
    /// Standard deviation of the strength, and its interval likewise. The estimate is low on average from few
    /// specimens.
    pub deviation: Estimate,
    /// Logarithm of the likelihood at its maximum.
    pub log_likelihood: f64,
}

impl ProbitFit {
    /// Level at which a share `probability` fails.
    pub fn level(&self, probability: f64) -> f64 {
        self.mean.value + self.deviation.value * normal::quantile(probability)
    }
}

/// Fits mean and deviation of the strength by maximum likelihood (probit analysis; Bliss 1935, Finney 1947), with
/// intervals of the profile likelihood: all values whose deviance, 2 (ℓ̂ − ℓ), is at most the quantile of χ² with one
/// degree of freedom.
///
/// The levels may be those of a staircase, [`super::Staircase::counts`]: that they followed from the outcomes does not
/// change the likelihood. The maximum exists where the levels of failures and survivors overlap (Silvapulle 1981).
///
/// # Errors
/// See [`ProbitError`].
///
/// # Panics
/// The confidence is not within (0, 1).
pub fn probit(counts: &[Counts], confidence: f64) -> Result<ProbitFit, ProbitError> {
    check(counts)?;
    let trials: f64 = counts.iter().map(|c| c.trials as f64).sum();
    let weighted = |of: &dyn Fn(f64) -> f64| counts.iter().map(|c| c.trials as f64 * of(c.level)).sum::<f64>() / trials;
    // Standardized levels: slope and offset are then of the order of one, and the start (0, 0) of Newton's method is
    // never far.
    let centre = weighted(&|x| x);
    let scale = weighted(&|x| (x - centre) * (x - centre)).sqrt();
    let likelihood = Likelihood::new(counts, centre, scale);
    let (a, b) = likelihood.maximum();
    // `check` sees levels only; failures may still become rarer on the whole.
    if b <= 0.0 {
        return Err(ProbitError::NotIncreasing);
    }
    let (mean, deviation) = (-a / b, 1.0 / b);
    let log_likelihood = likelihood.log(a, b);
    let least = log_likelihood - 0.5 * normal_factor(confidence).powi(2);
    // Signed distances from the maximum, the deviation's in its logarithm.
    // By the profile instead of the curvature at the maximum: the likelihood of few specimens is far from a parabola.
    let of_mean = |from: f64| profile_of_mean(&likelihood, mean + from * deviation) >= least;
    // In the logarithm, so that no step leads to a deviation of zero or below.
    let of_deviation = |from: f64| profile_of_slope(&likelihood, b * libm::exp(-from)) >= least;
    let mean_interval = Interval {
        low: centre + scale * (mean - deviation * reach(|t| of_mean(-t))),
        high: centre + scale * (mean + deviation * reach(of_mean)),
    };
    let deviation_interval = Interval {
        low: scale * deviation * libm::exp(-reach(|t| of_deviation(-t))),
        high: scale * deviation * libm::exp(reach(of_deviation)),
    };
    Ok(ProbitFit {
        mean: Estimate { value: centre + scale * mean, interval: Some(mean_interval) },
        deviation: Estimate { value: scale * deviation, interval: Some(deviation_interval) },
        log_likelihood,
    })
}

fn check(counts: &[Counts]) -> Result<(), ProbitError> {
    if let Some(&Counts { level, trials, failures }) =
        counts.iter().find(|c| c.failures > c.trials || !c.level.is_finite())
    {
        return Err(ProbitError::Counts { level, trials, failures });
    }
    let failed = || counts.iter().filter(|c| c.failures > 0).map(|c| c.level);
    let survived = || counts.iter().filter(|c| c.failures < c.trials).map(|c| c.level);
    if failed().next().is_none() || survived().next().is_none() {
        return Err(ProbitError::OneOutcome { trials: counts.iter().map(|c| c.trials).sum() });
    }
    let lowest = |levels: &mut dyn Iterator<Item = f64>| levels.fold(f64::INFINITY, f64::min);
    let highest = |levels: &mut dyn Iterator<Item = f64>| levels.fold(f64::NEG_INFINITY, f64::max);
    if lowest(&mut survived()) >= highest(&mut failed()) {
        return Err(ProbitError::NotIncreasing);
    }
    let (survived, failed) = (highest(&mut survived()), lowest(&mut failed()));
    // Separated outcomes: a deviation of zero explains them all, and the likelihood has no maximum.
    if failed >= survived {
        return Err(ProbitError::NoOverlap { survived, failed });
    }
    Ok(())
}

/// Farthest that an interval is followed, in deviations or as a logarithm.
const FARTHEST: f64 = 1e6;

/// Largest distance from the maximum at which `inside` still holds; infinite where it holds as far as it is followed.
fn reach(inside: impl Fn(f64) -> bool) -> f64 {
    let mut outside = 1.0;
    while inside(outside) {
        outside *= 2.0;
        if outside > FARTHEST {
            return f64::INFINITY;
        }
    }
    root(0.0, outside, inside)
}

/// Where a condition that holds at `low` and not at `high` ceases to hold.
fn root(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        // The first two hold where numbers resolve no further, also about zero, where the relative width never gets
        // small.
        if middle <= low || middle >= high || high - low <= 1e-13 * high.abs() {
            return middle;
        }
        if holds(middle) { low = middle } else { high = middle }
    }
}

/// Largest logarithm of the likelihood over all deviations, of strengths with this mean.
fn profile_of_mean(likelihood: &Likelihood, mean: f64) -> f64 {
    let rising = |b: f64| {
        let [by_a, by_b] = likelihood.gradient(-b * mean, b);
        by_b - mean * by_a > 0.0
    };
    // The best slope at this mean is not positive: the profile ends at b = 0, where all levels fail alike.
    if !rising(0.0) {
        return likelihood.log(0.0, 0.0);
    }
    let mut high = 1.0;
    while rising(high) {
        high *= 2.0;
    }
    let b = root(0.0, high, rising);
    likelihood.log(-b * mean, b)
}

/// Largest logarithm of the likelihood over all means, of strengths with the deviation 1/b.
fn profile_of_slope(likelihood: &Likelihood, b: f64) -> f64 {
    let rising = |a: f64| likelihood.gradient(a, b)[0] > 0.0;
    let (mut low, mut high) = (-1.0, 1.0);
    while !rising(low) {
        low *= 2.0;
    }
    while rising(high) {
        high *= 2.0;
    }
    likelihood.log(root(low, high, rising), b)
}
