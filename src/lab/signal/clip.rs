//! The clip of an acceleration: the highest level that it holds for a given time, 3 ms by convention.
//!
//! 49 CFR 571.208 (S6.3) and UN R94 (5.2.1.1) count the time above the level cumulatively; software and some protocols
//! ask for one unbroken interval. Both are offered, the regulations' is the default.

use super::{Series, gap};
use crate::error::{Error, refusal};
use base::number::significant;

/// How the time above a level is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Counting {
    /// All intervals together.
    #[default]
    Cumulative,
    /// The longest unbroken interval.
    Contiguous,
}

/// The highest level that a series holds for a time, equation 63.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// The level, in the unit of the series.
    pub level: f64,
    /// When the series first holds it, s.
    pub start: f64,
    /// When it last holds it, s; in between it may have been below where the time is counted cumulatively.
    pub end: f64,
}

/// The highest level that `series`, linear between samples, holds for `duration` s.
pub fn clip(series: &Series, duration: f64, counting: Counting) -> Result<Clip, Error> {
    if duration.is_nan() || duration <= 0.0 {
        return Err(refusal!("a duration of {} s is not positive", significant(duration, 9)));
    }
    gap::check(series)?;
    let too_short = |span: f64| {
        refusal!("a series of {} s holds no level for {} s", significant(span, 9), significant(duration, 9))
    };
    let (Some([_, lowest]), Some([_, highest])) = (series.smallest(), series.largest()) else {
        return Err(too_short(0.0));
    };
    // Sums of times that should be as long as the duration may lack a rounding error.
    let long_enough = |held: &Held| held.duration >= duration * (1.0 - 1e-9);
    let whole = Held::above(series, lowest, counting);
    if !long_enough(&whole) {
        return Err(too_short(whole.duration));
    }
    let (mut level, mut held, mut missed) = (lowest, whole, highest);
    let at_top = Held::above(series, highest, counting);
    if long_enough(&at_top) {
        (level, held) = (highest, at_top);
    }
    while missed - level > 1e-13 * (highest - lowest) {
        let middle = 0.5 * (level + missed);
        if middle <= level || middle >= missed {
            break;
        }
        let found = Held::above(series, middle, counting);
        if long_enough(&found) { (level, held) = (middle, found) } else { missed = middle }
    }
    // Without the sign of a zero.
    Ok(Clip { level: level + 0.0, start: held.start, end: held.end })
}

/// How long, and between what times, a series is at or above a level.
#[derive(Clone, Copy)]
struct Held {
    duration: f64,
    start: f64,
    end: f64,
}

impl Held {
    fn above(series: &Series, level: f64, counting: Counting) -> Held {
        let none = Held { duration: 0.0, start: f64::NAN, end: f64::NAN };
        match counting {
            Counting::Cumulative => spans(series, level).fold(none, |sum, [from, to]| Held {
                duration: sum.duration + (to - from),
                start: sum.start.min(from),
                end: to,
            }),
            Counting::Contiguous => spans(series, level).fold(none, |longest, [from, to]| {
                if to - from > longest.duration { Held { duration: to - from, start: from, end: to } } else { longest }
            }),
        }
    }
}

/// The unbroken intervals in which `series` is at or above `level`.
fn spans(series: &Series, level: f64) -> impl Iterator<Item = [f64; 2]> + '_ {
    let (time, values) = (series.time(), series.values());
    let mut next = 0;
    std::iter::from_fn(move || {
        let first = next + values[next..].iter().position(|value| *value >= level)?;
        let count = values[first..].iter().position(|value| *value < level).unwrap_or(values.len() - first);
        next = first + count;
        let crossing = |below: usize, above: usize| {
            time[below] + (level - values[below]) / (values[above] - values[below]) * (time[above] - time[below])
        };
        let from = if first == 0 { time[0] } else { crossing(first - 1, first) };
        let to = if next == values.len() { time[next - 1] } else { crossing(next, next - 1) };
        Some([from, to])
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const BOTH: [Counting; 2] = [Counting::Cumulative, Counting::Contiguous];

    fn sampled(step: f64, f: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=(0.06 / step).round() as usize).map(|i| i as f64 * step).collect();
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        Series::new(time, values)
    }

    #[test]
    fn a_half_sine_and_a_triangle_have_the_clips_of_their_closed_forms() {
        let sine =
            sampled(1e-5, |t| if (0.01..=0.03).contains(&t) { 80.0 * (PI * (t - 0.01) / 0.02).sin() } else { 0.0 });
        let triangle = sampled(1e-4, |t| 60.0 * (1.0 - (t - 0.02).abs() / 0.01).max(0.0));
        for counting in BOTH {
            let found = clip(&sine, 0.003, counting).unwrap();
            let exact = 80.0 * (PI * 0.0015 / 0.02).cos();
            assert!((found.level / exact - 1.0).abs() < 1e-6, "{counting:?}: {found:?} for {exact}");
            assert!((found.start - 0.0185).abs() < 1e-6 && (found.end - 0.0215).abs() < 1e-6);
            let found = clip(&triangle, 0.003, counting).unwrap();
            assert!((found.level - 60.0 * (1.0 - 0.15)).abs() < 1e-6, "{counting:?}: {found:?}");
        }
    }

    #[test]
    fn a_plateau_is_held_as_long_as_it_lasts() {
        let square = sampled(1e-4, |t| if (0.01985..=0.02315).contains(&t) { 50.0 } else { 0.0 });
        for counting in BOTH {
            assert_eq!(clip(&square, 0.003, counting).unwrap().level, 50.0);
            let flanks = clip(&square, 0.00321, counting).unwrap().level;
            // A twentieth of the flank on either side.
            assert!((flanks - 47.5).abs() < 1e-6, "{flanks}");
        }
    }

    #[test]
    fn two_short_peaks_count_together_and_not_as_one() {
        let peak = |t: f64, at: f64| (1.0 - (t - at).abs() / 0.004).max(0.0);
        let twice = sampled(1e-4, |t| 40.0 * (peak(t, 0.01) + peak(t, 0.04)));
        let cumulative = clip(&twice, 0.003, Counting::Cumulative).unwrap();
        let contiguous = clip(&twice, 0.003, Counting::Contiguous).unwrap();
        assert!((cumulative.level - 40.0 * (1.0 - 0.75 / 4.0)).abs() < 1e-6, "{cumulative:?}");
        assert!((contiguous.level - 40.0 * (1.0 - 1.5 / 4.0)).abs() < 1e-6, "{contiguous:?}");
        assert!(cumulative.end - cumulative.start > 0.03 && (contiguous.end - contiguous.start - 0.003).abs() < 1e-8);
    }

    #[test]
    fn one_interval_holds_the_highest_of_its_lowest_values() {
        let wave = sampled(1e-4, |t| (300.0 * t).sin() + 0.4 * (1111.0 * t).sin() - 0.2 * (2500.0 * t).cos());
        let fine: Vec<f64> = (0..=60_000).map(|i| wave.value_at(1e-6 * i as f64).unwrap_or(-9.0)).collect();
        let lowest = fine.windows(3001).map(|window| window.iter().copied().fold(f64::INFINITY, f64::min));
        let expected = lowest.fold(f64::NEG_INFINITY, f64::max);
        let found = clip(&wave, 0.003, Counting::Contiguous).unwrap().level;
        assert!((found - expected).abs() < 2e-3, "{found} for {expected}");
        assert!(clip(&wave, 0.003, Counting::Cumulative).unwrap().level >= found);
    }

    #[test]
    fn a_constant_is_its_own_clip_and_short_series_are_refused() {
        let flat = sampled(1e-3, |_| 7.0);
        for counting in BOTH {
            assert_eq!(clip(&flat, 0.003, counting).unwrap().level, 7.0);
        }
        let refused = |series: &Series, duration| clip(series, duration, Counting::Cumulative).unwrap_err().to_string();
        assert_eq!(refused(&flat.window([0.0, 0.002]), 0.003), "a series of 0.002 s holds no level for 0.003 s");
        assert_eq!(refused(&Series::new(vec![], vec![]), 0.003), "a series of 0 s holds no level for 0.003 s");
        assert_eq!(refused(&flat, -1.0), "a duration of -1 s is not positive");
        let gap = Series::new(vec![0.0, 1.0], vec![1.0, f64::NAN]);
        assert_eq!(refused(&gap, 0.003), "nothing was measured at 1 s");
    }
}
