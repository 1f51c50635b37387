//! How a law is fitted.

use std::fmt;
use std::str::FromStr;

use super::data_set::DataSet;
use crate::error::{Error, refusal};

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

/// Reference of differences of stresses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// The largest stress of all tests.
    #[default]
    Absolute,
    /// The measured stress, but not less than 2 % of the largest of its test.
    Relative,
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

impl fmt::Display for Weighting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Weighting::Absolute => "absolute",
            Weighting::Relative => "relative",
        })
    }
}
