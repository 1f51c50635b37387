//! A fitted law, with what is known of its coefficients and how well it follows each test.

use super::hyperelastic::Energy;
use super::{DataSet, Quality, Warning, Weighting};
use crate::confidence::Confidence;
use base::finding::Finding;
use membrane::material::{Law, Tension};

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
