//! The tower of a drop test, and how its recording is reduced.

use crate::experiment::absorption::Body;
use crate::experiment::contact::FallCondition;

/// The tower of a drop test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tower {
    /// Mass of the impactor, and gravity.
    pub body: Body,
    /// Height of fall, m.
    pub height: Height,
}

/// Where the fall begins above the film's upper face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// As set on the tower, m.
    Known(f64),
    /// Unknown: the height of the ideal fall that reaches the known impact speed, m.
    OfSpeed(f64),
}

impl Height {
    /// Unknown beside a known impact speed (m/s), under `gravity` (m/s²).
    pub fn of_speed(speed: f64, gravity: f64) -> Height {
        Height::OfSpeed(0.5 * speed * speed / gravity)
    }

    pub(super) fn metres(self) -> f64 {
        match self {
            Height::Known(height) | Height::OfSpeed(height) => height,
        }
    }
}

impl Tower {
    /// Speed of the ideal fall √(2gH), m/s.
    pub(super) fn ideal_speed(&self) -> f64 {
        (2.0 * self.body.gravity * self.height.metres()).sqrt()
    }

    /// The condition of a fall without a laser.
    pub(super) fn known(&self) -> FallCondition {
        match self.height {
            Height::Known(height) => FallCondition::Height(height),
            Height::OfSpeed(_) => FallCondition::Speed(self.ideal_speed()),
        }
    }
}

/// How the low frequencies that AC coupling removes are restored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Correction {
    /// The exact inverse of AC coupling with the time constant in s, or with the one fitted to the fall.
    Coupling {
        /// Time constant τ of the sensor's high pass, s; fitted to the fall where none is given.
        time_constant: Option<f64>,
    },
    /// The release, mirrored and added after contact.
    Ramp,
}

/// First contact as it is known from elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownContact {
    /// s, on the recording's clock.
    pub time: f64,
    /// Impact speed, m/s, positive.
    pub speed: f64,
}

/// How a recording is reduced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduction {
    /// Correction of the acceleration.
    pub correction: Correction,
    /// Channel frequency class of the filtered acceleration; none leaves it as corrected.
    pub class: Option<f64>,
    /// First contact where it is known; laser and fall are not used for it then.
    pub contact: Option<KnownContact>,
}

impl Default for Reduction {
    /// Coupling with the fall's own time constant, CFC 1000.
    fn default() -> Reduction {
        Reduction { correction: Correction::Coupling { time_constant: None }, class: Some(1000.0), contact: None }
    }
}
