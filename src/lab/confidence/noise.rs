//! Autocorrelation of residuals.
//!
//! Residuals of a filtered signal are not independent: N samples hold less information than N independent ones. An
//! autoregression is fitted to them (Burg, *Modern Spectral Analysis*, 1978, 34–48), of the order for which Akaike's
//! criterion with Hurvich and Tsai's correction (Biometrika 76, 1989) is smallest; its autocorrelation is the estimate
//! of that of the noise. This is the autoregressive estimate of covariance of den Haan and Levin (Handbook of
//! Statistics 15, 1997), which needs no bandwidth.

use nalgebra::DMatrix;

/// The assumed noise of the residuals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colour {
    /// Autoregressive: neighbouring residuals may be correlated.
    #[default]
    Coloured,
    /// White: all residuals are independent.
    White,
}

/// An assumed error of a part of the residuals, such as that of a model, with a correlation that decays exponentially.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Its norm, in the unit of the residuals' norm.
    pub error: f64,
    /// Number of residuals over which the correlation decays to 1/e; zero where all are independent.
    pub correlation: f64,
}

/// Stationary noise: an autoregression.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Reflection coefficients k of orders one, two, …; none for white noise.
    reflections: Vec<f64>,
}

impl Noise {
    /// Independent samples.
    pub fn white() -> Noise {
        Noise { reflections: vec![] }
    }

    /// Noise whose correlation e^(−l/`length`) decays with the lag l; independent samples where the length is zero.
    pub fn exponential(length: f64) -> Noise {
        if length == 0.0 { Noise::white() } else { Noise { reflections: vec![(-1.0 / length).exp()] } }
    }

    /// The noise of `residuals`. Their mean is part of it.
    pub fn from_residuals(residuals: &[f64], colour: Colour) -> Noise {
        match colour {
            Colour::White => Noise::white(),
            Colour::Coloured => autoregression(residuals),
        }
    }

    /// Order of the autoregression; zero for white noise.
    pub fn order(&self) -> usize {
        self.reflections.len()
    }

    /// `uᵀ R u` of the columns `u` (samples × columns) with the correlation R of the samples.
    pub fn covariance(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let count = columns.ncols();
        let products: Vec<Vec<f64>> = columns.column_iter().map(|u| self.correlate(u.as_slice())).collect();
        let dot = |row: usize, column: usize| -> f64 {
            columns.column(row).iter().zip(&products[column]).map(|(u, product)| u * product).sum()
        };
        DMatrix::from_fn(count, count, |row, column| dot(row.min(column), row.max(column)))
    }

    /// `R u`: the sum of the causal and the anticausal part.
    fn correlate(&self, u: &[f64]) -> Vec<f64> {
        let before = self.causal(u.iter().copied());
        let after = self.causal(u.iter().rev().copied());
        before.iter().zip(after.iter().rev()).map(|(before, after)| 0.5 * (before + after)).collect()
    }

    /// u_t + 2 Σ_{l ≥ 1} ρ_l u_{t−l} at every t, all lags at the cost of the order: the autocorrelation's one-sided
    /// spectrum is F = (1 + z⁻¹S₀)/(1 − z⁻¹S₀) with Schur's continued fraction S_m = (k_m + z⁻¹S_{m+1})/(1 + k_m
    /// z⁻¹S_{m+1}) of the reflections. The waves in such a lattice cannot grow, which the recursion in the coefficients
    /// of an autoregression can where its roots lie close together (Markel and Gray, *Linear Prediction of Speech*,
    /// 1976).
    fn causal(&self, u: impl Iterator<Item = f64>) -> Vec<f64> {
        // The backward waves of all layers one sample ago; there is none below the last layer.
        let mut back = vec![0.0; self.order() + 1];
        let step = |u: f64| {
            let sum = u + 2.0 * back[0];
            let mut down = u + back[0];
            for (layer, k) in self.reflections.iter().enumerate() {
                let from_below = back[layer + 1];
                down -= k * from_below;
                back[layer] = k * down + from_below;
            }
            sum
        };
        u.map(step).collect()
    }
}

/// Burg's recursion: every order's reflection coefficient makes the forward and backward errors of prediction smallest
/// together, which keeps the process stationary.
fn autoregression(x: &[f64]) -> Noise {
    let samples = x.len() as f64;
    let power = x.iter().map(|x| x * x).sum::<f64>() / samples;
    if power == 0.0 || !power.is_finite() {
        return Noise::white();
    }
    let (mut forward, mut backward) = (x.to_vec(), x.to_vec());
    let mut reflections: Vec<f64> = Vec::new();
    // Share of the variance that the process does not predict.
    let mut share = 1.0;
    let mut best = (criterion(samples, 0, share), 0);
    for order in 1..=most_order(x.len()) {
        let pairs = || forward[order..].iter().zip(&backward[order - 1..]);
        let product: f64 = pairs().map(|(f, b)| f * b).sum();
        let squares: f64 = pairs().map(|(f, b)| f * f + b * b).sum();
        if squares == 0.0 || share <= 0.0 {
            break;
        }
        let reflection = 2.0 * product / squares;
        reflections.push(reflection);
        // Backwards, because each entry needs the backward error of the entry before it as it was.
        for index in (order..x.len()).rev() {
            let (f, b) = (forward[index], backward[index - 1]);
            forward[index] = f - reflection * b;
            backward[index] = b - reflection * f;
        }
        share *= 1.0 - reflection * reflection;
        let value = criterion(samples, order, share);
        if value < best.0 {
            best = (value, order);
        }
    }
    reflections.truncate(best.1);
    Noise { reflections }
}

/// Akaike's criterion, corrected for few samples; `share` is the unpredicted part of the power.
fn criterion(samples: f64, order: usize, share: f64) -> f64 {
    let parameters = order as f64 + 1.0;
    samples * share.ln() + 2.0 * samples * parameters / (samples - parameters - 1.0)
}

/// 10 log₁₀ N, as is usual, and no more than every fourth sample can carry.
fn most_order(samples: usize) -> usize {
    let usual = 10.0 * (samples.max(1) as f64).log10();
    (usual as usize).min(samples / 4)
}

#[cfg(test)]
pub mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// White noise of deviation one.
    pub fn normals(seed: u64, count: usize) -> Vec<f64> {
        let mut stream = ChaCha8Rng::seed_from_u64(seed);
        (0..count).map(|_| StandardNormal.sample(&mut stream)).collect()
    }

    /// Noise of deviation one whose neighbours are correlated by `phi`.
    pub fn neighbours(seed: u64, count: usize, phi: f64) -> Vec<f64> {
        let drawn = normals(seed, count);
        let mut x = vec![drawn[0]];
        for drawn in &drawn[1..] {
            x.push(phi * x[x.len() - 1] + (1.0 - phi * phi).sqrt() * drawn);
        }
        x
    }

    /// ρ at lags 0 to `count`: the first column of R.
    fn correlations(noise: &Noise, count: usize) -> Vec<f64> {
        let mut first = vec![0.0; count];
        first[0] = 1.0;
        noise.correlate(&first)
    }

    #[test]
    fn the_correlation_of_neighbours_is_found() {
        for phi in [-0.5, 0.3, 0.9] {
            let noise = Noise::from_residuals(&neighbours(7, 20_000, phi), Colour::Coloured);
            for (lag, found) in correlations(&noise, 5).into_iter().enumerate() {
                assert!((found - phi.powi(lag as i32)).abs() < 0.03, "{found} at lag {lag} for {phi}");
            }
        }
    }

    #[test]
    fn the_correlation_of_a_moving_mean_is_found() {
        let drawn = normals(3, 20_004);
        let mean: Vec<f64> = drawn.windows(5).map(|five| five.iter().sum::<f64>() / 5.0).collect();
        let noise = Noise::from_residuals(&mean, Colour::Coloured);
        for (lag, found) in correlations(&noise, 8).into_iter().enumerate() {
            let expected = (1.0 - 0.2 * lag as f64).max(0.0);
            assert!((found - expected).abs() < 0.03, "{found} at lag {lag} for {expected}");
        }
    }

    /// The matrix R: Levinson's recursion gives the coefficients of the autoregression and its autocorrelation, and
    /// continues it lag by lag.
    fn whole(noise: &Noise, samples: usize) -> DMatrix<f64> {
        let (mut phi, mut rho, mut share) = (Vec::<f64>::new(), vec![1.0], 1.0);
        let next =
            |phi: &[f64], rho: &[f64]| -> f64 { phi.iter().zip(rho.iter().rev()).map(|(phi, rho)| phi * rho).sum() };
        for k in &noise.reflections {
            rho.push(next(&phi, &rho) + k * share);
            phi = phi.iter().zip(phi.iter().rev()).map(|(phi, mirrored)| phi - k * mirrored).chain([*k]).collect();
            share *= 1.0 - k * k;
        }
        while rho.len() < samples {
            rho.push(next(&phi, &rho));
        }
        DMatrix::from_fn(samples, samples, |row, column| rho[row.abs_diff(column)])
    }

    #[test]
    fn the_covariance_is_that_of_the_correlation_matrix() {
        let moving_mean = normals(3, 404).windows(5).map(|five| five.iter().sum::<f64>() / 5.0).collect();
        for (drawn, least_order) in [(neighbours(1, 60, 0.7), 1), (moving_mean, 5)] {
            let noise = Noise::from_residuals(&drawn, Colour::Coloured);
            assert!(noise.order() >= least_order, "{noise:?}");
            let columns = DMatrix::from_fn(drawn.len(), 2, |row, column| (0.1 * (row * (column + 1)) as f64).sin());
            let expected = columns.transpose() * whole(&noise, drawn.len()) * &columns;
            assert!((noise.covariance(&columns) - &expected).norm() < 1e-10 * expected.norm());
        }
    }

    /// After three moving means all roots of the autoregression are close to one, where products of its coefficients
    /// lose all digits.
    #[test]
    fn correlations_of_very_smooth_noise_stay_bounded() {
        let smooth = |x: Vec<f64>| x.windows(20).map(|some| some.iter().sum::<f64>()).collect::<Vec<_>>();
        let noise = Noise::from_residuals(&smooth(smooth(smooth(normals(4, 20_057)))), Colour::Coloured);
        assert!(noise.order() > 10);
        let found = correlations(&noise, 20_000);
        assert!(found.iter().all(|rho| rho.abs() <= 1.0 + 1e-9));
        assert!(found[2000..].iter().all(|rho| rho.abs() < 1e-3));
        // Autocorrelation of three moving means: the sixfold convolution of a box with itself.
        let convolved = |x: &[f64]| -> Vec<f64> {
            let at = |x: &[f64], index: usize| x.get(index).copied().unwrap_or(0.0);
            (0..x.len() + 19).map(|index| (0..20.min(index + 1)).map(|back| at(x, index - back)).sum()).collect()
        };
        let box_six = (0..5).fold(vec![1.0; 20], |x, _| convolved(&x));
        let middle = box_six.len() / 2;
        for lag in 0..57 {
            let expected = box_six[middle + lag] / box_six[middle];
            assert!((found[lag] - expected).abs() < 0.1, "{} for {expected} at lag {lag}", found[lag]);
        }
    }

    /// A random fit of 100 000 samples: with lag by lag 10¹⁰ products a column.
    #[test]
    fn a_long_record_near_a_unit_root_has_linear_cost() {
        let mut fit = normals(6, 100_000);
        for index in 1..fit.len() {
            fit[index] += fit[index - 1];
        }
        let noise = Noise::from_residuals(&fit, Colour::Coloured);
        let ones = DMatrix::from_element(fit.len(), 1, 1.0);
        let samples = fit.len() as f64;
        assert!(noise.covariance(&ones)[(0, 0)] > 1e3 * samples, "{noise:?}");
    }

    #[test]
    fn exponential_noise_has_the_correlation_that_decays_over_its_length() {
        for (lag, found) in correlations(&Noise::exponential(20.0), 60).into_iter().enumerate() {
            assert!((found - (-(lag as f64) / 20.0).exp()).abs() < 1e-12, "{found} at lag {lag}");
        }
        assert_eq!(Noise::exponential(0.0), Noise::white());
    }

    #[test]
    fn zero_and_very_few_residuals_are_white() {
        for residuals in [vec![0.0; 50], vec![1.0], vec![]] {
            assert_eq!(Noise::from_residuals(&residuals, Colour::Coloured), Noise::white());
        }
        assert_eq!(Noise::from_residuals(&neighbours(1, 60, 0.7), Colour::White), Noise::white());
    }
}
