//! Findings of the comparison with a reference and of the comparison of runs; the list of all findings of a run, whose own ones are
//! declared in `scene::simulate`.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::remedies::with_remedy;
use crate::field_comparison::NoComparison;
use base::finding::Finding;
use base::findings;
use base::number::{duration, significant};
use lab::Error;
use lab::experiment;
use lab::signal::VIRTUAL_RECORDING;
use scene::model::Model;
use scene::simulate::{BREAK_STRAIN_OF_COUPONS, Outcome};

findings! {
    /// A doubt about a comparison: that of a run with its reference, or that of several runs.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Warning {
        NoReferenceError {
            channel: &'static str, "what the channel is: `acceleration` or `displacement`" => "channel";
            reason: Error, "why";
        } = "no-reference-error", Warning;
            meaning "the error of a channel against the reference cannot be computed";
            remedy "check that the reference covers the window of the comparison and is not zero in it";
            message "no {channel} error: {reason}";
        NoFieldError {
            reason: NoComparison, "why";
        } = "no-field-error", Warning;
            meaning "the run cannot be compared with the displacement field of its reference";
            remedy "check that the times of the field are those of the run, and that the run reaches them";
            message "no errors against the field: {reason}";
        FieldNotReached {
            count: usize, "files within the window" => "files";
            first: f64, "time of the first of them, s" => "first_s";
        } = "field-not-reached", Warning;
            meaning "the run ended before some files of the displacement field were recorded, which are not compared";
            remedy "let the run last longer, or look why it ended early";
            message "the run does not reach {count} files of the field, the first at {}", duration(*first);
        FieldOffFilm {
            count: usize, "points off the film, of all times" => "points";
            of: usize, "points that were matched" => "of";
        } = "field-off-film", Warning;
            meaning "points of the displacement field lie farther from the film than an element is long, and are not \
                compared";
            remedy "check the unit of the field, its `align`, and the size of the specimen; leave out what was measured \
                beside the film";
            message "{count} of {of} points of the field do not lie on the film";
        FieldMotionUncertain {
            least_known: f64, "standard deviation of a place at the edge of the field, m" => "uncertainty_m";
            radius: f64, "radius of gyration of the field, m" => "radius_m";
        } = "field-motion-uncertain", Warning;
            meaning "places and displacements of the field do not determine the rigid motion between its axes and those of \
                the run: some motion changes them by less than their noise, as a turn of a round film about its axis";
            remedy "give markers by `reference.field.align`, or measure in the axes of the run and say \"none\" there";
            message "the motion of the field is not determined: some place is known to {} mm only",
                significant(least_known * 1e3, 3);
        FieldMotionAmbiguous {
            others: usize, "other motions" => "others";
            apart: f64, "smallest angle to one of them, degrees" => "apart_deg";
        } = "field-motion-ambiguous", Warning;
            meaning "other rigid motions bring the field as close to the run as the one that was taken, the smallest \
                turn; of a film with symmetries they are as right, of another one they may be the true one";
            remedy "give markers by `reference.field.align` where MD and TD must not be taken for each other";
            message "{others} other motions of the field fit as well, the nearest turned by {} degrees", significant(*apart, 3);
        /// The recording was computed.
        VirtualReference {
            note: String, "what the recording says of itself";
        } = "virtual-reference" as VIRTUAL_REFERENCE, Warning;
            meaning "the recording that the run is compared with was computed, not measured";
            remedy "do not take an agreement with it for a validation";
            message "reference: {note}";
        /// The run's impact speed is not that of the recording.
        ReferenceSpeed {
            run: f64, "impact speed of the run, m/s" => "run_m_s";
            low: f64, "lower end of the recording's, 95 %, m/s" => "low_m_s";
            high: f64, "its upper end, m/s" => "high_m_s";
        } = "reference-speed", Warning;
            meaning "the run's impact speed lies more than 1 % off the recording's, and outside of its interval of 95 %";
            remedy "set `loading.impact.velocity` to the recording's, or correct `reference.drop_height`, mass or column";
            message "reference: the impactor of the recording hit at {} to {} m/s (95 %), that of the run at {} m/s",
                significant(*low, 4), significant(*high, 4), significant(*run, 4);
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
            remedy "reduce it first with `droptower reduce drop`, and compare the table that it writes";
            message "{run} is a raw recording with no signal of a run; that of a drop is reduced with \
                `droptower reduce drop`";
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

/// What the data of a film leave open in every test of it, by the code of the finding that says so.
const LEFT_OPEN: [(&str, &str); 3] = [
    ("uncoupled-biaxial", "coupling of MD and TD"),
    ("strain-rate-outside", "strain rates"),
    (BREAK_STRAIN_OF_COUPONS.name, "break strain"),
];

/// What a finding says of the film's data, whatever the run: terminal and page collect these in one line.
pub fn left_open(code: &str) -> Option<&'static str> {
    LEFT_OPEN.iter().find(|(name, _)| *name == code).map(|(_, what)| *what)
}
