//! The impact of a drop from contact on: its motion and energies, and checks of its figures, which change none.

use super::result::Contact;
use crate::error::{Error, refusal};
use crate::experiment::Warning;
use crate::experiment::absorption::Body;
use crate::experiment::fit::least_squares;
use crate::signal::{Channel, Recording, Series, column, integrate, resample};

/// The channels on a time axis that starts at contact.
pub(super) fn signals(
    corrected: &Series,
    filtered: &Series,
    contact: &Contact,
    body: Body,
) -> Result<Recording, Error> {
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
fn axes(corrected: &Series, contact: f64) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let ends = || refusal!("acceleration: the recording ends with first contact at {contact:.4} s");
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

/// Distance of laser and integrated acceleration (m) beyond which they show different motions.
const LASER_APART: f64 = 1e-3;
/// Share of the ideal fall's speed below which friction would have dissipated most of the energy.
const SLOW: f64 = 0.5;
/// Change of the zero over the record (m/s²) that is reported, and how many of its standard errors it must be.
const ZERO_MOVES: f64 = 0.1;
const STANDARD_ERRORS: f64 = 5.0;

/// The figures of a drop that are checked.
pub(super) struct Impact<'a> {
    /// First contact.
    pub contact: &'a Contact,
    /// Speed of the ideal fall, m/s.
    pub ideal_speed: f64,
    /// Signals from contact on.
    pub signals: &'a Recording,
    /// D of equation 26, and its interval of 95 %.
    pub energy_absorption: Option<f64>,
    pub absorption_interval: Option<[f64; 2]>,
}

/// Reports that put an `impact` in doubt, from its figures and from the `reading` (m/s²) that it was reduced from, at
/// rest until `rest_end` (s).
pub(super) fn warnings(impact: &Impact<'_>, reading: &Series, rest_end: f64) -> Vec<Warning> {
    [absorption(impact), laser(impact), slow(impact), late_peak(impact), moving_zero(reading, rest_end)]
        .into_iter()
        .flatten()
        .collect()
}

fn absorption(impact: &Impact<'_>) -> Option<Warning> {
    // One near none is impossible only where its interval does not reach what is possible.
    let absorption = impact.energy_absorption?;
    let [low, high] = impact.absorption_interval.unwrap_or([absorption; 2]);
    if high >= 0.0 && low <= 1.0 {
        return None;
    }
    Some(Warning::ImpossibleAbsorption { absorption })
}

fn laser(impact: &Impact<'_>) -> Option<Warning> {
    let residual = impact.contact.laser_residual.filter(|residual| *residual > LASER_APART)?;
    Some(Warning::LaserMismatch { residual })
}

fn slow(impact: &Impact<'_>) -> Option<Warning> {
    let share = -impact.contact.velocity / impact.ideal_speed;
    (share < SLOW).then_some(Warning::SlowImpact { share })
}

fn late_peak(impact: &Impact<'_>) -> Option<Warning> {
    let [lowest_point, _] = impact.signals.series(column::DISPLACEMENT.name)?.smallest()?;
    let [peak, _] = impact.signals.series(column::ACCELERATION_FILTERED.name)?.largest()?;
    (peak > 1.2 * lowest_point).then_some(Warning::LatePeak { peak, lowest_point })
}

/// A zero that drifts at rest drifts later too.
fn moving_zero(reading: &Series, rest_end: f64) -> Option<Warning> {
    let rest = reading.window([f64::NEG_INFINITY, rest_end]);
    let &[first, .., last] = rest.time() else {
        return None;
    };
    let count = rest.len() as f64;
    let span = last - first;
    let samples = rest.time().iter().zip(rest.values());
    let ([_, rise], left) = least_squares(samples.map(|(t, r)| ([1.0, (t - first) / span - 0.5], *r)))?;
    // Of a slope over 0 to 1 in `count` even steps the variance is twelve times that of a sample over their number.
    let standard_error = (12.0 * left / count / count).sqrt();
    let over_record = rise / span * (reading.time().last()? - first);
    let moves = over_record.abs() > ZERO_MOVES && rise.abs() > STANDARD_ERRORS * standard_error;
    moves.then_some(Warning::ZeroDrift { rate: rise / span, over_record })
}
