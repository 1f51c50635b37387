//! What a measured signal may differ by from the simulated one of a true parameter: noise of the sensor, roughness of the
//! simulation, and an error of the model that is correlated along the signal (docs/theory.md, section 28).
//!
//! Signals are compared by their means over bins, so that noise that is faster than a bin counts once. In the
//! eigenvectors of the correlation of the model's error, noise and error are independent whatever the size of the error.

use lab::signal::Series;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use thiserror::Error;

/// Most bins of a signal.
const MOST_BINS: usize = 120;
/// Fewest bins of a signal.
const FEWEST_BINS: usize = 8;
/// Memory of the channel filter, times its class: the backward pass forgets as exp(−9.26 class t), so that the noise of
/// bins of twice that time is independent.
const FILTER_MEMORY: f64 = 2.0 / 9.26;
/// Samples of the shortest bins, of which neighbours share one.
const SAMPLES: usize = 4;
/// Least noise, as a share of the root mean square of the signal: what steps of the engine and of a table leave.
const LEAST_NOISE: f64 = 1e-4;
/// Variance of the third difference of independent values of unit variance: 1 + 9 + 9 + 1.
const OF_THIRD_DIFFERENCE: f64 = 20.0;

/// The noise of a measured signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Noise {
    /// As the third differences of means over the shortest bins show it whose noise is independent: an error of the model that
    /// is correlated over many of them, and the signal itself, hardly add to that.
    FromRecording,
    /// This standard deviation of the mean of a bin, as a share of the root mean square of the signal.
    Share(f64),
}

/// The distance over which the model's error is correlated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Correlation {
    /// Along the abscissa.
    Length(f64),
    /// As a share of the window.
    Share(f64),
}

/// Correlation of the model's error where none is given (assumed).
pub(super) const USUAL_CORRELATION: Correlation = Correlation::Share(0.03);

/// Why a signal cannot be compared.
#[derive(Clone, Debug, PartialEq, Error)]
pub(super) enum SignalError {
    /// The recording has too few samples in the window.
    #[error("the recording has {found} samples from {from} to {to}; at least {FEWEST_BINS} are needed")]
    TooFew { found: usize, from: f64, to: f64 },
    /// A signal has a gap.
    #[error("the {of} has no value between {from} and {to}")]
    Gap { of: &'static str, from: f64, to: f64 },
    /// The recording is zero throughout.
    #[error("the recording is zero from {from} to {to}")]
    Zero { from: f64, to: f64 },
}

/// A measured signal in bins, and its errors.
#[derive(Clone, Debug)]
pub(super) struct ErrorModel {
    edges: Vec<f64>,
    /// Means over the bins.
    measured: DVector<f64>,
    /// Root mean square of the measured means.
    level: f64,
    /// Standard deviation of the noise of a measured mean.
    recorded: f64,
    /// Standard deviation of the roughness of a simulated mean.
    simulated: f64,
    /// Eigenvectors of the model's correlation as rows.
    basis: DMatrix<f64>,
    /// Its eigenvalues.
    eigenvalues: Vec<f64>,
}

impl ErrorModel {
    /// Of the samples of `measured` in `window`; `class` is that of the channel filter behind it.
    pub(super) fn new(
        measured: &Series,
        window: [f64; 2],
        noise: Noise,
        correlation: Correlation,
        class: Option<f64>,
    ) -> Result<ErrorModel, SignalError> {
        let inside = measured.window(window);
        let (Some(from), Some(to)) = (inside.time().first().copied(), inside.time().last().copied()) else {
            return Err(SignalError::TooFew { found: 0, from: window[0], to: window[1] });
        };
        let independent = class.map_or(usize::MAX, |class| ((to - from) * class / FILTER_MEMORY) as usize);
        let bins = (inside.len() - 1).min(independent.max(FEWEST_BINS)).min(MOST_BINS);
        // The shortest bins whose noise is independent: neighbours share the sample between them.
        let fine = ((inside.len() - 1) / SAMPLES).min(independent).max(bins);
        if bins < FEWEST_BINS {
            return Err(SignalError::TooFew { found: inside.len(), from, to });
        }
        let edges = |bins: usize| (0..=bins).map(|edge| from + (to - from) * edge as f64 / bins as f64).collect();
        let (fine_edges, edges): (Vec<f64>, Vec<f64>) = (edges(fine), edges(bins));
        let means_of = |edges: &[f64]| means(&inside, edges, "recording");
        let means = means_of(&edges)?;
        let level = (means.iter().map(|mean| mean * mean).sum::<f64>() / bins as f64).sqrt();
        if level <= 0.0 {
            return Err(SignalError::Zero { from, to });
        }
        let noise = match noise {
            Noise::FromRecording => {
                let intervals = (inside.len() - 1) as f64 / fine as f64;
                independent_noise(third_difference(&means_of(&fine_edges)?), intervals)
                    * (bins as f64 / fine as f64).sqrt()
            }
            Noise::Share(share) => share * level,
        };
        let recorded = noise.max(LEAST_NOISE * level);
        let length = match correlation {
            Correlation::Length(length) => length,
            Correlation::Share(share) => share * (to - from),
        };
        let step = (to - from) / bins as f64;
        let rho = |row: usize, column: usize| (-(row.abs_diff(column) as f64) * step / length).exp();
        let eigen = SymmetricEigen::new(DMatrix::from_fn(bins, bins, rho));
        Ok(ErrorModel {
            edges,
            measured: DVector::from_vec(means),
            level,
            recorded,
            simulated: 0.0,
            basis: eigen.eigenvectors.transpose(),
            eigenvalues: eigen.eigenvalues.iter().map(|value| value.max(0.0)).collect(),
        })
    }

    /// Takes the roughness of a simulated signal, which contact makes, as noise beside that of the recording.
    pub(super) fn add_roughness(&mut self, simulated: &Series) -> Result<(), SignalError> {
        self.simulated = third_difference(&self.means(simulated)?);
        Ok(())
    }

    /// Number of bins.
    pub(super) fn bins(&self) -> usize {
        self.eigenvalues.len()
    }

    /// Standard deviation of the noise of the difference of two means, in the unit of the signal.
    pub(super) fn noise(&self) -> f64 {
        self.recorded.hypot(self.simulated)
    }

    /// The middles of the bins, and the measured means there.
    pub(super) fn middles(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.edges.windows(2).zip(self.measured.iter()).map(|(edges, mean)| [0.5 * (edges[0] + edges[1]), *mean])
    }

    /// Means of a simulated signal over the bins.
    pub(super) fn means(&self, simulated: &Series) -> Result<Vec<f64>, SignalError> {
        means(simulated, &self.edges, "simulated signal")
    }

    /// Difference of the means of a simulated signal from the measured ones in the eigenvectors, over the noise.
    pub(super) fn rotated(&self, simulated: &Series) -> Result<Vec<f64>, SignalError> {
        let difference = DVector::from_vec(self.means(simulated)?) - &self.measured;
        Ok((&self.basis * difference / self.noise()).as_slice().to_vec())
    }

    /// ‖simulated − measured‖/‖measured‖ over the bins.
    pub(super) fn relative_error(&self, simulated: &Series) -> Result<f64, SignalError> {
        let difference = DVector::from_vec(self.means(simulated)?) - &self.measured;
        Ok(difference.norm() / self.measured.norm())
    }

    /// Variances of the coordinates that [`Self::rotated`] gives, with a model's error of `share` of the root mean
    /// square of the signal.
    pub(super) fn variances(&self, share: f64) -> impl Iterator<Item = f64> + '_ {
        let size = (share * self.level / self.noise()).powi(2);
        self.eigenvalues.iter().map(move |eigenvalue| 1.0 + size * eigenvalue)
    }

    /// Variance of every coordinate for a model's error of `share` that is not correlated.
    pub(super) fn plain_variance(&self, share: f64) -> f64 {
        1.0 + (share * self.level / self.noise()).powi(2)
    }

    /// Independent residuals of unit variance, for a model's error of `share`.
    pub(super) fn whitened(&self, rotated: &[f64], share: f64) -> Vec<f64> {
        rotated.iter().zip(self.variances(share)).map(|(value, variance)| value / variance.sqrt()).collect()
    }

    /// Logarithm of the likelihood of `rotated`, up to what does not depend on `share`.
    pub(super) fn log_likelihood(&self, rotated: &[f64], share: f64) -> f64 {
        let of_one = |(value, variance): (&f64, f64)| -0.5 * (value * value / variance + variance.ln());
        rotated.iter().zip(self.variances(share)).map(of_one).sum()
    }
}

/// The share of the model's error for which the rotated differences of signals, each with its weight, are most likely; zero where
/// noise explains them.
pub(super) fn most_likely_share(signals: &[(&ErrorModel, f64, Vec<f64>)]) -> f64 {
    /// Shares that are considered.
    const RANGE: [f64; 2] = [1e-4, 1.0];
    /// Shares that are tried, evenly in the logarithm: 4 % apart.
    const TRIED: usize = 240;
    let of_one = |(model, weight, own): &(&ErrorModel, f64, Vec<f64>), share| weight * model.log_likelihood(own, share);
    let likelihood = |share: f64| signals.iter().map(|signal| of_one(signal, share)).sum::<f64>();
    let tried = (0..=TRIED).map(|place| RANGE[0] * (RANGE[1] / RANGE[0]).powf(place as f64 / TRIED as f64));
    let tried = std::iter::once(0.0).chain(tried).map(|share| (share, likelihood(share)));
    tried.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(share, _)| share)
}

/// Means of a series between neighbouring edges, linear between samples.
fn means(series: &Series, edges: &[f64], of: &'static str) -> Result<Vec<f64>, SignalError> {
    let (time, values) = (series.time(), series.values());
    let gap = |from: f64, to: f64| SignalError::Gap { of, from, to };
    let mean = |bin: &[f64]| {
        let [from, to] = [bin[0], bin[1]];
        // Where rounding puts the last edge behind the last sample, that sample counts.
        let at = |place: f64| {
            let inside = place.clamp(*time.first()?, *time.last()?);
            ((inside - place).abs() <= 1e-9 * (to - from)).then(|| series.value_at(inside))?
        };
        let ends = at(from).zip(at(to)).ok_or_else(|| gap(from, to))?;
        let start = time.partition_point(|t| *t <= from);
        let end = time.partition_point(|t| *t < to).max(start);
        let (mut sum, mut before) = (0.0, (from, ends.0));
        for next in time[start..end].iter().copied().zip(values[start..end].iter().copied()).chain([(to, ends.1)]) {
            sum += 0.5 * (before.1 + next.1) * (next.0 - before.0);
            before = next;
        }
        let mean = sum / (to - from);
        if mean.is_finite() { Ok(mean) } else { Err(gap(from, to)) }
    };
    edges.windows(2).map(mean).collect()
}

/// The noise of means over bins of so many intervals between samples, by their third differences (docs/theory.md, equation 331b).
///
/// Neighbouring bins share a sample, so that their means are correlated: third differences show less than their noise, and its
/// sum over many bins is larger than that of independent ones. This is the noise that bins which count as independent have.
fn independent_noise(third_difference: f64, intervals: f64) -> f64 {
    third_difference * (intervals / (intervals - 0.875)).sqrt()
}

/// Root mean square of the third differences, over that of independent values of unit variance.
fn third_difference(means: &[f64]) -> f64 {
    let differences = means.windows(4).map(|m| m[3] - 3.0 * m[2] + 3.0 * m[1] - m[0]);
    let (sum, count) = differences.fold((0.0, 0_usize), |(sum, count), d| (sum + d * d, count + 1));
    (sum / count as f64 / OF_THIRD_DIFFERENCE).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use uncertainty::random::Stream;

    /// A half wave of 140 m/s² over 0.1 s at 10 kHz, with noise.
    fn half_wave(noise: f64, seed: u64) -> Series {
        let mut stream = Stream::new(seed);
        let time: Vec<f64> = (0..=1000).map(|sample| 1e-4 * f64::from(sample)).collect();
        let value = |t: &f64| 140.0 * (std::f64::consts::PI * t / 0.1).sin() + noise * stream.normal();
        let values: Vec<f64> = time.iter().map(value).collect();
        Series::new(time, values)
    }

    fn model(series: &Series, correlation: Correlation) -> ErrorModel {
        ErrorModel::new(series, [0.0, 0.1], Noise::FromRecording, correlation, None).unwrap()
    }

    /// White noise on any number of samples: the mean of all bins has the deviation that independent bins would have.
    #[test]
    fn the_noise_of_few_samples_is_that_of_their_mean() {
        const RECORDINGS: u64 = 300;
        for samples in [33, 41, 121, 146, 241, 481, 1001] {
            let time: Vec<f64> = (0..samples).map(f64::from).collect();
            let (mut expected, mut found) = (0.0, 0.0);
            for seed in 0..RECORDINGS {
                let mut stream = Stream::new(seed);
                let values: Vec<f64> = time.iter().map(|_| 50.0 + stream.normal()).collect();
                let window = [0.0, f64::from(samples - 1)];
                let series = Series::new(time.clone(), values);
                let model =
                    ErrorModel::new(&series, window, Noise::FromRecording, Correlation::Share(0.03), None).unwrap();
                let bins = model.bins() as f64;
                expected += model.noise().powi(2) / bins;
                found += (model.measured.sum() / bins - 50.0).powi(2);
            }
            let ratio = (found / expected).sqrt();
            assert!((ratio - 1.0).abs() < 0.15, "{samples} samples: {ratio}");
        }
    }

    #[test]
    fn the_noise_of_a_smooth_signal_is_found_and_that_of_an_exact_one_is_the_least() {
        let found = model(&half_wave(1.5, 3), Correlation::Share(0.03)).noise();
        // 120 bins of 8.3 samples; white noise of 1.5 at samples: about 1.5/√8.3.
        assert!((found / (1.5 / 8.33_f64.sqrt()) - 1.0).abs() < 0.2, "{found}");
        let exact = model(&half_wave(0.0, 3), Correlation::Share(0.03)).noise();
        assert!((0.0098..0.011).contains(&exact), "{exact}");
    }

    /// The residuals are C^(−1/2) times the difference: their squares sum to dᵀ C⁻¹ d with C written out.
    #[test]
    fn whitened_residuals_have_the_norm_of_the_covariance() {
        let (measured, simulated) = (half_wave(1.0, 1), half_wave(0.0, 1));
        let model = model(&measured, Correlation::Length(2e-3));
        let share = 0.05;
        let means = DVector::from_vec(model.means(&simulated).unwrap()) - &model.measured;
        let level = model.measured.norm() / (model.bins() as f64).sqrt();
        let step = 0.1 / model.bins() as f64;
        let covariance = DMatrix::from_fn(model.bins(), model.bins(), |row, column| {
            let rho = (-(row.abs_diff(column) as f64) * step / 2e-3).exp();
            (share * level).powi(2) * rho + if row == column { model.noise().powi(2) } else { 0.0 }
        });
        let expected = means.dot(&(covariance.clone().try_inverse().unwrap() * &means));
        let rotated = model.rotated(&simulated).unwrap();
        let found: f64 = model.whitened(&rotated, share).iter().map(|r| r * r).sum();
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} for {expected}");
        let log_determinant = 2.0 * covariance.cholesky().unwrap().l().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let constant = 2.0 * model.bins() as f64 * model.noise().ln();
        let likelihood = -0.5 * (expected + log_determinant - constant);
        assert!((model.log_likelihood(&rotated, share) - likelihood).abs() < 1e-6 * likelihood.abs());
    }

    /// Differences drawn with a model's error of 4 % of the signal, five signals: the share is found again.
    #[test]
    fn the_size_of_the_model_s_error_is_found_again() {
        let measured = half_wave(0.3, 2);
        let model = model(&measured, Correlation::Length(2e-3));
        let mut stream = Stream::new(9);
        let mut drawn = |share: f64| -> Vec<f64> {
            model.variances(share).map(|variance| variance.sqrt() * stream.normal()).collect()
        };
        let found = most_likely_share(&(0..5).map(|_| (&model, 1.0, drawn(0.04))).collect::<Vec<_>>());
        assert!((found / 0.04 - 1.0).abs() < 0.15, "{found}");
        let none = most_likely_share(&(0..5).map(|_| (&model, 1.0, drawn(0.0))).collect::<Vec<_>>());
        assert!(none < 2e-3, "{none}");
    }

    #[test]
    fn roughness_of_the_simulation_is_noise_too() {
        let mut model = model(&half_wave(1.0, 1), Correlation::Share(0.03));
        let before = model.noise();
        model.add_roughness(&half_wave(1.0, 2)).unwrap();
        assert!((model.noise() / before / 2_f64.sqrt() - 1.0).abs() < 0.15, "{} {before}", model.noise());
    }

    #[test]
    fn gaps_and_short_recordings_are_refused() {
        let wave = half_wave(0.1, 1);
        let short = Series::new(&wave.time()[..900], &wave.values()[..900]);
        let error = model(&wave, Correlation::Share(0.1)).rotated(&short).unwrap_err();
        assert!(matches!(error, SignalError::Gap { of: "simulated signal", .. }), "{error}");
        let few = ErrorModel::new(&wave, [0.0, 5e-4], Noise::Share(0.01), Correlation::Share(0.1), None).unwrap_err();
        assert!(few.to_string().starts_with("the recording has 6 samples from 0 to 0.0005"), "{few}");
        let zero = wave.with_values(vec![0.0; wave.len()]);
        let error = ErrorModel::new(&zero, [0.0, 0.1], Noise::Share(0.01), Correlation::Share(0.1), None).unwrap_err();
        assert_eq!(error, SignalError::Zero { from: 0.0, to: 0.1 });
    }
}
