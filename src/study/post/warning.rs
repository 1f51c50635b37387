//! Warnings of the comparison with a reference and of the comparison of runs, and the findings of a run.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::remedies::with_remedy;
use base::finding::Finding;
use base::findings;
use lab::experiment;
use lab::signal::VIRTUAL_RECORDING;
use lab::signal::norm::NormError;
use scene::model::Model;
use scene::simulate::Outcome;

findings! {
    /// A doubt about a comparison: that of a run with its reference, or that of several runs.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        NoReferenceError {
            channel: &'static str, "what the channel is: `acceleration` or `displacement`" => "channel";
            reason: NormError, "why";
        } = "no-reference-error", Warning;
            meaning "the error of a channel against the reference cannot be computed";
            remedy "check that the reference covers the window of the comparison and is not zero in it";
            message "no {channel} error: {reason}";
        /// The recording was computed.
        VirtualReference {
            note: String, "what the recording says of itself";
        } = "virtual-reference" as VIRTUAL_REFERENCE, Warning;
            meaning "the recording that the run is compared with was computed, not measured";
            remedy "do not take an agreement with it for a validation";
            message "reference: {note}";
        /// The reduction of a raw recording is in doubt.
        ReferenceReduction(warning: experiment::Warning => ..warning.figures()) = code warning.code();
            message "reference: {warning}";
        FailedRun {
            run: String, "its name" => "run";
            cause: String, "why it failed";
        } = "failed-run" as FAILED_RUN, Warning;
            meaning "a run that is compared failed: its signals end where it did, and figures of its end are missing";
            remedy "run its scenario again once the cause of the failure is removed";
            message "{run} failed: {cause}";
        /// A compared run is a recording that was computed.
        VirtualRecording { run: String, "its name" => "run" } = code &VIRTUAL_RECORDING;
            message "{run} is a VIRTUAL recording: nothing was measured";
        /// The errors of a compared run were taken against a recording that was computed.
        ErrorsAgainstVirtual { run: String, "its name" => "run" } = code &VIRTUAL_REFERENCE;
            message "{run}: its errors are against a VIRTUAL recording: nothing was measured";
        SignalsOfOneRun {
            run: String, "its name" => "run";
            signals: Vec<String>, "columns of `signals.csv`" => "signals";
        } = "signals-of-one-run", Note;
            meaning "only one of the runs that are compared has these signals, so that there is nothing to compare \
                them with";
            remedy "none is needed; runs of one loading have the same signals";
            message "only {run} has {}", signals.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        NoCommonSignal = "no-common-signal", Warning;
            meaning "no two of the runs that are compared have a signal in common, of those that were asked for";
            remedy "compare runs of one loading, and recordings whose columns have the names of `signals.csv`";
            message "the runs have no signal in common";
        RawRecording { run: String, "its name" => "run" } = "raw-recording", Note;
            meaning "a file that is compared is a raw recording: its channels are what sensors read, none of them a \
                signal of a run";
            remedy "reduce it first with `droptower signal drop`, and compare the table that it writes";
            message "{run} is a raw recording with no signal of a run; that of a drop is reduced with \
                `droptower signal drop`";
    }
}

/// The findings of a run. In `summary.json` they are the field `findings`; the
/// messages of the warnings among them are the field `warnings`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunFindings(Vec<Finding>);

impl RunFindings {
    /// The findings of the run of `model`.
    pub(super) fn from_outcome(model: &Model, outcome: &Outcome) -> RunFindings {
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
