//! What searches and profiles warn of.

use serde::Serialize;
use serde_json::{Map, Value};
use thiserror::Error;

use super::bounds::Side;
use super::iteration::StopReason;
use super::point::Point;
use base::codes;
use base::finding::{Code, Report};
use base::number;

/// A warning about a search or a profile. `start` counts starts from zero.
#[derive(Clone, Debug, PartialEq, Error, Serialize)]
#[serde(untagged)]
pub enum Warning {
    /// A start without a value was replaced by a fallback.
    #[error("the objective has no value at the start {start}: {cause}; started from {fallback} instead")]
    StartReplaced {
        /// The start.
        start: Point,
        /// Why its trial failed.
        cause: String,
        /// The fallback.
        fallback: Point,
    },
    /// Starts spread over the bounds have no value.
    #[error("{count} of {starts} starts have no value and are left out, the first at {first}: {cause}")]
    StartsLeftOut {
        /// How many.
        count: usize,
        /// Number of starts.
        starts: usize,
        /// The first of them.
        first: Point,
        /// Why its trial failed.
        cause: String,
    },
    /// A start lies on a bound.
    #[error("start {} lies on the {side} bound of {parameter}", .start + 1)]
    StartOnBound {
        /// Number of the start.
        start: usize,
        /// The unknown.
        parameter: String,
        /// Which bound.
        side: Side,
    },
    /// Trials had no value.
    #[error(
        "{count} trials failed{} and counted as worst, the first at {first}: {cause}",
        if *.retried { ", also when repeated," } else { "" }
    )]
    FailedTrials {
        /// How many.
        count: usize,
        /// Whether each was repeated at a point beside.
        retried: bool,
        /// The first of them.
        first: Point,
        /// Why the first failed.
        cause: String,
    },
    /// The best start stopped before it converged.
    #[error("not converged: {reason}")]
    NotConverged {
        /// Why it stopped.
        reason: StopReason,
    },
    /// The best point lies on a bound.
    #[error(
        "not converged: {parameter} = {} lies on its {side} bound{}",
        number::significant(*.value, 5),
        match .falls_beyond {
            Some(true) => ", and the objective still falls beyond it",
            Some(false) => ", and the objective does not fall beyond it",
            None => "",
        }
    )]
    OnBound {
        /// The unknown.
        parameter: String,
        /// Its value.
        value: f64,
        /// Which bound.
        side: Side,
        /// Whether the gradient points outwards, where it is known: a minimum within the bounds.
        falls_beyond: Option<bool>,
    },
    /// Some starts ended at a higher objective value.
    #[error(
        "{} of {starts} starts ended higher than {}, at {}: there are local minima",
        .values.len(),
        number::significant(*.best, 5),
        listed(.values)
    )]
    StartsDisagree {
        /// Number of starts.
        starts: usize,
        /// The lowest objective value.
        best: f64,
        /// The higher values.
        values: Vec<f64>,
    },
    /// Some starts ended at the same objective value and another point.
    #[error("{count} of {starts} starts ended at the same value elsewhere: the minimum is not unique")]
    NotUnique {
        /// How many.
        count: usize,
        /// Number of starts.
        starts: usize,
    },
    /// The profile of a parameter does not reach the threshold on one side.
    #[error(
        "{parameter} has no {side} bound within {}: its profile rises by less than noise up to there, so that it is not \
         practically identifiable in that range",
        number::significant(*.limit, 4)
    )]
    NoBound {
        /// The parameter.
        parameter: String,
        /// Which end of its interval is missing.
        side: Side,
        /// The last point of the profile on that side.
        limit: f64,
    },
    /// Failed trials end the profile of a parameter before the threshold.
    #[error(
        "{parameter} has no {side} bound before {}, where trials failed: its interval is open on that side",
        number::significant(*.limit, 4)
    )]
    OpenInterval {
        /// The parameter.
        parameter: String,
        /// Which end of its interval is missing.
        side: Side,
        /// The first point without a value on that side.
        limit: f64,
    },
    /// Points of a profile have no value.
    #[error("trials failed where {parameter} is fixed at {}", listed(.values))]
    ProfileFailed {
        /// The parameter.
        parameter: String,
        /// Its values at these points.
        values: Vec<f64>,
    },
    /// A profile finds a lower objective value than the estimate.
    #[error(
        "not converged: the profile of {parameter} finds {} instead of {} at {x}",
        number::significant(*.found, 5),
        number::significant(*.estimate, 5)
    )]
    LowerThanEstimate {
        /// The parameter.
        parameter: String,
        /// Norm of the residuals there.
        found: f64,
        /// Norm of the residuals at the estimate.
        estimate: f64,
        /// All parameters there.
        x: Point,
    },
    /// A search continued from a point of a profile, or could not.
    #[error(
        "the profile of {parameter} finds {} instead of {} at {x}: {}",
        number::significant(*.found, 5),
        number::significant(*.estimate, 5),
        match .continued {
            Some(end) if end < .found => format!("the search continued from there to {}", number::significant(*end, 5)),
            Some(_) => "the search continued from there and found no lower value".into(),
            None => "the search could not continue from there, the objective has no value at its start".into(),
        }
    )]
    Continued {
        /// The parameter.
        parameter: String,
        /// Norm of the residuals at the point of the profile.
        found: f64,
        /// Norm of the residuals at the estimate.
        estimate: f64,
        /// The point of the profile.
        x: Point,
        /// Norm of the residuals at the end of the continued search; none where it has no value at its start.
        continued: Option<f64>,
    },
    /// The trials of a history were set aside, since a file that they depend on has changed.
    #[error("{input} has changed: the trials so far are set aside in {renamed}")]
    HistorySetAside {
        /// The file that has changed.
        input: String,
        /// The file with the trials so far.
        renamed: String,
    },
    /// Trials of an interrupted search are read from its history.
    #[error("{trials} trials are read from {path}")]
    TrialsRead {
        /// How many.
        trials: usize,
        /// The history.
        path: String,
    },
}

fn listed(values: &[f64]) -> String {
    values.iter().map(|value| number::significant(*value, 5)).collect::<Vec<_>>().join(", ")
}

codes! {
    START_REPLACED = "start-replaced", Note,
        "the objective has no value at a start of a search, which began at a fallback instead",
        "none is needed where the fallback is a good start; otherwise choose another start";
    STARTS_LEFT_OUT = "starts-left-out", Note,
        "the objective has no value at some of the starts that are spread over the bounds; the search has the others",
        "none is needed where enough starts are left; otherwise tighten the bounds, or give the starts as a list";
    START_ON_BOUND = "start-on-bound", Note,
        "a start of a search lies on a bound of an unknown, where the initial simplex and the transform of bounds \
         are one-sided",
        "move the start inside the bounds";
    FAILED_TRIALS = "failed-trials", Warning,
        "trials of a search had no value: the objective threw, was not finite, or the film ruptured; they count as \
         worse than all others",
        "tighten the bounds if many failed; use on_failure \"retry\" for a rough objective and on_rupture \"keep\" \
         for tests that rupture";
    NOT_CONVERGED = "not-converged", Warning,
        "a search stopped before its tolerances were met",
        "raise max_iterations and max_evaluations, or loosen tol_x and tol_f if the objective is rough";
    ON_BOUND = "on-bound", Warning,
        "the best point of a search lies on a bound: without it the minimum may lie beyond, so that the search counts as not \
         converged. Levenberg-Marquardt tells by the gradient whether the objective still falls beyond the bound: the \
         point is then the minimum within the bounds",
        "widen the bound if larger or smaller values are physical; otherwise search from another start or from several";
    STARTS_DISAGREE = "starts-disagree", Warning,
        "some starts of a search ended at a higher objective value than the best: there are local minima",
        "use more starts, and compare the points at which they ended";
    NOT_UNIQUE = "not-unique", Warning,
        "some starts of a search ended at the same objective value as the best and at another point: the data do not \
         determine the unknowns",
        "fix some unknowns, or add signals or tests to the objective";
    NO_BOUND = "no-bound", Warning,
        "the profile of a parameter has an open end: the objective does not rise to the threshold of 95 % on one side, and \
         the parameter is not practically identifiable as far as the profile goes",
        "fix another parameter, or add signals or tests to the objective";
    OPEN_INTERVAL = "open-interval", Warning,
        "trials failed along a parameter before the objective rose to the threshold of 95 %",
        "find out why these trials fail; the interval is open on that side";
    PROFILE_FAILED = "profile-failed", Warning,
        "trials failed at some points of a profile",
        "find out why these trials fail; the profile has gaps there";
    LOWER_THAN_ESTIMATE = "lower-than-estimate", Warning,
        "a profile finds a lower objective value than the estimate, also after three searches that continued from \
         such a point: the search has not converged",
        "search again from the point that the warning gives, or from several starts; loosen tol_f if the objective is \
         rough";
    CONTINUED = "continued-from-profile", Note,
        "a profile found a lower objective value than the estimate: the search continued from there, and the profiles \
         are those about its result, or about the point itself where the search has no value beside it",
        "none is needed; several starts find out whether there are other minima";
    HISTORY_SET_ASIDE = "history-set-aside", Note,
        "a file that an interrupted search read has changed, so its trials are no longer valid: its history was \
         renamed and the search starts from its beginning",
        "none is needed; restore the file and the name of the history to continue that search";
    HISTORY_READ = "history-read", Note,
        "an interrupted search continues: trials in its history are not repeated",
        "none is needed; remove the folder `.history` beside the results to repeat all trials";
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::StartReplaced { .. } => &START_REPLACED,
            Warning::StartsLeftOut { .. } => &STARTS_LEFT_OUT,
            Warning::StartOnBound { .. } => &START_ON_BOUND,
            Warning::FailedTrials { .. } => &FAILED_TRIALS,
            Warning::NotConverged { .. } => &NOT_CONVERGED,
            Warning::OnBound { .. } => &ON_BOUND,
            Warning::StartsDisagree { .. } => &STARTS_DISAGREE,
            Warning::NotUnique { .. } => &NOT_UNIQUE,
            Warning::NoBound { .. } => &NO_BOUND,
            Warning::OpenInterval { .. } => &OPEN_INTERVAL,
            Warning::ProfileFailed { .. } => &PROFILE_FAILED,
            Warning::LowerThanEstimate { .. } => &LOWER_THAN_ESTIMATE,
            Warning::Continued { .. } => &CONTINUED,
            Warning::HistorySetAside { .. } => &HISTORY_SET_ASIDE,
            Warning::TrialsRead { .. } => &HISTORY_READ,
        }
    }

    /// The fields of the variant.
    fn figures(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_figures_of_a_warning_are_its_fields() {
        let warning = Warning::NotConverged { reason: StopReason::MaxEvaluations };
        assert_eq!(warning.figures()["reason"], "max_evaluations was reached");
        let warning = Warning::NoBound { parameter: "k1".into(), side: Side::Lower, limit: 0.5 };
        assert_eq!(Value::Object(warning.figures()), json!({ "parameter": "k1", "side": "lower", "limit": 0.5 }));
        let warning = Warning::FailedTrials {
            count: 2,
            retried: false,
            first: Point::new(&["k1".into()], &[1.0]),
            cause: "no".into(),
        };
        assert_eq!(warning.to_string(), "2 trials failed and counted as worst, the first at k1 = 1: no");
    }

    #[test]
    fn a_search_that_could_not_continue_is_not_said_to_have() {
        let text = |continued| {
            let x = Point::new(&["k1".into()], &[1.0]);
            Warning::Continued { parameter: "k1".into(), found: 0.5, estimate: 0.7, x, continued }.to_string()
        };
        let found = "the profile of k1 finds 0.5 instead of 0.7 at k1 = 1: ";
        for (continued, expected) in [
            (Some(0.3), "the search continued from there to 0.3"),
            (Some(0.5), "the search continued from there and found no lower value"),
            (None, "the search could not continue from there, the objective has no value at its start"),
        ] {
            assert_eq!(text(continued), format!("{found}{expected}"));
        }
    }
}
