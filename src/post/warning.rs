//! Warnings of the comparison with a reference, and the findings of a run.

use std::fmt;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use super::remedies::with_remedy;
use crate::experiment;
use crate::finding::{Code, Finding, Report, codes};
use crate::model::Model;
use crate::signal::norm::NormError;
use crate::simulate::Outcome;

codes! {
    NO_REFERENCE_ERROR = "no-reference-error", Warning,
        "the error of a channel against the reference cannot be computed",
        "check that the reference covers the window of the comparison and is not zero in it";
    VIRTUAL_REFERENCE = "virtual-reference", Warning,
        "the recording that the run is compared with was computed, not measured",
        "do not take an agreement with it for a validation";
}

/// What puts the comparison with a reference in doubt.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// A channel has no error.
    NoReferenceError {
        /// What the channel is: `acceleration` or `displacement`.
        channel: &'static str,
        /// Why.
        reason: NormError,
    },
    /// The recording was computed.
    VirtualReference {
        /// What the recording says of itself.
        note: String,
    },
    /// The reduction of a raw recording is in doubt.
    ReferenceReduction(experiment::Warning),
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::NoReferenceError { channel, reason } => write!(f, "no {channel} error: {reason}"),
            Warning::VirtualReference { note } => write!(f, "reference: {note}"),
            Warning::ReferenceReduction(warning) => write!(f, "reference: {warning}"),
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::NoReferenceError { .. } => &NO_REFERENCE_ERROR,
            Warning::VirtualReference { .. } => &VIRTUAL_REFERENCE,
            Warning::ReferenceReduction(warning) => warning.code(),
        }
    }

    fn figures(&self) -> Map<String, Value> {
        match self {
            Warning::NoReferenceError { channel, .. } => Map::from_iter([("channel".into(), (*channel).into())]),
            Warning::VirtualReference { .. } => Map::new(),
            Warning::ReferenceReduction(warning) => warning.figures(),
        }
    }
}

/// The findings of a run. In `summary.json` they are the fields `warnings`, their messages, and `findings`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunFindings(Vec<Finding>);

impl RunFindings {
    /// What the run of `model` reported.
    pub(super) fn of(model: &Model, outcome: &Outcome) -> RunFindings {
        let finding = |warning| {
            let message = with_remedy(warning, model, outcome.mass_scaling);
            Finding { message, ..Finding::new(warning) }
        };
        RunFindings(outcome.warnings.iter().map(finding).collect())
    }

    /// Adds a finding of the comparison.
    pub(super) fn push(&mut self, warning: &Warning) {
        self.0.push(Finding::new(warning));
    }

    /// Adds findings of the post script.
    pub(super) fn extend(&mut self, findings: &[Finding]) {
        self.0.extend_from_slice(findings);
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Finding> {
        self.0.iter()
    }
}

impl Serialize for RunFindings {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let messages: Vec<&str> = self.0.iter().map(|finding| finding.message.as_str()).collect();
        let mut fields = to.serialize_map(Some(2))?;
        fields.serialize_entry("warnings", &messages)?;
        fields.serialize_entry("findings", &self.0)?;
        fields.end()
    }
}
