//! How a simulated signal is compared with a measured one: residuals along it, or a few numbers about it.

use super::error_model::ErrorModel;
use crate::script::Options;
use lab::signal::{Series, integrate, rating};

/// A distance of two signals. All but the first are over the error that is expected, one standard deviation, so that
/// they stand beside residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Distance {
    /// Differences along the signal, over noise and model error.
    Residuals,
    /// ‖s − m‖/‖m‖ (paper, equation 14), one number.
    ErrorNorm(f64),
    /// One minus the overall rating of ISO/TS 18571.
    Rating(f64),
    /// ‖s − m‖/‖m‖ along the path of dynamic time warping, which may shift by a share of the window (Sakoe, Chiba 1978).
    Warping {
        /// Error that is expected.
        error: f64,
        /// Largest shift, as a share of the window.
        bound: f64,
    },
    /// Peak, its time and impulse, each relative; the time to the window.
    Features(f64),
}

const NAMES: [&str; 5] = ["residuals", "error-norm", "rating", "warping", "features"];
/// Error that is expected where none is given.
const USUAL_ERROR: f64 = 0.05;
/// Largest shift of warping.
const USUAL_BOUND: f64 = 0.05;

impl Distance {
    /// The option `distance`, a word or `#{ warping: 0.05 }`, with the option `error`.
    pub(super) fn read(options: &Options<'_>) -> Result<Distance, String> {
        let error = options.number("error", USUAL_ERROR).map_err(|error| error.to_string())?;
        let positive = |what: &str, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(value),
            false => Err(format!("`{what}` is {value}, which must be above zero")),
        };
        let error = positive("error", error)?;
        let Some(given) = options.map.get("distance") else {
            if options.map.contains_key("error") {
                return Err("`error` is of a `distance` other than \"residuals\"".into());
            }
            return Ok(Distance::Residuals);
        };
        if let Some(map) = given.read_lock::<rhai::Map>() {
            let bound = match (map.len(), map.get("warping").map(|bound| crate::script::number(bound, "warping"))) {
                (1, Some(Ok(bound))) if bound < 1.0 => positive("warping", bound)?,
                _ => {
                    return Err(format!(
                        "`distance` is one of {}, or #{{ warping: 0.05 }}, not {given}",
                        NAMES.join(", ")
                    ));
                }
            };
            return Ok(Distance::Warping { error, bound });
        }
        match given.to_string().as_str() {
            "residuals" if options.map.contains_key("error") => {
                Err("`error` is of a `distance` other than \"residuals\"".into())
            }
            "residuals" => Ok(Distance::Residuals),
            "error-norm" => Ok(Distance::ErrorNorm(error)),
            "rating" => Ok(Distance::Rating(error)),
            "warping" => Ok(Distance::Warping { error, bound: USUAL_BOUND }),
            "features" => Ok(Distance::Features(error)),
            other => Err(format!("there is no distance `{other}`; there are {}", NAMES.join(", "))),
        }
    }

    /// Whether it is of differences along the signal.
    pub(super) fn is_residuals(&self) -> bool {
        *self == Distance::Residuals
    }

    /// How many numbers any distance but residuals has.
    pub(super) fn count(&self) -> usize {
        if matches!(self, Distance::Features(_)) { 3 } else { 1 }
    }

    /// The numbers of any distance but residuals.
    pub(super) fn numbers(
        &self,
        errors: &ErrorModel,
        measured: &Series,
        simulated: &Series,
    ) -> Result<Vec<f64>, String> {
        let text = |error: &dyn std::fmt::Display| error.to_string();
        match *self {
            Distance::Residuals => Ok(Vec::new()),
            Distance::ErrorNorm(error) => {
                let found = errors.relative_error(simulated).map_err(|error| text(&error))?;
                Ok(vec![found / error])
            }
            Distance::Rating(error) => {
                let found = rating::rate(measured, simulated).map_err(|error| text(&error))?;
                Ok(vec![(1.0 - found.overall) / error])
            }
            Distance::Warping { error, bound } => {
                let own = errors.means(simulated).map_err(|error| text(&error))?;
                let measured: Vec<f64> = errors.middles().map(|[_, mean]| mean).collect();
                let shift = ((bound * own.len() as f64).round() as usize).max(1);
                let level = measured.iter().map(|mean| mean * mean).sum::<f64>().sqrt();
                Ok(vec![warped(&own, &measured, shift) / level / error])
            }
            Distance::Features(error) => {
                let simulated = over_the_same(measured, simulated)?;
                let pairs = features(measured).zip(features(&simulated));
                let (measured, simulated) = pairs.ok_or("a signal without samples has no features")?;
                let relative = |index: usize| (simulated[index] / measured[index] - 1.0) / error;
                let length = errors.length();
                let late = (simulated[1] - measured[1]) / length / error;
                let found = vec![relative(0), late, relative(2)];
                match found.iter().all(|number| number.is_finite()) {
                    true => Ok(found),
                    false => Err("the recording has a peak or an impulse of zero, which nothing is relative to".into()),
                }
            }
        }
    }
}

/// A simulated signal from the first to the last sample of the measured one: a run may go on behind the window that is compared.
fn over_the_same(measured: &Series, simulated: &Series) -> Result<Series, String> {
    let (Some(from), Some(to)) = (measured.time().first().copied(), measured.time().last().copied()) else {
        return Err("the recording has no samples".into());
    };
    // Rounding may put an end of the recording a hair outside of the run.
    let near = 1e-9 * (to - from);
    let first = simulated.time().first().copied().unwrap_or(f64::INFINITY);
    let last = simulated.time().last().copied().unwrap_or(f64::NEG_INFINITY);
    if first > from + near || last < to - near {
        return Err(format!("the simulated signal goes from {first} to {last} and the recording from {from} to {to}"));
    }
    let [from, to] = [from.max(first), to.min(last)];
    let inside = simulated.samples().filter(|[time, _]| from < *time && *time < to);
    let ends = [from, to].map(|end| simulated.value_at(end).map(|value| [end, value]));
    let [Some(first), Some(last)] = ends else {
        return Err("the simulated signal has a gap at an end of the window".into());
    };
    let samples: Vec<[f64; 2]> = std::iter::once(first).chain(inside).chain([last]).collect();
    let (time, values): (Vec<f64>, Vec<f64>) = samples.iter().map(|[time, value]| (*time, *value)).unzip();
    Ok(Series::new(time, values))
}

/// The value of largest size, its place, and the integral.
fn features(series: &Series) -> Option<[f64; 3]> {
    let measured = series.samples().filter(|[_, value]| value.is_finite());
    let [place, peak] = measured.reduce(|best, own| if own[1].abs() > best[1].abs() { own } else { best })?;
    let impulse = integrate::once(series, 0.0).values().last().copied()?;
    Some([peak, place, impulse])
}

/// Root of the least sum of squared differences along a path that goes through both lists in order and pairs values at
/// most `shift` places apart.
fn warped(one: &[f64], other: &[f64], shift: usize) -> f64 {
    let mut before = vec![f64::INFINITY; other.len() + 1];
    before[0] = 0.0;
    for (row, value) in one.iter().enumerate() {
        let mut own = vec![f64::INFINITY; other.len() + 1];
        for column in row.saturating_sub(shift)..(row + shift + 1).min(other.len()) {
            let least = before[column].min(before[column + 1]).min(own[column]);
            own[column + 1] = least + (value - other[column]).powi(2);
        }
        before = own;
    }
    before[other.len()].sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::error_model::{Correlation, Noise};

    fn wave(shift: f64, factor: f64) -> Series {
        let time: Vec<f64> = (0..=400).map(|sample| 2.5e-4 * f64::from(sample)).collect();
        let values: Vec<f64> = time.iter().map(|t| factor * (-((t - 0.05 - shift) / 0.012).powi(2)).exp()).collect();
        Series::new(time, values)
    }

    fn of(distance: Distance, simulated: &Series) -> Vec<f64> {
        let measured = wave(0.0, 100.0);
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let errors = ErrorModel::new(&measured, all, Noise::FromRecording, Correlation::Share(0.03), None).unwrap();
        distance.numbers(&errors, &measured, simulated).unwrap()
    }

    #[test]
    fn every_distance_vanishes_for_the_same_signal_and_none_for_another() {
        let all = [
            Distance::ErrorNorm(0.05),
            Distance::Rating(0.05),
            Distance::Warping { error: 0.05, bound: 0.05 },
            Distance::Features(0.05),
        ];
        for distance in all {
            assert!(of(distance, &wave(0.0, 100.0)).iter().all(|number| number.abs() < 1e-6), "{distance:?}");
            assert!(of(distance, &wave(0.004, 120.0)).iter().any(|number| number.abs() > 0.5), "{distance:?}");
        }
    }

    /// A run that goes on behind the recording, with a second wave that is twice as high.
    #[test]
    fn what_a_run_does_behind_the_recording_does_not_count() {
        let first = wave(0.0, 100.0);
        let later = first.samples().skip(1).map(|[time, value]| [time + 0.1, 2.0 * value]);
        let (time, values): (Vec<f64>, Vec<f64>) = first.samples().chain(later).map(|[t, v]| (t, v)).unzip();
        let longer = Series::new(time, values);
        for distance in [Distance::ErrorNorm(0.05), Distance::Rating(0.05), Distance::Features(0.05)] {
            assert!(of(distance, &longer).iter().all(|number| number.abs() < 1e-6), "{distance:?}");
        }
        let shorter = first.window([0.0, 0.09]);
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let errors = ErrorModel::new(&first, all, Noise::FromRecording, Correlation::Share(0.03), None).unwrap();
        let error = Distance::Features(0.05).numbers(&errors, &first, &shorter).unwrap_err();
        assert!(error.contains("goes from 0 to 0.09"), "{error}");
    }

    #[test]
    fn warping_forgives_a_shift_within_its_bound_and_features_name_it() {
        let late = wave(0.004, 100.0);
        let warped = of(Distance::Warping { error: 0.05, bound: 0.05 }, &late)[0];
        let plain = of(Distance::ErrorNorm(0.05), &late)[0];
        assert!(warped < 0.1 * plain, "{warped} of {plain}");
        let found = of(Distance::Features(0.05), &late);
        assert!((found[1] - 0.004 / 0.1 / 0.05).abs() < 0.01 && found[0].abs() < 0.01, "{found:?}");
        let higher = of(Distance::Features(0.05), &wave(0.0, 110.0));
        assert!((higher[0] - 2.0).abs() < 1e-6 && (higher[2] - 2.0).abs() < 1e-6, "{higher:?}");
    }

    /// By hand: [0, 1, 2] against [0, 0, 2] pairs 0 with both zeros, and 1 with 0 or 2.
    #[test]
    fn a_path_of_warping_is_the_shortest() {
        assert_eq!(super::warped(&[0.0, 1.0, 2.0], &[0.0, 0.0, 2.0], 2), 1.0);
        assert_eq!(super::warped(&[0.0, 3.0], &[3.0, 0.0], 1), 18_f64.sqrt());
    }
}
