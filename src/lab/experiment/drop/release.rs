//! The rest before a drop, the release, and the impact that ends the fall.

use thiserror::Error;

use crate::experiment::fit::least_squares;
use crate::signal::Series;
use crate::signal::gap::{self, Gap};

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
const BLOW: f64 = 1.0;

/// Share of the largest rise below which a peak is a knock.
const KNOCK: f64 = 0.25;

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
    pub blow: f64,
    /// Time of the first peak of the impact, s.
    pub peak: f64,
}

/// Why a reading is not that of a drop.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ReleaseError {
    /// The reading has a gap.
    #[error("acceleration: {0}")]
    NotMeasured(Gap),
    /// The reading is not at rest when the recording begins.
    #[error(
        "acceleration: the recording begins after contact: the reading changes by {change:.1} m/s² in the first {:.0} ms, where the impactor should be at rest or fall",
        1e3 * within
    )]
    BeginsAfterContact {
        /// Change of the reading, m/s²: more than a release makes.
        change: f64,
        /// Time from the first sample on in which it changes so, s.
        within: f64,
    },
    /// The impact is the most negative reading.
    #[error(
        "acceleration: the impact reads {lowest:.1} m/s² downward; deceleration must be positive, so the sign looks reversed"
    )]
    UpsideDown {
        /// Depth of the impact below the mean of the first samples, m/s².
        lowest: f64,
    },
    /// The depth of the fall is that of another unit.
    #[error(
        "acceleration: the reading falls by {depth:.2} m/s² after the release, where a fall has 9.81: it looks as if it were in \
         {is} and was read in {read}"
    )]
    OtherUnit {
        /// m/s².
        depth: f64,
        /// The unit that it seems to be in.
        is: &'static str,
        /// The unit that it was read in.
        read: &'static str,
    },
    /// No reading rises by 1 g.
    #[error(
        "acceleration: there is no contact: the largest reading is {largest:.2} m/s² above the first, less than 1 g"
    )]
    NoContact {
        /// Largest rise above the mean of the first samples, m/s².
        largest: f64,
    },
    /// The reading does not fall as a release asks for.
    #[error(
        "acceleration: there is no release before the impact at {blow:.4} s: the reading falls by {fall:.2} m/s² at most"
    )]
    NoRelease {
        /// Time at which the reading has risen by one gravity in the impact, s.
        blow: f64,
        /// Largest fall below the mean of the first samples before the impact, m/s².
        fall: f64,
    },
    /// The rest before the release is too short.
    #[error(
        "acceleration: {rest:.4} s of rest before the release at {release:.4} s, at least {SHORTEST_REST} s are needed for the sensor's zero"
    )]
    NoRest {
        /// Duration of the rest, s.
        rest: f64,
        /// Time at which the reading begins to fall, s.
        release: f64,
    },
}

impl Release {
    /// Finds the landmarks in a complete `reading` (m/s²) on equal steps, under `gravity` (m/s²).
    pub fn find(reading: &Series, gravity: f64) -> Result<Release, ReleaseError> {
        let smooth = smoothed(reading)?;
        let (time, values) = (smooth.time(), smooth.values());
        let level = level(&smooth);
        let peak = smooth.largest().unwrap_or([f64::NAN, f64::NAN]);
        let largest = peak[1] - level;
        let lowest = level - smooth.smallest().unwrap_or(peak)[1];
        // A release changes the reading by one gravity at most.
        let change = change(&smooth);
        if change > LEAVES * gravity {
            return Err(ReleaseError::BeginsAfterContact { change, within: SHORTEST_REST });
        }
        if lowest > UPSIDE_DOWN * largest.max(gravity) {
            let leaves = smooth.samples().find(|[_, v]| (v - level).abs() > LEAVES * gravity);
            let within = leaves.map_or(f64::INFINITY, |[t, _]| t - time[0]);
            if within < SHORTEST_FALL {
                return Err(ReleaseError::BeginsAfterContact { change: LEAVES * gravity, within });
            }
            return Err(ReleaseError::UpsideDown { lowest });
        }
        if largest.is_nan() || largest < BLOW * gravity {
            return Err(ReleaseError::NoContact { largest });
        }
        let first_peak = first_peak(values, level, largest, BLOW * gravity);
        let blow = values[..first_peak].iter().rposition(|v| v - level < BLOW * gravity).unwrap_or(0);
        let depth = values[..=blow].iter().map(|v| level - v).fold(0.0, f64::max);
        let units = [("m/s²", "g"), ("g", "m/s²")];
        for ([low, high], (is, read)) in OF_OTHER_UNIT.into_iter().zip(units) {
            if (low..=high).contains(&(depth / gravity)) {
                return Err(ReleaseError::OtherUnit { depth, is, read });
            }
        }
        if depth < FALL * gravity {
            return Err(ReleaseError::NoRelease { blow: time[blow], fall: depth });
        }
        let fallen = |share: f64| values.iter().position(|v| level - v >= share * depth).unwrap_or(0);
        let bottom = fallen(0.95);
        let top = values[..bottom].iter().rposition(|v| level - v < 0.1 * depth).unwrap_or(0);
        let rest_end = time[top] - MARGIN;
        let rest = reading.window([f64::NEG_INFINITY, rest_end]);
        let length = rest_end - time[0];
        if rest.len() < 2 || length < SHORTEST_REST {
            return Err(ReleaseError::NoRest { rest: length.max(0.0), release: time[top] });
        }
        let offset = rest.values().iter().sum::<f64>() / rest.len() as f64;
        let centred = rest.samples().map(|[t, r]| ([1.0, (t - time[0]) / length - 0.5], r - offset));
        let centred: Vec<_> = centred.collect();
        let left = least_squares(centred.iter().copied()).map_or(0.0, |(_, left)| left);
        let noise = (left / (rest.len() - 1) as f64).sqrt();
        let flank = [time[top], time[bottom]];
        Ok(Release { offset, noise, rest_end, flank, blow: time[blow], peak: time[first_peak] })
    }
}

/// Means over [`SMOOTHED`] about each sample.
fn smoothed(reading: &Series) -> Result<Series, ReleaseError> {
    if let Some(gap) = gap::first(reading) {
        return Err(ReleaseError::NotMeasured(gap));
    }
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
            assert!((0.5..0.51).contains(&release.blow), "{}", release.blow);
            assert!((0.094..0.1).contains(&release.rest_end), "{}", release.rest_end);
        }
    }

    #[test]
    fn what_is_not_a_drop_is_refused() {
        let whole = drop(0.0);
        let fall_only = whole.window([0.0, 0.49]);
        assert!(matches!(Release::find(&fall_only, 9.81), Err(ReleaseError::NoContact { .. })));
        let impact_only = whole.window([0.42, 0.6]);
        assert!(matches!(Release::find(&impact_only, 9.81), Err(ReleaseError::NoRelease { .. })));
        for begin in [0.502, 0.52, 0.54, 0.56] {
            let late = whole.window([begin, 0.6]);
            assert!(matches!(Release::find(&late, 9.81), Err(ReleaseError::BeginsAfterContact { .. })), "{begin}");
        }
        let no_rest = whole.window([0.09, 0.6]);
        assert!(matches!(Release::find(&no_rest, 9.81), Err(ReleaseError::NoRest { .. })));
        let gap = whole.with_values(whole.samples().map(|[t, v]| if t == 0.2 { f64::NAN } else { v }).collect());
        assert_eq!(Release::find(&gap, 9.81).unwrap_err().to_string(), "acceleration: nothing was measured at 0.2 s");
    }
}
