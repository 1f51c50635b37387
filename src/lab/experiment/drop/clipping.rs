//! An accelerometer at the end of its range.

use crate::signal::Series;

/// Duration of a constant largest reading (s), and share of the pulse's width at half of it, beyond which it is the end
/// of the range.
const FLAT: f64 = 2e-3;
const FLAT_SHARE: f64 = 0.1;
/// So many times the duration for which the steps of the converter hold the reading at the top of a pulse.
const BEYOND_STEPS: f64 = 2.5;
/// Share of all that was read below which two values are the same but for the rounding of their units.
const ROUNDING: f64 = 1e-9;
/// Fewest samples of such a reading.
const FEWEST: usize = 5;

/// Samples at the end of the range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clipping {
    /// The reading, m/s².
    pub level: f64,
    /// Time of the first of them, s.
    pub start: f64,
    /// Duration of the longest run of them, s.
    pub duration: f64,
}

impl Clipping {
    /// The clipping of an evenly sampled `reading` (m/s²) from `contact` (s) on: a largest value that stays for longer
    /// than the steps of the reading explain.
    pub(super) fn find(reading: &Series, contact: f64) -> Option<Clipping> {
        let impact = reading.window([contact, f64::INFINITY]);
        let [start, level] = impact.largest()?;
        let (time, values) = (impact.time(), impact.values());
        let runs = values.chunk_by(|a, b| a == b).scan(0, |first, run| {
            *first += run.len();
            Some([*first - run.len(), *first - 1])
        });
        let flat = runs.filter(|[first, last]| values[*first] == level && last - first + 1 >= FEWEST);
        let [first, last] = flat.max_by_key(|[first, last]| last - first)?;
        let duration = time[last] - time[first];
        let width = width(&impact, [first, last], 0.5 * level);
        let explained = width * (2.0 * quantum(reading.values()) / level).sqrt();
        (duration > FLAT.min(FLAT_SHARE * width).max(BEYOND_STEPS * explained)).then_some(Clipping {
            level,
            start,
            duration,
        })
    }
}

/// Duration for which the `pulse` stays at `level` (m/s²) or above about the samples `[first, last]`, s.
fn width(pulse: &Series, [first, last]: [usize; 2], level: f64) -> f64 {
    let (time, values) = (pulse.time(), pulse.values());
    let before = values[..first].iter().rposition(|value| *value < level).map_or(0, |below| below + 1);
    let after = values[last..].iter().position(|value| *value < level).map_or(values.len(), |below| last + below);
    time[after - 1] - time[before]
}

/// The smallest distance of two of the `values`, beyond their rounding: one step of the converter, m/s².
///
/// The top of a pulse is a parabola whose width grows with the root of the depth below it, so that a step q holds a
/// reading of level L, of width w at L/2, for w √(2q/L).
fn quantum(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rounding = ROUNDING * sorted.last().zip(sorted.first()).map_or(0.0, |(most, least)| most - least);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    steps.filter(|step| *step > rounding).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contact of the pulses, s.
    const CONTACT: f64 = 0.1;

    /// Half a sine of 100 m/s², sampled at 10 kHz with a resolution of `step` (m/s²), after a rest that changes by one
    /// step at times.
    fn pulse(duration: f64, range: f64, step: f64) -> Series {
        let time: Vec<f64> = (0..3000).map(|i| 1e-4 * f64::from(i)).collect();
        let value = |t: f64| 100.0 * (std::f64::consts::PI * (t - CONTACT) / duration).sin();
        let rest = |t: f64| if t < CONTACT && (1e4 * t).round() % 7.0 == 0.0 { step } else { 0.0 };
        let value = |t: f64| if (CONTACT..CONTACT + duration).contains(&t) { value(t).min(range) } else { rest(t) };
        let values: Vec<f64> = time.iter().map(|t| (value(*t) / step).round() * step).collect();
        Series::new(time, values)
    }

    #[test]
    fn short_pulses_and_long_ones_are_clipped_alike() {
        for duration in [0.005, 0.02, 0.06] {
            assert_eq!(Clipping::find(&pulse(duration, 200.0, 0.25), CONTACT), None, "{duration} s");
            let clipped = Clipping::find(&pulse(duration, 90.0, 0.25), CONTACT).unwrap();
            assert!(clipped.level == 90.0 && (clipped.duration / duration - 0.287).abs() < 0.03, "{clipped:?}");
        }
    }

    #[test]
    fn the_steps_of_a_coarse_converter_are_not_the_end_of_its_range() {
        for (duration, step) in [(0.06, 1.0), (0.06, 4.0), (0.02, 5.0), (0.15, 0.5)] {
            let whole = pulse(duration, 200.0, step);
            assert_eq!(Clipping::find(&whole, CONTACT), None, "{duration} s in steps of {step} m/s²");
        }
        for (duration, step) in [(0.06, 1.0), (0.06, 2.0), (0.02, 2.0), (0.15, 0.5)] {
            let clipped = Clipping::find(&pulse(duration, 70.0, step), CONTACT).unwrap();
            assert!(clipped.level == 70.0 && clipped.start > CONTACT, "{clipped:?}");
        }
    }

    /// The magnet's knock reaches the end of the range too.
    #[test]
    fn a_knock_before_contact_hides_no_clipping() {
        let clipped = pulse(0.02, 90.0, 0.25);
        let knock = |[t, value]: [f64; 2]| if (0.05..0.051).contains(&t) { 90.0 } else { value };
        let knocked = clipped.with_values(clipped.samples().map(knock).collect());
        assert_eq!(Clipping::find(&knocked, CONTACT), Clipping::find(&clipped, CONTACT));
        assert!(Clipping::find(&knocked, CONTACT).is_some());
    }
}
