//! Rerun recordings of runs: film, impactors, signals, events; a file, or an open viewer.
#![warn(missing_docs)]

mod diagram;
mod eye;
mod film;
mod layout;
mod live;
mod quantity;
mod recording;
mod scene;
mod signals;
mod stage;
mod text;

use re_sdk::RecordingStreamError;
use re_sdk::sink::SinkFlushError;
use thiserror::Error;

pub use crate::live::{Live, LiveError};
pub use crate::quantity::{Quantity, Stroke, TIME};
pub use crate::recording::write;
pub use crate::scene::{
    Body, Chart, Charts, Document, Event, Extent, PointState, PointTrack, Scene, Severity, SignalTrack,
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
