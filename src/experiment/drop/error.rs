//! Why a recording of a drop cannot be reduced.

use thiserror::Error;

use crate::experiment::contact::ContactError;
use crate::experiment::coupling::CouplingError;
use crate::experiment::ramp::RampError;
use crate::experiment::release::ReleaseError;
use crate::signal::filter::FilterError;
use crate::signal::gap::Gap;
use crate::signal::resample::ResampleError;

/// Why a recording cannot be reduced.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DropError {
    #[error("the {what} is {value}, but must be positive")]
    NotPositive { what: &'static str, value: f64 },
    #[error("acceleration: {0}")]
    NotMeasured(Gap),
    #[error("acceleration: {0}")]
    Filter(#[from] FilterError),
    #[error("acceleration: {0}")]
    Resample(#[from] ResampleError),
    #[error(transparent)]
    Release(#[from] ReleaseError),
    #[error(transparent)]
    Ramp(#[from] RampError),
    #[error("acceleration: {0}; give the time constant (a DC-coupled sensor has an endless one, such as 1000 s)")]
    Coupling(#[from] CouplingError),
    #[error(transparent)]
    Contact(#[from] ContactError),
    #[error(
        "the impact speed of {speed:.3} m/s is above the {ideal:.3} m/s of a free fall over {height} m; check the height"
    )]
    FasterThanFall { speed: f64, ideal: f64, height: f64 },
    #[error("the gravity ramp needs a laser for the impact speed: use the correction by coupling")]
    LaserNeeded,
    #[error("acceleration: the recording ends with first contact at {contact:.4} s")]
    EndsAtContact { contact: f64 },
}
