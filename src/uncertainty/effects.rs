//! Main effects: which share of the variance of an output an input has alone, from any sample.

use std::collections::BTreeMap;

use crate::random::Stream;
use crate::statistics::{Bootstrap, Estimate, Interval, check_counts, mean, normal_factor, present};
use crate::surrogate::{Family, Surrogate};
use crate::{Error, ensure};

/// First-order indices of all coordinates, none below zero or above one.
#[derive(Clone, Debug, PartialEq)]
pub struct MainEffects {
    /// Of each coordinate.
    pub shares: Vec<Estimate>,
    /// Interval of their sum, of independent coordinates: what it lacks of one, coordinates have only together.
    pub sum: Option<Interval>,
}

const LEAST_SAMPLES: usize = 8;
/// Samples of a polynomial chaos: more tell little more of shares, and take long.
const MOST_SAMPLES: usize = 512;
/// Coordinates of which polynomials of high degree are too many.
const MANY: usize = 6;
/// More bins than this resolve nothing that an index would show.
const MOST_BINS: usize = 50;

/// Main effects from points of a given design, whose coordinates are `independent` or may vary together.
///
/// Where the points are all combinations of some values of each coordinate, equally often, the shares are those of the variance over
/// these points, exactly. Of other points with independent coordinates they are those of a polynomial chaos of the ranks, times
/// the share of the variance that it predicts in cross-validation; to the upper ends of the intervals is added what it
/// does not predict, which may be due to any coordinate (docs/methods.md, equation 314). Coordinates that vary together share
/// what the means in √n bins have (Plischke, Borgonovo, Smith 2013), less what chance spreads these by (Kelley 1935), with the
/// intervals of the bootstrap's deviation. Points whose output is missing are left out.
///
/// # Errors
/// There are too few outputs, or they do not vary.
pub fn main_effects(
    points: &[Vec<f64>],
    outputs: &[Option<f64>],
    independent: bool,
    bootstrap: &Bootstrap,
) -> Result<MainEffects, Error> {
    check_counts(points, outputs)?;
    let (points, outputs): (Vec<&Vec<f64>>, Vec<f64>) =
        points.iter().zip(outputs).filter_map(|(point, output)| Some((point, present(*output)?))).unzip();
    let samples = outputs.len();
    let varies = outputs.iter().any(|output| *output != outputs[0]);
    if is_factorial(&points) && varies {
        return Ok(of_factorial(&points, &outputs));
    }
    ensure(samples >= LEAST_SAMPLES, || format!("{samples} samples are too few: at least {LEAST_SAMPLES} are needed"))?;
    ensure(varies, || "the output is the same everywhere: it has no variance to share")?;
    if independent { of_chaos(&points, &outputs, bootstrap.confidence) } else { of_bins(&points, &outputs, bootstrap) }
}

/// Whether points are all combinations of the values of their coordinates, equally often.
fn is_factorial(points: &[&Vec<f64>]) -> bool {
    let mut counts: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
    points.iter().for_each(|point| *counts.entry(point.iter().map(|x| x.to_bits()).collect()).or_default() += 1);
    let Some((first, times)) = counts.first_key_value() else { return false };
    let values = |factor: usize| {
        let mut all: Vec<u64> = counts.keys().map(|point| point[factor]).collect();
        all.sort_unstable();
        all.dedup();
        all.len()
    };
    let all: usize = (0..first.len()).map(values).product();
    all == counts.len() && counts.values().all(|count| count == times)
}

/// The shares of the variance over all combinations.
fn of_factorial(points: &[&Vec<f64>], outputs: &[f64]) -> MainEffects {
    let centre = mean(outputs).unwrap_or(0.0);
    let whole: f64 = outputs.iter().map(|output| (output - centre).powi(2)).sum();
    let share = |factor: usize| {
        let mut levels: BTreeMap<u64, (f64, f64)> = BTreeMap::new();
        for (point, output) in points.iter().zip(outputs) {
            let (sum, count) = levels.entry(point[factor].to_bits()).or_default();
            (*sum, *count) = (*sum + output - centre, *count + 1.0);
        }
        levels.values().map(|(sum, count)| sum * sum / count).sum::<f64>() / whole
    };
    let exact = |value: f64| Interval { low: value, high: value };
    let values: Vec<f64> = (0..points[0].len()).map(|factor| share(factor).clamp(0.0, 1.0)).collect();
    let sum = Some(exact(values.iter().sum::<f64>().min(1.0)));
    MainEffects {
        shares: values.iter().map(|own| Estimate { value: *own, interval: Some(exact(*own)) }).collect(),
        sum,
    }
}

/// By a polynomial chaos of the ranks.
fn of_chaos(points: &[&Vec<f64>], outputs: &[f64], confidence: f64) -> Result<MainEffects, Error> {
    // In a random order, so that the first ones are spread as all are.
    let order: Vec<usize> = Stream::new(0).permutation(outputs.len()).into_iter().take(MOST_SAMPLES).collect();
    let points: Vec<&Vec<f64>> = order.iter().map(|place| points[*place]).collect();
    let outputs: Vec<Option<f64>> = order.iter().map(|place| Some(outputs[*place])).collect();
    let samples = outputs.len();
    let ranks: Vec<Vec<f64>> = (0..points[0].len()).map(|factor| ranks(&points, factor)).collect();
    let ranked: Vec<Vec<f64>> = (0..samples).map(|point| ranks.iter().map(|own| own[point]).collect()).collect();
    let highest_degree = if ranks.len() > MANY { 4 } else { 8 };
    let chaos = Surrogate::fit(&vec![Family::Legendre; ranks.len()], &ranked, &outputs, highest_degree);
    let chaos = chaos?;
    let predicted = chaos.q2().clamp(0.0, 1.0);
    let first = chaos.first().unwrap_or_else(|| vec![0.0; ranks.len()]);
    let estimate = |of_chaos: f64| {
        let (value, left) = ((predicted * of_chaos).abs(), 1.0 - predicted);
        let half = 2.0 * normal_factor(confidence) * (value * left / samples as f64).sqrt();
        let interval = Interval { low: (value - half).max(0.0), high: (value + half + left).min(1.0) };
        Estimate { value, interval: Some(interval) }
    };
    let sum = estimate(first.iter().sum()).interval;
    Ok(MainEffects { shares: first.into_iter().map(estimate).collect(), sum })
}

/// Places of all points along a coordinate, within 0 and 1; equal values have one place.
fn ranks(points: &[&Vec<f64>], factor: usize) -> Vec<f64> {
    let mut order: Vec<f64> = points.iter().map(|point| point[factor]).collect();
    order.sort_by(f64::total_cmp);
    let place = |point: &&Vec<f64>| {
        let [below, up_to] =
            [order.partition_point(|own| *own < point[factor]), order.partition_point(|own| *own <= point[factor])];
        0.5 * (below + up_to) as f64 / order.len() as f64
    };
    points.iter().map(place).collect()
}

/// By the means in bins of a coordinate.
fn of_bins(points: &[&Vec<f64>], outputs: &[f64], bootstrap: &Bootstrap) -> Result<MainEffects, Error> {
    let samples = outputs.len();
    // √n: as many bins as points in each, which balances the error of bin means and that of their coarseness.
    let bins = (samples as f64).sqrt().floor().min(MOST_BINS as f64) as usize;
    let of_factor = |factor: usize| {
        let mut order: Vec<usize> = (0..samples).collect();
        order.sort_by(|&a, &b| points[a][factor].total_cmp(&points[b][factor]));
        let mut bin = vec![0; samples];
        // By rank: bins hold equally many points whatever the distribution of the input.
        order.iter().enumerate().for_each(|(rank, &index)| bin[index] = rank * bins / samples);
        let ratio = |indices: &[usize]| correlation_ratio(indices, &bin, outputs, bins);
        let value = ratio(&(0..samples).collect::<Vec<_>>())
            .ok_or_else(|| Error::new("the output is the same everywhere: it has no variance to share"))?;
        let interval = bootstrap.deviation(samples, ratio).map(|deviation| {
            let Interval { low, high } = Interval::normal(value, deviation, bootstrap.confidence);
            Interval { low: low.clamp(0.0, 1.0), high: high.clamp(0.0, 1.0) }
        });
        Ok(Estimate { value: value.clamp(0.0, 1.0), interval })
    };
    let shares = (0..points[0].len()).map(of_factor).collect::<Result<_, _>>()?;
    Ok(MainEffects { shares, sum: None })
}

/// One minus the mean square within bins over that of all.
fn correlation_ratio(indices: &[usize], bin: &[usize], outputs: &[f64], bins: usize) -> Option<f64> {
    let n = indices.len();
    let mean = indices.iter().map(|&index| outputs[index]).sum::<f64>() / n as f64;
    let (mut counts, mut sums) = (vec![0_usize; bins], vec![0.0; bins]);
    let mut total = 0.0;
    for &index in indices {
        let from_mean = outputs[index] - mean;
        counts[bin[index]] += 1;
        sums[bin[index]] += from_mean;
        total += from_mean * from_mean;
    }
    // A resample may leave bins empty; they take no degree of freedom.
    let filled = counts.iter().filter(|&&count| count > 0).count();
    let between: f64 = counts.iter().zip(&sums).filter(|(count, _)| **count > 0).map(|(&c, s)| s * s / c as f64).sum();
    // Unbiased within bins as without: what chance alone spreads the means by drops out (methods.md, equation 314b).
    let within = (total - between) / (n - filled) as f64;
    (total > 0.0).then(|| 1.0 - within / (total / (n - 1) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Levels, Method, points};
    use crate::functions::{ishigami, ishigami_indices};

    fn studied(method: Method, samples: usize, seed: u64, independent: bool) -> MainEffects {
        let points = points(method, &[Levels::Continuous; 4], samples, seed).unwrap();
        let outputs: Vec<Option<f64>> = points.iter().map(|u| Some(ishigami(&u[..3]))).collect();
        main_effects(&points, &outputs, independent, &Bootstrap { resamples: 200, ..Bootstrap::default() }).unwrap()
    }

    /// Ishigami's function and a fourth coordinate without effect, by three designs: intervals hold the closed indices and what
    /// coordinates have only together; none leaves 0 to 1.
    #[test]
    fn intervals_hold_the_indices_whatever_the_design() {
        let (first, _, _) = ishigami_indices();
        let exact: Vec<f64> = first.into_iter().chain([0.0]).collect();
        let (mut held, mut all) = (0, 0);
        for method in [Method::Sobol, Method::LatinHypercube, Method::Random] {
            for samples in [40, 64, 256] {
                for seed in 0..3 {
                    let found = studied(method, samples, seed, true);
                    let sum = found.sum.unwrap();
                    assert!(found.shares.iter().all(|own| {
                        let Interval { low, high } = own.interval.unwrap();
                        0.0 <= low && low <= own.value && own.value <= high && high <= 1.0
                    }));
                    let pairs = || found.shares.iter().zip(&exact);
                    held += pairs().filter(|(own, exact)| own.interval.unwrap().contains(**exact)).count();
                    held += usize::from(sum.contains(exact.iter().sum()));
                    all += 5;
                    let is_near = pairs().all(|(own, exact)| (own.value - exact).abs() < 0.05) && sum.high < 1.0;
                    assert!(samples < 256 || is_near, "{found:?}");
                }
            }
        }
        println!("intervals of 95 % held {held} of {all}");
        assert!(held as f64 > 0.95 * all as f64, "{held} of {all}");
    }

    /// A sum of inputs is explained by them alone: none act together.
    #[test]
    fn what_adds_up_does_not_act_together() {
        let points = points(Method::Sobol, &[Levels::Continuous; 5], 40, 2).unwrap();
        let outputs: Vec<Option<f64>> =
            points.iter().map(|u| Some(4.0 * u[0] + 2.0 * u[1] + u[2] + 0.3 * (40.0 * u[3]).sin())).collect();
        let found = main_effects(&points, &outputs, true, &Bootstrap::default()).unwrap();
        // 16 : 4 : 1 over twelve, and half of 0.09.
        let exact = [16.0, 4.0, 1.0].map(|own| own / (21.0 + 12.0 * 0.045));
        for (own, exact) in found.shares.iter().zip(exact) {
            assert!(own.interval.unwrap().contains(exact) && (own.value - exact).abs() < 0.06, "{own:?} for {exact}");
        }
        assert!(found.shares[0].interval.unwrap().low > 0.5 && found.sum.unwrap().high == 1.0, "{found:?}");
    }

    /// All combinations of five values each: the shares are those of the variances of the parts.
    #[test]
    fn a_full_factorial_has_the_shares_of_its_parts() {
        let levels = [-2.0, -1.0, 0.0, 1.0, 2.0];
        let points: Vec<Vec<f64>> = levels.iter().flat_map(|a| levels.iter().map(|b| vec![*a, *b])).collect();
        let outputs: Vec<Option<f64>> =
            points.iter().map(|p| Some(3.0 + p[0] + (p[1] * p[1] - 2.0) + 0.5 * p[0] * p[1])).collect();
        // Variances over the levels: 2, (4 + 1 + 4 + 1 + 4)/5 = 2.8, and 0.25·2·2 of the product.
        let found = main_effects(&points, &outputs, true, &Bootstrap::default()).unwrap();
        let values: Vec<f64> = found.shares.iter().map(|own| own.value).collect();
        assert!((values[0] - 2.0 / 5.8).abs() < 1e-12 && (values[1] - 2.8 / 5.8).abs() < 1e-12, "{values:?}");
        assert!((found.sum.unwrap().high - 4.8 / 5.8).abs() < 1e-12);
    }

    #[test]
    fn coordinates_that_may_vary_together_share_what_bins_have() {
        let (first, _, _) = ishigami_indices();
        for (method, samples, allowed) in [(Method::Sobol, 4096, 0.02), (Method::Random, 500, 0.12)] {
            let found = studied(method, samples, 3, false);
            for (factor, (found, exact)) in found.shares.iter().zip(first.iter().chain(&[0.0])).enumerate() {
                assert!((found.value - exact).abs() < allowed, "x{}: {found:?}", factor + 1);
            }
            assert!(found.sum.is_none());
        }
    }

    #[test]
    fn what_tells_nothing_is_refused() {
        let points: Vec<Vec<f64>> =
            (0..9).map(|place| [0.09, 0.05].map(|step| 0.1 + step * f64::from(place)).to_vec()).collect();
        let found = |outputs: &[Option<f64>]| main_effects(&points, outputs, true, &Bootstrap::default());
        let same = Error::new("the output is the same everywhere: it has no variance to share");
        assert_eq!(found(&[Some(1.0); 9]), Err(same));
        let few = found(&[Some(1.0), Some(2.0), None, None, None, None, None, None, Some(2.0)]);
        assert_eq!(few, Err(Error::new(format!("3 samples are too few: at least {LEAST_SAMPLES} are needed"))));
        assert_eq!(found(&[]), Err(Error::new("9 points have 0 outputs")));
    }
}
