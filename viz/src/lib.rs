//! Rerun recordings of deforming films: plain positions, values and plots in, one `.rrd` file out.
#![warn(missing_docs)]

mod diagram;
mod eye;
mod film;
mod layout;
mod quantity;
mod scene;
mod stage;

use re_sdk::RecordingStreamError;
use re_sdk::sink::SinkFlushError;
use thiserror::Error;

pub use crate::diagram::Diagram;
pub use crate::quantity::{Quantity, Stroke, TIME};
pub use crate::scene::{
    BodyTrack, Chart, Document, Event, Extent, FilmSnapshot, FilmTrack, PointState, PointTrack, Pose, Scene, Severity,
    SignalTrack, SpringTrack,
};
pub use crate::stage::{Address, AddressError, Stage};

/// Why a recording could not be written.
#[derive(Debug, Error)]
pub enum VizError {
    /// The SDK cannot log.
    #[error("recording: {0}")]
    Rerun(Box<RecordingStreamError>),
    /// The file cannot be made.
    #[error("recording: {0}")]
    File(#[from] std::io::Error),
    /// The file or the viewer does not take the data in time.
    #[error("recording: {0}")]
    Flush(#[from] SinkFlushError),
    /// Lists that belong to each other have different lengths, in these words.
    #[error("recording: {0}")]
    Mismatch(String),
}

impl From<RecordingStreamError> for VizError {
    fn from(error: RecordingStreamError) -> VizError {
        VizError::Rerun(Box::new(error))
    }
}
