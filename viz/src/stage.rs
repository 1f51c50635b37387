//! A recording while it is written, to a file or to an open viewer; both are logged by the same functions.

use std::path::Path;
use std::time::Duration;

use re_sdk::log::{ChunkBatcherConfig, TimeColumn};
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};
use re_sdk_types::archetypes::{Scalars, SeriesLines, TextDocument, TextLog, Transform3D, ViewCoordinates};
use re_sdk_types::components::{MediaType, TextLogLevel};

use crate::eye::Eye;
use crate::file_sink::FileSink;
use crate::film::Film;
use crate::live::Address;
use crate::scene::{Document, Event, FilmSnapshot, Pose, Scene, Severity};
use crate::series::{SignalTrack, TIME};
use crate::{VizError, blueprint, body, diagram, points};

/// Name of the application in the viewer, which stores one layout for all its recordings.
const APPLICATION: &str = "droptower";

/// Logs a scene into a recording.
pub struct Stage {
    stream: RecordingStream,
    /// The scene with its present colour ranges.
    scene: Scene,
    films: Vec<Film>,
}

impl Stage {
    /// Begins the file `path`, replacing what is there, with all that `scene` holds; states of its films follow.
    ///
    /// # Errors
    /// The file cannot be written, or lists of the scene do not fit each other; then nothing is written.
    pub fn file(path: &Path, scene: Scene) -> Result<Stage, VizError> {
        scene.check()?;
        let stream = recording(&scene).batcher_config(by_size()).buffered()?;
        stream.set_sink(Box::new(FileSink::new(path)?));
        Stage::begin(stream, scene)
    }

    /// A stage in the viewer at `address`.
    ///
    /// # Errors
    /// Lists of the scene do not fit each other. [`Address::answers`] reports whether there is a viewer.
    pub fn live(address: &Address, scene: Scene) -> Result<Stage, VizError> {
        scene.check()?;
        let stream = recording(&scene).connect_grpc_opts(address.to_string())?;
        Stage::begin(stream, scene)
    }

    /// Logs a state of the film with this index.
    ///
    /// # Errors
    /// The state is not one of that film.
    pub fn film(&mut self, index: usize, snapshot: &FilmSnapshot) -> Result<(), VizError> {
        let (Some(track), Some(film)) = (self.scene.films.get(index), self.films.get_mut(index)) else {
            return Err(VizError::NoFilm { index });
        };
        track.check(snapshot, self.scene.quantities.len())?;
        Ok(film.log(&self.stream, track, snapshot, &self.scene.quantities)?)
    }

    /// Sets the colour range of each quantity for the snapshots from `from` (s) on.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn set_ranges(&mut self, from: f64, ranges: &[[f32; 2]]) -> Result<(), VizError> {
        for (quantity, range) in self.scene.quantities.iter_mut().zip(ranges) {
            quantity.range = *range;
            quantity.log_numbers(&self.stream, from)?;
        }
        Ok(())
    }

    /// Replaces the texts, signals, charts, diagrams and events by those of `rest` and sends the layout for them. Of
    /// signals that were logged before, `rest` holds the new values.
    ///
    /// # Errors
    /// Lists of `rest` do not fit each other.
    pub fn complete(&mut self, rest: Scene) -> Result<(), VizError> {
        rest.check()?;
        let Scene { documents, signals, charts, more_charts, diagrams, events, .. } = rest;
        let scene = std::mem::take(&mut self.scene);
        self.scene = Scene { documents, signals, charts, more_charts, diagrams, events, ..scene };
        blueprint::send(&self.stream, &self.scene)?;
        self.log_lists()
    }

    /// Logs the pose of the body of this index, if the scene has it.
    pub fn pose(&self, body: usize, pose: &Pose) -> Result<(), VizError> {
        let Some(body) = self.scene.bodies.get(body) else { return Ok(()) };
        Ok(body::log_pose(&self.stream, body, pose)?)
    }

    /// Logs further values of the signal at `path`, each at its time (s).
    pub fn samples(&self, path: &str, times: &[f64], values: &[f32]) -> Result<(), VizError> {
        if times.is_empty() {
            return Ok(());
        }
        let values = Scalars::new(values.iter().copied().map(f64::from));
        let times = TimeColumn::new_duration_secs(TIME, times.iter().copied());
        let columns = values.columns_of_unit_batches().map_err(RecordingStreamError::from)?;
        Ok(self.stream.send_columns(path, [times], columns)?)
    }

    /// Waits until everything is written or sent.
    ///
    /// # Errors
    /// Writing or sending fails, or takes longer than `timeout`.
    pub fn finish(self, timeout: Duration) -> Result<(), VizError> {
        Ok(self.stream.flush_with_timeout(timeout)?)
    }

    fn begin(stream: RecordingStream, scene: Scene) -> Result<Stage, VizError> {
        // Timelines of the recorder itself would differ from run to run.
        stream.set_log_tick_enabled(false);
        stream.set_log_time_enabled(false);
        blueprint::send(&stream, &scene)?;
        stream.log_static("/", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
        let enlargement = Eye::on(&scene).enlargement;
        // On the root of the scene: positions in the recording stay in metres.
        if enlargement > 1.0 {
            stream.log_static("scene", &Transform3D::from_scale(enlargement))?;
        }
        for quantity in &scene.quantities {
            quantity.log_bar(&stream)?;
            quantity.log_numbers(&stream, 0.0)?;
        }
        let films = scene.films.iter().map(|film| Film::begin(&stream, film, &scene.extent));
        let films = films.collect::<Result<_, _>>()?;
        let stage = Stage { stream, scene, films };
        for (index, body) in stage.scene.bodies.iter().enumerate() {
            body::log_shape(&stage.stream, body)?;
            body.poses.iter().try_for_each(|pose| stage.pose(index, pose))?;
        }
        stage.scene.points.iter().try_for_each(|track| points::log(&stage.stream, track))?;
        stage.log_lists()?;
        Ok(stage)
    }

    /// Texts, signals, diagrams and events of the scene.
    fn log_lists(&self) -> Result<(), VizError> {
        let Scene { documents, signals, diagrams, events, .. } = &self.scene;
        documents.iter().try_for_each(|document| self.document(document))?;
        signals.iter().try_for_each(|signal| self.signal(signal))?;
        diagrams.iter().try_for_each(|diagram| diagram::log(&self.stream, diagram))?;
        events.iter().try_for_each(|event| self.event(event))
    }

    fn event(&self, event: &Event) -> Result<(), VizError> {
        let level = match event.severity {
            Severity::Info => TextLogLevel::INFO,
            Severity::Warning => TextLogLevel::WARN,
        };
        self.stream.set_duration_secs(TIME, event.time);
        Ok(self.stream.log("events", &TextLog::new(event.text.as_str()).with_level(level))?)
    }

    fn document(&self, document: &Document) -> Result<(), VizError> {
        let text = TextDocument::new(document.text.as_str()).with_media_type(MediaType::markdown());
        Ok(self.stream.log_static(document.path.as_str(), &text)?)
    }

    fn signal(&self, signal: &SignalTrack) -> Result<(), VizError> {
        let style = SeriesLines::new()
            .with_names([signal.label.as_str()])
            .with_colors([signal.stroke.colour])
            .with_widths([signal.stroke.width]);
        self.stream.log_static(signal.path.as_str(), &style)?;
        self.samples(&signal.path, &signal.times, &signal.values)
    }
}

/// Chunks of a file end at a size, not after a time, so that the size of the file is reproducible.
fn by_size() -> ChunkBatcherConfig {
    ChunkBatcherConfig { flush_tick: Duration::MAX, ..ChunkBatcherConfig::DEFAULT }
}

fn recording(scene: &Scene) -> RecordingStreamBuilder {
    RecordingStreamBuilder::new(APPLICATION).recording_name(scene.name.as_str()).enabled(true)
}
