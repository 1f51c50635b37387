//! The lines of a history file after its first.

use std::path::PathBuf;
use std::sync::Arc;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::{Deserialize, Serialize};

use crate::identify::objective::{Evaluation, ObjectiveValue, Trial};
use crate::script::{Compared, Over, Target};

/// One line.
#[derive(Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub(super) enum Record {
    /// One trial.
    Trial {
        /// The point.
        x: Vec<f64>,
        /// Objective value; none of a failed trial.
        f: Option<f64>,
        /// Why the trial failed, where it did.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        failed: Option<String>,
        /// Whether a simulation failed numerically.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        numerical: bool,
        /// Wall time, s.
        seconds: f64,
        /// x, then the scalar or the residuals: little-endian doubles in base64.
        bits: String,
        /// Whether the objective value is residuals.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        residuals: bool,
        /// Simulated curves that were compared with references.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        compared: Vec<CurveRecord>,
    },
    /// A file that a trial was the first to read, and a description of its content.
    Input { input: PathBuf, content: String },
    /// A reference that the next trial is the first to be compared with.
    Target {
        /// Its number, from zero.
        target: usize,
        /// The quantity of its abscissae.
        over: Over,
        /// Its abscissae, little-endian floats in base64.
        places: String,
        /// Its values, likewise.
        values: String,
    },
}

/// A simulated curve: number of its reference, from zero, and values, little-endian floats in base64.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct CurveRecord {
    target: usize,
    values: String,
}

impl Record {
    /// The record of a trial at `x` whose curves are `compared`; none of a fatal error.
    pub(super) fn of_trial(
        x: &[f64],
        evaluation: &Evaluation,
        seconds: f64,
        compared: Vec<CurveRecord>,
    ) -> Option<Record> {
        let (values, failed, residuals) = match evaluation {
            Evaluation::Value(ObjectiveValue::Scalar(value)) => (vec![*value], None, false),
            Evaluation::Value(ObjectiveValue::Residuals(residuals)) => (residuals.clone(), None, true),
            Evaluation::Failed { cause, .. } => (vec![], Some(cause.clone()), false),
            Evaluation::Fatal(_) => return None,
        };
        let numerical = matches!(evaluation, Evaluation::Failed { numerical: true, .. });
        let f = match evaluation {
            Evaluation::Value(value) => Some(value.value()),
            _ => None,
        };
        let bytes: Vec<u8> = x.iter().chain(&values).flat_map(|value| value.to_le_bytes()).collect();
        let bits = BASE64_STANDARD.encode(bytes);
        Some(Record::Trial { x: x.into(), f, failed, numerical, seconds, bits, residuals, compared })
    }

    /// The record of reference `number`.
    pub(super) fn of_target(number: usize, target: &Target) -> Record {
        let (places, values) = (packed(&target.places), packed(&target.values));
        Record::Target { target: number, over: target.over, places, values }
    }

    /// The point and the trial of a record of a trial; none where it is damaged.
    pub(super) fn trial(self, targets: &[Arc<Target>]) -> Option<(Vec<f64>, Trial)> {
        let Record::Trial { x, failed, numerical, bits, residuals, compared, .. } = self else {
            return None;
        };
        let bytes = BASE64_STANDARD.decode(bits).ok()?;
        let (numbers, rest) = bytes.as_chunks::<8>();
        let numbers: Vec<f64> = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let values = numbers.get(x.len()..).filter(|_| rest.is_empty())?;
        let evaluation = match (failed, values) {
            (Some(cause), []) => Evaluation::Failed { cause, numerical },
            (None, values) if residuals => Evaluation::Value(ObjectiveValue::Residuals(values.into())),
            (None, [value]) => Evaluation::Value(ObjectiveValue::Scalar(*value)),
            _ => return None,
        };
        let compared = compared.into_iter().map(|curve| curve.compared(targets));
        Some((numbers[..x.len()].into(), Trial { evaluation, compared: compared.collect::<Option<_>>()? }))
    }
}

impl CurveRecord {
    /// The record of a curve over reference `target`.
    pub(super) fn new(target: usize, values: &[f32]) -> CurveRecord {
        CurveRecord { target, values: packed(values) }
    }

    fn compared(self, targets: &[Arc<Target>]) -> Option<Compared> {
        let target = targets.get(self.target)?;
        let values = unpacked(&self.values).filter(|values| values.len() == target.places.len())?;
        Some(Compared { target: Arc::clone(target), values })
    }
}

/// The reference of a record; none where it is damaged.
pub(super) fn target(over: Over, places: &str, values: &str) -> Option<Target> {
    Some(Target { over, places: unpacked(places)?, values: unpacked(values)? })
}

fn packed(values: &[f32]) -> String {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    BASE64_STANDARD.encode(bytes)
}

fn unpacked(text: &str) -> Option<Vec<f32>> {
    let bytes = BASE64_STANDARD.decode(text).ok()?;
    let (values, rest) = bytes.as_chunks::<4>();
    rest.is_empty().then(|| values.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
}
