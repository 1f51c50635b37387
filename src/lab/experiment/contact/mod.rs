//! First contact of impactor and film: when, and how fast (Polymers 2021, 13, 1537, section 3.2).
//!
//! A laser determines it by the place of the impactor ([`by_laser`]); without one it follows from the height or the
//! speed of the fall ([`by_fall`]).

mod fall;
mod laser;
mod onset;
#[cfg(test)]
mod tests;

use serde::Serialize;
use thiserror::Error;

use crate::signal::Series;
use base::number::significant;

pub use fall::{ClosedFall, by_fall};
pub use laser::by_laser;

/// Source of contact time and impact speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SpeedSource {
    /// The acceleration, integrated twice and fitted to the laser.
    Laser,
    /// The acceleration, integrated from rest over the known height.
    Fall,
    /// The known speed, which the acceleration, integrated from rest, reaches at contact.
    Given,
    /// Both are known, and nothing is determined from the recording.
    Stated,
}

/// First contact of impactor and film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// s, on the recording's clock.
    pub time: f64,
    /// m/s, negative: downward.
    pub velocity: f64,
    /// Iterations until the contact time converged.
    pub iterations: u32,
    /// Root mean square distance of fitted motion and laser, m.
    pub laser_residual: Option<f64>,
    /// Standard error of the speed by the scatter of the laser, m/s.
    pub speed_error: Option<f64>,
    /// Source of both.
    pub speed_from: SpeedSource,
}

/// Known height or speed of a fall that was recorded without a laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FallCondition {
    /// Height that it covers, m.
    Height(f64),
    /// Speed that it reaches, m/s.
    Speed(f64),
}

impl FallCondition {
    /// The condition with its figure, as a predicate of the fall.
    fn predicate(self) -> String {
        match self {
            FallCondition::Height(height) => format!("covers {} m", significant(height, 6)),
            FallCondition::Speed(speed) => format!("reaches {speed:.3} m/s"),
        }
    }

    /// The quantity that is known.
    pub(super) fn name(self) -> &'static str {
        match self {
            FallCondition::Height(_) => "height",
            FallCondition::Speed(_) => "speed",
        }
    }
}

/// The zero of the sensor, from the rest before the release.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroOffset {
    /// Samples that it is the mean of.
    pub samples: usize,
    /// Standard deviation of one sample, m/s².
    pub deviation: f64,
}

impl ZeroOffset {
    /// Standard error of the mean, m/s².
    pub fn error(&self) -> f64 {
        self.deviation / (self.samples.max(1) as f64).sqrt()
    }
}

/// Why first contact cannot be determined.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ContactError {
    /// The laser measured too little of the fall.
    #[error(
        "laser: fewer than {FEWEST} samples within any {LASER_LENGTH} s between the release at {release:.4} s and the end at {end:.4} s"
    )]
    LaserWithoutSamples {
        /// Release of the impactor, s.
        release: f64,
        /// Last time of the laser, s.
        end: f64,
    },
    /// The laser counts downward.
    #[error("laser: it rises while the impactor falls; its values must count upward from the film's upper face")]
    LaserReversed,
    /// The motion that was fitted to the laser does not reach the film.
    #[error("laser: the motion fitted to it does not pass the film's upper face near {near:.4} s")]
    NoCrossing {
        /// Contact time about which the motion was fitted, s.
        near: f64,
    },
    /// The recorded fall is shorter than the height.
    #[error(
        "acceleration: integrated from rest it does not fall through {} m; check the height",
        significant(*height, 6)
    )]
    HeightNotCovered {
        /// Height of the fall, m.
        height: f64,
    },
    /// The recorded fall is slower than the speed.
    #[error("acceleration: integrated from rest it does not reach {} m/s; check the speed", significant(*speed, 6))]
    SpeedNotReached {
        /// Impact speed, m/s.
        speed: f64,
    },
    /// The acceleration does not rise at the end of the fall.
    #[error(
        "acceleration: there is no onset of the force near {near:.4} s, where the fall {}; check the {}",
        known.predicate(), known.name()
    )]
    NoOnset {
        /// Time near which the onset was sought, s.
        near: f64,
        /// Height or speed of the fall.
        known: FallCondition,
    },
    /// The offset that closes the fall is too many of its standard errors.
    #[error(
        "acceleration: a fall that {} would need the sensor's zero {offset:.3} m/s² off its mean at rest, which is known to {error:.4} m/s²; check the {}",
        known.predicate(), known.name()
    )]
    NotClosed {
        /// Height or speed of the fall.
        known: FallCondition,
        /// Change of the sensor's zero that closes the fall, m/s².
        offset: f64,
        /// Standard error of its mean at rest, m/s².
        error: f64,
    },
    /// The contact time of successive iterations differs.
    #[error("the contact time does not converge within {MOST_ITERATIONS} iterations")]
    NotSettled,
}

/// Fewest samples of the laser that a motion is fitted to.
const FEWEST: usize = 10;
/// Length of the interval about contact in which the laser counts, s.
const LASER_LENGTH: f64 = 0.08;
const MOST_ITERATIONS: u32 = 50;

/// Time at which a signal first falls to `level`, linear between samples.
fn falls_to(signal: &Series, level: f64) -> Option<f64> {
    let (time, z) = (signal.time(), signal.values());
    let k = (1..signal.len()).find(|k| z[k - 1] > level && z[*k] <= level)?;
    Some(time[k - 1] + (time[k] - time[k - 1]) * (z[k - 1] - level) / (z[k - 1] - z[k]))
}
