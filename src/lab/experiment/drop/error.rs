//! Why a recording of a drop cannot be reduced.

use thiserror::Error;

use super::ramp::RampError;
use super::release::ReleaseError;
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
    /// The samples are too far apart for a drop.
    #[error(
        "acceleration: its samples are {} s apart, too far for an impact; are the times in milliseconds?",
        significant(*step, 6)
    )]
    TooSlow {
        /// Time between two samples, s.
        step: f64,
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
    /// Nothing says how far the impactor fell, or how fast it became.
    #[error("neither height, impact speed nor time of contact is known")]
    NothingKnown,
    /// No motion explains the recording.
    #[error(
        "acceleration: no rest, release, fall and impact explain the reading between {from:.4} s and {to:.4} s; check column and unit"
    )]
    NoFit {
        /// First time of the recording, s.
        from: f64,
        /// End of the onset of the force, s.
        to: f64,
    },
    /// What is known excludes the fall that was recorded.
    #[error(
        "acceleration: the fall that was recorded has {what} {} ± {} {unit}, not {} {unit}; check the {what}, the column \
         and its unit",
        significant(*found, 4), significant(*error, 2), significant(*stated, 6)
    )]
    Contradicts {
        /// The height, the impact speed or the time of contact.
        what: &'static str,
        /// Its unit.
        unit: &'static str,
        /// As the recording shows it.
        found: f64,
        /// Two standard deviations of that.
        error: f64,
        /// As it was given.
        stated: f64,
    },
    /// Something other than film stopped the fall.
    #[error(
        "acceleration: the reading leaves the fall at {time:.4} s, {} ms before the contact at {contact:.4} s that the rest of it shows: the \
         impactor touched something there, or height, time constant, mass or column are others",
        significant(1e3 * (contact - time), 3)
    )]
    NoFall {
        /// When it leaves the fall, s.
        time: f64,
        /// Time of the contact that was found, s.
        contact: f64,
    },
    /// What the impactor met is not pressed as film is.
    #[error(
        "acceleration: from the contact at {contact:.4} s on no force that grows with the travel explains the reading at {time:.4} s: the impactor \
         met something else first, or twice, or height, time constant, mass or column are others"
    )]
    NoOnset {
        /// Where the reading is off, s.
        time: f64,
        /// Time of the contact that was found, s.
        contact: f64,
    },
    /// The recording has no samples after first contact.
    #[error("acceleration: the recording ends with first contact at {contact:.4} s")]
    EndsAtContact {
        /// Time of first contact, s.
        contact: f64,
    },
}
