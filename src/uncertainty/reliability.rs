//! Probability of failure: that a limit state g of standard normal inputs is below zero.
//!
//! A limit state is given as a closure over a batch of points, so that its caller may evaluate them in parallel and
//! record them; all points of a batch are known before any of its outputs. Inputs of other distributions are reached by
//! quantile(Φ(u)) (iso-probabilistic transformation; Rosenblatt 1952, Nataf 1962).

use crate::random::Stream;
use crate::statistics::{self, Interval, wilson};
use crate::{Error, Kind, ensure};

/// Limit state: one output for every point of a batch in standard normal space, none for a run that failed to give one;
/// a value that is no number counts as missing. Below zero is failure; zero itself is not, so that a figure equal to its limit is
/// not beyond it.
pub type LimitState<'a> = dyn FnMut(&[Vec<f64>]) -> Vec<Option<f64>> + 'a;

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

/// How much is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Number of points; of subset simulation those of a level, a multiple of ten.
    pub samples: usize,
    /// Probability with which the interval should contain the probability of failure, within (0, 1).
    pub confidence: f64,
    /// Seed, which decides the points.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { samples: 1000, confidence: 0.95, seed: 0 }
    }
}

/// Most points that are given to the limit state at once.
const BATCH: usize = 1024;

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

    fn evaluate(&mut self, points: &[Vec<f64>]) -> Result<Vec<Option<f64>>, Error> {
        let outputs = (self.limit_state)(points);
        let (found, wanted) = (outputs.len(), points.len());
        ensure(found == wanted, || format!("the limit state gave {found} outputs for {wanted} points"))?;
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
/// See [`Error`].
pub fn monte_carlo(inputs: usize, options: &Sampling, limit_state: &mut LimitState) -> Result<Probability, Error> {
    ensure(inputs > 0, || "a limit state needs at least one input")?;
    ensure(options.samples > 0, || "at least one sample is needed")?;
    let mut stream = Stream::new(options.seed);
    let mut counted = Counted::new(limit_state);
    let mut failures = 0;
    while counted.evaluations < options.samples {
        let batch = (options.samples - counted.evaluations).min(BATCH);
        let points: Vec<Vec<f64>> = (0..batch).map(|_| normal_point(&mut stream, inputs)).collect();
        failures += counted.evaluate(&points)?.into_iter().flatten().filter(|g| *g < 0.0).count() as u64;
    }
    let Counted { evaluations, missing, .. } = counted;
    ensure(missing < evaluations, || format!("all {evaluations} outputs are missing"))?;
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

/// Length of a chain: the inverse of the conditional probability p₀ = 0.1 of every level.
const CHAIN: usize = 10;

/// Most levels, of a tenth of the probability each.
const MOST_LEVELS: usize = 12;

/// Half the width of the uniform proposal, in standard deviations.
const REACH: f64 = 1.0;

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
/// first level suffices, whose samples are independent, it is Wilson's (1927) as with [`monte_carlo`].
///
/// # Errors
/// See [`Error`].
pub fn subset_simulation(
    inputs: usize,
    options: &Sampling,
    limit_state: &mut LimitState,
) -> Result<SubsetResult, Error> {
    within_levels(inputs, options, MOST_LEVELS, limit_state)
}

/// Subset simulation of at most so many levels. In one piece, since every step changes what the estimate is made of.
fn within_levels(
    inputs: usize,
    options: &Sampling,
    levels: usize,
    limit_state: &mut LimitState,
) -> Result<SubsetResult, Error> {
    ensure(inputs > 0, || "a limit state needs at least one input")?;
    // A tenth of the samples start the chains, and these must fill the next level exactly.
    let samples = options.samples;
    ensure(samples > 0 && samples.is_multiple_of(CHAIN), || {
        format!("the samples of a level must be a positive multiple of {CHAIN}, found {samples}")
    })?;
    let mut stream = Stream::new(options.seed);
    let mut counted = Counted::new(limit_state);
    let mut level = first_level(&mut counted, &mut stream, inputs, options.samples)?;
    let (mut value, mut log_deviation) = (1.0, 0.0);
    let mut thresholds = Vec::new();
    let (mut number, mut reached) = (0, false);
    while !reached {
        let is_last = number + 1 >= levels;
        // Nothing tells these samples apart, so the next level would be this one again.
        let leads_on = |threshold: &f64| level.outputs.iter().any(|g| g > threshold);
        let threshold = level.threshold();
        if threshold == Some(f64::INFINITY) {
            return Err(Error::new(format!("nine tenths of the outputs of level {number} are missing")));
        }
        // Fewer than a tenth that fail are counted only where no level follows.
        let threshold = threshold.filter(|at| !level.fails() || !is_last && leads_on(at));
        if let Some(threshold) = threshold.filter(|at| !leads_on(at)) {
            return Err(Error::new(format!(
                "all samples of level {number} have the output {threshold}: nothing leads on to failure"
            ))
            .of_kind(Kind::NoProgress));
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
        level = level.conditional(threshold, &mut counted, &mut stream)?;
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
    Ok(SubsetResult { probability, thresholds, reached })
}

fn first_level(counted: &mut Counted, stream: &mut Stream, inputs: usize, samples: usize) -> Result<Level, Error> {
    let points: Vec<Vec<f64>> = (0..samples).map(|_| normal_point(stream, inputs)).collect();
    // Infinity: not failed, and the last of all to start a chain.
    let outputs: Vec<f64> = counted.evaluate(&points)?.into_iter().map(|g| g.unwrap_or(f64::INFINITY)).collect();
    ensure(counted.missing < samples, || format!("all {} outputs are missing", counted.evaluations))?;
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
    /// outputs.
    fn conditional(&self, threshold: f64, counted: &mut Counted, stream: &mut Stream) -> Result<Self, Error> {
        let chains = self.chains();
        let mut order: Vec<usize> = (0..self.outputs.len()).collect();
        // Stable: of equal outputs the earlier sample, the same in every run.
        order.sort_by(|&a, &b| self.outputs[a].total_cmp(&self.outputs[b]));
        let mut points: Vec<Vec<f64>> = order[..chains].iter().map(|&seed| self.points[seed].clone()).collect();
        let mut outputs: Vec<f64> = order[..chains].iter().map(|&seed| self.outputs[seed]).collect();
        // All chains go a place on together: one batch a place, where chain after chain would be one run at a time.
        for place in 1..CHAIN {
            let before = (place - 1) * chains..place * chains;
            // A rejected step repeats its sample, and the copy counts: Metropolis would be biased without it.
            points.extend_from_within(before.clone());
            outputs.extend_from_within(before.clone());
            // Where no component moved the output is known, and a run is saved.
            let candidates = before.filter_map(|at| Some((at + chains, proposed(&points[at], stream)?)));
            let (places, candidates): (Vec<usize>, Vec<Vec<f64>>) = candidates.unzip();
            let found = counted.evaluate(&candidates)?;
            for ((at, candidate), output) in places.into_iter().zip(candidates).zip(found) {
                if let Some(output) = output.filter(|&g| g <= threshold) {
                    points[at] = candidate;
                    outputs[at] = output;
                }
            }
        }
        Ok(Self { points, outputs })
    }
}

/// Candidate of the component-wise Metropolis algorithm for the standard normal distribution; none where no component
/// moves.
fn proposed(point: &[f64], stream: &mut Stream) -> Option<Vec<f64>> {
    let moved = |&u: &f64| {
        // Component by component: in many dimensions, a whole point would hardly ever be accepted (Au and Beck 2001).
        let candidate = u + REACH * (2.0 * stream.uniform() - 1.0);
        let ratio = libm::exp(0.5 * (u * u - candidate * candidate));
        if stream.uniform() < ratio { candidate } else { u }
    };
    let candidate: Vec<f64> = point.iter().map(moved).collect();
    (candidate != point).then_some(candidate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal;
    use crate::statistics::{deviation, mean, wilson};

    /// A limit state of a batch.
    type Batch = Box<dyn FnMut(&[Vec<f64>]) -> Vec<Option<f64>>>;

    /// Linear limit state of ten inputs at the distance `index`, as one of a batch.
    fn linear(index: f64) -> impl FnMut(&[Vec<f64>]) -> Vec<Option<f64>> {
        batched(move |u| index - u.iter().sum::<f64>() / (u.len() as f64).sqrt())
    }

    fn batched(g: impl Fn(&[f64]) -> f64) -> impl FnMut(&[Vec<f64>]) -> Vec<Option<f64>> {
        move |points| points.iter().map(|u| Some(g(u))).collect()
    }

    /// Series system of four branches (Waarts 2000; Schueremans, Van Gemert 2005), at the distances 3 and k/√2; k is usually 6 or 7.
    fn four_branches(k: f64) -> impl FnMut(&[Vec<f64>]) -> Vec<Option<f64>> {
        branches_at([3.0, k])
    }

    /// The same with the two curved branches at the distance `near`.
    fn branches_at([near, k]: [f64; 2]) -> impl FnMut(&[Vec<f64>]) -> Vec<Option<f64>> {
        batched(move |u| {
            let (sum, difference) = (u[0] + u[1], u[0] - u[1]);
            let curved = near + 0.1 * difference * difference - sum.abs() / 2.0_f64.sqrt();
            curved.min(k / 2.0_f64.sqrt() - difference.abs())
        })
    }

    /// Exact probability of [`four_branches`].
    fn four_branches_exact(k: f64) -> f64 {
        branches_at_exact([3.0, k])
    }

    /// Exact probability of [`branches_at`]. With x = (u₁ + u₂)/√2 and y = (u₁ − u₂)/√2 the safe domain is |x| < near + 0.2
    /// y², |y| < k/2, so that P = 1 − ∫ φ(y) (1 − 2 Φ(−near − 0.2 y²)) dy: Simpson's rule.
    fn branches_at_exact([near, k]: [f64; 2]) -> f64 {
        let steps = 20_000;
        let width = k / f64::from(steps);
        let failing = |i: i32| {
            let y = -0.5 * k + width * f64::from(i);
            normal::density(y) * 2.0 * normal::cumulative(-near - 0.2 * y * y)
        };
        let inner: f64 = (1..steps).map(|i| if i % 2 == 0 { 2.0 } else { 4.0 } * failing(i)).sum();
        2.0 * normal::cumulative(-0.5 * k) + (failing(0) + inner + failing(steps)) * width / 3.0
    }

    #[test]
    fn failure_that_is_the_rule_takes_one_level() {
        let often = subset_simulation(10, &Sampling::default(), &mut linear(-1.5)).unwrap();
        assert!((often.probability.value - normal::cumulative(1.5)).abs() < 0.04 && often.thresholds == [0.0]);
    }

    /// Of studies of one probability: the mean of their estimates over it, less one, the scatter of those, what they say that it is,
    /// and how many intervals hold it.
    fn of_studies(name: &str, exact: f64, results: &[Probability]) -> ([f64; 3], u64) {
        let said = mean(&results.iter().map(|found| found.variation.unwrap()).collect::<Vec<f64>>()).unwrap();
        let ratios: Vec<f64> = results.iter().map(|found| found.value / exact).collect();
        let (bias, scatter) = (mean(&ratios).unwrap() - 1.0, deviation(&ratios).unwrap());
        let covered = results.iter().filter(|found| found.interval.contains(exact)).count() as u64;
        print!("{name}, {exact:.1e}: bias {bias:.4}, scatter {scatter:.4}, said {said:.4}");
        println!(", covered {covered} of {}", results.len());
        ([bias, scatter, said], covered)
    }

    /// Estimates over seeds: without bias beyond the order of 1/N, and within the 95 % intervals at least as often as these say.
    /// With levels taken for independent, 224 to 278 of 300 would be.
    #[test]
    fn intervals_of_subset_simulation_cover() {
        let studies: usize = 300;
        let plane = |exact: f64| -> Batch { Box::new(linear(-normal::quantile(exact))) };
        let branches = |at: [f64; 2]| -> Batch { Box::new(branches_at(at)) };
        let limits: [(&str, usize, f64, Batch); 8] = [
            ("plane, 3 inputs", 3, 1e-4, plane(1e-4)),
            ("plane, 1 input", 1, 1e-6, plane(1e-6)),
            ("four branches, k = 6", 2, four_branches_exact(6.0), branches([3.0, 6.0])),
            ("plane, 1 input", 1, 1e-4, plane(1e-4)),
            ("plane, 10 inputs", 10, 1e-6, plane(1e-6)),
            ("four branches, k = 9", 2, four_branches_exact(9.0), branches([3.0, 9.0])),
            ("four branches at 4, k = 8", 2, branches_at_exact([4.0, 8.0]), branches([4.0, 8.0])),
            ("four branches at 5, k = 10", 2, branches_at_exact([5.0, 10.0]), branches([5.0, 10.0])),
        ];
        for (name, inputs, exact, mut limit) in thorough::first(3, limits) {
            let options = |seed| Sampling { samples: 500, seed, ..Sampling::default() };
            let results: Vec<Probability> = (0..studies as u64)
                .map(|seed| subset_simulation(inputs, &options(seed), &mut *limit).unwrap().probability)
                .collect();
            let ([bias, scatter, said], covered) = of_studies(name, exact, &results);
            assert!(bias.abs() < 0.02 + 3.0 * scatter / (studies as f64).sqrt(), "{name}: {bias}");
            assert!(covered as f64 >= 0.95 * studies as f64, "{name}: {covered}");
            // An upper bound, but no more than some times the scatter.
            assert!(said < 4.0 * scatter, "{name}: {said} for {scatter}");
        }
    }

    #[test]
    fn a_larger_sample_begins_with_the_points_of_a_smaller() {
        let points = |samples: usize| {
            let mut all = Vec::new();
            let mut limit_state = |points: &[Vec<f64>]| {
                all.extend_from_slice(points);
                points.iter().map(|_| Some(1.0)).collect()
            };
            monte_carlo(2, &Sampling { samples, ..Sampling::default() }, &mut limit_state).unwrap();
            all
        };
        assert_eq!(points(3 * BATCH + 7)[..BATCH + 5], points(BATCH + 5));
    }

    /// A study of the seed given.
    type Study<'a> = Box<dyn Fn(u64) -> Probability + 'a>;

    /// Independent samples cover as often as they say, neither less nor more; their mean over seeds is the probability, and
    /// their scatter the coefficient of variation that they state.
    #[test]
    fn monte_carlo_covers_as_often_as_it_says() {
        let studies = 300;
        let options = |samples: usize, seed: u64| Sampling { samples, seed, ..Sampling::default() };
        let crude = |samples: usize, exact: f64| -> Study<'_> {
            let index = -normal::quantile(exact);
            Box::new(move |seed| monte_carlo(10, &options(samples, seed), &mut linear(index)).unwrap())
        };
        let branches: Study<'_> =
            Box::new(|seed| monte_carlo(2, &options(4000, seed), &mut four_branches(6.0)).unwrap());
        let cases = [
            ("Monte Carlo, plane", 0.02, crude(500, 0.02)),
            ("Monte Carlo, four branches", four_branches_exact(6.0), branches),
        ];
        for (name, exact, study) in cases {
            let results: Vec<Probability> = (0..studies).map(study).collect();
            let ([bias, scatter, said], covered) = of_studies(name, exact, &results);
            let coverage = wilson(covered, studies, 0.999);
            assert!(coverage.contains(0.95), "{name}, {exact:e}: {covered}: {coverage:?}");
            // Of the mean of the studies, and of the scatter of so many (its deviation is 4 % of it).
            assert!(bias.abs() < 3.0 * scatter / (studies as f64).sqrt(), "{name}, {exact:e}: {bias}");
            assert!((said / scatter - 1.0).abs() < 0.15, "{name}, {exact:e}: {said} for {scatter}");
        }
    }

    #[test]
    fn no_failure_is_bounded_from_above() {
        let none = monte_carlo(1, &Sampling::default(), &mut linear(9.0)).unwrap();
        let interval = none.interval;
        assert_eq!((none.value, none.variation, interval.low), (0.0, None, 0.0));
        assert!(interval.high > 3e-3 && interval.high < 4e-3, "{interval:?}");
    }

    #[test]
    fn missing_outputs_are_counted_and_the_estimate_is_of_what_is_left() {
        let mut calls = 0;
        let mut flawed = |points: &[Vec<f64>]| {
            let output = |u: &Vec<f64>| {
                calls += 1;
                (calls % 7 != 0).then_some(2.0 - u.iter().sum::<f64>() / (u.len() as f64).sqrt())
            };
            points.iter().map(output).collect::<Vec<_>>()
        };
        let (exact, studies) = (normal::cumulative(-2.0), 300);
        let found: Vec<Probability> = (0..studies)
            .map(|seed| {
                let options = Sampling { samples: 1400, seed, ..Sampling::default() };
                monte_carlo(3, &options, &mut flawed).unwrap()
            })
            .collect();
        assert!(found.iter().all(|found| (found.evaluations, found.missing) == (1400, 200)));
        let covered = found.iter().filter(|found| found.interval.contains(exact)).count() as u64;
        println!("with a seventh of the outputs missing, covered {covered} of {studies}");
        assert!(wilson(covered, studies, 0.999).contains(0.95), "{covered}");
        let subset = subset_simulation(3, &Sampling::default(), &mut flawed).unwrap();
        assert!(subset.probability.missing > 200, "{subset:?}");
    }

    #[test]
    fn the_seed_decides() {
        let found = |seed| monte_carlo(4, &Sampling { seed, ..Sampling::default() }, &mut linear(1.0)).unwrap();
        assert_eq!(found(3), found(3));
        assert_ne!(found(3), found(4));
        let subset = |seed| subset_simulation(4, &Sampling { seed, ..Sampling::default() }, &mut linear(3.0));
        assert_eq!(subset(1), subset(1));
        assert_ne!(subset(1), subset(2));
    }

    #[test]
    fn what_has_no_probability_is_refused() {
        let options = Sampling::default();
        let mut short = |_: &[Vec<f64>]| vec![Some(1.0)];
        let refused = monte_carlo(1, &options, &mut short).unwrap_err();
        assert_eq!(refused, Error::new("the limit state gave 1 outputs for 1000 points"));
        let mut missing = |points: &[Vec<f64>]| vec![None; points.len()];
        assert_eq!(monte_carlo(1, &options, &mut missing).unwrap_err(), Error::new("all 1000 outputs are missing"));
        let mut flat = batched(|_| 1.0);
        let refused = subset_simulation(2, &options, &mut flat).unwrap_err();
        let message = "all samples of level 0 have the output 1: nothing leads on to failure";
        assert_eq!(refused, Error::new(message).of_kind(Kind::NoProgress));
        for output in [1.0, -1.0] {
            let mut rare =
                |points: &[Vec<f64>]| (0..points.len()).map(|place| (place % 20 == 0).then_some(output)).collect();
            let refused = subset_simulation(2, &options, &mut rare).unwrap_err();
            assert_eq!(refused, Error::new("nine tenths of the outputs of level 0 are missing"));
        }
        let refused = subset_simulation(2, &Sampling { samples: 105, ..options }, &mut flat).unwrap_err();
        assert_eq!(refused, Error::new("the samples of a level must be a positive multiple of 10, found 105"));
    }

    #[test]
    fn an_output_equal_to_zero_does_not_fail() {
        let mut zero = batched(|_| 0.0);
        let options = Sampling { samples: 20, ..Sampling::default() };
        assert_eq!(monte_carlo(1, &options, &mut zero).unwrap().value, 0.0);
        assert_eq!(subset_simulation(1, &options, &mut zero).unwrap_err().kind, Kind::NoProgress);
        // Half of the samples at zero and one in 44 beyond: zero is a level on the way, in which what fails is counted.
        let mut step = batched(|u| if u[0] > 2.0 { -1.0 } else { f64::from(u8::from(u[0] < 0.0)) });
        let found = subset_simulation(1, &Sampling::default(), &mut step).unwrap();
        assert!(found.reached && found.thresholds == [0.0, 0.0], "{found:?}");
        assert!(found.probability.interval.contains(normal::cumulative(-2.0)), "{found:?}");
    }

    #[test]
    fn one_level_of_subset_simulation_has_the_interval_of_its_count() {
        let options = Sampling { samples: 20, ..Sampling::default() };
        for index in [-9.0, 0.0] {
            let subset = subset_simulation(1, &options, &mut linear(index)).unwrap();
            let crude = monte_carlo(1, &options, &mut linear(index)).unwrap();
            assert!(subset.reached && subset.thresholds == [0.0]);
            assert_eq!((subset.probability.value, subset.probability.interval), (crude.value, crude.interval));
        }
    }

    /// Failure beyond the last level is bounded by the probability of that level; of fewer than a tenth that fail there, the
    /// share counts.
    #[test]
    fn failure_that_no_level_reached_is_bounded() {
        let rare = within_levels(2, &Sampling::default(), 2, &mut linear(6.0)).unwrap();
        let (found, interval) = (&rare.probability, rare.probability.interval);
        assert!(!rare.reached && rare.thresholds.len() == 2 && rare.thresholds[1] > 0.0);
        assert_eq!((found.value, found.variation, interval.low, found.evaluations <= 1900), (0.0, None, 0.0, true));
        assert!(interval.high > 0.01 && interval.high < 0.02, "{interval:?}");
        let exact = 3e-3;
        let few = within_levels(2, &Sampling::default(), 2, &mut linear(-normal::quantile(exact))).unwrap();
        let full = subset_simulation(2, &Sampling::default(), &mut linear(-normal::quantile(exact))).unwrap();
        assert!(few.reached && few.probability.interval.contains(exact), "{few:?}");
        assert!(full.thresholds.len() == 3 && few.thresholds.len() == 2);
    }
}
