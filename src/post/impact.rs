//! Measures of an impact.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::{Audit, ReferenceComparison, RunFindings, Warning};
use crate::engine::GuideFriction;
use crate::experiment::absorption::{Body, absorption_of, film_absorption};
use crate::experiment::drop::Figures;
use crate::model::{Impactor, Loading, Model};
use crate::number::clean_time;
use crate::signal::column::{self, Column};
use crate::signal::norm::NormError;
use crate::signal::{Recording, Series};
use crate::simulate::Outcome;

/// Figures of an impact; fields of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Impact {
    /// Of each impactor.
    #[serde(skip)]
    pub bodies: Vec<BodyFigures>,
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

/// Figures of one impactor; fields of `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BodyFigures {
    /// What the names of its figures and signals begin with; empty of a single impactor.
    #[serde(skip)]
    pub prefix: String,
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
}

impl Impact {
    /// Measures of `signals`, which hold the filtered channels.
    pub fn measure(
        model: &Model,
        outcome: &Outcome,
        signals: &Recording,
        comparison: Option<&ReferenceComparison>,
    ) -> Impact {
        let prefixes = model.prefixes();
        let bodies = model.impactors.iter().zip(&prefixes);
        let bodies = bodies.map(|(impactor, prefix)| BodyFigures::measure(impactor, prefix, model, signals)).collect();
        let recorded = model.reference.as_ref().and_then(|reference| prefixes.get(reference.impactor));
        let prefix = recorded.or(prefixes.first()).map_or("", String::as_str);
        let mut findings = RunFindings::of(model, outcome);
        let mut error = |channel: &'static str, result: Option<Result<f64, NormError>>| match result {
            Some(Err(reason)) => {
                findings.push(&Warning::NoReferenceError { channel, reason });
                None
            }
            Some(Ok(error)) => Some(error),
            None => None,
        };
        let acceleration = channel(signals, prefix, column::ACCELERATION_FILTERED);
        let displacement = channel(signals, prefix, column::DISPLACEMENT);
        let acceleration_error = error("acceleration", comparison.and_then(|c| c.acceleration_error(&acceleration)));
        let displacement_error = error("displacement", comparison.and_then(|c| c.displacement_error(&displacement)));
        comparison.into_iter().flat_map(ReferenceComparison::warnings).for_each(|warning| findings.push(&warning));
        let [break_strain_md, break_strain_td] = break_strains(model);
        Impact {
            bodies,
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

    /// Figures of the only impactor, or of the first.
    pub fn first(&self) -> &BodyFigures {
        static NONE: BodyFigures = BodyFigures::NONE;
        self.bodies.first().unwrap_or(&NONE)
    }

    /// The figures by name, those of the impactors first.
    pub(super) fn figures(&self) -> Map<String, Value> {
        let object = |value: Value| match value {
            Value::Object(figures) => figures,
            _ => Map::new(),
        };
        let of_body = |body: &BodyFigures| {
            object(json!(body))
                .into_iter()
                .map(|(name, value)| (format!("{}{name}", body.prefix), value))
                .collect::<Vec<_>>()
        };
        self.bodies.iter().flat_map(of_body).chain(object(json!(self))).collect()
    }

    /// The same of a run that was ended early: without the figures of its end, and without the peaks where there was no
    /// rebound yet.
    pub(super) fn ended_early(self) -> Impact {
        Impact { bodies: self.bodies.into_iter().map(BodyFigures::ended_early).collect(), ..self }
    }
}

impl BodyFigures {
    const NONE: BodyFigures = BodyFigures {
        prefix: String::new(),
        peak_acceleration_m_s2: None,
        time_of_peak_acceleration_s: None,
        peak_displacement_m: None,
        time_of_peak_displacement_s: None,
        rebound_velocity_m_s: None,
        energy_absorption: None,
        film_energy_absorption: None,
    };

    /// Measures of the channels of `signals` that begin with `prefix`.
    fn measure(impactor: &Impactor, prefix: &str, model: &Model, signals: &Recording) -> BodyFigures {
        let moves = impactor.mass.is_finite();
        let peak = channel(signals, prefix, column::ACCELERATION_FILTERED).largest().filter(|_| moves);
        let deepest = channel(signals, prefix, column::DISPLACEMENT).smallest().filter(|_| moves);
        let rebound = lowest_point(signals, prefix).filter(|_| moves).and_then(|[time, _]| {
            let after = channel(signals, prefix, column::VELOCITY).window([time, f64::INFINITY]);
            after.largest()
        });
        let absorption = |friction: &GuideFriction| absorption(impactor, model, friction, (signals, prefix));
        BodyFigures {
            prefix: prefix.to_owned(),
            peak_acceleration_m_s2: peak.map(|[_, value]| value),
            time_of_peak_acceleration_s: peak.map(|[time, _]| clean_time(time)),
            peak_displacement_m: deepest.map(|[_, value]| value),
            time_of_peak_displacement_s: deepest.map(|[time, _]| clean_time(time)),
            rebound_velocity_m_s: rebound.map(|[_, value]| value),
            energy_absorption: absorption(&GuideFriction::default()),
            film_energy_absorption: absorption(&impactor.guide_friction),
        }
    }

    fn ended_early(self) -> BodyFigures {
        let early =
            BodyFigures { rebound_velocity_m_s: None, energy_absorption: None, film_energy_absorption: None, ..self };
        if self.rebound_velocity_m_s.is_some() {
            early
        } else {
            BodyFigures { prefix: early.prefix, ..BodyFigures::NONE }
        }
    }
}

/// A channel of the impactor whose channels begin with `prefix`; empty where there is none.
fn channel(signals: &Recording, prefix: &str, column: Column) -> Series {
    signals.series(&format!("{prefix}{}", column.name)).unwrap_or_else(|| Series::new([], []))
}

/// Time (s) and displacement (m) of the lowest point of the impactor whose channels begin with `prefix`; none where it
/// still moves down at the end.
pub fn lowest_point(signals: &Recording, prefix: &str) -> Option<[f64; 2]> {
    let displacement = signals.series(&format!("{prefix}{}", column::DISPLACEMENT.name))?;
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

/// Share of its energy that an impactor lost, with the friction of its guide left out.
fn absorption(
    impactor: &Impactor,
    model: &Model,
    friction: &GuideFriction,
    (signals, prefix): (&Recording, &str),
) -> Option<f64> {
    let Loading::Impact { gravity, .. } = model.loading else { return None };
    let Impactor { mass, .. } = *impactor;
    if !mass.is_finite() {
        return None;
    }
    // One that is released later is held before.
    let from = signals.time.partition_point(|time| *time < impactor.release);
    let own = |column: Column| signals.channel(&format!("{prefix}{}", column.name))?.get(from..);
    if let Some(kinetic) = own(column::KINETIC_ENERGY).filter(|_| own(column::ACCELERATION_RESULTANT).is_some()) {
        let potential = own(column::POTENTIAL_ENERGY)?;
        let energy: Vec<f64> = kinetic.iter().zip(potential).map(|(kinetic, potential)| kinetic + potential).collect();
        return absorption_of(&energy, own(column::DISPLACEMENT)?).ok();
    }
    let body = Body { mass, gravity };
    film_absorption(body, friction, own(column::VELOCITY)?, own(column::DISPLACEMENT)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Channel;

    #[test]
    fn an_impactor_that_still_moves_down_has_no_lowest_point() {
        let falls = |values: &[f64]| {
            let displacement = Channel { name: "displacement_m".into(), values: values.to_vec() };
            let time = (0..values.len()).map(|i| i as f64).collect();
            lowest_point(&Recording { time, channels: vec![displacement] }, "")
        };
        assert_eq!(falls(&[0.0, -0.2, -0.1]), Some([1.0, -0.2]));
        assert_eq!(falls(&[0.0, -0.1, -0.2]), None);
        assert_eq!(lowest_point(&Recording::default(), ""), None);
    }
}
