//! Rerun recordings of deforming films and of searches: plain positions, values and curves in, one `.rrd` file out.

mod body;
mod colour;
mod diagram;
mod film;
mod layout;
mod normals;
mod scene;
mod series;
mod stroke;

use std::path::Path;

use re_sdk::sink::SinkFlushError;
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};
use re_sdk_types::archetypes::{Scalars, SeriesLines, TextDocument, TextLog, ViewCoordinates};
use re_sdk_types::components::{MediaType, TextLogLevel};
use thiserror::Error;

pub use diagram::{Axis, Curve, Diagram, Look, State};
pub use scene::{BodyShape, BodyTrack, Document, Event, FilmFrame, FilmTrack, Pose, Scene, Severity};
pub use series::{Chart, ITERATION, Moment, Places, SignalTrack, TIME};
pub use stroke::Stroke;

/// Why a recording could not be written.
#[derive(Debug, Error)]
pub enum VizError {
    #[error("{0}")]
    Rerun(Box<RecordingStreamError>),
    #[error("{0}")]
    Flush(#[from] SinkFlushError),
    #[error("film `{film}` at {time} s: {found} positions or values for {expected} nodes")]
    Nodes { film: String, time: f64, found: usize, expected: usize },
    #[error("film `{film}` at {time} s: {found} visibilities for {expected} triangles")]
    Triangles { film: String, time: f64, found: usize, expected: usize },
    #[error("signal `{signal}`: {found} values at {expected} times")]
    Samples { signal: String, found: usize, expected: usize },
    #[error("diagram `{diagram}`: {found} curves in one state, {expected} in the first")]
    Curves { diagram: String, found: usize, expected: usize },
}

impl From<RecordingStreamError> for VizError {
    fn from(error: RecordingStreamError) -> VizError {
        VizError::Rerun(Box::new(error))
    }
}

/// Writes `scene` to the file `path`, replacing what is there.
pub fn write(path: &Path, scene: &Scene) -> Result<(), VizError> {
    scene.check()?;
    let stream = RecordingStreamBuilder::new("droptower")
        .recording_name(scene.name.as_str())
        .enabled(true)
        .with_blueprint(layout::blueprint(scene))
        .save(path)?;
    stream.set_log_tick_enabled(false);
    stream.set_log_time_enabled(false);

    stream.log_static("scene", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    for document in &scene.documents {
        let text = TextDocument::new(document.text.as_str()).with_media_type(MediaType::markdown());
        stream.log_static(document.path.as_str(), &text)?;
    }
    for film in &scene.films {
        film::log(&stream, film)?;
    }
    if let Some(body) = &scene.body {
        body::log(&stream, body)?;
    }
    for signal in &scene.signals {
        log_signal(&stream, signal)?;
    }
    for diagram in &scene.diagrams {
        diagram::log(&stream, diagram)?;
    }
    for event in &scene.events {
        log_event(&stream, event)?;
    }
    stream.flush_blocking()?;
    Ok(())
}

fn log_signal(stream: &RecordingStream, signal: &SignalTrack) -> Result<(), VizError> {
    let entity = signal.path.as_str();
    let style = SeriesLines::new()
        .with_names([signal.label.as_str()])
        .with_colors([signal.stroke.colour])
        .with_widths([signal.stroke.width]);
    stream.log_static(entity, &style)?;
    let values = Scalars::new(signal.values.iter().copied().map(f64::from));
    let columns = values.columns_of_unit_batches();
    let columns = columns.map_err(RecordingStreamError::from)?;
    Ok(stream.send_columns(entity, [signal.places.column()], columns)?)
}

fn log_event(stream: &RecordingStream, event: &Event) -> Result<(), VizError> {
    let level = match event.severity {
        Severity::Info => TextLogLevel::INFO,
        Severity::Warning => TextLogLevel::WARN,
    };
    event.at.set(stream);
    let entry = TextLog::new(event.text.as_str()).with_level(level);
    Ok(stream.log("events", &entry)?)
}
