//! Figures and warnings of the comparison with a displacement field.

use schemars::JsonSchema;
use serde::Serialize;

use super::{ReferenceComparison, Warning};
use crate::field_comparison::{FieldComparison, FoundMotion, NoComparison, StateErrors};
use base::number::clean_time;
use scene::model::Model;
use scene::simulate::Outcome;

/// The comparison with a displacement field; a part of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FieldFigures {
    /// Points of all times that were matched.
    pub points: usize,
    /// Those of them on the film, which are compared.
    pub compared: usize,
    /// Root mean square of the errors.
    pub rms_m: Option<f64>,
    /// Largest error.
    pub largest_m: Option<f64>,
    /// Translation from the axes of the field to those of the run, after the rotation.
    pub translation_m: [f64; 3],
    /// The rotation: an axis times an angle.
    pub rotation_rad: [f64; 3],
    /// Standard deviation of the residuals of a motion that was found.
    pub alignment_deviation_m: Option<f64>,
    /// Standard deviation of a place at the edge of the field in the direction in which it is known least.
    pub alignment_uncertainty_m: Option<f64>,
    /// The errors at each time.
    pub times: Vec<FieldTime>,
}

/// The errors at one time.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FieldTime {
    /// Time.
    pub time_s: f64,
    /// Points on the film.
    pub compared: usize,
    /// Points that were not matched.
    pub missing: usize,
    /// Root mean square of the errors.
    pub rms_m: Option<f64>,
    /// Largest error.
    pub largest_m: Option<f64>,
}

impl FieldFigures {
    /// The figures of a comparison.
    pub(super) fn from_comparison(field: &FieldComparison) -> FieldFigures {
        let ([points, compared], norms, found) = (field.counts(), field.norms(), field.alignment.found);
        let time = |state: &StateErrors| FieldTime {
            time_s: clean_time(state.time),
            compared: state.norms.points,
            missing: state.missing,
            rms_m: state.norms.rms(),
            largest_m: state.norms.largest(),
        };
        FieldFigures {
            points,
            compared,
            rms_m: norms.rms(),
            largest_m: norms.largest(),
            translation_m: field.alignment.motion.translation.into(),
            rotation_rad: field.alignment.motion.rotation_vector(),
            alignment_deviation_m: found.map(|found| found.deviation),
            alignment_uncertainty_m: found.map(|found| found.least_known),
            times: field.states.iter().map(time).collect(),
        }
    }
}

/// The run beside the field of its reference, where there is one.
pub(super) fn compare(
    model: &Model,
    outcome: &Outcome,
    comparison: Option<&ReferenceComparison>,
) -> Option<Result<FieldComparison, NoComparison>> {
    let comparison = comparison?;
    let (field, reference) = (comparison.field.as_ref()?, model.reference.as_ref()?.field.as_ref()?);
    Some(match &outcome.motion {
        Some(motion) => FieldComparison::new(motion, field, &reference.align, comparison.window),
        None => Err(NoComparison::NoState),
    })
}

/// Share of points off the film above which they are a warning.
const OFF_FILM: f64 = 0.05;

/// Doubts about a comparison, or why there is none.
pub(super) fn warnings(field: Option<&Result<FieldComparison, NoComparison>>) -> Vec<Warning> {
    let field = match field {
        None => return vec![],
        Some(Err(reason)) => return vec![Warning::NoFieldError { reason: *reason }],
        Some(Ok(field)) => field,
    };
    let [points, compared] = field.counts();
    let off = points - compared;
    let off_film = (off as f64 > OFF_FILM * points as f64).then_some(Warning::FieldOffFilm { count: off, of: points });
    let first = field.not_reached.first();
    let not_reached = first.map(|first| Warning::FieldNotReached { count: field.not_reached.len(), first: *first });
    let of_motion = |found: FoundMotion| {
        let FoundMotion { least_known, radius, others, apart, .. } = found;
        let uncertain = found.is_uncertain().then_some(Warning::FieldMotionUncertain { least_known, radius });
        let ambiguous = (others > 0).then_some(Warning::FieldMotionAmbiguous { others, apart: apart.to_degrees() });
        [uncertain, ambiguous]
    };
    let of_motion = field.alignment.found.map(of_motion).into_iter().flatten().flatten();
    off_film.into_iter().chain(not_reached).chain(of_motion).collect()
}
