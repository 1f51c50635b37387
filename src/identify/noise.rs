//! How residuals hang together from sample to sample.
//!
//! Residuals of a filtered signal are not independent: N samples say less than N numbers would. An autoregression is fitted to
//! them (Burg, *Modern Spectral Analysis*, 1978, 34–48), of the order for which Akaike's criterion with Hurvich and Tsai's
//! correction (Biometrika 76, 1989) is smallest; its autocorrelation stands for that of the noise. This is the autoregressive
//! estimate of covariance of den Haan and Levin (Handbook of Statistics 15, 1997), which needs no bandwidth.

use nalgebra::DMatrix;

/// Autocorrelations smaller than this, over a whole order of the autoregression, end the sums over lags.
const NEGLIGIBLE: f64 = 1e-6;

/// What is assumed of the residuals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colour {
    /// Neighbours may be correlated.
    #[default]
    Coloured,
    /// Every residual is independent of the others, as the textbook has it.
    White,
}

/// Autocorrelation of noise that does not change its character along the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// At lags 0, 1, …: the first is one.
    autocorrelation: Vec<f64>,
    /// Of the autoregression; zero for white noise.
    pub order: usize,
}

impl Noise {
    /// Independent samples.
    pub fn white() -> Noise {
        Noise { autocorrelation: vec![1.0], order: 0 }
    }

    /// The noise of which `residuals` are a sample. What never changes sign is noise too: no mean is taken off.
    pub fn of(residuals: &[f64], colour: Colour) -> Noise {
        match colour {
            Colour::White => Noise::white(),
            Colour::Coloured => autoregression(residuals).continued(residuals.len()),
        }
    }

    /// `uᵀ R u` of the columns `u` (samples × columns) with the correlation R of the samples.
    pub fn between(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let count = columns.ncols();
        let mixed: Vec<Vec<f64>> = columns.column_iter().map(|u| self.mix(u.as_slice())).collect();
        let dot = |row: usize, column: usize| -> f64 {
            columns.column(row).iter().zip(&mixed[column]).map(|(u, mixed)| u * mixed).sum()
        };
        DMatrix::from_fn(count, count, |row, column| dot(row.min(column), row.max(column)))
    }

    /// `R u`
    fn mix(&self, u: &[f64]) -> Vec<f64> {
        let mut mixed = u.to_vec();
        for (lag, correlation) in self.autocorrelation.iter().enumerate().skip(1) {
            for place in lag..u.len() {
                mixed[place] += correlation * u[place - lag];
                mixed[place - lag] += correlation * u[place];
            }
        }
        mixed
    }
}

/// x_t = Σ φ_i x_{t−i} + e_t
struct Autoregression {
    coefficients: Vec<f64>,
    /// At lags 0 to the order.
    autocorrelation: Vec<f64>,
}

impl Autoregression {
    /// With the autocorrelation at all lags of `samples` that matter.
    fn continued(self, samples: usize) -> Noise {
        let order = self.coefficients.len();
        let mut rho = self.autocorrelation;
        let gone = |rho: &[f64]| rho[rho.len() - order.max(1)..].iter().all(|rho| rho.abs() < NEGLIGIBLE);
        while order > 0 && rho.len() < samples && !gone(&rho) {
            let next = self.coefficients.iter().zip(rho.iter().rev()).map(|(phi, rho)| phi * rho).sum();
            rho.push(next);
        }
        Noise { autocorrelation: rho, order }
    }
}

/// Burg's recursion: every order's reflection coefficient makes the forward and backward errors of prediction smallest
/// together, which keeps the process stationary.
fn autoregression(x: &[f64]) -> Autoregression {
    let samples = x.len() as f64;
    let white = || Autoregression { coefficients: vec![], autocorrelation: vec![1.0] };
    let power = x.iter().map(|x| x * x).sum::<f64>() / samples;
    if power == 0.0 || !power.is_finite() {
        return white();
    }
    let (mut forward, mut backward) = (x.to_vec(), x.to_vec());
    let mut coefficients: Vec<f64> = Vec::new();
    let mut rho = vec![1.0];
    let mut share = 1.0;
    let mut best = (criterion(samples, 0, share), white());
    for order in 1..=most_order(x.len()) {
        let pairs = || forward[order..].iter().zip(&backward[order - 1..]);
        let product: f64 = pairs().map(|(f, b)| f * b).sum();
        let squares: f64 = pairs().map(|(f, b)| f * f + b * b).sum();
        if squares == 0.0 {
            break;
        }
        let reflection = 2.0 * product / squares;
        let known: f64 = coefficients.iter().zip(rho.iter().rev()).map(|(phi, rho)| phi * rho).sum();
        rho.push(known + reflection * share);
        let mirrored: Vec<f64> = coefficients.iter().rev().map(|phi| reflection * phi).collect();
        coefficients.iter_mut().zip(mirrored).for_each(|(phi, mirrored)| *phi -= mirrored);
        coefficients.push(reflection);
        for place in (order..x.len()).rev() {
            let (f, b) = (forward[place], backward[place - 1]);
            forward[place] = f - reflection * b;
            backward[place] = b - reflection * f;
        }
        share *= 1.0 - reflection * reflection;
        let value = criterion(samples, order, share);
        if value < best.0 {
            best = (value, Autoregression { coefficients: coefficients.clone(), autocorrelation: rho.clone() });
        }
    }
    best.1
}

/// Akaike's criterion, corrected for few samples; `share` is the part of the power that is not foreseen.
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
pub(super) mod tests {
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

    #[test]
    fn the_correlation_of_neighbours_is_found() {
        for phi in [-0.5, 0.3, 0.9] {
            let noise = Noise::of(&neighbours(7, 20_000, phi), Colour::Coloured);
            for lag in 1..5 {
                let found = noise.autocorrelation[lag];
                assert!((found - phi.powi(lag as i32)).abs() < 0.03, "{found} at lag {lag} for {phi}");
            }
        }
    }

    #[test]
    fn the_correlation_of_a_moving_mean_is_found() {
        let drawn = normals(3, 20_004);
        let mean: Vec<f64> = drawn.windows(5).map(|five| five.iter().sum::<f64>() / 5.0).collect();
        let noise = Noise::of(&mean, Colour::Coloured);
        for lag in 0..8 {
            let (found, expected) = (noise.autocorrelation[lag], (1.0 - 0.2 * lag as f64).max(0.0));
            assert!((found - expected).abs() < 0.03, "{found} at lag {lag} for {expected}");
        }
    }

    #[test]
    fn sums_over_lags_are_those_of_the_whole_matrix() {
        let noise = Noise::of(&neighbours(1, 60, 0.7), Colour::Coloured);
        assert!(noise.order > 0);
        let rho = |lag: usize| noise.autocorrelation.get(lag).copied().unwrap_or(0.0);
        let whole = DMatrix::from_fn(60, 60, |row, column| rho(row.abs_diff(column)));
        let columns = DMatrix::from_fn(60, 2, |row, column| (0.1 * (row * (column + 1)) as f64).sin());
        let expected = columns.transpose() * whole * &columns;
        assert!((noise.between(&columns) - expected).norm() < 1e-10);
    }

    #[test]
    fn nothing_and_next_to_nothing_are_white() {
        for residuals in [vec![0.0; 50], vec![1.0], vec![]] {
            assert_eq!(Noise::of(&residuals, Colour::Coloured), Noise::white());
        }
        assert_eq!(Noise::of(&neighbours(1, 60, 0.7), Colour::White), Noise::white());
    }
}
