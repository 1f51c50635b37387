//! Measures of an impact.

use serde::Serialize;

use super::{Audit, ReferenceComparison, RunFindings, Warning};
use crate::engine::GuideFriction;
use crate::experiment::absorption::{Body, absorption_of, film_absorption};
use crate::experiment::drop::Figures;
use crate::model::{Impactor, Loading, Model};
use crate::number::clean_time;
use crate::signal::norm::NormError;
use crate::signal::{Recording, Series, column};
use crate::simulate::Outcome;

/// Figures of an impact; fields of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Impact {
    /// Largest filtered acceleration.
    pub peak_acceleration_m_s2: Option<f64>,
    /// Time of the largest filtered acceleration.
    pub time_of_peak_acceleration_s: Option<f64>,
    /// Lowest displacement from first contact; negative.
    pub peak_displacement_m: Option<f64>,
    /// Time of the lowest displacement.
    pub time_of_peak_displacement_s: Option<f64>,
    /// Largest upward velocity after the lowest point; none without a rebound.
    pub rebound_velocity_m_s: Option<f64>,
    /// D of the paper's equation 11; none without a rebound.
    pub energy_absorption: Option<f64>,
    /// D of the film alone, without what the guide dissipates; none without a rebound.
    pub film_energy_absorption: Option<f64>,
    /// Engineering strains at which the MD and TD fibres break, of the face that breaks first; none where nothing
    /// breaks.
    pub break_strain_md: Option<f64>,
    /// The same along TD.
    pub break_strain_td: Option<f64>,
    /// E_a of the paper's equation 14; none without a reference.
    pub acceleration_error: Option<f64>,
    /// E_d of the paper's equation 15; none without a reference.
    pub displacement_error: Option<f64>,
    /// Figures of the reduction of a raw recording, with their intervals; none of other references.
    pub reference_drop: Option<Box<Figures>>,
    /// Notes of the recording, of its reading and of its reduction; none without a reference.
    pub reference_notes: Option<Vec<String>>,
    /// Size, cost and errors of the run.
    #[serde(flatten)]
    pub audit: Audit,
    /// What the run and the comparison reported.
    #[serde(flatten)]
    pub findings: RunFindings,
}

impl Impact {
    /// Measures of `signals`, which hold the filtered channel.
    pub fn measure(
        model: &Model,
        outcome: &Outcome,
        signals: &Recording,
        comparison: Option<&ReferenceComparison>,
    ) -> Impact {
        let channel = |name| signals.series(name).unwrap_or_else(|| Series::new([], []));
        let acceleration = channel(column::ACCELERATION_FILTERED.name);
        let displacement = channel(column::DISPLACEMENT.name);
        let moves = model.impactor.as_ref().is_none_or(|impactor| impactor.mass.is_finite());
        let peak = acceleration.largest().filter(|_| moves);
        let deepest = displacement.smallest().filter(|_| moves);
        let rebound = lowest_point(signals).filter(|_| moves).and_then(|[time, _]| {
            let after = channel(column::VELOCITY.name).window([time, f64::INFINITY]);
            after.largest()
        });
        let mut findings = RunFindings::of(model, outcome);
        let mut error = |channel: &'static str, result: Option<Result<f64, NormError>>| match result {
            Some(Err(reason)) => {
                findings.push(&Warning::NoReferenceError { channel, reason });
                None
            }
            Some(Ok(error)) => Some(error),
            None => None,
        };
        let acceleration_error = error("acceleration", comparison.and_then(|c| c.acceleration_error(&acceleration)));
        let displacement_error = error("displacement", comparison.and_then(|c| c.displacement_error(&displacement)));
        comparison.into_iter().flat_map(ReferenceComparison::warnings).for_each(|warning| findings.push(&warning));
        let [break_strain_md, break_strain_td] = break_strains(model);
        let guide_friction =
            model.impactor.as_ref().map_or_else(GuideFriction::default, |of| of.guide_friction.clone());
        Impact {
            peak_acceleration_m_s2: peak.map(|[_, value]| value),
            time_of_peak_acceleration_s: peak.map(|[time, _]| clean_time(time)),
            peak_displacement_m: deepest.map(|[_, value]| value),
            time_of_peak_displacement_s: deepest.map(|[time, _]| clean_time(time)),
            rebound_velocity_m_s: rebound.map(|[_, value]| value),
            energy_absorption: absorption(model, &GuideFriction::default(), signals),
            film_energy_absorption: absorption(model, &guide_friction, signals),
            break_strain_md,
            break_strain_td,
            acceleration_error,
            displacement_error,
            reference_drop: comparison.and_then(|comparison| comparison.drop.clone().map(Box::new)),
            reference_notes: comparison.map(ReferenceComparison::notes),
            audit: Audit::of(outcome),
            findings,
        }
    }
}

impl Impact {
    /// The same of a run that was ended early: without the figures of its end, and without the peaks where there was no
    /// rebound yet.
    pub(super) fn ended_early(self) -> Impact {
        let early =
            Impact { rebound_velocity_m_s: None, energy_absorption: None, film_energy_absorption: None, ..self };
        if self.rebound_velocity_m_s.is_some() {
            return early;
        }
        Impact {
            peak_acceleration_m_s2: None,
            time_of_peak_acceleration_s: None,
            peak_displacement_m: None,
            time_of_peak_displacement_s: None,
            ..early
        }
    }
}

/// Time (s) and displacement (m) of the lowest point of the impactor; none where it still moves down at the end.
pub fn lowest_point(signals: &Recording) -> Option<[f64; 2]> {
    let displacement = signals.series(column::DISPLACEMENT.name)?;
    displacement.smallest().filter(|[time, _]| displacement.time().last() > Some(time))
}

/// The smallest over the faces, along MD and TD.
fn break_strains(model: &Model) -> [Option<f64>; 2] {
    let strains = || model.faces.iter().map(|face| face.material.law.break_strains());
    [0, 1].map(|fibre| {
        let smallest = strains().map(|strains| strains[fibre]).fold(f64::INFINITY, f64::min);
        Some(smallest).filter(|strain| strain.is_finite())
    })
}

/// Whether the impactor does not move along z alone.
fn is_spatial(signals: &Recording) -> bool {
    signals.channel(column::ACCELERATION_RESULTANT.name).is_some()
}

fn absorption(model: &Model, friction: &GuideFriction, signals: &Recording) -> Option<f64> {
    let (Loading::Impact { gravity, .. }, Some(Impactor { mass, .. })) = (&model.loading, &model.impactor) else {
        return None;
    };
    if !mass.is_finite() {
        return None;
    }
    if let Some(kinetic) = signals.channel(column::KINETIC_ENERGY.name).filter(|_| is_spatial(signals)) {
        let potential = signals.channel(column::POTENTIAL_ENERGY.name)?;
        let energy: Vec<f64> = kinetic.iter().zip(potential).map(|(kinetic, potential)| kinetic + potential).collect();
        return absorption_of(&energy, signals.channel(column::DISPLACEMENT.name)?).ok();
    }
    let body = Body { mass: *mass, gravity: *gravity };
    let velocity = signals.channel(column::VELOCITY.name)?;
    film_absorption(body, friction, velocity, signals.channel(column::DISPLACEMENT.name)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    #[test]
    fn an_impactor_that_still_moves_down_has_no_lowest_point() {
        let falls = |values: &[f64]| {
            let displacement = Channel { name: "displacement_m".into(), values: values.to_vec() };
            lowest_point(&Recording {
                time: (0..values.len()).map(|i| i as f64).collect(),
                channels: vec![displacement],
            })
        };
        assert_eq!(falls(&[0.0, -0.2, -0.1]), Some([1.0, -0.2]));
        assert_eq!(falls(&[0.0, -0.1, -0.2]), None);
        assert_eq!(lowest_point(&Recording::default()), None);
    }
}
