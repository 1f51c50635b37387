//! Estimates from samples of equal weight, and how well they are known.

use crate::random::Stream;
use crate::{Error, ensure, normal};

/// Confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Its lower and its upper end.
    pub fn ends(self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Whether `value` lies in it, ends included.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Symmetric about `centre`: `deviation` times the normal quantile of this confidence to either side.
    pub fn normal(centre: f64, deviation: f64, confidence: f64) -> Self {
        let half = normal_factor(confidence) * deviation;
        Self { low: centre - half, high: centre + half }
    }
}

/// Refuses points of which not each has an output.
pub(crate) fn check_counts(points: &[Vec<f64>], outputs: &[Option<f64>]) -> Result<(), Error> {
    let (points, outputs) = (points.len(), outputs.len());
    ensure(points == outputs, || format!("{points} points have {outputs} outputs"))
}

/// An output that counts: no missing one, and none that is no finite number.
pub(crate) fn present(output: Option<f64>) -> Option<f64> {
    output.filter(|output| output.is_finite())
}

/// Deviations to either side of the mean between which a normal variable lies with this probability.
///
/// # Panics
/// The confidence is not within (0, 1).
pub(crate) fn normal_factor(confidence: f64) -> f64 {
    assert!(confidence > 0.0 && confidence < 1.0, "a confidence lies within 0 and 1, not {confidence}");
    -normal::quantile(0.5 * (1.0 - confidence))
}

/// An estimate and its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its confidence interval; none where the samples do not tell.
    pub interval: Option<Interval>,
}

/// Arithmetic mean; none of no samples.
pub fn mean(samples: &[f64]) -> Option<f64> {
    (!samples.is_empty()).then(|| samples.iter().sum::<f64>() / samples.len() as f64)
}

/// Variance with n − 1 in the denominator; none of fewer than two samples.
pub fn variance(samples: &[f64]) -> Option<f64> {
    let mean = mean(samples).filter(|_| samples.len() > 1)?;
    Some(samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (samples.len() - 1) as f64)
}

/// Standard deviation with n − 1 in the denominator; none of fewer than two samples.
pub fn deviation(samples: &[f64]) -> Option<f64> {
    variance(samples).map(f64::sqrt)
}

/// Quantiles at the probabilities `at`, linear between order statistics of which the first is the quantile of 0 and the
/// last that of 1 (type 7 of Hyndman, Fan 1996, the default of R and NumPy); none of no samples.
///
/// # Panics
/// A probability is not within 0 and 1.
pub fn quantiles(samples: &[f64], at: &[f64]) -> Option<Vec<f64>> {
    order_statistics(samples, at, |p, count| p * (count - 1.0))
}

/// Values below which one more sample of the same distribution lies with the probabilities `at`, linear between order
/// statistics of which the k-th of n is that of k/(n + 1), as it is for every distribution (type 6 of Hyndman, Fan 1996);
/// the least and the largest sample beyond 1/(n + 1) and n/(n + 1). None of no samples.
///
/// [`quantiles`] lie closer together: those of 2.5 and 97.5 % of 48 samples hold 91.1 % of further ones.
///
/// # Panics
/// A probability is not within 0 and 1.
pub fn predictive_quantiles(samples: &[f64], at: &[f64]) -> Option<Vec<f64>> {
    order_statistics(samples, at, |p, count| (p * (count + 1.0) - 1.0).clamp(0.0, count - 1.0))
}

/// Values between sorted samples; `place` of a probability and their number counts from zero.
fn order_statistics(samples: &[f64], at: &[f64], place: impl Fn(f64, f64) -> f64) -> Option<Vec<f64>> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let value = |&p: &f64| {
        assert!((0.0..=1.0).contains(&p), "a probability lies within 0 and 1, not {p}");
        let place = place(p, sorted.len() as f64);
        let below = place as usize;
        let above = (below + 1).min(sorted.len() - 1);
        sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
    };
    (!sorted.is_empty()).then(|| at.iter().map(value).collect())
}

/// Interval of a probability of which `count` of `trials` were counted, by the score test (Wilson 1927); the whole unit
/// interval of no trials.
///
/// It needs no quantile but the normal one, has ends other than 0 and 1 where none or all were counted, and covers the
/// probability on average as often as it says, where that of Clopper and Pearson (1934) covers more often and is
/// accordingly wider (Brown, Cai, DasGupta 2001). Single probabilities near 0 or 1 may be covered less often, where the
/// interval lies on the side of 1/2: the upper end of a rare event's, on which safety rests, is exceeded in at most
/// 2.7 % of studies where it should be in 2.5 % (probabilities up to 0.1, 20 to 1000 trials).
///
/// # Panics
/// More are counted than tried, or the confidence is not within (0, 1).
pub fn wilson(count: u64, trials: u64, confidence: f64) -> Interval {
    assert!(count <= trials, "{count} of {trials} trials");
    if trials == 0 {
        return Interval { low: 0.0, high: 1.0 };
    }
    let (n, z) = (trials as f64, normal_factor(confidence));
    let end = |successes: f64, failures: f64| {
        // Lower end; its denominator adds positive terms only, so that it has all digits for rare events.
        let root = z * (z * z + 4.0 * successes * failures / n).sqrt();
        2.0 * successes * successes / n / (2.0 * successes + z * z + root)
    };
    let (successes, failures) = (count as f64, (trials - count) as f64);
    // The upper end by the lower one of survivors: by symmetry, and with the same digits.
    Interval { low: end(successes, failures), high: 1.0 - end(failures, successes) }
}

/// How deviations are found by resampling (Efron 1979).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// Number of resamples; some hundreds for a deviation.
    pub resamples: usize,
    /// Probability with which an interval should contain what is estimated, within (0, 1).
    pub confidence: f64,
    /// Seed, which decides the resamples.
    pub seed: u64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self { resamples: 1000, confidence: 0.95, seed: 0 }
    }
}

impl Bootstrap {
    /// Standard deviation of a statistic over resamples of `count` places; none where it is undefined in one of them.
    pub fn deviation(&self, count: usize, mut statistic: impl FnMut(&[usize]) -> Option<f64>) -> Option<f64> {
        let mut stream = Stream::new(self.seed);
        let mut places = vec![0; count];
        let resamples = if count == 0 { 0 } else { self.resamples };
        let values = (0..resamples).map(|_| {
            places.iter_mut().for_each(|place| *place = stream.below(count));
            statistic(&places)
        });
        // Leaving out an undefined one would bias the interval.
        deviation(&values.collect::<Option<Vec<f64>>>()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_r() {
        // quantile(c(3, 1, 4, 1, 5, 9, 2, 6), c(0, .1, .25, .5, .9, 1)) of R.
        let samples = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let found = quantiles(&samples, &[0.0, 0.1, 0.25, 0.5, 0.9, 1.0]).unwrap();
        for (found, expected) in found.iter().zip([1.0, 1.0, 1.75, 3.5, 6.9, 9.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(quantiles(&[], &[0.5]), None);
        assert_eq!(quantiles(&[2.0], &[0.3]), Some(vec![2.0]));
        // The k-th of four samples is that of k/5, and no sample lies beyond the outer ones.
        let found = predictive_quantiles(&[4.0, 1.0, 3.0, 2.0], &[0.0, 0.2, 0.5, 0.7, 0.8, 1.0]).unwrap();
        let mut pairs = found.iter().zip([1.0, 1.0, 2.5, 3.5, 4.0, 4.0]);
        assert!(pairs.all(|(own, expected)| (own - expected).abs() < 1e-12), "{found:?}");
        assert_eq!(predictive_quantiles(&[], &[0.5]), None);
    }

    #[test]
    fn mean_and_deviation() {
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(deviation(&[1.0, 2.0, 6.0]), Some(7.0_f64.sqrt()));
        assert_eq!((mean(&[]), deviation(&[1.0])), (None, None));
    }

    #[test]
    fn wilsons_interval_is_the_published_one() {
        // Newcombe 1998, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29, at 95 %.
        for (count, trials, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
        {
            let interval = wilson(count, trials, 0.95);
            assert!((interval.low - low).abs() < 5e-5 && (interval.high - high).abs() < 5e-5, "{interval:?}");
            let mirrored = wilson(trials - count, trials, 0.95);
            assert!((mirrored.low + interval.high - 1.0).abs() < 1e-15);
        }
        assert_eq!(wilson(20, 20, 0.95).high, 1.0);
        assert_eq!(wilson(0, 0, 0.95), Interval { low: 0.0, high: 1.0 });
    }

    fn binomial(k: u64, n: u64, p: f64) -> f64 {
        let factorial = |k: u64| libm::lgamma(k as f64 + 1.0);
        let log_choose = factorial(n) - factorial(k) - factorial(n - k);
        (log_choose + k as f64 * p.ln() + (n - k) as f64 * (1.0 - p).ln()).exp()
    }

    /// Exact coverage, by the sum over all counts, averaged over probabilities and at its least.
    #[test]
    fn wilsons_interval_covers_on_average_what_it_says() {
        for trials in [20_u64, 100, 1000] {
            let intervals: Vec<Interval> = (0..=trials).map(|count| wilson(count, trials, 0.95)).collect();
            let coverage = |p: f64| -> f64 {
                let covered = (0..=trials).filter(|&count| intervals[count as usize].contains(p));
                covered.map(|k| binomial(k, trials, p)).sum()
            };
            let all: Vec<f64> = (0..400).map(|step| coverage((f64::from(step) + 0.5) / 400.0)).collect();
            let missed_above = |p: f64| -> f64 {
                (0..=trials).filter(|&count| intervals[count as usize].high < p).map(|k| binomial(k, trials, p)).sum()
            };
            let missed = (1..400).map(|step| missed_above(f64::from(step) / 4000.0)).fold(0.0, f64::max);
            assert!(missed < 0.027, "{missed}");
            let (average, least) = (mean(&all).unwrap(), all.iter().copied().fold(1.0, f64::min));
            print!("{trials} trials: coverage {average:.4} on average, {least:.3} at least;");
            println!(" up to 0.1 the upper end is exceeded in {missed:.4} at most");
            assert!((average - 0.95).abs() < 0.005 && least > 0.83, "{average} {least}");
        }
    }

    /// The mean of three samples, one of them 1 and the others 0: its variance over all resamples is 2/27.
    #[test]
    fn a_resample_takes_every_sample_equally_often() {
        for one in 0..3 {
            let bootstrap = Bootstrap { resamples: 20_000, ..Bootstrap::default() };
            let mean = |places: &[usize]| Some(places.iter().filter(|place| **place == one).count() as f64 / 3.0);
            let deviation = bootstrap.deviation(3, mean);
            assert!((deviation.unwrap() / (2.0_f64 / 27.0).sqrt() - 1.0).abs() < 0.02, "{one}: {deviation:?}");
        }
    }

    #[test]
    fn an_undefined_statistic_has_no_deviation() {
        let bootstrap = Bootstrap::default();
        assert_eq!(bootstrap.deviation(3, |_| Some(1.0)), Some(0.0));
        assert_eq!(bootstrap.deviation(3, |places| (places[0] > 0).then_some(1.0)), None);
        assert_eq!(bootstrap.deviation(0, |_| Some(1.0)), None);
    }
}
