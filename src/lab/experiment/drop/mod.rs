//! The reduction of a drop test: from the readings of the sensors to contact, speed, travel and energies.

mod channels;
mod fit;
mod model;
mod recording;
#[cfg(test)]
mod recordings_tests;
mod reduce;
mod release;
mod result;
#[cfg(test)]
mod tests;

use crate::experiment::absorption::Body;

pub use channels::{Bridged, ChannelNames, DropChannels, Stated, bridged, longest_gap};
pub use reduce::reduce;
pub use release::{GravityRamp, Release};
pub use result::{Contact, Drop, Figures, Input, Intervals, Landmarks, SpeedSource};

/// The tower of a drop test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tower {
    /// Mass of the impactor, and gravity.
    pub body: Body,
    /// Height of fall over the film's upper face, m; none where speed or time of contact is known in its place.
    pub height: Option<f64>,
}

/// How the low frequencies that AC coupling removes are restored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Correction {
    /// The exact inverse of AC coupling with the time constant in s, or with the one that the recording shows.
    Coupling {
        /// Time constant τ of the sensor's high pass, s.
        time_constant: Option<f64>,
    },
    /// The release, mirrored and added after contact.
    Ramp,
}

impl Default for Correction {
    fn default() -> Correction {
        Correction::Coupling { time_constant: None }
    }
}

/// The channel frequency class of the filtered acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Class {
    /// The highest of 1000, 600, 180 and 60 that the rate of the samples allows.
    #[default]
    OfRate,
    /// This one.
    Given(f64),
    /// The acceleration stays as corrected.
    None,
}

/// How a recording is reduced, and what is known beside the height.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reduction {
    /// Correction of the acceleration.
    pub correction: Correction,
    /// Filter of the acceleration.
    pub class: Class,
    /// Impact speed where it is known, m/s, positive.
    pub speed: Option<f64>,
    /// Time of first contact where it is known, s, on the recording's clock.
    pub contact_time: Option<f64>,
    /// Standard deviation of the height, m.
    pub height_error: Option<f64>,
    /// Standard deviation of a speed that is known, m/s.
    pub speed_error: Option<f64>,
    /// Standard deviation of a time of first contact that is known, s.
    pub contact_error: Option<f64>,
    /// Friction of the guide and its standard deviation, N.
    pub guide_friction: Option<[f64; 2]>,
}

/// What is known of a drop before its recording is looked at: values with their standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    /// m.
    pub height: Option<[f64; 2]>,
    /// m/s.
    pub speed: Option<[f64; 2]>,
    /// s.
    pub contact_time: Option<[f64; 2]>,
    /// Over the weight.
    pub friction: Option<[f64; 2]>,
    /// Inverse time constant, 1/s.
    pub inverse: Option<f64>,
}

impl Known {
    /// Friction over the weight and its scale where nothing is known. Assumed.
    pub(super) const FRICTION: [f64; 2] = [0.01, 0.01];
    /// Share to which a height and a speed are known where no error is given: one standard deviation. Assumed.
    pub(super) const HEIGHT_ERROR: f64 = 0.005;
    const SPEED_ERROR: f64 = 0.005;

    /// Of a recording with samples `step` (s) apart.
    pub(super) fn new(tower: &Tower, reduction: &Reduction, step: f64) -> Known {
        let Reduction { speed, contact_time, height_error, speed_error, contact_error, guide_friction, .. } =
            *reduction;
        let weight = tower.body.mass * tower.body.gravity;
        let inverse = match reduction.correction {
            Correction::Coupling { time_constant } => time_constant.map(|given| 1.0 / given),
            Correction::Ramp => None,
        };
        Known {
            height: tower.height.map(|height| [height, height_error.unwrap_or(Known::HEIGHT_ERROR * height)]),
            speed: speed.map(|speed| [speed, speed_error.unwrap_or(Known::SPEED_ERROR * speed)]),
            contact_time: contact_time.map(|time| [time, contact_error.unwrap_or(0.5 * step)]),
            friction: guide_friction.map(|friction| friction.map(|force| force / weight)),
            inverse,
        }
    }
}
