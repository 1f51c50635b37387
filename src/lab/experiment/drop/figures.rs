//! The figures of a reduced drop.

use serde::Serialize;

use super::result::Drop;
use crate::experiment::Warning;
use crate::experiment::contact::SpeedSource;
use crate::signal::{Series, column};
use base::number::clean_time;
use membrane::engine::GuideFriction;

/// Figures of a drop, units in their names; times of peaks count from contact. Those that rest on an accelerometer at
/// the end of its range are none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// When the reading begins to fall, on the recording's clock.
    pub release_time_s: f64,
    /// On the recording's clock.
    pub contact_time_s: f64,
    /// Speed at contact, downward.
    pub impact_velocity_m_s: f64,
    /// Of the ideal fall √(2gH).
    pub ideal_velocity_m_s: f64,
    /// Largest filtered acceleration.
    pub peak_acceleration_m_s2: Option<f64>,
    /// Of the largest filtered acceleration.
    pub time_of_peak_acceleration_s: Option<f64>,
    /// Largest travel below first contact; negative.
    pub peak_displacement_m: Option<f64>,
    /// Of the largest travel.
    pub time_of_peak_displacement_s: Option<f64>,
    /// Largest upward velocity after the lowest point; none without a rebound.
    pub rebound_velocity_m_s: Option<f64>,
    /// Of that velocity.
    pub time_of_rebound_s: Option<f64>,
    /// ½Mv² at contact.
    #[serde(rename = "impact_energy_J")]
    pub impact_energy: Option<f64>,
    /// Largest work done on the film (W of equation 10).
    #[serde(rename = "peak_absorbed_energy_J")]
    pub peak_absorbed_energy: Option<f64>,
    /// Work done on the film at the end.
    #[serde(rename = "final_absorbed_energy_J")]
    pub final_absorbed_energy: Option<f64>,
    /// D of the paper's equation 11; none without rebound.
    pub energy_absorption: Option<f64>,
    /// D of the film alone, if the friction of the guide in the fall goes on after contact.
    pub film_energy_absorption: Option<f64>,
    /// Largest deviation of the total energy (equation 10) from its first value, over that.
    pub total_energy_drift: f64,
    /// Iterations of the search for contact.
    pub iterations: u32,
    /// Root mean square distance of matched motion and laser; none without a laser.
    pub laser_residual_m: Option<f64>,
    /// Source of contact time and impact speed.
    pub speed_from: SpeedSource,
    /// Of the correction by coupling; none with the ramp.
    pub time_constant_s: Option<f64>,
    /// Interval of 95 % of the time constant; none where it was given.
    pub time_constant_interval_s: Option<[f64; 2]>,
    /// Interval of the impact speed by that of the time constant and the scatter of the laser.
    pub impact_velocity_interval_m_s: Option<[f64; 2]>,
    /// Interval of the largest travel by that of the time constant.
    pub peak_displacement_interval_m: Option<[f64; 2]>,
    /// Interval of the energy absorption by that of the time constant.
    pub energy_absorption_interval: Option<[f64; 2]>,
    /// Friction of the guide in the fall; none with the ramp.
    pub guide_friction: Option<GuideFriction>,
    /// Of the correction by the gravity ramp; none with coupling.
    pub ramp_duration_s: Option<f64>,
    /// Reading of the sensor at rest.
    pub offset_m_s2: f64,
    /// The warnings as texts.
    pub notes: Vec<String>,
}

impl Drop {
    /// The figures of this drop.
    pub fn figures(&self) -> Figures {
        let channel = |name| self.signals.series(name).unwrap_or_else(|| Series::new([], []));
        let peak = channel(column::ACCELERATION_FILTERED.name).largest();
        let deepest = channel(column::DISPLACEMENT.name).smallest();
        let absorbed = channel(column::ABSORBED_ENERGY.name);
        let last = absorbed.samples().last();
        let is_measured = |sample: &[f64; 2]| self.clipped_from.is_none_or(|clipped| sample[0] < clipped);
        let [peak, deepest, most, last] =
            [peak, deepest, absorbed.largest(), last].map(|sample| sample.filter(is_measured));
        // A clipped peak is not exceeded by the rest of its reading.
        let peak = peak.filter(|_| self.clipped_from.is_none());
        let rebound = self.rebound();
        Figures {
            release_time_s: self.release.flank[0],
            contact_time_s: self.contact.time,
            impact_velocity_m_s: -self.contact.velocity,
            ideal_velocity_m_s: self.ideal_speed,
            peak_acceleration_m_s2: peak.map(|[_, value]| value),
            time_of_peak_acceleration_s: peak.map(|[time, _]| clean_time(time)),
            peak_displacement_m: deepest.map(|[_, value]| value),
            time_of_peak_displacement_s: deepest.map(|[time, _]| clean_time(time)),
            rebound_velocity_m_s: rebound.map(|[_, value]| value),
            time_of_rebound_s: rebound.map(|[time, _]| clean_time(time)),
            impact_energy: channel(column::KINETIC_ENERGY.name).values().first().copied(),
            peak_absorbed_energy: most.map(|[_, work]| work),
            final_absorbed_energy: last.map(|[_, work]| work),
            energy_absorption: self.energy_absorption,
            film_energy_absorption: self.film_absorption,
            total_energy_drift: self.total_energy_drift,
            iterations: self.contact.iterations,
            laser_residual_m: self.contact.laser_residual,
            speed_from: self.contact.speed_from,
            time_constant_s: self.time_constant,
            time_constant_interval_s: self.intervals.map(|intervals| intervals.time_constant),
            impact_velocity_interval_m_s: self.intervals.map(|intervals| intervals.impact_speed),
            peak_displacement_interval_m: deepest.and(self.intervals).map(|intervals| intervals.displacement),
            energy_absorption_interval: self.intervals.and_then(|intervals| intervals.energy_absorption),
            guide_friction: self.guide_friction.clone(),
            ramp_duration_s: self.ramp.map(|ramp| ramp.duration),
            offset_m_s2: self.offset,
            notes: self.warnings.iter().map(Warning::to_string).collect(),
        }
    }
}
