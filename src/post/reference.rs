//! The recording that a run is compared with, brought to the run's own filter.

use std::path::PathBuf;

use thiserror::Error;

use crate::model::{Loading, Model, Reference, Window};
use crate::signal::filter::{self, FilterError, Standard};
use crate::signal::norm::{NormError, relative_error};
use crate::signal::resample::{self, ResampleError};
use crate::signal::{Series, csv, integrate};

/// A recording ready for comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Through the run's channel filter, m/s².
    pub acceleration: Option<Series>,
    /// m; `NaN` where the recording has none.
    pub displacement: Option<Series>,
    /// Part that the errors are taken over, s.
    pub window: [f64; 2],
}

/// Why a recording cannot be compared with a run.
#[derive(Debug, Error)]
pub enum ReferenceError {
    #[error(transparent)]
    Read(#[from] csv::ReadError),
    #[error("{} has neither `acceleration_m_s2` nor `displacement_m`", path.display())]
    NothingToCompare { path: PathBuf },
    #[error("{}: acceleration: {source}", path.display())]
    Filter { path: PathBuf, source: FilterError },
    #[error("{}: acceleration: {source}", path.display())]
    Resample { path: PathBuf, source: ResampleError },
    #[error("{}: the end of loading cannot be found: displacement has gaps and acceleration does not bring the impactor to rest", path.display())]
    NoTurn { path: PathBuf },
}

impl Comparison {
    /// Reads the recording of `model`, if it names one.
    pub fn read(model: &Model) -> Result<Option<Comparison>, ReferenceError> {
        let Some(reference) = &model.reference else {
            return Ok(None);
        };
        let path = || reference.signals.clone();
        let recording = csv::read(&reference.signals)?;
        let raw = recording.series("acceleration_m_s2");
        let displacement = recording.series("displacement_m");
        let acceleration = match recording.series("acceleration_filtered_m_s2") {
            Some(filtered) => Some(filtered),
            None => raw.as_ref().map(|raw| filtered(raw, model, reference)).transpose()?,
        };
        if acceleration.is_none() && displacement.is_none() {
            return Err(ReferenceError::NothingToCompare { path: path() });
        }
        let window = match reference.window {
            Window::Range(range) => range,
            Window::All => [0.0, model.run_time()],
            Window::Loading => {
                let motion = raw.as_ref().or(acceleration.as_ref());
                let turn = turn(motion, displacement.as_ref(), model);
                [0.0, turn.ok_or_else(|| ReferenceError::NoTurn { path: path() })?]
            }
        };
        Ok(Some(Comparison { acceleration, displacement, window }))
    }

    /// Error of a filtered acceleration (paper, equation 14).
    pub fn acceleration_error(&self, filtered: &Series) -> Option<Result<f64, NormError>> {
        let reference = self.acceleration.as_ref()?;
        Some(relative_error(filtered, reference, self.window))
    }

    /// Error of a displacement (paper, equation 15).
    pub fn displacement_error(&self, displacement: &Series) -> Option<Result<f64, NormError>> {
        let reference = self.displacement.as_ref()?;
        Some(relative_error(displacement, reference, self.window))
    }
}

/// The recording through the filter of the run, on equal steps.
fn filtered(raw: &Series, model: &Model, reference: &Reference) -> Result<Series, ReferenceError> {
    let path = || reference.signals.clone();
    let Some(class) = model.output.filter else {
        return Ok(raw.clone());
    };
    let even = match resample::common_step(raw.time()) {
        Some(_) => raw.clone(),
        None => resample::uniform(raw, 1.0 / model.output.sample_rate)
            .map_err(|source| ReferenceError::Resample { path: path(), source })?,
    };
    filter::channel(&even, class, Standard::Iso6487).map_err(|source| ReferenceError::Filter { path: path(), source })
}

/// When the impactor of the recording turns round: the largest travel where it was measured throughout,
/// else where the integral of the acceleration has used up the impact velocity.
fn turn(acceleration: Option<&Series>, displacement: Option<&Series>, model: &Model) -> Option<f64> {
    if let Some(complete) = displacement.filter(|d| d.is_complete()) {
        return complete.smallest().map(|[time, _]| time);
    }
    let Loading::Impact { velocity, .. } = model.loading else {
        return None;
    };
    let fall = acceleration?.window([0.0, f64::INFINITY]);
    let speed = integrate::once(&fall, -velocity);
    speed.samples().find(|[_, v]| *v >= 0.0).map(|[time, _]| time)
}
