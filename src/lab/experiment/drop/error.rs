//! Why a recording of a drop cannot be reduced.

use thiserror::Error;

use crate::experiment::contact::ContactError;
use crate::experiment::coupling::CouplingError;
use crate::experiment::ramp::RampError;
use crate::experiment::release::ReleaseError;
use crate::signal::filter::FilterError;
use crate::signal::gap::Gap;
use crate::signal::resample::ResampleError;
use base::number::significant;

/// Why a recording cannot be reduced.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DropError {
    /// A quantity of the tower or of the correction is not positive.
    #[error("the {what} is {}, but must be positive", significant(*value, 6))]
    NotPositive {
        /// Mass, gravity, height or time constant, as the message names it.
        what: &'static str,
        /// Its value in the SI unit.
        value: f64,
    },
    /// The acceleration has a gap.
    #[error("acceleration: {0}")]
    NotMeasured(Gap),
    /// The channel filter cannot be applied to the acceleration.
    #[error("acceleration: {0}")]
    Filter(#[from] FilterError),
    /// The acceleration cannot be brought to equal steps.
    #[error("acceleration: {0}")]
    Resample(#[from] ResampleError),
    /// The recording has no rest, release or impact.
    #[error(transparent)]
    Release(#[from] ReleaseError),
    /// The recording has no gravity ramp.
    #[error(transparent)]
    Ramp(#[from] RampError),
    /// The time constant cannot be determined.
    #[error("acceleration: {0}; give the time constant (a DC-coupled sensor has an endless one, such as 1000 s)")]
    Coupling(#[from] CouplingError),
    /// First contact cannot be determined.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The impact speed is above that of the ideal fall by more than an error of measurement.
    #[error(
        "the impact speed of {speed:.3} m/s is above the {ideal:.3} m/s of a free fall over {} m; check the height",
        significant(*height, 6)
    )]
    FasterThanFall {
        /// Impact speed, m/s.
        speed: f64,
        /// Speed of the ideal fall √(2gH), m/s.
        ideal: f64,
        /// Height H of the fall, m.
        height: f64,
    },
    /// The contact time that is known is not one of this fall.
    #[error(
        "the contact time of {contact:.4} s lies outside the fall, from the release at {release:.4} s to the impact at {impact:.4} s"
    )]
    ContactOutsideFall {
        /// As known, s.
        contact: f64,
        /// Release of the impactor, s.
        release: f64,
        /// Time at which the reading has risen by one gravity in the impact, s.
        impact: f64,
    },
    /// The correction by the gravity ramp does not close a fall without laser.
    #[error("the gravity ramp needs a laser for the impact speed: use the correction by coupling")]
    LaserNeeded,
    /// The recording has no samples after first contact.
    #[error("acceleration: the recording ends with first contact at {contact:.4} s")]
    EndsAtContact {
        /// Time of first contact, s.
        contact: f64,
    },
}
