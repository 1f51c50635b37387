//! The figures of a fitted law, as text and as JSON.

use serde::Serialize;

use crate::{findings, table};
use base::finding::Finding;
use base::number::{figure, significant};
use lab::experiment::law_fit::{Coefficient, LawFit, TestFit};

/// All figures; SI.
#[derive(Serialize)]
pub(super) struct LawFigures {
    law: String,
    residual: String,
    coefficients: Vec<CoefficientFigures>,
    /// Rows of the correlation matrix of the coefficients.
    correlation: Option<Vec<Vec<f64>>>,
    tests: Vec<TestFigures>,
    predictions: Vec<TestFigures>,
    stable_to_stretch: f64,
    /// Kind of tension and stretch below 10 from which on the law is unstable.
    unstable_from: Option<(String, f64)>,
    findings: Vec<Finding>,
    written: Vec<String>,
}

#[derive(Serialize)]
struct CoefficientFigures {
    name: String,
    value: f64,
    unit: &'static str,
    standard_error: Option<f64>,
    interval: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct TestFigures {
    name: String,
    kind: String,
    weight: f64,
    stresses: usize,
    is_virtual: bool,
    r_squared: f64,
    #[serde(rename = "rms_Pa")]
    rms_pa: f64,
    relative_rms: f64,
    #[serde(rename = "largest_error_Pa")]
    largest_error_pa: f64,
    largest_error_at_stretch: f64,
}

impl LawFigures {
    pub(super) fn new(fit: &LawFit, findings: Vec<Finding>, written: Vec<String>) -> LawFigures {
        let matrix = fit.confidence.as_ref().map(|confidence| &confidence.correlation);
        LawFigures {
            law: fit.choice.to_string(),
            residual: fit.weighting.to_string(),
            coefficients: fit.coefficients.iter().map(coefficient).collect(),
            correlation: matrix.map(|matrix| matrix.row_iter().map(|row| row.iter().copied().collect()).collect()),
            tests: fit.tests.iter().map(test).collect(),
            predictions: fit.predictions.iter().map(test).collect(),
            stable_to_stretch: fit.stable_to,
            unstable_from: fit.unstable_from.map(|(tension, stretch)| (tension.to_string(), stretch)),
            findings,
            written,
        }
    }

    pub(super) fn text(&self) -> String {
        let coefficients = self.coefficients.iter().map(CoefficientFigures::cells);
        let coefficients: Vec<Vec<String>> =
            std::iter::once(COEFFICIENTS.map(String::from).to_vec()).chain(coefficients).collect();
        let test = |fitted: bool| move |test: &TestFigures| test.cells(fitted);
        let tests = self.tests.iter().map(test(true)).chain(self.predictions.iter().map(test(false)));
        let lines: Vec<Vec<String>> = std::iter::once(HEADER.map(String::from).to_vec()).chain(tests).collect();
        let stability = match &self.unstable_from {
            None => "stable up to the stretch 10".to_owned(),
            Some((tension, stretch)) => {
                format!("unstable in {tension} from the stretch {} on", significant(*stretch, 4))
            }
        };
        format!(
            "{}, {} residuals\n{}{}  {stability} (Hill's criterion)\n{}{}",
            self.law,
            self.residual,
            table::aligned(&coefficients, 2),
            table::aligned(&lines, 2),
            findings::lines("", &self.findings),
            self.written.iter().map(|file| format!("wrote {file}\n")).collect::<String>()
        )
    }
}

const COEFFICIENTS: [&str; 5] = ["", "", "value", "95 % from", "to"];

const HEADER: [&str; 7] = ["", "", "stresses", "R2", "rms (MPa)", "rms (%)", "largest (MPa)"];

impl CoefficientFigures {
    fn cells(&self) -> Vec<String> {
        let (factor, unit) = if self.unit == "Pa" { (1e-6, "MPa") } else { (1.0, "") };
        let shown = |value: f64| figure(value * factor, 5);
        let ends = match self.interval {
            Some(ends) if ends.iter().all(|end| end.is_finite()) => ends.map(shown),
            Some(_) => ["not determined".into(), String::new()],
            None => [String::new(), String::new()],
        };
        let [low, high] = ends;
        vec![self.name.clone(), unit.into(), shown(self.value), low, high]
    }
}

impl TestFigures {
    fn cells(&self, fitted: bool) -> Vec<String> {
        let mark = if fitted { "" } else { ", predicted" };
        vec![
            self.name.clone(),
            format!("{}{mark}", self.kind),
            self.stresses.to_string(),
            format!("{:.5}", self.r_squared),
            figure(self.rms_pa * 1e-6, 3),
            format!("{:.2}", self.relative_rms * 100.0),
            figure(self.largest_error_pa * 1e-6, 3),
        ]
    }
}

fn coefficient(one: &Coefficient) -> CoefficientFigures {
    CoefficientFigures {
        name: one.name.clone(),
        value: one.value,
        unit: if one.is_modulus { "Pa" } else { "" },
        standard_error: one.standard_error,
        interval: one.interval,
    }
}

fn test(test: &TestFit) -> TestFigures {
    TestFigures {
        name: test.set.name.clone(),
        kind: test.set.kind().to_string(),
        weight: test.set.weight,
        stresses: test.quality.samples,
        is_virtual: test.set.is_virtual,
        r_squared: test.quality.r_squared,
        rms_pa: test.quality.rms,
        relative_rms: test.quality.relative_rms,
        largest_error_pa: test.quality.largest_error,
        largest_error_at_stretch: test.quality.at_stretch,
    }
}
