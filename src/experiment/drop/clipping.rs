//! An accelerometer at the end of its range.

use crate::signal::Series;

/// Duration of a constant largest reading (s), and share of the time at half of it or more, beyond which it is the end
/// of the range.
const FLAT: f64 = 2e-3;
const FLAT_SHARE: f64 = 0.1;
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
    /// The clipping of an evenly sampled `reading` (m/s²): a largest value that stays.
    pub(super) fn of(reading: &Series) -> Option<Clipping> {
        let [start, level] = reading.largest()?;
        let (time, values) = (reading.time(), reading.values());
        let runs = values.chunk_by(|a, b| a == b).scan(0, |first, run| {
            *first += run.len();
            Some((*first - run.len(), run))
        });
        let flat = runs.filter(|(_, run)| run[0] == level && run.len() >= FEWEST);
        let duration = flat.map(|(first, run)| time[first + run.len() - 1] - time[first]).fold(0.0, f64::max);
        let high = values.iter().filter(|value| **value >= 0.5 * level).count() as f64;
        let step = (time.last()? - time.first()?) / (time.len() - 1).max(1) as f64;
        (duration > FLAT.min(FLAT_SHARE * high * step)).then_some(Clipping { level, start, duration })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a sine of 100 m/s², sampled at 10 kHz with a resolution of 0.25 m/s².
    fn pulse(duration: f64, range: f64) -> Series {
        let time: Vec<f64> = (0..3000).map(|i| 1e-4 * f64::from(i)).collect();
        let value = |t: f64| 100.0 * (std::f64::consts::PI * (t - 0.1) / duration).sin();
        let value = |t: f64| if (0.1..0.1 + duration).contains(&t) { value(t).min(range) } else { 0.0 };
        let values: Vec<f64> = time.iter().map(|t| (4.0 * value(*t)).round() / 4.0).collect();
        Series::new(time, values)
    }

    #[test]
    fn short_pulses_and_long_ones_are_clipped_alike() {
        for duration in [0.005, 0.02, 0.06] {
            assert_eq!(Clipping::of(&pulse(duration, 200.0)), None, "{duration} s");
            let clipped = Clipping::of(&pulse(duration, 90.0)).unwrap();
            assert!(clipped.level == 90.0 && (clipped.duration / duration - 0.287).abs() < 0.03, "{clipped:?}");
        }
    }
}
