//! Rerun recordings of deforming films: plain positions, values and curves in, one `.rrd` file out.
#![warn(missing_docs)]

mod diagram;
mod eye;
mod film;
mod layout;
pub mod playback;
mod quantity;
mod scene;
mod stage;

use re_sdk::RecordingStreamError;
use re_sdk::sink::SinkFlushError;
use thiserror::Error;

pub use crate::diagram::{Axis, Curve, Diagram, Look, Window};
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
    #[error("{0}")]
    Rerun(Box<RecordingStreamError>),
    /// The file cannot be made.
    #[error("{0}")]
    File(#[from] std::io::Error),
    /// The file or the viewer does not take the data in time.
    #[error("{0}")]
    Flush(#[from] SinkFlushError),
    /// A snapshot has another number of nodes than its film.
    #[error("film `{film}` at {time} s: {found} positions or values for {expected} nodes")]
    Nodes {
        /// Name of the film.
        film: String,
        /// Time of the snapshot, s.
        time: f64,
        /// Number of positions or values.
        found: usize,
        /// Number of nodes.
        expected: usize,
    },
    /// A snapshot has values of another number of quantities than the scene.
    #[error("film `{film}` at {time} s: values of {found} quantities where there are {expected}")]
    Quantities {
        /// Name of the film.
        film: String,
        /// Time of the snapshot, s.
        time: f64,
        /// Number of quantities with values.
        found: usize,
        /// Number of quantities of the scene.
        expected: usize,
    },
    /// The scene has no film of this index.
    #[error("there is no film {index}")]
    NoFilm {
        /// Index of the film, from zero.
        index: usize,
    },
    /// A snapshot has another number of triangles than its film.
    #[error("film `{film}` at {time} s: {found} visibilities for {expected} triangles")]
    Triangles {
        /// Name of the film.
        film: String,
        /// Time of the snapshot, s.
        time: f64,
        /// Number of visibilities.
        found: usize,
        /// Number of triangles.
        expected: usize,
    },
    /// A signal has another number of values than of times.
    #[error("signal `{signal}`: {found} values at {expected} times")]
    Samples {
        /// Path of the signal.
        signal: String,
        /// Number of values.
        found: usize,
        /// Number of times.
        expected: usize,
    },
}

impl From<RecordingStreamError> for VizError {
    fn from(error: RecordingStreamError) -> VizError {
        VizError::Rerun(Box::new(error))
    }
}
