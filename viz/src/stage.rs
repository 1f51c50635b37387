//! A recording while it is made: a file, or what a running viewer shows. Both are logged by the same functions.

use std::path::Path;
use std::time::Duration;

use re_sdk::sink::{FileSink, FileSinkOptions};
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};
use re_sdk_types::archetypes::{Scalars, SeriesLines, TextDocument, TextLog, Transform3D, ViewCoordinates};
use re_sdk_types::components::{MediaType, TextLogLevel};

use crate::eye::Eye;
use crate::film::Film;
use crate::live::Address;
use crate::quantity::Quantity;
use crate::scene::{Document, Event, FilmFrame, Pose, Scene, Severity};
use crate::series::{Places, SignalTrack};
use crate::{VizError, blueprint, body, diagram};

/// Name of the application in the viewer, which keeps one arrangement for all its recordings.
const APPLICATION: &str = "droptower";

/// A scene on its way into a recording.
pub struct Stage<'a> {
    stream: RecordingStream,
    scene: &'a Scene,
    films: Vec<Film<'a>>,
    /// With the ranges that are in force.
    quantities: Vec<Quantity>,
}

impl<'a> Stage<'a> {
    /// Begins the file `path`, replacing what is there, with all of `scene` that stays and all that it holds already.
    ///
    /// # Errors
    /// The file cannot be written, or lists of the scene do not fit each other; then nothing is written.
    pub fn file(path: &Path, scene: &'a Scene) -> Result<Stage<'a>, VizError> {
        scene.check()?;
        let stream = recording(scene).buffered()?;
        let sink = FileSink::with_options(path, FileSinkOptions { write_footer: false });
        stream.set_sink(Box::new(sink.map_err(RecordingStreamError::from)?));
        Stage::begin(stream, scene)
    }

    /// The same in the viewer at `address`.
    ///
    /// # Errors
    /// Lists of the scene do not fit each other. That nobody listens is no error here: [`Address::answers`] tells.
    pub fn live(address: &Address, scene: &'a Scene) -> Result<Stage<'a>, VizError> {
        scene.check()?;
        Stage::begin(recording(scene).connect_grpc_opts(address.to_string())?, scene)
    }

    /// Logs a state of the film with this index.
    ///
    /// # Errors
    /// The state is not one of that film.
    pub fn film(&mut self, index: usize, frame: &FilmFrame) -> Result<(), VizError> {
        let (Some(track), Some(film)) = (self.scene.films.get(index), self.films.get_mut(index)) else {
            return Err(VizError::NoFilm { index });
        };
        track.check(frame, self.scene.quantities.len())?;
        Ok(film.log(&self.stream, frame, &self.quantities)?)
    }

    /// Spreads the colours of each quantity over another range, from the next state on.
    pub fn spread(&mut self, ranges: &[[f32; 2]]) -> Result<(), VizError> {
        for (quantity, range) in self.quantities.iter_mut().zip(ranges) {
            quantity.range = *range;
            quantity.log_legend(&self.stream)?;
        }
        Ok(())
    }

    /// Logs where the body is, if the scene has one.
    pub fn pose(&self, pose: &Pose) -> Result<(), VizError> {
        let Some(body) = &self.scene.body else { return Ok(()) };
        Ok(body::log_pose(&self.stream, body, pose)?)
    }

    /// Logs further values of the signal at `path`.
    pub fn samples(&self, path: &str, places: &Places, values: &[f32]) -> Result<(), VizError> {
        if places.len() == 0 {
            return Ok(());
        }
        let values = Scalars::new(values.iter().copied().map(f64::from));
        let columns = values.columns_of_unit_batches().map_err(RecordingStreamError::from)?;
        Ok(self.stream.send_columns(path, [places.column()], columns)?)
    }

    /// Logs what happened.
    pub fn event(&self, event: &Event) -> Result<(), VizError> {
        let level = match event.severity {
            Severity::Info => TextLogLevel::INFO,
            Severity::Warning => TextLogLevel::WARN,
        };
        event.at.set(&self.stream);
        Ok(self.stream.log("events", &TextLog::new(event.text.as_str()).with_level(level))?)
    }

    /// Logs a text, in place of the one that was at its path.
    pub fn document(&self, document: &Document) -> Result<(), VizError> {
        let text = TextDocument::new(document.text.as_str()).with_media_type(MediaType::markdown());
        Ok(self.stream.log_static(document.path.as_str(), &text)?)
    }

    /// Waits until all is written or sent.
    ///
    /// # Errors
    /// It is not within `patience`, or cannot be at all.
    pub fn finish(self, patience: Duration) -> Result<(), VizError> {
        Ok(self.stream.flush_with_timeout(patience)?)
    }

    fn begin(stream: RecordingStream, scene: &'a Scene) -> Result<Stage<'a>, VizError> {
        stream.set_log_tick_enabled(false);
        stream.set_log_time_enabled(false);
        blueprint::send(&stream, scene)?;
        stream.log_static("/", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
        let enlargement = Eye::on(scene).enlargement;
        if enlargement > 1.0 {
            stream.log_static("scene", &Transform3D::from_scale(enlargement))?;
        }
        scene.quantities.iter().try_for_each(|quantity| quantity.log_legend(&stream))?;
        let films = scene.films.iter().map(|film| Film::begin(&stream, film));
        let films = films.collect::<Result<_, _>>()?;
        let mut stage = Stage { stream, scene, films, quantities: scene.quantities.clone() };
        stage.log_scene()?;
        Ok(stage)
    }

    /// All that the scene holds already.
    fn log_scene(&mut self) -> Result<(), VizError> {
        let scene = self.scene;
        scene.documents.iter().try_for_each(|document| self.document(document))?;
        scene.signals.iter().try_for_each(|signal| self.signal(signal))?;
        scene.diagrams.iter().try_for_each(|diagram| diagram::log(&self.stream, diagram))?;
        if let Some(body) = &scene.body {
            body::log_shape(&self.stream, body)?;
            body.poses.iter().try_for_each(|pose| self.pose(pose))?;
        }
        for (film, track) in self.films.iter_mut().zip(&scene.films) {
            track.frames.iter().try_for_each(|frame| film.log(&self.stream, frame, &scene.quantities))?;
        }
        scene.events.iter().try_for_each(|event| self.event(event))
    }

    fn signal(&self, signal: &SignalTrack) -> Result<(), VizError> {
        let style = SeriesLines::new()
            .with_names([signal.label.as_str()])
            .with_colors([signal.stroke.colour])
            .with_widths([signal.stroke.width]);
        self.stream.log_static(signal.path.as_str(), &style)?;
        self.samples(&signal.path, &signal.places, &signal.values)
    }
}

fn recording(scene: &Scene) -> RecordingStreamBuilder {
    RecordingStreamBuilder::new(APPLICATION).recording_name(scene.name.as_str()).enabled(true)
}
