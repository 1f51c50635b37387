//! The rest before a drop, the release, and the impact that ends the fall; the gravity ramp of the release.
//!
//! The ramp is the parabolic decrease of the reading during the release, mirrored and added after contact (Polymers 2021,
//! 13, 1537, section 3.2). It replaces gravity in the reading of an accelerometer that reads zero in free fall. It repeats
//! the shape of the release and neglects the shift of the sensor's zero in the impact, −(1/τ)∫p dt.

use super::result::{Contact, Drop};
use crate::error::{Error, Kind, refusal};
use crate::experiment::Warning;
use crate::experiment::absorption::Body;
use crate::experiment::fit::least_squares;
use crate::signal::{Channel, Recording, Series, column, gap, integrate, resample};

/// Length of the means in which landmarks are sought, s; figures come from the reading itself. A channel filter would put
/// a fall before a short peak where there is none.
const SMOOTHED: f64 = 5e-3;
/// Shortest rest that gives the sensor's zero, s.
const SHORTEST_REST: f64 = 0.02;
/// Time between the rest and the first sample that may belong to the release, s.
const MARGIN: f64 = 0.005;
/// Share of gravity by which the reading falls in a release.
const FALL: f64 = 0.3;
/// A fall of so many times the rise of the reading, or of gravity, is the impact on a sensor that counts downward.
const UPSIDE_DOWN: f64 = 2.0;
/// Rise above the rest, in gravities, that is an impact.
const IMPACT: f64 = 1.0;

/// Share of the largest rise below which a peak is a knock.
const KNOCK: f64 = 0.25;

/// Time before and after a knock that a mask covers, s.
const AROUND_KNOCK: f64 = 0.01;

/// Depths of a fall in gravities that show another unit: m/s² read as g, and g read as m/s².
const OF_OTHER_UNIT: [[f64; 2]; 2] = [[7.5, 12.0], [0.08, 0.12]];

/// Change from the rest, in gravities, that no release makes.
const LEAVES: f64 = 1.3;
/// Shortest time from the beginning of a recording to its impact, s: that of a rest, a release and a fall of 3 cm.
const SHORTEST_FALL: f64 = 0.1;

/// Landmarks of a drop in the reading of an accelerometer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Release {
    /// Mean reading at rest, m/s²: the sensor's zero.
    pub offset: f64,
    /// Standard deviation of a sample at rest about a straight line, m/s².
    pub noise: f64,
    /// End of the rest, s.
    pub rest_end: f64,
    /// Where the reading falls: from a tenth to nearly all of the depth that it reaches, s.
    pub flank: [f64; 2],
    /// When the reading has risen by one gravity in the impact, s; on a soft film well after contact.
    pub impact: f64,
    /// Time of the first peak of the impact, s.
    pub peak: f64,
}

impl Release {
    /// Finds the landmarks in a complete `reading` (m/s²) on equal steps, under `gravity` (m/s²). In one
    /// piece, since each refusal states what was found before it.
    pub fn find(reading: &Series, gravity: f64) -> Result<Release, Error> {
        let smooth = smoothed(reading)?;
        let (time, values) = (smooth.time(), smooth.values());
        let level = level(&smooth);
        let peak = smooth.largest().unwrap_or([f64::NAN, f64::NAN]);
        let largest = peak[1] - level;
        let lowest = level - smooth.smallest().unwrap_or(peak)[1];
        // A release changes the reading by one gravity at most.
        let change = change(&smooth);
        if change > LEAVES * gravity {
            return Err(begins_late(change, SHORTEST_REST));
        }
        if lowest > UPSIDE_DOWN * largest.max(gravity) {
            let leaves = smooth.samples().find(|[_, v]| (v - level).abs() > LEAVES * gravity);
            let within = leaves.map_or(f64::INFINITY, |[t, _]| t - time[0]);
            if within < SHORTEST_FALL {
                return Err(begins_late(LEAVES * gravity, within));
            }
            return Err(refusal!(
                "acceleration: the impact reads {lowest:.1} m/s² downward; deceleration must be positive, so the sign looks \
                 reversed"
            )
            .with_hint("--invert turns the sensor round, and so does `invert = true` in `[reference]`"));
        }
        if largest.is_nan() || largest < IMPACT * gravity {
            return Err(refusal!(
                "acceleration: there is no contact: the largest reading is {largest:.2} m/s² above the first, less than 1 g"
            ));
        }
        let first_peak = first_peak(values, level, largest, IMPACT * gravity);
        let risen = values[..first_peak].iter().rposition(|v| v - level < IMPACT * gravity).unwrap_or(0);
        let impact = time[risen];
        let depth = values[..=risen].iter().map(|v| level - v).fold(0.0, f64::max);
        let units = [("m/s²", "g"), ("g", "m/s²")];
        for ([low, high], (is, read)) in OF_OTHER_UNIT.into_iter().zip(units) {
            if (low..=high).contains(&(depth / gravity)) {
                return Err(refusal!(
                    "acceleration: the reading falls by {depth:.2} m/s² after the release, where a fall has 9.81: it looks \
                     as if it were in {is} and was read in {read}"
                )
                .with_hint(format!(
                    "--unit {is} where the header states none; else name the columns, such as --columns \"time [s],a [{is}]\""
                )));
            }
        }
        if depth < FALL * gravity {
            return Err(refusal!(
                "acceleration: there is no release before the impact at {impact:.4} s: the reading falls by {depth:.2} m/s² \
                 at most"
            )
            .with_hint(format!(
                "{BEGINS_WITH_REST}; if the peak at {:.4} s is a knock and not the impact, leave it out: --mask \"{:.0} ms..{:.0} ms\"",
                time[first_peak],
                1e3 * (impact - AROUND_KNOCK),
                1e3 * (time[first_peak] + AROUND_KNOCK)
            ))
            .with_kind(Kind::NoRelease(impact)));
        }
        let fallen = |share: f64| values.iter().position(|v| level - v >= share * depth).unwrap_or(0);
        let bottom = fallen(0.95);
        let top = values[..bottom].iter().rposition(|v| level - v < 0.1 * depth).unwrap_or(0);
        let rest_end = time[top] - MARGIN;
        let rest = reading.window([f64::NEG_INFINITY, rest_end]);
        let length = rest_end - time[0];
        if rest.len() < 2 || length < SHORTEST_REST {
            let (rest, release) = (length.max(0.0), time[top]);
            return Err(refusal!(
                "acceleration: {rest:.4} s of rest before the release at {release:.4} s, at least {SHORTEST_REST} s are \
                 needed for the sensor's zero"
            )
            .with_hint(BEGINS_WITH_REST)
            .with_kind(Kind::NoRest(release)));
        }
        let offset = rest.values().iter().sum::<f64>() / rest.len() as f64;
        let centred = rest.samples().map(|[t, r]| ([1.0, (t - time[0]) / length - 0.5], r - offset));
        let left = least_squares(centred).map_or(0.0, |(_, left)| left);
        let noise = (left / (rest.len() - 1) as f64).sqrt();
        let flank = [time[top], time[bottom]];
        Ok(Release { offset, noise, rest_end, flank, impact, peak: time[first_peak] })
    }
}

/// What helps where the beginning of a drop is missing.
const BEGINS_WITH_REST: &str = "the recording must begin with the rest before the release";

/// The refusal of a reading that changes by more than a release makes within a time (s) of its first sample.
fn begins_late(change: f64, within: f64) -> Error {
    refusal!(
        "acceleration: the recording begins after contact: the reading changes by {change:.1} m/s² in the first {:.0} ms, \
         where the impactor should be at rest or fall",
        1e3 * within
    )
    .with_hint(BEGINS_WITH_REST)
}

/// Means over [`SMOOTHED`] about each sample.
fn smoothed(reading: &Series) -> Result<Series, Error> {
    gap::check(reading).map_err(|gap| Error::from(gap).about("acceleration"))?;
    let values = reading.values();
    let step = reading.time().windows(2).next().map_or(f64::INFINITY, |pair| pair[1] - pair[0]);
    let half = (0.5 * SMOOTHED / step) as usize;
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(values.iter().scan(0.0, |sum, value| {
            *sum += value;
            Some(*sum)
        }))
        .collect();
    let mean = |i: usize| {
        let [from, to] = [i.saturating_sub(half), (i + half + 1).min(values.len())];
        (sums[to] - sums[from]) / (to - from) as f64
    };
    Ok(reading.with_values((0..values.len()).map(mean).collect()))
}

/// Place of the first peak of the impact: the largest of the `values` before they fall to half of their rise above the
/// `level`. Peaks below a share of the `largest` rise, or below `least`, are knocks.
fn first_peak(values: &[f64], level: f64, largest: f64, least: f64) -> usize {
    let mut peak = 0;
    for (i, value) in values.iter().enumerate() {
        let [rise, most] = [value - level, values[peak] - level];
        if most > least.max(KNOCK * largest) && rise < 0.5 * most {
            break;
        }
        if rise > most {
            peak = i;
        }
    }
    peak
}

/// Largest less smallest of the first samples.
fn change(smooth: &Series) -> f64 {
    let head = head(smooth);
    let value = |extreme: Option<[f64; 2]>| extreme.map_or(0.0, |[_, value]| value);
    value(head.largest()) - value(head.smallest())
}

/// Mean of the first samples, as long as the length of the rest is unknown.
fn level(smooth: &Series) -> f64 {
    let head = head(smooth);
    head.values().iter().sum::<f64>() / head.len().max(1) as f64
}

fn head(smooth: &Series) -> Series {
    let first = smooth.time().first().copied().unwrap_or(0.0);
    smooth.window([first, first + SHORTEST_REST])
}

/// The paper adds the ramp over the first 50 ms after contact.
pub const ADDED_OVER: f64 = 0.05;

/// A parabola that leaves zero, r = −depth (2s − s²) with s = (t − start)/duration, and ends at its vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityRamp {
    /// When the reading leaves zero, s.
    pub start: f64,
    /// s.
    pub duration: f64,
    /// m/s², positive.
    pub depth: f64,
}

impl GravityRamp {
    /// Fits the parabola to the flank of a `reading` (offset removed) between `from` and `to`, s.
    pub fn fit(reading: &Series, [from, to]: [f64; 2]) -> Result<GravityRamp, Error> {
        let refused = |what: &str| refusal!("acceleration: the reading between {from:.4} s and {to:.4} s {what}");
        let flank = reading.window([from, to]);
        // Time in lengths of the flank: columns of one magnitude.
        let length = to - from;
        let rows = flank.samples().map(|[t, r]| ((t - from) / length, r)).map(|(u, r)| ([1.0, u, u * u], r));
        let fit = least_squares(rows);
        let ([c, b, a], _) = fit.ok_or_else(|| refused("has too few samples for the gravity ramp"))?;
        let vertex = -b / (2.0 * a);
        let depth = a * vertex * vertex - c;
        // Only a flank that bends upward has its vertex at the bottom, where the magnet lets go.
        if a.is_nan() || a <= 0.0 || depth <= 0.0 || vertex <= 0.0 {
            return Err(refused("does not flatten out as a gravity ramp does"));
        }
        // The parabola in the form a (u − vertex)² − depth, which is zero a width before its vertex.
        let width = (depth / a).sqrt();
        Ok(GravityRamp { start: from + length * (vertex - width), duration: length * width, depth })
    }

    /// Reading of the release at time `t` (s): zero before it, −depth from its vertex on.
    pub fn reading_at(&self, t: f64) -> f64 {
        let s = ((t - self.start) / self.duration).clamp(0.0, 1.0);
        -self.depth * (2.0 * s - s * s)
    }

    /// Correction at time `t` (s) where contact was at `contact` (s): −depth up to contact, then the release
    /// mirrored, back to zero after its duration or after `ADDED_OVER`.
    pub fn mirrored(&self, t: f64, contact: f64) -> f64 {
        let since = (t - contact).max(0.0);
        if since > ADDED_OVER { 0.0 } else { self.reading_at(self.start + self.duration - since) }
    }
}

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

/// Reports that put a reduced `drop` in doubt, from its figures and from the `reading` (m/s²) that it was reduced from, at
/// rest until `rest_end` (s).
pub(super) fn warnings(drop: &Drop, reading: &Series, rest_end: f64) -> Vec<Warning> {
    let mismatch = drop.contact.laser_residual.filter(|residual| *residual > LASER_APART);
    let mismatch = mismatch.map(|residual| Warning::LaserMismatch { residual });
    let share = -drop.contact.velocity / drop.ideal_speed;
    let slow = (share < SLOW).then_some(Warning::SlowImpact { share });
    [impossible_absorption(drop), mismatch, slow, late_peak(drop), moving_zero(reading, rest_end)]
        .into_iter()
        .flatten()
        .collect()
}

fn impossible_absorption(drop: &Drop) -> Option<Warning> {
    // One near none is impossible only where its interval does not reach what is possible.
    let absorption = drop.energy_absorption?;
    let interval = drop.intervals.as_ref().and_then(|all| all.energy_absorption);
    let [low, high] = interval.unwrap_or([absorption; 2]);
    let is_possible = high >= 0.0 && low <= 1.0;
    (!is_possible).then_some(Warning::ImpossibleAbsorption { absorption })
}

fn late_peak(drop: &Drop) -> Option<Warning> {
    let first = drop.first_impact();
    let [lowest_point, _] = drop.signals.series(column::DISPLACEMENT.name)?.window(first).smallest()?;
    let [peak, _] = drop.signals.series(column::ACCELERATION_FILTERED.name)?.window(first).largest()?;
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
    let ([_, rise], left) = least_squares(rest.samples().map(|[t, r]| ([1.0, (t - first) / span - 0.5], r)))?;
    // Of a slope over 0 to 1 in `count` even steps the variance is twelve times that of a sample over their number.
    let standard_error = (12.0 * left / count / count).sqrt();
    let over_record = rise / span * (reading.time().last()? - first);
    let moves = over_record.abs() > ZERO_MOVES && rise.abs() > STANDARD_ERRORS * standard_error;
    moves.then_some(Warning::ZeroDrift { rate: rise / span, over_record })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rest to 0.1 s, a linear fall to −9 m/s² in 30 ms, zero from 0.4 s, an impact of 100 m/s² at 0.5 s.
    fn drop(offset: f64) -> Series {
        let time: Vec<f64> = (0..6000).map(|i| 1e-4 * f64::from(i)).collect();
        let value = |t: f64| match t {
            t if t < 0.1 => 0.0,
            t if t < 0.13 => -300.0 * (t - 0.1),
            t if t < 0.4 => -9.0,
            t if t < 0.5 => 0.0,
            t => 100.0 * (30.0 * (t - 0.5)).sin().max(-0.2),
        };
        let values: Vec<f64> = time.iter().map(|t| value(*t) + offset).collect();
        Series::new(time, values)
    }

    #[test]
    fn landmarks_of_a_made_reading_are_found() {
        for offset in [0.0, -1.5, 4.0] {
            let release = Release::find(&drop(offset), 9.81).unwrap();
            assert!((release.offset - offset).abs() < 1e-9);
            assert!((release.flank[0] - 0.103).abs() < 2e-3, "{:?}", release.flank);
            assert!((release.flank[1] - 0.1285).abs() < 2e-3, "{:?}", release.flank);
            assert!((0.5..0.51).contains(&release.impact), "{}", release.impact);
            assert!((0.094..0.1).contains(&release.rest_end), "{}", release.rest_end);
        }
    }

    #[test]
    fn what_is_not_a_drop_is_refused() {
        let whole = drop(0.0);
        for (window, expected) in [
            ([0.0, 0.49], "there is no contact"),
            ([0.42, 0.6], "there is no release before the impact at"),
            ([0.502, 0.6], "the recording begins after contact"),
            ([0.52, 0.6], "the recording begins after contact"),
            ([0.54, 0.6], "the recording begins after contact"),
            ([0.56, 0.6], "the recording begins after contact"),
            ([0.09, 0.6], "s of rest before the release at"),
        ] {
            let error = Release::find(&whole.window(window), 9.81).unwrap_err().to_string();
            assert!(error.starts_with("acceleration: ") && error.contains(expected), "{window:?}: {error}");
        }
        let gap = whole.with_values(whole.samples().map(|[t, v]| if t == 0.2 { f64::NAN } else { v }).collect());
        assert_eq!(Release::find(&gap, 9.81).unwrap_err().to_string(), "acceleration: nothing was measured at 0.2 s");
    }

    const RAMP: GravityRamp = GravityRamp { start: 0.1503, duration: 0.032, depth: 8.7 };

    fn reading() -> Series {
        let time: Vec<f64> = (0..4000).map(|i| 1e-4 * f64::from(i)).collect();
        let values: Vec<f64> = time.iter().map(|t| RAMP.reading_at(*t)).collect();
        Series::new(time, values)
    }

    #[test]
    fn a_parabola_is_fitted_exactly() {
        let found = GravityRamp::fit(&reading(), [0.152, 0.178]).unwrap();
        assert!((found.start - RAMP.start).abs() < 1e-9);
        assert!((found.duration - RAMP.duration).abs() < 1e-9);
        assert!((found.depth - RAMP.depth).abs() < 1e-9);
    }

    #[test]
    fn the_mirror_runs_from_minus_the_depth_to_zero() {
        let contact = 0.6;
        assert_eq!(RAMP.mirrored(0.5, contact), -8.7);
        assert_eq!(RAMP.mirrored(contact, contact), -8.7);
        for share in [0.25, 0.5, 0.75] {
            let mirrored = RAMP.mirrored(contact + share * RAMP.duration, contact);
            assert!((mirrored - RAMP.reading_at(RAMP.start + (1.0 - share) * RAMP.duration)).abs() < 1e-9);
        }
        assert!(RAMP.mirrored(contact + RAMP.duration, contact).abs() < 1e-9);
        let slow = GravityRamp { duration: 0.2, ..RAMP };
        assert_eq!(slow.mirrored(contact + 0.0501, contact), 0.0);
    }

    #[test]
    fn a_reading_without_vertex_is_not_a_ramp() {
        let falling = reading().with_values(reading().samples().map(|[t, _]| -100.0 * t * t).collect());
        for (flank, expected) in [([0.1, 0.2], "does not flatten out"), ([0.9, 0.95], "has too few samples")] {
            let error = GravityRamp::fit(&falling, flank).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
