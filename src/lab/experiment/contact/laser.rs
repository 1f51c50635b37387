//! First contact where a laser measured the impactor.

use super::{Contact, ContactError, FEWEST, MOST_ITERATIONS, SpeedSource, falls_to};
use crate::experiment::fit::least_squares;
use crate::signal::{Series, integrate};

/// Change of the contact time at which the iteration has converged, s.
const CONVERGED: f64 = 1e-6;
/// Interval about contact in which the laser counts, s: its first pass through the range, not the rebound.
const LASER_SPAN: [f64; 2] = [-0.02, 0.06];

/// Fits the motion to the `laser` (m, upward from the film's upper face; `NaN` out of its range).
///
/// `acceleration` gives the corrected acceleration (m/s²) for an assumed contact time (s). Each iteration fits its
/// double integral to the laser by linear least squares in place and speed; contact is where the fitted motion passes
/// zero. The iteration starts where the laser first measured after the `release` (s). Where that does not converge,
/// because the laser covers the whole fall, it starts at `ideal` (s), the contact time of the ideal fall.
///
/// # Errors
/// The laser has too few samples, is reversed, or does not pass zero; the contact time does not converge.
pub fn by_laser(
    acceleration: impl Fn(f64) -> Series,
    laser: &Series,
    release: f64,
    ideal: f64,
) -> Result<Contact, ContactError> {
    let search = |from: f64| converged(&acceleration, laser, first_pass(laser, release, from)?);
    search(release).or_else(|_| search(ideal.max(release)))
}

/// Contact after the iterations from the `assumed` time (s) on.
fn converged(acceleration: impl Fn(f64) -> Series, laser: &Series, mut assumed: f64) -> Result<Contact, ContactError> {
    for iterations in 1..=MOST_ITERATIONS {
        let pass = pass(laser, assumed);
        if pass.len() < FEWEST {
            return Err(ContactError::NoCrossing { near: assumed });
        }
        let motion = FittedMotion::fit(&acceleration(assumed), &pass, assumed)?;
        let (time, velocity) = motion.contact(assumed)?;
        // The window moves with the contact: at convergence the laser that decides is the one about contact, and the
        // correction by the ramp (equation 44) begins there.
        if (time - assumed).abs() < CONVERGED {
            let (laser_residual, speed_error) = (Some(motion.residual), Some(motion.speed_error));
            let speed_from = SpeedSource::Laser;
            return Ok(Contact { time, velocity, iterations, laser_residual, speed_error, speed_from });
        }
        assumed = time;
    }
    Err(ContactError::NotSettled)
}

/// Samples of the laser about the assumed contact.
fn pass(laser: &Series, assumed: f64) -> Vec<[f64; 2]> {
    let near = laser.window(LASER_SPAN.map(|span| assumed + span));
    near.samples().filter(|[_, place]| place.is_finite()).collect()
}

/// First time from `from` (s) on about which the laser has enough samples.
fn first_pass(laser: &Series, release: f64, from: f64) -> Result<f64, ContactError> {
    let end = laser.time().last().copied().unwrap_or(release);
    let measured = laser.samples().filter(|[t, place]| *t > from && place.is_finite()).map(|[t, _]| t);
    let found = std::iter::once(from).chain(measured).find(|place| pass(laser, *place).len() >= FEWEST);
    found.ok_or(ContactError::LaserWithoutSamples { release, end })
}

/// The motion that fits the laser best.
struct FittedMotion {
    velocity: Series,
    place: Series,
    /// Root mean square distance from the laser, m.
    residual: f64,
    /// Standard error of its speed by the scatter about it, m/s.
    speed_error: f64,
}

impl FittedMotion {
    fn fit(acceleration: &Series, pass: &[[f64; 2]], assumed: f64) -> Result<FittedMotion, ContactError> {
        let span = LASER_SPAN.map(|span| assumed + span);
        // The acceleration gives the shape of the motion: in equation 45 only place and speed at its beginning are
        // unknown, both linear, and the laser need not be differentiated.
        let velocity = integrate::once(&acceleration.window(span), 0.0);
        let place = integrate::once(&velocity, 0.0);
        let origin = place.time().first().copied().unwrap_or(assumed);
        let length = span[1] - span[0];
        let rows =
            pass.iter().filter_map(|[t, laser]| Some(([1.0, (t - origin) / length], laser - place.value_at(*t)?)));
        let fitted = least_squares(rows.clone()).ok_or(ContactError::NoCrossing { near: assumed })?;
        let ([at_origin, rise], left) = fitted;
        let speed = rise / length;
        let residual = (left / rows.clone().count() as f64).sqrt();
        let count = rows.clone().count() as f64;
        // Variance of a slope: that of a sample over the sum of squares of the times about their mean.
        let mean = rows.clone().map(|([_, s], _)| s).sum::<f64>() / count;
        let spread = rows.map(|([_, s], _)| (s - mean).powi(2)).sum::<f64>();
        let speed_error = residual / spread.sqrt() / length;
        let velocity = integrate::once(&acceleration.window(span), speed);
        let place = integrate::once(&velocity, at_origin);
        Ok(FittedMotion { velocity, place, residual, speed_error })
    }

    /// Time and velocity at which it first falls to zero.
    fn contact(&self, assumed: f64) -> Result<(f64, f64), ContactError> {
        let missing = || ContactError::NoCrossing { near: assumed };
        let time = falls_to(&self.place, 0.0).ok_or_else(|| match self.velocity.values().first() {
            Some(velocity) if *velocity > 0.0 => ContactError::LaserReversed,
            _ => missing(),
        })?;
        Ok((time, self.velocity.value_at(time).ok_or_else(missing)?))
    }
}
