//! Fits of film laws to measured stresses: which laws there are, the tests that they are fitted to, and the fit.
//!
//! Laws are energies of rubber-like film ([`hyperelastic`]).

mod data_set;
pub mod hyperelastic;
mod warning;

use std::str::FromStr;

use crate::confidence::Confidence;
use crate::error::{Error, refusal};
use base::finding::Finding;
use base::words;
use hyperelastic::Energy;
use membrane::material::{Law, Tension};

pub use data_set::{BiaxialPoint, DataSet, Measured, StressReader, TestKind, range};
pub use hyperelastic::fit_law;
pub use warning::{CODES, Warning};

/// A law fitted to tests.
#[derive(Clone, Debug)]
pub struct LawFit {
    /// Which law; of Ogden's with the terms that are left.
    pub choice: Energy,
    /// The law itself, as runs use it.
    pub law: Law,
    /// Its coefficients in the order of their names.
    pub coefficients: Vec<Coefficient>,
    /// The tests that it was fitted to.
    pub tests: Vec<TestFit>,
    /// Tests that it was not fitted to, predicted.
    pub predictions: Vec<TestFit>,
    /// Reference of the residuals.
    pub weighting: Weighting,
    /// The stretch up to which the law was to be stable.
    pub stable_to: f64,
    /// Kind of tension and stretch below 10 from which on it is unstable, where there is one.
    pub unstable_from: Option<(Tension, f64)>,
    /// Intervals and correlation of the coefficients, where there are any.
    pub confidence: Option<Confidence>,
    /// Reports of the fit.
    pub warnings: Vec<Warning>,
}

/// A coefficient of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficient {
    /// As the material file calls it; `mu_2` is the second of a list.
    pub name: String,
    /// Pa, or without unit.
    pub value: f64,
    /// Whether it is in Pa.
    pub is_modulus: bool,
    /// Standard error, where there is one.
    pub standard_error: Option<f64>,
    /// Interval of 95 %, where there is one.
    pub interval: Option<[f64; 2]>,
}

/// A test beside the law.
#[derive(Clone, Debug, PartialEq)]
pub struct TestFit {
    /// As measured.
    pub set: DataSet,
    /// Stresses of the law in the order of the measured ones, Pa.
    pub predicted: Vec<f64>,
    /// R² and errors.
    pub quality: Quality,
    /// Stretch and stress (Pa) of the law over the range of the test; empty for biaxial tests.
    pub curve: Vec<[f64; 2]>,
}

impl LawFit {
    /// Reports of the fit and its intervals, as findings.
    pub fn findings(&self) -> Vec<Finding> {
        let doubts = self.confidence.iter().flat_map(|confidence| &confidence.warnings);
        self.warnings.iter().map(Finding::new).chain(doubts.map(Finding::new)).collect()
    }
}

impl Coefficient {
    /// The coefficients of these names and values, with their intervals.
    pub(super) fn all(
        names: Vec<String>,
        values: &[f64],
        is_modulus: impl Fn(&str) -> bool,
        confidence: Option<&Confidence>,
    ) -> Vec<Coefficient> {
        let one = |(index, (name, value)): (usize, (String, &f64))| Coefficient {
            is_modulus: is_modulus(&name),
            name,
            value: *value,
            standard_error: confidence.map(|found| found.standard_errors[index]),
            interval: confidence.map(|found| found.intervals[index]),
        };
        names.into_iter().zip(values).enumerate().map(one).collect()
    }
}

/// Figures of one test beside a law.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// R² = 1 − Σ (P − P̂)²/Σ (P − mean P)² over all stresses of the test, which differ.
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

/// How a law is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// Reference of the residuals.
    pub weighting: Weighting,
    /// Stretch up to which the law is to be stable in every kind of tension; the largest of the tests where none is
    /// given.
    pub stable_to: Option<f64>,
}

/// Share of the largest stress of a test below which a stress is not divided by itself: there its error is that of the
/// machine.
const FLOOR: f64 = 0.02;

words! {
    /// Reference of differences of stresses.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Weighting {
        /// The largest stress of all tests.
        #[default]
        Absolute = "absolute",
        /// The measured stress, but not less than 2 % of the largest of its test.
        Relative = "relative",
    }
}

impl Weighting {
    /// The factor of each stress of each set in a residual, with the weight of its set (methods.md, equation 231).
    pub fn factors(self, sets: &[DataSet]) -> Vec<f64> {
        let largest = |set: &DataSet| set.measured.stresses().into_iter().fold(0.0, |most: f64, p| most.max(p.abs()));
        let of_all = sets.iter().map(largest).fold(0.0, f64::max);
        let factors = sets.iter().flat_map(|set| {
            let (weight, floor) = (set.weight.sqrt(), FLOOR * largest(set));
            set.measured.stresses().into_iter().map(move |stress| match self {
                Weighting::Absolute => weight / of_all,
                Weighting::Relative => weight / stress.abs().max(floor),
            })
        });
        factors.collect()
    }
}

impl FromStr for Weighting {
    type Err = Error;

    fn from_str(word: &str) -> Result<Weighting, Error> {
        match word {
            "absolute" => Ok(Weighting::Absolute),
            "relative" => Ok(Weighting::Relative),
            other => Err(refusal!("expected absolute or relative, found `{other}`")),
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
