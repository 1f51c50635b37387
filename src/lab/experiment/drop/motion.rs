//! Motion and energies from contact on.

use super::error::DropError;
use super::result::Contact;
use crate::experiment::absorption::Body;
use crate::signal::{Channel, Recording, Series, column, integrate, resample};

/// The channels on a time axis that starts at contact.
pub(super) fn signals(
    corrected: &Series,
    filtered: &Series,
    contact: &Contact,
    body: Body,
) -> Result<Recording, DropError> {
    let (axis, clock) = axes(corrected, contact.time)?;
    let acceleration = Series::new(axis.as_slice(), resample::onto(corrected, &clock));
    let velocity = integrate::once(&acceleration, contact.velocity);
    let displacement = integrate::once(&velocity, 0.0);
    let motion = || velocity.values().iter().zip(displacement.values());
    let kinetic: Vec<f64> = velocity.values().iter().map(|v| 0.5 * body.mass * v * v).collect();
    let potential: Vec<f64> = displacement.values().iter().map(|d| body.mass * body.gravity * d).collect();
    let filtered = resample::onto(filtered, &clock);
    // Of the filtered signal: with the one that was integrated the total would be constant by construction.
    let absorbed = work(body, &filtered, displacement.values());
    let total = motion().zip(&absorbed).map(|((v, d), w)| body.energy(*v, *d) + w).collect();
    let channels = [
        (column::DISPLACEMENT.name, displacement.values().to_vec()),
        (column::VELOCITY.name, velocity.values().to_vec()),
        (column::ACCELERATION.name, acceleration.values().to_vec()),
        (column::ACCELERATION_FILTERED.name, filtered),
        (column::KINETIC_ENERGY.name, kinetic),
        (column::POTENTIAL_ENERGY.name, potential),
        (column::ABSORBED_ENERGY.name, absorbed),
        (column::TOTAL_ENERGY.name, total),
    ];
    let channels = channels.map(|(name, values)| Channel { name: name.into(), values });
    Ok(Recording { time: axis, channels: channels.into() })
}

/// Times from contact on in steps of the recording, and the same times on its clock; s.
fn axes(corrected: &Series, contact: f64) -> Result<(Vec<f64>, Vec<f64>), DropError> {
    let ends = || DropError::EndsAtContact { contact };
    let &[first, .., last] = corrected.time() else {
        return Err(ends());
    };
    let step = (last - first) / (corrected.len() - 1) as f64;
    let count = ((last - contact) / step).floor();
    if count.is_nan() || count < 2.0 {
        return Err(ends());
    }
    let axis: Vec<f64> = (0..=count as usize).map(|i| i as f64 * step).collect();
    let clock = axis.iter().map(|t| (contact + t).min(last)).collect();
    Ok((axis, clock))
}

/// Work that the film has taken from the impactor, W = −∫M(a + g) dd, J.
fn work(body: Body, a: &[f64], d: &[f64]) -> Vec<f64> {
    let mut taken = 0.0;
    let steps = (1..a.len()).map(|i| {
        taken -= body.mass * (0.5 * (a[i] + a[i - 1]) + body.gravity) * (d[i] - d[i - 1]);
        taken
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// Largest deviation of the total energy from its first value, over that.
pub(super) fn drift(total: &[f64]) -> f64 {
    let first = total.first().copied().unwrap_or(f64::NAN);
    total.iter().map(|e| (e - first).abs()).fold(0.0, f64::max) / first.abs()
}
