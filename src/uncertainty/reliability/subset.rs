//! Subset simulation: rare failure as a sequence of events that are not rare.

use super::{Counted, LimitState, Probability, ReliabilityError, log_normal, normal_point};
use crate::random::Stream;
use crate::statistics::{Interval, wilson};

/// Length of a chain: the inverse of the conditional probability p₀ = 0.1 of every level.
const CHAIN: usize = 10;

/// How failure is approached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubsetOptions {
    /// Samples of a level, a multiple of ten.
    pub samples: usize,
    /// Most levels, of a tenth of the probability each.
    pub levels: usize,
    /// Half the width of the uniform proposal, in standard deviations.
    pub reach: f64,
    /// Probability with which the interval should contain the probability of failure, within (0, 1).
    pub confidence: f64,
    /// Seed, which decides the points.
    pub seed: u64,
}

impl Default for SubsetOptions {
    fn default() -> Self {
        Self { samples: 1000, levels: 12, reach: 1.0, confidence: 0.95, seed: 0 }
    }
}

/// Probability of failure by subset simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct SubsetResult {
    /// The probability. Its coefficient of variation is Au and Beck's upper bound (2001): levels that share the chains they grew
    /// from err together, and independence would have 75 to 90 % of 95 % intervals cover.
    pub probability: Probability,
    /// Outputs that bound the levels, decreasing; the last is zero where failure was reached.
    pub thresholds: Vec<f64>,
    /// Whether failure was reached; if not, the interval of the probability goes from 0 to the upper end of that of the last level,
    /// within which failure lies.
    pub reached: bool,
    /// Share of the proposed points that each level after the first accepted.
    pub acceptance: Vec<f64>,
}

/// Samples of one level: chain by chain next to each other, place after place.
struct Level {
    points: Vec<Vec<f64>>,
    outputs: Vec<f64>,
}

/// Subset simulation (Au, Beck 2001) with the component-wise Metropolis algorithm, p₀ = 0.1, and all chains of a level
/// in step: nine batches of a tenth of the samples.
///
/// A point whose output is missing counts as one that does not fail: in a chain it is rejected. Where failure itself
/// makes a run give no output, the estimate is low. The interval takes the logarithm of the estimate for normal; where the
/// first level suffices, whose samples are independent, it is Wilson's (1927) as with [`super::monte_carlo`].
///
/// # Errors
/// See [`ReliabilityError`].
pub fn subset_simulation(
    inputs: usize,
    options: &SubsetOptions,
    limit_state: &mut LimitState,
) -> Result<SubsetResult, ReliabilityError> {
    if inputs == 0 {
        return Err(ReliabilityError::NoInputs);
    }
    // A tenth of the samples start the chains, and these must fill the next level exactly.
    if options.samples == 0 || !options.samples.is_multiple_of(CHAIN) {
        return Err(ReliabilityError::Level { samples: options.samples, chain: CHAIN });
    }
    let mut stream = Stream::new(options.seed);
    let mut counted = Counted::new(limit_state);
    let mut level = first_level(&mut counted, &mut stream, inputs, options.samples)?;
    let (mut value, mut log_deviation) = (1.0, 0.0);
    let (mut thresholds, mut acceptance) = (Vec::new(), Vec::new());
    let (mut number, mut reached) = (0, false);
    while !reached {
        let is_last = number + 1 >= options.levels;
        // Nothing tells these samples apart, so the next level would be this one again.
        let leads_on = |threshold: &f64| level.outputs.iter().any(|g| g > threshold);
        // Fewer than a tenth that fail are counted only where no level follows.
        let threshold = level.threshold().filter(|at| !level.fails() || !is_last && leads_on(at));
        if let Some(threshold) = threshold.filter(|at| !leads_on(at)) {
            return Err(ReliabilityError::NoProgress { level: number, threshold });
        }
        // Counted, not 0.1: at the last level more may fail, and equal outputs may share the threshold.
        let within = level.within(threshold);
        let share = within.iter().filter(|within| **within).count() as f64 / options.samples as f64;
        value *= share;
        // Deviations of the logarithms add up in a product of factors that are fully correlated; only the first level has
        // no chains.
        log_deviation += libm::log1p(level.squared_variation(&within, share, number > 0)).sqrt();
        thresholds.push(threshold.unwrap_or(0.0));
        reached = threshold.is_none();
        let Some(threshold) = threshold.filter(|_| !is_last) else { break };
        let accepted;
        (level, accepted) = level.conditional(threshold, options.reach, &mut counted, &mut stream)?;
        acceptance.push(accepted);
        number += 1;
    }
    let variation = libm::expm1(log_deviation * log_deviation).sqrt();
    let interval = if reached && number == 0 {
        wilson((value * options.samples as f64).round() as u64, options.samples as u64, options.confidence)
    } else {
        log_normal(value, variation, options.confidence)
    };
    let probability = Probability {
        value: if reached { value } else { 0.0 },
        variation: reached.then_some(variation),
        // All failure lies within the last level, whose probability bounds that of failure.
        interval: if reached { interval } else { Interval { low: 0.0, ..interval } },
        evaluations: counted.evaluations,
        missing: counted.missing,
    };
    Ok(SubsetResult { probability, thresholds, reached, acceptance })
}

fn first_level(
    counted: &mut Counted,
    stream: &mut Stream,
    inputs: usize,
    samples: usize,
) -> Result<Level, ReliabilityError> {
    let points: Vec<Vec<f64>> = (0..samples).map(|_| normal_point(stream, inputs)).collect();
    // Infinity: not failed, and the last of all to start a chain.
    let outputs: Vec<f64> = counted.evaluate(&points)?.into_iter().map(|g| g.unwrap_or(f64::INFINITY)).collect();
    if counted.missing == samples {
        return Err(ReliabilityError::AllMissing { evaluations: counted.evaluations });
    }
    Ok(Level { points, outputs })
}

impl Level {
    /// Number of chains that the next level has.
    fn chains(&self) -> usize {
        self.outputs.len() / CHAIN
    }

    fn fails(&self) -> bool {
        self.outputs.iter().any(|&g| g < 0.0)
    }

    /// Output that a tenth of the samples does not exceed; none where at least so many fail.
    fn threshold(&self) -> Option<f64> {
        let mut sorted = self.outputs.clone();
        sorted.sort_by(f64::total_cmp);
        let (last, next) = (sorted[self.chains() - 1], sorted[self.chains()]);
        // Between two samples, so that none lies on the threshold by rounding.
        let between = if next.is_finite() { 0.5 * (last + next) } else { last };
        (last >= 0.0 || between > 0.0).then_some(between)
    }

    /// Whether each sample is within `threshold`, or fails where there is none.
    fn within(&self, threshold: Option<f64>) -> Vec<bool> {
        self.outputs.iter().map(|&g| threshold.map_or(g < 0.0, |threshold| g <= threshold)).collect()
    }

    /// Square of the coefficient of variation of the share of samples `within`: of independent ones, or of chains, whose
    /// samples are correlated (Au, Beck 2001).
    fn squared_variation(&self, within: &[bool], share: f64, chains: bool) -> f64 {
        let samples = self.outputs.len();
        let independent = (1.0 - share) / (share * samples as f64);
        if !chains || share == 1.0 {
            return independent;
        }
        let within: Vec<f64> = within.iter().map(|&within| f64::from(u8::from(within))).collect();
        let correlation = |lag: usize| {
            let pairs = within.iter().zip(&within[lag * self.chains()..]);
            let mean = pairs.map(|(one, other)| one * other).sum::<f64>() / (samples - lag * self.chains()) as f64;
            (mean - share * share) / (share * (1.0 - share))
        };
        let lags = (1..CHAIN).map(|lag| (1.0 - lag as f64 / CHAIN as f64) * correlation(lag));
        independent * (1.0 + 2.0 * lags.sum::<f64>()).max(0.0)
    }

    /// Samples given that the output is at most `threshold`, from chains that start at the samples of the lowest
    /// outputs; and the share of steps that moved.
    fn conditional(
        &self,
        threshold: f64,
        reach: f64,
        counted: &mut Counted,
        stream: &mut Stream,
    ) -> Result<(Self, f64), ReliabilityError> {
        let chains = self.chains();
        let mut order: Vec<usize> = (0..self.outputs.len()).collect();
        // Stable: of equal outputs the earlier sample, the same in every run.
        order.sort_by(|&a, &b| self.outputs[a].total_cmp(&self.outputs[b]));
        let mut points: Vec<Vec<f64>> = order[..chains].iter().map(|&seed| self.points[seed].clone()).collect();
        let mut outputs: Vec<f64> = order[..chains].iter().map(|&seed| self.outputs[seed]).collect();
        let mut accepted = 0;
        // All chains go a place on together: one batch a place, where chain after chain would be one run at a time.
        for place in 1..CHAIN {
            let before = (place - 1) * chains..place * chains;
            // A rejected step repeats its sample, and the copy counts: Metropolis would be biased without it.
            points.extend_from_within(before.clone());
            outputs.extend_from_within(before.clone());
            // Where no component moved the output is known, and a run is saved.
            let candidates = before.filter_map(|at| Some((at + chains, proposed(&points[at], reach, stream)?)));
            let (places, candidates): (Vec<usize>, Vec<Vec<f64>>) = candidates.unzip();
            let found = counted.evaluate(&candidates)?;
            for ((at, candidate), output) in places.into_iter().zip(candidates).zip(found) {
                if let Some(output) = output.filter(|&g| g <= threshold) {
                    points[at] = candidate;
                    outputs[at] = output;
                    accepted += 1;
                }
            }
        }
        Ok((Self { points, outputs }, accepted as f64 / (chains * (CHAIN - 1)) as f64))
    }
}

/// Candidate of the component-wise Metropolis algorithm for the standard normal distribution; none where no component
/// moves.
fn proposed(point: &[f64], reach: f64, stream: &mut Stream) -> Option<Vec<f64>> {
    let moved = |&u: &f64| {
        // Component by component: in many dimensions, a whole point would hardly ever be accepted (Au and Beck 2001).
        let candidate = u + reach * (2.0 * stream.uniform() - 1.0);
        let ratio = libm::exp(0.5 * (u * u - candidate * candidate));
        if stream.uniform() < ratio { candidate } else { u }
    };
    let candidate: Vec<f64> = point.iter().map(moved).collect();
    (candidate != point).then_some(candidate)
}
