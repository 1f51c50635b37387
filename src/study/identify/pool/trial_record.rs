//! The lines of a history file after its first.

use std::path::PathBuf;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::{Deserialize, Serialize};

use crate::identify::objective::{Evaluation, ObjectiveValue};

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
    },
    /// A file that a trial was the first to read, and a description of its content.
    Input { input: PathBuf, content: String },
}

impl Record {
    /// The record of a trial at `x`; none of a fatal error.
    pub(super) fn of_trial(x: &[f64], evaluation: &Evaluation, seconds: f64) -> Option<Record> {
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
        Some(Record::Trial { x: x.into(), f, failed, numerical, seconds, bits, residuals })
    }

    /// The point and the outcome of a record of a trial; none where it is damaged.
    pub(super) fn trial(self) -> Option<(Vec<f64>, Evaluation)> {
        let Record::Trial { x, failed, numerical, bits, residuals, .. } = self else {
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
        Some((numbers[..x.len()].into(), evaluation))
    }
}
