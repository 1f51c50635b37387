//! First contact where height or speed of the fall is known.

use super::onset::{onset, step};
use super::{Contact, ContactError, FallCondition, MOST_ITERATIONS, SpeedSource, ZeroOffset, falls_to};
use crate::signal::{Series, integrate};

/// Last part of the fall, over which the rate at the known height or speed is taken, s.
const RATE_OVER: f64 = 0.01;

impl FallCondition {
    /// The integral of an acceleration that reaches [`FallCondition::level`] at contact.
    fn integral(self, acceleration: &Series) -> Series {
        match self {
            FallCondition::Height(_) => integrate::twice(acceleration, 0.0, 0.0),
            FallCondition::Speed(_) => integrate::once(acceleration, 0.0),
        }
    }

    fn level(self) -> f64 {
        match self {
            FallCondition::Height(value) | FallCondition::Speed(value) => -value,
        }
    }

    fn speed_from(self) -> SpeedSource {
        match self {
            FallCondition::Height(_) => SpeedSource::Fall,
            FallCondition::Speed(_) => SpeedSource::Given,
        }
    }

    fn not_met(self) -> ContactError {
        match self {
            FallCondition::Height(height) => ContactError::HeightNotCovered { height },
            FallCondition::Speed(speed) => ContactError::SpeedNotReached { speed },
        }
    }
}

/// First contact at the end of a fall that meets its condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedFall {
    /// First contact.
    pub contact: Contact,
    /// Offset beyond the mean of the rest that closes the fall, m/s².
    pub offset: f64,
    /// The offset is larger than the scatter of the rest explains.
    pub doubtful: bool,
}

/// An offset is doubtful, or refused, beyond so many standard errors and so large a share of what is known.
const DOUBTFUL: [f64; 2] = [5.0, 0.0025];
const REFUSED: [f64; 2] = [10.0, 0.01];

/// Closes a fall without laser: from rest to what is `known` of it, with the sensor's offset as the unknown.
///
/// `acceleration` gives the corrected acceleration (m/s²) from rest on, for an offset (m/s²) beyond the mean of the
/// rest, the sensor's `zero`. Each iteration locates the onset of the force near the time at which the fall meets the
/// condition, and chooses the offset with which it is met at the onset.
///
/// # Errors
/// The recorded fall does not meet the condition, no onset ends it, or only an offset far beyond the scatter of the
/// rest would close it; the contact time does not converge.
pub fn by_fall(
    acceleration: impl Fn(f64) -> Series,
    known: FallCondition,
    zero: ZeroOffset,
) -> Result<ClosedFall, ContactError> {
    let integral = |offset: f64| known.integral(&acceleration(offset));
    let reached_at = |offset: f64, time: f64| integral(offset).value_at(time).ok_or(known.not_met());
    let fallen = falls_to(&integral(0.0), known.level()).ok_or(known.not_met())?;
    let rate = (reached_at(0.0, fallen)? - reached_at(0.0, fallen - RATE_OVER)?) / RATE_OVER;
    // The integral is linear in the offset.
    let per_offset = reached_at(1.0, fallen)? - reached_at(0.0, fallen)?;
    // Noise moves the mean of the rest, and the integral of the fall as much again. Both are proportional to the noise,
    // and the residual of the onset to its square.
    let weight = 0.5 * zero.samples as f64 * (rate / per_offset).powi(2);
    let (mut offset, mut assumed) = (0.0, fallen);
    for iterations in 1..=MOST_ITERATIONS {
        let corrected = acceleration(offset);
        let time = onset(&corrected, assumed, |time| weight * (time - fallen).powi(2));
        let time = time.ok_or(ContactError::NoOnset { near: assumed, known })?;
        let (without, with) = (reached_at(0.0, time)?, reached_at(1.0, time)?);
        offset = (known.level() - without) / (with - without);
        // Between two samples all onsets are equal, so that the iterations may alternate between neighbours.
        if (time - assumed).abs() <= 1.01 * step(&corrected) {
            let beyond = |[errors, share]: [f64; 2]| {
                offset.abs() > errors * zero.error() && (offset * per_offset / known.level()).abs() > share
            };
            if beyond(REFUSED) {
                return Err(ContactError::NotClosed { known, offset, error: zero.error() });
            }
            let velocity = integrate::once(&acceleration(offset), 0.0).value_at(time).ok_or(known.not_met())?;
            let speed_from = known.speed_from();
            let contact = Contact { time, velocity, iterations, laser_residual: None, speed_error: None, speed_from };
            return Ok(ClosedFall { contact, offset, doubtful: beyond(DOUBTFUL) });
        }
        assumed = time;
    }
    Err(ContactError::NotSettled)
}
