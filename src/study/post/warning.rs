//! Warnings of the comparison with a reference and of the comparison of runs, and the findings of a run.

use std::fmt;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use super::remedies::with_remedy;
use base::codes;
use base::finding::{Code, Finding, Report};
use lab::experiment;
use lab::signal::VIRTUAL_RECORDING;
use lab::signal::norm::NormError;
use scene::model::Model;
use scene::simulate::Outcome;

codes! {
    NO_REFERENCE_ERROR = "no-reference-error", Warning,
        "the error of a channel against the reference cannot be computed",
        "check that the reference covers the window of the comparison and is not zero in it";
    VIRTUAL_REFERENCE = "virtual-reference", Warning,
        "the recording that the run is compared with was computed, not measured",
        "do not take an agreement with it for a validation";
    FAILED_RUN = "failed-run", Warning,
        "a run that is compared failed: its signals end where it did, and figures of its end are missing",
        "run its scenario again once the cause of the failure is removed";
    SIGNALS_OF_ONE_RUN = "signals-of-one-run", Note,
        "only one of the runs that are compared has these signals, so that there is nothing to compare them with",
        "none is needed; runs of one loading have the same signals";
    NO_COMMON_SIGNAL = "no-common-signal", Warning,
        "no two of the runs that are compared have a signal in common, of those that were asked for",
        "compare runs of one loading, and recordings whose columns have the names of `signals.csv`";
    RAW_RECORDING = "raw-recording", Note,
        "a file that is compared is a raw recording: its channels are what sensors read, none of them a signal of a run",
        "reduce it first with `droptower signal drop`, and compare the table that it writes";
}

/// What puts a comparison in doubt: that of a run with its reference, or that of several runs.
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
    /// A compared run failed.
    FailedRun {
        /// Its name.
        run: String,
        /// Why it failed.
        cause: String,
    },
    /// A compared run is a recording that was computed.
    VirtualRecording {
        /// Its name.
        run: String,
    },
    /// The errors of a compared run were taken against a recording that was computed.
    ErrorsAgainstVirtual {
        /// Its name.
        run: String,
    },
    /// Only one of the compared runs has these signals.
    SignalsOfOneRun {
        /// Its name.
        run: String,
        /// Columns of `signals.csv`.
        signals: Vec<String>,
    },
    /// A file that is compared has channels of no other one.
    RawRecording {
        /// Its name.
        run: String,
    },
    /// The compared runs have no signal in common.
    NoCommonSignal,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::NoReferenceError { channel, reason } => write!(f, "no {channel} error: {reason}"),
            Warning::VirtualReference { note } => write!(f, "reference: {note}"),
            Warning::ReferenceReduction(warning) => write!(f, "reference: {warning}"),
            Warning::FailedRun { run, cause } => write!(f, "{run} failed: {cause}"),
            Warning::VirtualRecording { run } => write!(f, "{run} is a VIRTUAL recording: nothing was measured"),
            Warning::ErrorsAgainstVirtual { run } => {
                write!(f, "{run}: its errors are against a VIRTUAL recording: nothing was measured")
            }
            Warning::SignalsOfOneRun { run, signals } => {
                let names: Vec<String> = signals.iter().map(|name| format!("`{name}`")).collect();
                write!(f, "only {run} has {}", names.join(", "))
            }
            Warning::RawRecording { run } => write!(
                f,
                "{run} is a raw recording with no signal of a run; that of a drop is reduced with `droptower signal drop`"
            ),
            Warning::NoCommonSignal => f.write_str("the runs have no signal in common"),
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::NoReferenceError { .. } => &NO_REFERENCE_ERROR,
            Warning::VirtualReference { .. } | Warning::ErrorsAgainstVirtual { .. } => &VIRTUAL_REFERENCE,
            Warning::ReferenceReduction(warning) => warning.code(),
            Warning::FailedRun { .. } => &FAILED_RUN,
            Warning::VirtualRecording { .. } => &VIRTUAL_RECORDING,
            Warning::SignalsOfOneRun { .. } => &SIGNALS_OF_ONE_RUN,
            Warning::RawRecording { .. } => &RAW_RECORDING,
            Warning::NoCommonSignal => &NO_COMMON_SIGNAL,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        match self {
            Warning::NoReferenceError { channel, .. } => Map::from_iter([("channel".into(), (*channel).into())]),
            Warning::VirtualReference { .. } | Warning::NoCommonSignal => Map::new(),
            Warning::ReferenceReduction(warning) => warning.figures(),
            Warning::FailedRun { run, .. }
            | Warning::VirtualRecording { run }
            | Warning::RawRecording { run }
            | Warning::ErrorsAgainstVirtual { run } => Map::from_iter([("run".into(), run.as_str().into())]),
            Warning::SignalsOfOneRun { run, signals } => {
                Map::from_iter([("run".into(), run.as_str().into()), ("signals".into(), signals.clone().into())])
            }
        }
    }
}

/// The findings of a run. In `summary.json` they are the field `findings`; the
/// messages of the warnings among them are the field `warnings`.
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

    /// Adds findings of the scenario or of the post script.
    pub(super) fn extend<'f>(&mut self, findings: impl IntoIterator<Item = &'f Finding>) {
        self.0.extend(findings.into_iter().cloned());
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Finding> {
        self.0.iter()
    }
}

impl Serialize for RunFindings {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let warnings = self.0.iter().filter(|finding| finding.is_warning());
        let messages: Vec<&str> = warnings.map(|finding| finding.message.as_str()).collect();
        let mut fields = to.serialize_map(Some(2))?;
        fields.serialize_entry("warnings", &messages)?;
        fields.serialize_entry("findings", &self.0)?;
        fields.end()
    }
}
