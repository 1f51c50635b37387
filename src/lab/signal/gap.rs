//! Where a series was not measured: samples without a value, and samples that are missing altogether.

use thiserror::Error;

use super::{Series, resample};
use crate::error::Kind;
use base::number::{clean_time, significant};

/// A step that is longer than this many usual ones is a hole.
const HOLE: f64 = 2.5;

/// The first place at which a series was not measured.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Gap {
    /// A sample without a value.
    #[error("nothing was measured at {} s", significant(*time, 9))]
    Sample {
        /// Time of the sample, s.
        time: f64,
    },
    /// Rows are missing.
    #[error(
        "there are no samples between {} s and {} s, where {} s is the usual step",
        significant(*from, 9), significant(*to, 9), significant(*step, 9)
    )]
    Hole {
        /// Time of the last sample before the hole, s.
        from: f64,
        /// Time of the first sample after it, s.
        to: f64,
        /// Median time step of the series, s.
        step: f64,
    },
}

impl Gap {
    /// Samples that are missing at the usual step, or have no value.
    pub fn missing(&self) -> usize {
        match self {
            Gap::Sample { .. } => 1,
            Gap::Hole { from, to, step } => (((to - from) / step).round() - 1.0).max(1.0) as usize,
        }
    }
}

impl From<Gap> for crate::Error {
    fn from(gap: Gap) -> crate::Error {
        crate::Error::new(gap.to_string()).with_kind(Kind::Gap)
    }
}

/// Refuses a series with a gap.
pub fn check(series: &Series) -> Result<(), Gap> {
    first(series).map_or(Ok(()), Err)
}

/// The first gap of `series`, if it has one: a sample without value, or else a hole.
pub fn first(series: &Series) -> Option<Gap> {
    let unmeasured = series.samples().find(|[_, value]| !value.is_finite());
    let sample = unmeasured.map(|[time, _]| Gap::Sample { time });
    sample.or_else(|| holes(series.time()).next())
}

/// Steps of `time` (s) that are longer than two and a half of its median.
pub fn holes(time: &[f64]) -> impl Iterator<Item = Gap> {
    let step = usual_step(time);
    let long = time.windows(2).filter(move |pair| is_hole(pair[1] - pair[0], step));
    long.map(move |pair| Gap::Hole { from: pair[0], to: pair[1], step: clean_time(step) })
}

/// Whether samples are missing within a `duration` (s) between two of them, where `step` (s) is the usual one.
pub fn is_hole(duration: f64, step: f64) -> bool {
    duration > HOLE * step
}

/// The median step; that of all where they are equal.
pub fn usual_step(time: &[f64]) -> f64 {
    if let Some(step) = resample::common_step(time) {
        return step;
    }
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() { f64::INFINITY } else { *steps.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(time: &[f64]) -> Series {
        Series::new(time, vec![1.0; time.len()])
    }

    #[test]
    fn missing_rows_are_a_hole_and_uneven_steps_are_none() {
        let hole = series(&[0.0, 1.0, 2.0, 8.0, 9.0]);
        assert_eq!(first(&hole), Some(Gap::Hole { from: 2.0, to: 8.0, step: 1.0 }));
        for whole in [&[0.0, 1.0, 2.0][..], &[0.0, 0.8, 2.1, 3.0, 5.0], &[0.0], &[]] {
            assert_eq!(first(&series(whole)), None, "{whole:?}");
        }
    }

    #[test]
    fn times_are_printed_without_their_noise() {
        let sample = Gap::Sample { time: 0.030_100_000_000_000_002 };
        assert_eq!(sample.to_string(), "nothing was measured at 0.0301 s");
        let hole = Gap::Hole { from: 0.1 + 0.2, to: 0.4, step: 1e-6 };
        let words = "there are no samples between 0.3 s and 0.4 s, where 0.000001 s is the usual step";
        assert_eq!(hole.to_string(), words);
    }

    #[test]
    fn a_sample_without_value_comes_first() {
        let empty = Series::new(vec![0.0, 1.0, 9.0, 10.0], vec![1.0, 1.0, f64::NAN, 1.0]);
        assert_eq!(first(&empty), Some(Gap::Sample { time: 9.0 }));
        assert_eq!(holes(empty.time()).count(), 1);
    }
}
