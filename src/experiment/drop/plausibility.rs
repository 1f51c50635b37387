//! What makes a reduced drop doubtful. Its figures stand; whoever reads them should look first.

use super::Drop;
use crate::experiment::fit::least_squares;
use crate::signal::{Series, column};

/// Laser and integrated acceleration that are further apart (m) do not show one motion.
const LASER_APART: f64 = 1e-3;
/// Share of the ideal fall's speed below which the guide would have taken more than it left.
const SLOW: f64 = 0.5;
/// A reading that stands still at its largest value for longer (s) has met the end of its range.
const FLAT: f64 = 2e-3;
/// Change of the zero over the record (m/s²) that is worth a word, and how many of its standard errors it must be.
const ZERO_MOVES: f64 = 0.1;
const STANDARD_ERRORS: f64 = 5.0;

/// Doubts about `drop`, from its figures and from the `reading` (m/s²) that it was reduced from, at rest until `rest_end` (s).
pub(super) fn doubts(drop: &Drop, reading: &Series, rest_end: f64) -> Vec<String> {
    [absorption(drop), laser(drop), slow(drop), late_peak(drop), saturated(reading), moving_zero(reading, rest_end)]
        .into_iter()
        .flatten()
        .collect()
}

fn absorption(drop: &Drop) -> Option<String> {
    let absorption = drop.energy_absorption.filter(|d| !(0.0..=1.0).contains(d))?;
    Some(format!(
        "an energy absorption of {:.1} % is impossible: laser, time constant and zero of the sensor do not fit together",
        100.0 * absorption
    ))
}

fn laser(drop: &Drop) -> Option<String> {
    let apart = drop.contact.laser_residual.filter(|apart| *apart > LASER_APART)?;
    Some(format!(
        "laser and integrated acceleration are {:.2} mm apart: check the laser's unit, its zero and what it writes out of range",
        1e3 * apart
    ))
}

fn slow(drop: &Drop) -> Option<String> {
    let share = -drop.contact.velocity / drop.ideal_speed;
    (share < SLOW).then(|| format!("the impact speed is {:.0} % of the ideal fall's", 100.0 * share))
}

fn late_peak(drop: &Drop) -> Option<String> {
    let [turn, _] = drop.signals.series(column::DISPLACEMENT.name)?.smallest()?;
    let [peak, _] = drop.signals.series(column::ACCELERATION_FILTERED.name)?.largest()?;
    (peak > 1.2 * turn).then(|| {
        format!(
            "the largest acceleration, at {:.1} ms, is not that of the impact, which turned the impactor at {:.1} ms",
            1e3 * peak,
            1e3 * turn
        )
    })
}

fn saturated(reading: &Series) -> Option<String> {
    let [_, largest] = reading.largest()?;
    let (time, values) = (reading.time(), reading.values());
    let runs = values.chunk_by(|a, b| a == b).scan(0, |first, run| {
        *first += run.len();
        Some((*first - run.len(), run))
    });
    let flat = runs.filter(|(_, run)| run[0] == largest);
    let longest = flat.map(|(first, run)| time[first + run.len() - 1] - time[first]).fold(0.0, f64::max);
    (longest > FLAT).then(|| {
        format!("the accelerometer reads {largest:.1} m/s2 for {:.1} ms: the end of its range?", 1e3 * longest)
    })
}

/// A zero that moves while the impactor rests will have moved on.
fn moving_zero(reading: &Series, rest_end: f64) -> Option<String> {
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
    moves.then(|| {
        format!(
            "the reading at rest drifts by {:.2} m/s2 per second, {over_record:.2} m/s2 over the record",
            rise / span
        )
    })
}
