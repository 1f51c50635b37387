//! How well a law follows a test.

use super::data_set::Measured;

/// Figures of one test beside a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// R² = 1 − Σ (P − P̂)²/Σ (P − mean P)² over all stresses of the test, which differ (theory.md, equation
    /// 233).
    pub r_squared: f64,
    /// Root mean square of P − P̂, Pa.
    pub rms: f64,
    /// Root mean square of P − P̂ over that of P.
    pub relative_rms: f64,
    /// Largest |P − P̂|, Pa.
    pub largest_error: f64,
    /// Stretch at which it is.
    pub at_stretch: f64,
    /// Number of stresses.
    pub samples: usize,
}

impl Quality {
    /// Figures of the stresses `predicted` (Pa), in the order of the measured ones.
    pub fn from_stresses(measured: &Measured, predicted: &[f64]) -> Quality {
        let (stresses, stretches) = (measured.stresses(), measured.stretches());
        let count = stresses.len() as f64;
        let mean = stresses.iter().sum::<f64>() / count;
        let errors: Vec<f64> = stresses.iter().zip(predicted).map(|(p, found)| p - found).collect();
        let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
        let left = square(&mut errors.iter().copied());
        let scatter = square(&mut stresses.iter().map(|stress| stress - mean));
        let size = square(&mut stresses.iter().copied());
        // NaN, beyond the limit of a law, counts as the largest.
        let larger = |a: &&f64, b: &&f64| a.abs().total_cmp(&b.abs());
        let worst = errors.iter().max_by(larger).copied().unwrap_or(f64::NAN);
        let place = errors.iter().position(|error| error.to_bits() == worst.to_bits()).unwrap_or(0);
        Quality {
            r_squared: 1.0 - left / scatter,
            rms: (left / count).sqrt(),
            relative_rms: (left / size).sqrt(),
            largest_error: worst.abs(),
            at_stretch: stretches[place],
            samples: stresses.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use membrane::material::Tension;

    #[test]
    fn figures_are_those_of_their_definition() {
        let measured = Measured::Tension(Tension::Uniaxial, vec![[1.0, 0.0], [2.0, 3.0], [3.0, 6.0]]);
        let found = Quality::from_stresses(&measured, &[0.0, 4.0, 5.0]);
        assert!((found.r_squared - (1.0 - 2.0 / 18.0)).abs() < 1e-15, "{found:?}");
        assert!((found.rms - (2.0_f64 / 3.0).sqrt()).abs() < 1e-15 && found.samples == 3);
        assert!((found.relative_rms - (2.0_f64 / 45.0).sqrt()).abs() < 1e-15);
        assert_eq!((found.largest_error, found.at_stretch), (1.0, 3.0));
        let beyond = Quality::from_stresses(&measured, &[0.0, f64::NAN, 6.0]);
        assert!(beyond.rms.is_nan() && beyond.largest_error.is_nan() && beyond.at_stretch == 2.0);
    }
}
