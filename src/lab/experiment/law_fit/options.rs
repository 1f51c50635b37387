//! How a law is fitted, and why it cannot be.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::data_set::DataSet;

/// How a law is fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// Reference of the residuals.
    pub weighting: Weighting,
    /// Stretch up to which the law is to be stable in every kind of tension; the largest of the tests where none is
    /// given.
    pub stable_to: Option<f64>,
}

/// Why a law cannot be fitted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FitError {
    /// There is no test, or none has a weight.
    #[error("no test has a weight above zero")]
    NoData,
    /// There are fewer stresses than coefficients.
    #[error("{samples} measured stresses for {unknowns} coefficients: there must be more stresses than coefficients")]
    TooFew {
        /// Number of stresses.
        samples: usize,
        /// Number of coefficients.
        unknowns: usize,
    },
    /// The law has no finite stress at the measured stretches.
    #[error("the law has no finite stress at the measured stretches")]
    NoValue,
    /// No coefficients with a stiffness at rest fit.
    #[error("no coefficients that fit have a stiffness at rest")]
    NoStiffness,
    /// The stretch up to which the law is to be stable is not above one.
    #[error("expected a largest stretch above 1, found {0}")]
    StableTo(f64),
}

impl FitError {
    /// The remedy, where there is one.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            FitError::TooFew { .. } => Some("fit a law with fewer coefficients, or add tests"),
            FitError::NoValue | FitError::NoStiffness => {
                Some("check signs, units and the order of the columns: nominal stress grows with stretch")
            }
            FitError::NoData | FitError::StableTo(_) => None,
        }
    }
}

/// Share of the largest stress of a test below which a stress is not divided by itself: there its error is that of the
/// machine.
const FLOOR: f64 = 0.02;

/// Reference of differences of stresses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// The largest stress of all tests.
    #[default]
    Absolute,
    /// The measured stress, but not less than 2 % of the largest of its test.
    Relative,
}

/// Why a word is no weighting.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("expected absolute or relative, found `{word}`")]
pub struct WeightingError {
    /// As it was written.
    pub word: String,
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
    type Err = WeightingError;

    fn from_str(word: &str) -> Result<Weighting, WeightingError> {
        match word {
            "absolute" => Ok(Weighting::Absolute),
            "relative" => Ok(Weighting::Relative),
            other => Err(WeightingError { word: other.into() }),
        }
    }
}

impl fmt::Display for Weighting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Weighting::Absolute => "absolute",
            Weighting::Relative => "relative",
        })
    }
}
