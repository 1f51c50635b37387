//! Checks of a reduced drop. They change no figure.

use super::result::Contact;
use crate::experiment::Warning;
use crate::experiment::fit::least_squares;
use crate::signal::{Recording, Series, column};

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
