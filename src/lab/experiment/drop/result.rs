//! A reduced drop.

use crate::experiment::Warning;
use crate::experiment::contact::Contact;
use crate::experiment::ramp::GravityRamp;
use crate::experiment::release::Release;
use crate::signal::{Recording, Series, integrate};
use membrane::engine::GuideFriction;

/// Intervals of 95 % of the figures that follow from the time constant of the accelerometer, by its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intervals {
    /// s.
    pub time_constant: [f64; 2],
    /// Impact speed, m/s; with the scatter of the laser that measured it.
    pub impact_speed: [f64; 2],
    /// Largest travel below first contact, m; negative.
    pub displacement: [f64; 2],
    /// D of the paper's equation 11.
    pub energy_absorption: Option<[f64; 2]>,
}

/// A reduced drop.
#[derive(Clone, Debug, PartialEq)]
pub struct Drop {
    /// Rest and release.
    pub release: Release,
    /// First contact.
    pub contact: Contact,
    /// The corrected acceleration from the end of the rest on, m/s²; the recording's clock.
    pub acceleration: Series,
    /// Speed of the ideal fall √(2gH), m/s.
    pub ideal_speed: f64,
    /// Of the correction by coupling, s.
    pub time_constant: Option<f64>,
    /// Intervals of 95 % of what follows from the time constant; none where that was given.
    pub intervals: Option<Intervals>,
    /// Of the guide in the fall; none without a correction by coupling.
    pub guide_friction: Option<GuideFriction>,
    /// Of the correction by the gravity ramp.
    pub ramp: Option<GravityRamp>,
    /// Reading of the sensor at rest, m/s².
    pub offset: f64,
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
        let velocity = self.through(integrate::once(&self.acceleration, 0.0), self.contact.velocity);
        let displacement = self.through(integrate::once(&velocity, 0.0), 0.0);
        [velocity, displacement]
    }

    /// A signal, shifted to have this value at first contact.
    fn through(&self, signal: Series, value: f64) -> Series {
        let shift = signal.value_at(self.contact.time).map_or(0.0, |own| value - own);
        let shifted = signal.values().iter().map(|own| own + shift).collect();
        signal.with_values(shifted)
    }
}
