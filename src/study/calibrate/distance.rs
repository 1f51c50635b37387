//! How a simulated signal is compared with a measured one: residuals along it, or one number about it.

use nalgebra::DVector;
use rhai::Dynamic;

use super::error_model::{ErrorModel, root_mean_square};
use crate::script::{HostResult, Options, refuse};
use base::removed;
use lab::signal::{Series, rating};

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
}

const NAMES: [&str; 3] = ["residuals", "error-norm", "rating"];
/// Error that is expected where none is given.
const USUAL_ERROR: f64 = 0.05;

impl Distance {
    /// The option `distance`, a word, with the option `error`.
    pub(super) fn read(options: &Options<'_>) -> HostResult<Distance> {
        let error = options.number("error", USUAL_ERROR)?;
        if !(error > 0.0 && error.is_finite()) {
            return Err(refuse!("`error` is {error}, which must be above zero"));
        }
        match options.map.get("distance").map_or_else(|| "residuals".to_owned(), Dynamic::to_string).as_str() {
            "residuals" if options.map.contains_key("error") => {
                Err(refuse("`error` is of a `distance` other than \"residuals\""))
            }
            "residuals" => Ok(Distance::Residuals),
            "error-norm" => Ok(Distance::ErrorNorm(error)),
            "rating" => Ok(Distance::Rating(error)),
            other => {
                let known = || format!("there are {}", NAMES.join(", "));
                let hint = removed::function(&format!("calibrate.{other}")).unwrap_or_else(known);
                Err(refuse!("there is no distance `{other}`; {hint}"))
            }
        }
    }

    /// Whether it is of differences along the signal.
    pub(super) fn is_residuals(&self) -> bool {
        *self == Distance::Residuals
    }

    /// What a simulated signal differs by from the recordings: bin by bin over the noise, or one number, the root mean square of
    /// those of the recordings, which have the model's error in common.
    pub(super) fn scaled(
        &self,
        errors: &ErrorModel,
        recordings: &[Series],
        simulated: &Series,
    ) -> Result<DVector<f64>, String> {
        match *self {
            Distance::Residuals => errors.scaled(simulated),
            Distance::ErrorNorm(error) => Ok(DVector::from_element(1, errors.relative_error(simulated)? / error)),
            Distance::Rating(error) => {
                let rated =
                    recordings.iter().map(|measured| rating::rate(measured, simulated).map(|own| 1.0 - own.overall));
                let rated = rated.collect::<Result<Vec<_>, _>>().map_err(|error| error.to_string())?;
                Ok(DVector::from_element(1, root_mean_square(&rated) / error))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::error_model::{Noise, Recorded, Shape};

    fn wave(shift: f64, factor: f64) -> Series {
        let time: Vec<f64> = (0..=400).map(|sample| 2.5e-4 * f64::from(sample)).collect();
        let values: Vec<f64> = time.iter().map(|t| factor * (-((t - 0.05 - shift) / 0.012).powi(2)).exp()).collect();
        Series::new(time, values)
    }

    fn of(distance: Distance, simulated: &Series) -> f64 {
        let measured = wave(0.0, 100.0);
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let recorded = [Recorded::new(&measured, all, None).unwrap()];
        let errors = ErrorModel::new(&recorded, Noise::FromRecording, Shape::all(None)[0]).unwrap();
        distance.scaled(&errors, &[measured], simulated).unwrap()[0]
    }

    const ALL: [Distance; 2] = [Distance::ErrorNorm(0.05), Distance::Rating(0.05)];

    #[test]
    fn every_distance_vanishes_for_the_same_signal_and_none_for_another() {
        for distance in ALL {
            assert!(of(distance, &wave(0.0, 100.0)).abs() < 1e-6, "{distance:?}");
            assert!(of(distance, &wave(0.004, 120.0)).abs() > 0.5, "{distance:?}");
        }
    }

    /// A run that goes on behind the recording, with a second wave that is twice as high.
    #[test]
    fn what_a_run_does_behind_the_recording_does_not_count() {
        let first = wave(0.0, 100.0);
        let later = first.samples().skip(1).map(|[time, value]| [time + 0.1, 2.0 * value]);
        let (time, values): (Vec<f64>, Vec<f64>) = first.samples().chain(later).map(|[t, v]| (t, v)).unzip();
        let longer = Series::new(time, values);
        for distance in ALL {
            assert!(of(distance, &longer).abs() < 1e-6, "{distance:?}");
        }
    }
}
