//! Main effects: which share of the variance of an output an input has alone, from any sample.

use thiserror::Error;

use crate::statistics::{Bootstrap, Estimate, Interval, present};

/// Why there are no main effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum MainEffectsError {
    /// There is not one output a point.
    #[error("{points} points have {outputs} outputs")]
    Outputs {
        /// Number of points.
        points: usize,
        /// Number of outputs.
        outputs: usize,
    },
    /// Too few outputs for two bins.
    #[error("{samples} samples are too few: at least {} are needed", LEAST_SAMPLES)]
    TooFewSamples {
        /// Number of finite outputs.
        samples: usize,
    },
    /// The output does not vary.
    #[error("the output is the same everywhere: it has no variance to share")]
    Constant,
}

const LEAST_SAMPLES: usize = 8;
/// More bins than this resolve nothing that an index would show.
const MOST_BINS: usize = 50;

/// First-order index of every coordinate from a given sample: of the variance, the share that the mean in bins of the
/// coordinate has (correlation ratio; Pearson 1905, as estimator of the index by Plischke, Borgonovo, Smith 2013).
///
/// The √n bins, at most 50, hold equally many points. What chance alone spreads their means by is subtracted (ε² of
/// Kelley 1935), so that a coordinate without effect is zero on average and may be a little negative; from points that
/// are spread more evenly than by chance, as those of a Sobol' sequence, indices are low by up to the number of bins
/// over that of points. Intervals are the normal ones of the bootstrap's deviation. Points whose output is missing are
/// left out. Coordinates may be correlated; then the indices of those that vary together share.
///
/// # Errors
/// There are fewer than eight outputs, or they do not vary.
pub fn main_effects(
    points: &[Vec<f64>],
    outputs: &[Option<f64>],
    bootstrap: &Bootstrap,
) -> Result<Vec<Estimate>, MainEffectsError> {
    if points.len() != outputs.len() {
        return Err(MainEffectsError::Outputs { points: points.len(), outputs: outputs.len() });
    }
    let (points, outputs): (Vec<&Vec<f64>>, Vec<f64>) =
        points.iter().zip(outputs).filter_map(|(point, output)| Some((point, present(*output)?))).unzip();
    let samples = outputs.len();
    if samples < LEAST_SAMPLES {
        return Err(MainEffectsError::TooFewSamples { samples });
    }
    // √n: as many bins as points in each, which balances the error of bin means and that of their coarseness.
    let bins = (samples as f64).sqrt().floor().min(MOST_BINS as f64) as usize;
    let of_factor = |factor: usize| {
        let mut order: Vec<usize> = (0..samples).collect();
        order.sort_by(|&a, &b| points[a][factor].total_cmp(&points[b][factor]));
        let mut bin = vec![0; samples];
        // By rank: bins hold equally many points whatever the distribution of the input.
        order.iter().enumerate().for_each(|(rank, &index)| bin[index] = rank * bins / samples);
        let ratio = |indices: &[usize]| correlation_ratio(indices, &bin, &outputs, bins);
        let value = ratio(&(0..samples).collect::<Vec<_>>()).ok_or(MainEffectsError::Constant)?;
        let [deviation] = bootstrap.deviations(samples, |indices| [ratio(indices)]);
        let interval = deviation.map(|deviation| Interval::normal(value, deviation, bootstrap.confidence));
        Ok(Estimate { value, interval })
    };
    (0..points[0].len()).map(of_factor).collect()
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
    // Unbiased within bins as without: what chance alone spreads the means by drops out (theory.md, equation 314).
    let within = (total - between) / (n - filled) as f64;
    (total > 0.0).then(|| 1.0 - within / (total / (n - 1) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Levels, Method, points};
    use crate::functions::{ishigami, ishigami_indices};

    #[test]
    fn a_given_sample_has_the_first_order_indices() {
        let (first, _, _) = ishigami_indices();
        for (method, samples, allowed) in [(Method::Sobol, 4096, 0.02), (Method::Random, 500, 0.12)] {
            let points = points(method, &[Levels::Continuous; 4], samples, 3).unwrap();
            let outputs: Vec<Option<f64>> = points.iter().map(|u| Some(ishigami(&u[..3]))).collect();
            let found = main_effects(&points, &outputs, &Bootstrap { resamples: 200, ..Bootstrap::default() }).unwrap();
            for (factor, (found, exact)) in found.iter().zip(first.iter().chain(&[0.0])).enumerate() {
                let interval = found.interval.unwrap();
                println!(
                    "{samples} samples, x{}: S {:.4} ({exact:.4}; 95 % {:.3} … {:.3})",
                    factor + 1,
                    found.value,
                    interval.low,
                    interval.high
                );
                assert!((found.value - exact).abs() < allowed, "x{}: {found:?}", factor + 1);
            }
        }
    }

    #[test]
    fn intervals_cover_about_as_often_as_they_say() {
        let (first, _, _) = ishigami_indices();
        let (mut covered, mut all) = (0, 0);
        for seed in 0..60 {
            let points = points(Method::Random, &[Levels::Continuous; 3], 400, seed).unwrap();
            let outputs: Vec<Option<f64>> = points.iter().map(|u| Some(ishigami(u))).collect();
            let bootstrap = Bootstrap { resamples: 200, seed, ..Bootstrap::default() };
            for (found, exact) in main_effects(&points, &outputs, &bootstrap).unwrap().iter().zip(first) {
                covered += u32::from(found.interval.unwrap().contains(exact));
                all += 1;
            }
        }
        println!("95 % intervals from 400 samples covered {covered} of {all} first-order indices");
        assert!((0.90..=1.0).contains(&(f64::from(covered) / f64::from(all))), "{covered} of {all}");
    }

    /// Ten bins of ten points: without what is subtracted for chance, the mean of the estimates would be 0.09.
    #[test]
    fn a_coordinate_without_effect_is_zero_on_average() {
        let bootstrap = Bootstrap { resamples: 2, ..Bootstrap::default() };
        let studies = 400;
        let sum: f64 = (0..studies)
            .map(|seed| {
                let points = points(Method::Random, &[Levels::Continuous; 4], 100, seed).unwrap();
                let outputs: Vec<Option<f64>> = points.iter().map(|u| Some(ishigami(&u[..3]))).collect();
                main_effects(&points, &outputs, &bootstrap).unwrap()[3].value
            })
            .sum();
        println!("mean index of a coordinate without effect: {:.4}", sum / studies as f64);
        assert!((sum / studies as f64).abs() < 0.01);
    }

    #[test]
    fn what_tells_nothing_is_refused() {
        let points = vec![vec![0.5]; 9];
        let bootstrap = Bootstrap::default();
        assert_eq!(main_effects(&points, &[Some(1.0); 9], &bootstrap), Err(MainEffectsError::Constant));
        let few = main_effects(&points, &[Some(1.0), Some(2.0), None, None, None, None, None, None, None], &bootstrap);
        assert_eq!(few, Err(MainEffectsError::TooFewSamples { samples: 2 }));
        assert_eq!(main_effects(&points, &[], &bootstrap), Err(MainEffectsError::Outputs { points: 9, outputs: 0 }));
    }
}
