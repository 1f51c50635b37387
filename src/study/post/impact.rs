//! Measures of an impact.

use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

use super::{ReferenceComparison, RunFindings, Warning};
use crate::script::object;
use base::number::clean_time;
use lab::experiment::absorption::{Body, absorption_of, film_absorption};
use lab::experiment::drop::Figures;
use lab::signal::column::{self, Column};
use lab::signal::{Recording, Series};
use membrane::engine::GuideFriction;
use scene::model::{Impactor, Model};
use scene::simulate::ends_loaded;

/// Figures of an impact; fields of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Impact {
    /// Of each impactor.
    #[serde(skip)]
    pub bodies: Vec<BodyFigures>,
    /// Engineering strains at which the MD and TD fibres break, of the face that breaks first; none where nothing
    /// breaks.
    pub break_strain_md: Option<f64>,
    /// The same along TD.
    pub break_strain_td: Option<f64>,
    /// Least distance of the middle surfaces of two faces, or of parts of one, in any sample; none where film meets no film.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_film_distance_m: Option<f64>,
    /// Largest force of one spring of the frame; none without springs.
    #[serde(rename = "peak_spring_force_N", skip_serializing_if = "Option::is_none")]
    pub peak_spring_force: Option<f64>,
    /// Largest elongation of a spring of the frame; none without springs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_spring_elongation_m: Option<f64>,
    /// Relative error of the acceleration over the window that is compared, E_a of the paper's equation 14; none without a
    /// reference.
    pub acceleration_error: Option<f64>,
    /// Relative error of the displacement over that window, E_d of the paper's equation 15; none without a reference.
    pub displacement_error: Option<f64>,
    /// Figures of the reduction of a raw recording, with their intervals; none of other references.
    #[schemars(with = "Option<Value>")]
    pub reference_drop: Option<Box<Figures>>,
    /// Notes of the recording, of its reading and of its reduction; none without a reference.
    pub reference_notes: Option<Vec<String>>,
}

/// Figures of one impactor; fields of `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct BodyFigures {
    /// The beginning of the names of its figures and signals; empty of a single impactor.
    #[serde(skip)]
    pub prefix: String,
    /// Whether it met the film; without, it has neither a lowest point nor a rebound, and the film absorbed nothing of
    /// it.
    #[serde(skip)]
    pub had_film_contact: bool,
    /// Whether the run ended while film still pressed on it.
    #[serde(skip)]
    pub is_unfinished: bool,
    /// Largest filtered acceleration; none where it met nothing.
    pub peak_acceleration_m_s2: Option<f64>,
    /// Time of the largest filtered acceleration.
    pub time_of_peak_acceleration_s: Option<f64>,
    /// Lowest displacement from first contact with the film; negative.
    pub peak_displacement_m: Option<f64>,
    /// Time of the lowest displacement.
    pub time_of_peak_displacement_s: Option<f64>,
    /// Largest upward velocity after the lowest point; none without a rebound.
    pub rebound_velocity_m_s: Option<f64>,
    /// Share of the energy of loading that the film does not return on unloading (D of the paper's equation 11), without what other
    /// impactors and the frame's bars did to the impactor; none without a rebound, and where the run ended while film still pressed on it.
    pub energy_absorption: Option<f64>,
    /// The same of the film alone, without what the guide dissipates.
    pub film_energy_absorption: Option<f64>,
}

impl Impact {
    /// Measures of `signals`, which hold the filtered channels; `findings` gets the errors against a reference that there are not.
    pub(super) fn measure(
        model: &Model,
        signals: &Recording,
        comparison: Option<&ReferenceComparison>,
        findings: &mut RunFindings,
    ) -> Impact {
        let prefixes = model.prefixes();
        let bodies = model.impactors.iter().zip(&prefixes);
        let bodies = bodies.map(|(impactor, prefix)| BodyFigures::measure(impactor, prefix, model, signals)).collect();
        let recorded = model.reference.as_ref().and_then(|reference| prefixes.get(reference.impactor));
        let prefix = recorded.or(prefixes.first()).map_or("", String::as_str);
        let mut error = |channel: &'static str, result: Option<Result<f64, lab::Error>>| match result {
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
        let [break_strain_md, break_strain_td] = break_strains(model);
        Impact {
            bodies,
            break_strain_md,
            break_strain_td,
            least_film_distance_m: extreme(signals, column::FILM_DISTANCE, f64::min),
            peak_spring_force: extreme(signals, column::SPRING_FORCE, f64::max),
            peak_spring_elongation_m: extreme(signals, column::SPRING_ELONGATION, f64::max),
            acceleration_error,
            displacement_error,
            reference_drop: comparison.and_then(|comparison| comparison.drop.clone().map(Box::new)),
            reference_notes: comparison.map(ReferenceComparison::notes),
        }
    }

    /// Figures of the only impactor, or of the first.
    pub fn first(&self) -> &BodyFigures {
        static NONE: LazyLock<BodyFigures> = LazyLock::new(BodyFigures::default);
        self.bodies.first().unwrap_or(&NONE)
    }

    /// The figures by name, those of the impactors first.
    pub(super) fn figures(&self) -> Map<String, Value> {
        let of_body = |body: &BodyFigures| {
            let named = |(name, value)| (format!("{}{name}", body.prefix), value);
            object(body).into_iter().map(named).collect::<Vec<_>>()
        };
        self.bodies.iter().flat_map(of_body).chain(object(self)).collect()
    }

    /// The figures of a run that was ended early: without those of its end, and without the peaks where there was no
    /// rebound yet.
    pub(super) fn ended_early(self) -> Impact {
        Impact { bodies: self.bodies.into_iter().map(BodyFigures::ended_early).collect(), ..self }
    }
}

impl BodyFigures {
    /// Measures of the channels of `signals` that begin with `prefix`.
    fn measure(impactor: &Impactor, prefix: &str, model: &Model, signals: &Recording) -> BodyFigures {
        let moves = impactor.mass.is_finite();
        let had_film_contact = met(signals, prefix, column::CONTACT_FORCE);
        let met_any = had_film_contact || met(signals, prefix, column::COLLISION_FORCE);
        let peak = channel(signals, prefix, column::ACCELERATION_FILTERED).largest().filter(|_| moves && met_any);
        let deepest = channel(signals, prefix, column::DISPLACEMENT).smallest().filter(|_| moves && had_film_contact);
        let rebound = lowest_point(signals, prefix).filter(|_| moves).and_then(|[time, _]| {
            let after = channel(signals, prefix, column::VELOCITY).window([time, f64::INFINITY]);
            after.largest()
        });
        let force = signals.channel(&format!("{prefix}{}", column::CONTACT_FORCE.name));
        let is_unfinished = moves && force.is_some_and(ends_loaded);
        // What the film has given back so far is not what it gives back.
        let absorption = |friction: &GuideFriction| {
            absorption(impactor, model, friction, (signals, prefix)).filter(|_| !is_unfinished)
        };
        BodyFigures {
            prefix: prefix.to_owned(),
            had_film_contact,
            is_unfinished,
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
        let BodyFigures { prefix, had_film_contact, .. } = self;
        match self.rebound_velocity_m_s {
            Some(_) => {
                let (rebound_velocity_m_s, energy_absorption, film_energy_absorption) = (None, None, None);
                BodyFigures { prefix, rebound_velocity_m_s, energy_absorption, film_energy_absorption, ..self }
            }
            None => BodyFigures { prefix, had_film_contact, ..BodyFigures::default() },
        }
    }
}

/// A channel of the impactor whose channels begin with `prefix`; empty where there is none.
pub(super) fn channel(signals: &Recording, prefix: &str, column: Column) -> Series {
    signals.series(&format!("{prefix}{}", column.name)).unwrap_or_else(|| Series::new([], []))
}

/// The largest or smallest value of a channel, by `of`; none where there is none.
fn extreme(signals: &Recording, column: Column, of: fn(f64, f64) -> f64) -> Option<f64> {
    signals.channel(column.name)?.iter().copied().reduce(of)
}

/// Whether a force acted on the impactor whose channels begin with `prefix`.
fn met(signals: &Recording, prefix: &str, force: Column) -> bool {
    let force = signals.channel(&format!("{prefix}{}", force.name));
    force.is_some_and(|force| force.iter().any(|force| *force != 0.0))
}

/// Time (s) and displacement (m) of the lowest point of the impactor whose channels begin with `prefix`; none where it
/// still moves down at the end, or never met the film.
pub fn lowest_point(signals: &Recording, prefix: &str) -> Option<[f64; 2]> {
    let displacement = signals.series(&format!("{prefix}{}", column::DISPLACEMENT.name))?;
    if !met(signals, prefix, column::CONTACT_FORCE) {
        return None;
    }
    displacement.smallest().filter(|[time, _]| displacement.time().last() > Some(time))
}

/// The smallest over the faces, along MD and TD.
fn break_strains(model: &Model) -> [Option<f64>; 2] {
    let strains = || model.faces.iter().map(|face| face.material.break_strains());
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
    let gravity = model.loading.impact()?.gravity;
    let Impactor { mass, .. } = *impactor;
    if !mass.is_finite() {
        return None;
    }
    lowest_point(signals, prefix)?;
    // One that is released later is held before.
    let from = signals.time.partition_point(|time| *time < impactor.release);
    let own = |column: Column| signals.channel(&format!("{prefix}{}", column.name))?.get(from..);
    if met(signals, prefix, column::COLLISION_FORCE) {
        // Its own energy has what the others gave and took; that of the film and the guide is the rest of the balance
        // (methods.md, equation 53a).
        let (velocity, displacement) = (own(column::VELOCITY)?, own(column::DISPLACEMENT)?);
        let [all, left_out] =
            [&impactor.guide_friction, friction].map(|friction| friction.dissipated(velocity, displacement));
        let guide = all.iter().zip(&left_out).map(|(all, left_out)| all - left_out);
        let film: Vec<f64> = own(column::ABSORBED_ENERGY)?.iter().map(|work| -work).collect();
        let energy: Vec<f64> = film.iter().zip(guide).map(|(film, guide)| film - guide).collect();
        return absorption_of(&energy, &film).ok();
    }
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
    use lab::signal::Channel;

    /// A bar takes all of the motion of a body that gave 2 J to the film and gets back 0.5 J of it, 0.3 J of which go
    /// into its guide.
    #[test]
    fn what_bars_take_is_not_absorbed_by_the_film() {
        let text = "specimen.shape.rectangle = [0.2, 0.2]
             specimen.mesh = { element = \"quad4\", size = 0.02 }
             specimen.material = { density = 915, thickness = 20e-6, elastic = { young = 1e6, poisson = 0.3 } }
             frame.bars = { radius = 0.01, friction = 0.2 }
             impactor = { shape.sphere.radius = 0.02, mass = 1, friction = 0.0, guide_friction.constant = 3 }
             loading.impact = { velocity = 2, gravity = 0, duration = 0.01 }";
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bars.toml");
        std::fs::write(&path, text).unwrap();
        let model = scene::model::check(&scene::scenario::Document::read(&path).unwrap()).unwrap();
        let channels = [
            ("displacement_m", [0.0, -0.1, -0.2, -0.15, -0.1]),
            ("velocity_m_s", [-2.0, -2.0, 0.0, 5.0, 5.0]),
            ("contact_force_N", [0.0, 10.0, 10.0, 1.0, 0.0]),
            ("collision_force_N", [0.0, 0.0, 900.0, 0.0, 0.0]),
            ("absorbed_energy_J", [0.0, 1.0, 2.0, 1.8, 1.5]),
        ];
        let channels = channels.map(|(name, values)| Channel { name: name.into(), values: values.to_vec() });
        let signals = Recording { time: vec![0.0, 1.0, 2.0, 3.0, 4.0], channels: channels.to_vec() };
        let body = BodyFigures::measure(&model.impactors[0], "", &model, &signals);
        assert!((body.film_energy_absorption.unwrap() - (1.0 - 0.5 / 2.0)).abs() < 1e-12, "{body:?}");
        let guide = [0.6, 0.3];
        let expected = 1.0 - (0.5 - guide[1]) / (2.0 + guide[0]);
        assert!((body.energy_absorption.unwrap() - expected).abs() < 1e-12, "{body:?}");
    }

    #[test]
    fn an_impactor_that_still_moves_down_has_no_lowest_point() {
        let falls = |values: &[f64]| {
            let displacement = Channel { name: "displacement_m".into(), values: values.to_vec() };
            let force = Channel { name: "contact_force_N".into(), values: vec![1.0; values.len()] };
            let time = (0..values.len()).map(|i| i as f64).collect();
            lowest_point(&Recording { time, channels: vec![displacement, force] }, "")
        };
        assert_eq!(falls(&[0.0, -0.2, -0.1]), Some([1.0, -0.2]));
        assert_eq!(falls(&[0.0, -0.1, -0.2]), None);
        assert_eq!(lowest_point(&Recording::default(), ""), None);
    }
}
