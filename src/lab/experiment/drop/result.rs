//! A reduced drop: its figures, their intervals, and the times of its events.

use serde::Serialize;

use super::release::GravityRamp;
use crate::experiment::Warning;
use crate::experiment::absorption::first_impact;
use crate::signal::{Recording, Series, column, integrate};
use base::number::clean_time;
use membrane::engine::GuideFriction;

/// What contact and impact speed were determined from, beside the acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SpeedSource {
    /// The laser, and the height where it is known.
    Laser,
    /// The height of fall.
    Fall,
    /// The speed, or the time of contact, that was given.
    Given,
}

/// First contact of impactor and film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// s, on the recording's clock.
    pub time: f64,
    /// m/s, negative: downward.
    pub velocity: f64,
    /// Root mean square distance of fitted motion and laser, m.
    pub laser_residual: Option<f64>,
    /// What both were determined from.
    pub speed_from: SpeedSource,
}

/// What is uncertain about a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Input {
    /// The reading at rest, and its drift.
    Offset,
    /// The time constant of the sensor's coupling.
    Coupling,
    /// The friction of the guide.
    Friction,
    /// The height of fall.
    Height,
    /// The begin of the release, and how long it takes.
    Release,
    /// The shape of the force after contact.
    Onset,
    /// The zero of the laser.
    Laser,
}

/// Intervals of 95 % by all that is uncertain: noise, offset, drift, coupling, friction, height, release, onset.
#[derive(Clone, Debug, PartialEq)]
pub struct Intervals {
    /// s; the upper end is infinite where the sensor may hold a constant. None where it was given.
    pub time_constant: Option<[f64; 2]>,
    /// s, on the recording's clock.
    pub contact_time: [f64; 2],
    /// m/s.
    pub impact_speed: [f64; 2],
    /// Kinetic energy at contact, J.
    pub impact_energy: [f64; 2],
    /// Largest travel below first contact, m; negative.
    pub displacement: [f64; 2],
    /// m/s.
    pub rebound_speed: Option<[f64; 2]>,
    /// Largest energy taken from the impactor, J.
    pub absorbed_energy: [f64; 2],
    /// D of the paper's equation 11.
    pub energy_absorption: Option<[f64; 2]>,
    /// The input that widens the interval of the travel most, with its share of the variance.
    pub widest: (Input, f64),
    /// Covariance of time of contact (s) and impact speed (m/s).
    pub contact: [[f64; 2]; 2],
}

impl Intervals {
    /// Intervals that hold those of `other` unknowns, too.
    pub(super) fn with(self, other: &Intervals) -> Intervals {
        let both = |[low, high]: [f64; 2], [least, most]: [f64; 2]| [low.min(least), high.max(most)];
        let either =
            |own: Option<[f64; 2]>, other: Option<[f64; 2]>| own.zip(other).map(|(own, other)| both(own, other));
        // The middles are apart by so much; either may be the value.
        let apart = |own: [f64; 2], other: [f64; 2]| 0.5 * (other[0] + other[1] - own[0] - own[1]);
        let apart = [apart(self.contact_time, other.contact_time), apart(self.impact_speed, other.impact_speed)];
        let contact = [0, 1].map(|row| [0, 1].map(|of| self.contact[row][of] + 0.5 * apart[row] * apart[of]));
        Intervals {
            time_constant: either(self.time_constant, other.time_constant),
            contact_time: both(self.contact_time, other.contact_time),
            impact_speed: both(self.impact_speed, other.impact_speed),
            impact_energy: both(self.impact_energy, other.impact_energy),
            displacement: both(self.displacement, other.displacement),
            rebound_speed: either(self.rebound_speed, other.rebound_speed),
            absorbed_energy: both(self.absorbed_energy, other.absorbed_energy),
            energy_absorption: either(self.energy_absorption, other.energy_absorption),
            contact,
            ..self
        }
    }
}

/// A reduced drop.
#[derive(Clone, Debug, PartialEq)]
pub struct Drop {
    /// Begin of the release on the recording's clock, s: of the motion that was fitted, since means of the reading blur a fast
    /// release by milliseconds.
    pub release: f64,
    /// First contact.
    pub contact: Contact,
    /// The corrected acceleration from the end of the rest on, m/s²; the recording's clock.
    pub acceleration: Series,
    /// Speed of the ideal fall √(2gH), m/s.
    pub ideal_speed: f64,
    /// Of the sensor's coupling, s; infinite where it holds a constant. None with the ramp.
    pub time_constant: Option<f64>,
    /// Intervals of 95 %; none where the recording does not determine them.
    pub intervals: Option<Intervals>,
    /// Of the guide in the fall.
    pub guide_friction: Option<GuideFriction>,
    /// Of the correction by the gravity ramp.
    pub ramp: Option<GravityRamp>,
    /// Reading of the sensor at rest, m/s².
    pub offset: f64,
    /// Noise of a sample of the accelerometer, m/s².
    pub noise: f64,
    /// Channel frequency class of the filtered acceleration.
    pub class: Option<f64>,
    /// Time from contact on (s): `displacement_m`, `velocity_m_s`, `acceleration_m_s2`, `acceleration_filtered_m_s2`,
    /// `kinetic_energy_J`, `potential_energy_J`, `absorbed_energy_J`, `total_energy_J`.
    pub signals: Recording,
    /// D of the paper's equation 11; none where the recording ends before the rebound, and where the
    /// accelerometer is at the end of its range.
    pub energy_absorption: Option<f64>,
    /// D of the film alone, if the friction of the guide in the fall goes on after contact; none where either is none.
    pub film_absorption: Option<f64>,
    /// Largest deviation of the total energy (equation 10) from its first value, over that.
    pub total_energy_drift: f64,
    /// First time from contact on (s) at which the accelerometer is at the end of its range: what rests on the signals
    /// from there on is no figure of the drop.
    pub clipped_from: Option<f64>,
    /// Assumptions, and doubts about the figures.
    pub warnings: Vec<Warning>,
}

impl Drop {
    /// Velocity (m/s) and displacement (m) from the end of the rest on, over the recording's clock: the corrected
    /// acceleration, integrated so that the velocity at first contact is that of the contact, and the displacement zero.
    pub fn motion(&self) -> [Series; 2] {
        let through = |signal: Series, value: f64| {
            let shift = signal.value_at(self.contact.time).map_or(0.0, |own| value - own);
            let shifted = signal.values().iter().map(|own| own + shift).collect();
            signal.with_values(shifted)
        };
        let velocity = through(integrate::once(&self.acceleration, 0.0), self.contact.velocity);
        let displacement = through(integrate::once(&velocity, 0.0), 0.0);
        [velocity, displacement]
    }

    /// Time from contact (s) and place (m) of the lowest point; none where the impactor still descends at the end, and
    /// where the accelerometer was at the end of its range before.
    pub fn lowest_point(&self) -> Option<[f64; 2]> {
        let displacement = self.signals.series(column::DISPLACEMENT.name)?;
        displacement
            .window(self.first_impact())
            .smallest()
            .filter(|sample| displacement.time().last() > Some(&sample[0]) && self.is_measured(sample))
    }

    /// Time from contact (s) and velocity (m/s, upward) at which the film lets go of the impactor: the largest after the
    /// lowest point. None without a lowest point, without motion upward after it, and where the accelerometer was at the
    /// end of its range before.
    pub fn rebound(&self) -> Option<[f64; 2]> {
        let [lowest, _] = self.lowest_point()?;
        let after = self.signals.series(column::VELOCITY.name)?.window([lowest, self.first_impact()[1]]);
        after.largest().filter(|sample| sample[1] > 0.0 && self.is_measured(sample))
    }

    /// From contact to the end of the first impact, s: the highest point before a later impact, or the end.
    pub(super) fn first_impact(&self) -> [f64; 2] {
        let end = self.signals.series(column::DISPLACEMENT.name).and_then(|displacement| {
            displacement.time().get(first_impact(displacement.values()).checked_sub(1)?).copied()
        });
        [0.0, end.unwrap_or(0.0)]
    }

    fn is_measured(&self, sample: &[f64; 2]) -> bool {
        self.clipped_from.is_none_or(|clipped| sample[0] < clipped)
    }
}

/// Figures of a drop, units in their names; times of peaks count from contact. Those that rest on an accelerometer at
/// the end of its range are none. Intervals are of 95 %; an end without a limit is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Begin of the release, on the recording's clock.
    pub release_time_s: f64,
    /// On the recording's clock.
    pub contact_time_s: f64,
    /// Of the time of contact.
    pub contact_time_interval_s: Option<[f64; 2]>,
    /// Speed at contact, downward.
    pub impact_velocity_m_s: f64,
    /// Of the impact speed.
    pub impact_velocity_interval_m_s: Option<[f64; 2]>,
    /// Of the ideal fall √(2gH).
    pub ideal_velocity_m_s: f64,
    /// Largest filtered acceleration.
    pub peak_acceleration_m_s2: Option<f64>,
    /// Of the largest filtered acceleration.
    pub time_of_peak_acceleration_s: Option<f64>,
    /// Channel frequency class of the filter.
    pub class: Option<f64>,
    /// Largest travel below first contact; negative.
    pub peak_displacement_m: Option<f64>,
    /// Of the largest travel.
    pub peak_displacement_interval_m: Option<[f64; 2]>,
    /// Of the largest travel.
    pub time_of_peak_displacement_s: Option<f64>,
    /// Largest upward velocity after the lowest point; none without a rebound.
    pub rebound_velocity_m_s: Option<f64>,
    /// Of that velocity.
    pub rebound_velocity_interval_m_s: Option<[f64; 2]>,
    /// Of that velocity.
    pub time_of_rebound_s: Option<f64>,
    /// ½Mv² at contact.
    #[serde(rename = "impact_energy_J")]
    pub impact_energy: Option<f64>,
    /// Of that energy.
    #[serde(rename = "impact_energy_interval_J")]
    pub impact_energy_interval: Option<[f64; 2]>,
    /// Largest work done on the film (W of equation 10).
    #[serde(rename = "peak_absorbed_energy_J")]
    pub peak_absorbed_energy: Option<f64>,
    /// Of that work.
    #[serde(rename = "peak_absorbed_energy_interval_J")]
    pub peak_absorbed_energy_interval: Option<[f64; 2]>,
    /// Work done on the film at the end; none where that is of later drops, too.
    #[serde(rename = "final_absorbed_energy_J")]
    pub final_absorbed_energy: Option<f64>,
    /// D of the paper's equation 11; none without rebound.
    pub energy_absorption: Option<f64>,
    /// Of the energy absorption.
    pub energy_absorption_interval: Option<[f64; 2]>,
    /// D of the film alone, if the friction of the guide in the fall goes on after contact.
    pub film_energy_absorption: Option<f64>,
    /// Largest deviation of the total energy (equation 10) from its first value, over that.
    pub total_energy_drift: f64,
    /// The input that widens the interval of the travel most.
    pub widest_input: Option<Input>,
    /// Its share of the variance.
    pub widest_share: Option<f64>,
    /// Root mean square distance of fitted motion and laser; none without a laser.
    pub laser_residual_m: Option<f64>,
    /// What contact and speed were determined from, beside the acceleration.
    pub speed_from: SpeedSource,
    /// Of the sensor's coupling; none with the ramp, and where the sensor holds a constant.
    pub time_constant_s: Option<f64>,
    /// Of the time constant; none where it was given.
    pub time_constant_interval_s: Option<[Option<f64>; 2]>,
    /// Friction of the guide in the fall.
    pub guide_friction: Option<GuideFriction>,
    /// Of the correction by the gravity ramp; none with coupling.
    pub ramp_duration_s: Option<f64>,
    /// Reading of the sensor at rest.
    pub offset_m_s2: f64,
    /// Noise of a sample, as a standard deviation.
    pub noise_m_s2: f64,
    /// The warnings as texts.
    pub notes: Vec<String>,
}

impl Drop {
    /// The figures of this drop.
    pub fn figures(&self) -> Figures {
        let whole = |name| self.signals.series(name).unwrap_or_else(|| Series::new([], []));
        let first = self.first_impact();
        let channel = |name| whole(name).window(first);
        let peak = channel(column::ACCELERATION_FILTERED.name).largest();
        let deepest = channel(column::DISPLACEMENT.name).smallest();
        let absorbed = channel(column::ABSORBED_ENERGY.name);
        let last = whole(column::ABSORBED_ENERGY.name).samples().last();
        let [peak, deepest, most, last] =
            [peak, deepest, absorbed.largest(), last].map(|sample| sample.filter(|sample| self.is_measured(sample)));
        // Work of a later drop is none of this one.
        let last = last.filter(|[_, work]| most.is_none_or(|[_, most]| *work <= most));
        // A clipped peak is not exceeded by the rest of its reading.
        let peak = peak.filter(|_| self.clipped_from.is_none());
        let rebound = self.rebound();
        let intervals = self.intervals.as_ref();
        let finite = |value: f64| value.is_finite().then_some(value);
        Figures {
            release_time_s: self.release,
            contact_time_s: self.contact.time,
            contact_time_interval_s: intervals.map(|intervals| intervals.contact_time),
            impact_velocity_m_s: -self.contact.velocity,
            impact_velocity_interval_m_s: intervals.map(|intervals| intervals.impact_speed),
            ideal_velocity_m_s: self.ideal_speed,
            peak_acceleration_m_s2: peak.map(|[_, value]| value),
            time_of_peak_acceleration_s: peak.map(|[time, _]| clean_time(time)),
            class: self.class,
            peak_displacement_m: deepest.map(|[_, value]| value),
            peak_displacement_interval_m: deepest.and(intervals).map(|intervals| intervals.displacement),
            time_of_peak_displacement_s: deepest.map(|[time, _]| clean_time(time)),
            rebound_velocity_m_s: rebound.map(|[_, value]| value),
            rebound_velocity_interval_m_s: rebound.and(intervals).and_then(|intervals| intervals.rebound_speed),
            time_of_rebound_s: rebound.map(|[time, _]| clean_time(time)),
            impact_energy: channel(column::KINETIC_ENERGY.name).values().first().copied(),
            impact_energy_interval: intervals.map(|intervals| intervals.impact_energy),
            peak_absorbed_energy: most.map(|[_, work]| work),
            peak_absorbed_energy_interval: most.and(intervals).map(|intervals| intervals.absorbed_energy),
            final_absorbed_energy: last.map(|[_, work]| work),
            energy_absorption: self.energy_absorption,
            energy_absorption_interval: intervals.and_then(|intervals| intervals.energy_absorption),
            film_energy_absorption: self.film_absorption,
            total_energy_drift: self.total_energy_drift,
            widest_input: intervals.map(|intervals| intervals.widest.0),
            widest_share: intervals.map(|intervals| intervals.widest.1),
            laser_residual_m: self.contact.laser_residual,
            speed_from: self.contact.speed_from,
            time_constant_s: self.time_constant.and_then(finite),
            time_constant_interval_s: intervals.and_then(|of| of.time_constant).map(|ends| ends.map(finite)),
            guide_friction: self.guide_friction.clone(),
            ramp_duration_s: self.ramp.map(|ramp| ramp.duration),
            offset_m_s2: self.offset,
            noise_m_s2: self.noise,
            notes: self.warnings.iter().map(Warning::to_string).collect(),
        }
    }
}

/// Times of a drop on the recording's clock, s, as far as they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Landmarks {
    /// Begin of the release; of a recording that is not reduced, where means over 5 ms of the reading begin to fall.
    pub release: Option<f64>,
    /// First contact.
    pub contact: Option<f64>,
    /// When the reading has risen by one gravity in the impact; of a recording that is not reduced.
    pub impact: Option<f64>,
    /// Largest travel; none where the impactor still descends at the end.
    pub lowest_point: Option<f64>,
    /// Largest upward velocity after the lowest point.
    pub rebound: Option<f64>,
}

impl Landmarks {
    /// The landmarks of a reduced drop.
    pub fn of_drop(drop: &Drop) -> Landmarks {
        let clock = |[time, _]: [f64; 2]| drop.contact.time + time;
        Landmarks {
            release: Some(drop.release),
            contact: Some(drop.contact.time),
            impact: None,
            lowest_point: drop.lowest_point().map(clock),
            rebound: drop.rebound().map(clock),
        }
    }

    /// The landmarks that are known with their names, in the order of their times.
    pub fn named(&self) -> Vec<(&'static str, f64)> {
        let all = [
            ("release", self.release),
            ("contact", self.contact),
            ("impact (1 g)", self.impact),
            ("lowest point", self.lowest_point),
            ("rebound", self.rebound),
        ];
        let mut known: Vec<(&str, f64)> = all.into_iter().filter_map(|(name, time)| Some((name, time?))).collect();
        known.sort_by(|a, b| a.1.total_cmp(&b.1));
        known
    }
}
