//! Rerun recordings of deforming films: plain positions, values and curves in, one `.rrd` file out.

mod body;
mod colour;
mod film;
mod layout;
mod normals;
mod scene;

use std::path::Path;

use re_sdk::log::TimeColumn;
use re_sdk::sink::SinkFlushError;
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};
use re_sdk_types::archetypes::{Scalars, SeriesLines, TextDocument, TextLog, ViewCoordinates};
use re_sdk_types::components::{MediaType, TextLogLevel};
use thiserror::Error;

pub use scene::{BodyShape, BodyTrack, Event, FilmFrame, FilmTrack, Plot, Pose, Scene, Severity, SignalTrack};

/// The one timeline, in seconds since the start.
pub const TIMELINE: &str = "time";

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
    let summary = TextDocument::new(scene.summary.as_str()).with_media_type(MediaType::markdown());
    stream.log_static("summary", &summary)?;
    for film in &scene.films {
        film::log(&stream, film)?;
    }
    if let Some(body) = &scene.body {
        body::log(&stream, body)?;
    }
    for signal in &scene.signals {
        log_signal(&stream, signal)?;
    }
    for event in &scene.events {
        log_event(&stream, event)?;
    }
    stream.flush_blocking()?;
    Ok(())
}

fn log_signal(stream: &RecordingStream, signal: &SignalTrack) -> Result<(), VizError> {
    let entity = signal.path.as_str();
    let style = SeriesLines::new().with_names([signal.label.as_str()]);
    stream.log_static(entity, &style)?;
    let times = TimeColumn::new_duration_secs(TIMELINE, signal.times.iter().copied());
    let values = Scalars::new(signal.values.iter().copied());
    let columns = values.columns_of_unit_batches();
    let columns = columns.map_err(RecordingStreamError::from)?;
    Ok(stream.send_columns(entity, [times], columns)?)
}

fn log_event(stream: &RecordingStream, event: &Event) -> Result<(), VizError> {
    let level = match event.severity {
        Severity::Info => TextLogLevel::INFO,
        Severity::Warning => TextLogLevel::WARN,
    };
    stream.set_duration_secs(TIMELINE, event.time);
    let entry = TextLog::new(event.text.as_str()).with_level(level);
    Ok(stream.log("events", &entry)?)
}
