//! A recording while it is written, to a file or to an open viewer; both are logged by the same functions.

use std::fmt::{self, Display};
use std::fs::File;
use std::io::{self, BufWriter};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::str::FromStr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use re_sdk::external::re_log_encoding::Encoder;
use re_sdk::external::re_log_encoding::rrd::EncodingOptions;
use re_sdk::external::re_uri::ProxyUri;
use re_sdk::log::{ChunkBatcherConfig, LogMsg, TimeColumn};
use re_sdk::sink::{LogSink, SinkFlushError};
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};
use re_sdk_types::archetypes::{Scalars, SeriesLines, TextDocument, TextLog, Transform3D, ViewCoordinates};
use re_sdk_types::components::{MediaType, TextLogLevel};
use thiserror::Error;

use crate::eye::Eye;
use crate::film::{self, Film};
use crate::quantity::TIME;
use crate::scene::{Document, Event, Scene, Severity, SignalTrack};
use crate::{VizError, diagram, layout};
use scene::simulate::Snapshot;

/// Name of the application in the viewer, which stores one layout for all its recordings.
const APPLICATION: &str = "droptower";

/// Logs a scene into a recording.
pub struct Stage {
    stream: RecordingStream,
    /// The file that the stream is written to; none in a viewer.
    file: Option<FileSink>,
    /// The scene with its present colour ranges.
    scene: Scene,
    films: Vec<Film>,
}

impl Stage {
    /// Begins the file `path`, replacing what is there, with all that `scene` holds; its snapshots follow.
    ///
    /// # Errors
    /// The file cannot be written, or lists of the scene do not fit each other; then nothing is written.
    pub fn file(path: &Path, scene: Scene) -> Result<Stage, VizError> {
        scene.check()?;
        let stream = recording(&scene).batcher_config(by_size()).buffered()?;
        let file = FileSink::new(path)?;
        stream.set_sink(Box::new(file.clone()));
        Stage::begin(stream, Some(file), scene)
    }

    /// A stage in the viewer at `address`.
    ///
    /// # Errors
    /// Lists of the scene do not fit each other. [`Address::answers`] reports whether there is a viewer.
    pub fn live(address: &Address, scene: Scene) -> Result<Stage, VizError> {
        scene.check()?;
        let stream = recording(&scene).connect_grpc_opts(address.to_string())?;
        Stage::begin(stream, None, scene)
    }

    /// Logs the face of this index in a snapshot of the scene.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn film(&mut self, face: usize, snapshot: &Snapshot) -> Result<(), VizError> {
        let (shape, film) = (&self.scene.faces[face], &snapshot.films[face]);
        self.stream.set_duration_secs(TIME, snapshot.time);
        Ok(self.films[face].log(&self.stream, shape, film, &self.scene.quantities)?)
    }

    /// Logs where the bodies are in a snapshot of the scene.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn bodies(&self, snapshot: &Snapshot) -> Result<(), VizError> {
        self.stream.set_duration_secs(TIME, snapshot.time);
        let mut placed = self.scene.bodies.iter().zip(&snapshot.impactors);
        Ok(placed.try_for_each(|(body, pose)| film::log_pose(&self.stream, body, pose))?)
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

    /// Replaces the texts, charts, diagrams and events by those of `rest` and sends the layout for them. Of
    /// signals that were logged before, `rest` holds the new values.
    ///
    /// # Errors
    /// Lists of `rest` do not fit each other.
    pub fn complete(&mut self, rest: Scene) -> Result<(), VizError> {
        rest.check()?;
        let Scene { documents, charts, diagrams, events, .. } = rest;
        let scene = std::mem::take(&mut self.scene);
        self.scene = Scene { documents, charts, diagrams, events, ..scene };
        layout::send(&self.stream, &self.scene)?;
        self.log_lists()
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

    /// Waits until everything is written or sent, and ends the file.
    ///
    /// # Errors
    /// Writing or sending fails, or takes longer than `timeout`.
    pub fn finish(self, timeout: Duration) -> Result<(), VizError> {
        self.stream.flush_with_timeout(timeout)?;
        Ok(self.file.map_or(Ok(()), |file| file.close())?)
    }

    fn begin(stream: RecordingStream, file: Option<FileSink>, scene: Scene) -> Result<Stage, VizError> {
        // Timelines of the recorder itself would differ from run to run.
        stream.set_log_tick_enabled(false);
        stream.set_log_time_enabled(false);
        layout::send(&stream, &scene)?;
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
        let films = scene.faces.iter().enumerate();
        let films = films.map(|(number, face)| Film::begin(&stream, number, face, &scene.extent));
        let films = films.collect::<Result<_, _>>()?;
        let stage = Stage { stream, file, scene, films };
        stage.scene.bodies.iter().try_for_each(|body| film::log_shape(&stage.stream, body))?;
        stage.scene.points.iter().try_for_each(|track| film::log_points(&stage.stream, track))?;
        stage.log_lists()?;
        Ok(stage)
    }

    /// Texts, signals, diagrams and events of the scene.
    fn log_lists(&self) -> Result<(), VizError> {
        let Scene { documents, charts, diagrams, events, .. } = &self.scene;
        documents.iter().try_for_each(|document| self.document(document))?;
        charts.tracks().try_for_each(|signal| self.signal(signal))?;
        diagrams.iter().enumerate().try_for_each(|(index, plot)| diagram::log(&self.stream, index, plot))?;
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

/// Writes messages to a file as they come. Clones share the file.
#[derive(Clone)]
struct FileSink(Arc<Mutex<State>>);

struct State {
    encoder: Encoder<BufWriter<File>>,
    /// Why nothing is written any more.
    failure: Option<String>,
}

impl FileSink {
    /// A sink into the file at `path`, replacing what is there.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn new(path: &Path) -> io::Result<FileSink> {
        let file = BufWriter::new(File::create(path)?);
        let version = re_sdk::build_info().version;
        let encoder = Encoder::new_eager(version, EncodingOptions::PROTOBUF_COMPRESSED, file);
        let encoder = encoder.map_err(io::Error::other)?;
        Ok(FileSink(Arc::new(Mutex::new(State { encoder, failure: None }))))
    }

    /// Ends the file with its index of chunks, by which a viewer reads a part of it.
    ///
    /// # Errors
    /// The file cannot be written.
    fn close(&self) -> Result<(), SinkFlushError> {
        self.with(Encoder::finish).and_then(|()| self.with(Encoder::flush_blocking)).map_err(SinkFlushError::failed)
    }

    /// Does `work` unless an earlier one failed.
    fn with<E: ToString>(
        &self,
        work: impl FnOnce(&mut Encoder<BufWriter<File>>) -> Result<(), E>,
    ) -> Result<(), String> {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(failure) = &state.failure {
            return Err(failure.clone());
        }
        work(&mut state.encoder).map_err(|error| {
            let failure = error.to_string();
            state.failure = Some(failure.clone());
            failure
        })
    }
}

impl LogSink for FileSink {
    fn send(&self, message: LogMsg) {
        // What fails is told by the flush that ends every recording.
        let _ = self.with(|encoder| encoder.append(&message).map(drop));
    }

    fn flush_blocking(&self, _timeout: Duration) -> Result<(), SinkFlushError> {
        self.with(Encoder::flush_blocking).map_err(SinkFlushError::failed)
    }
}

/// Address of a viewer, e.g. `rerun+http://127.0.0.1:9876/proxy`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address(ProxyUri);

/// Why a text is not the address of a viewer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{cause}")]
pub struct AddressError {
    cause: String,
}

impl Address {
    /// The default address of a viewer.
    pub const DEFAULT: &str = "rerun+http://127.0.0.1:9876/proxy";

    /// Checks that a viewer listens there.
    ///
    /// # Errors
    /// No connection within `patience`.
    pub fn answers(&self, patience: Duration) -> io::Result<()> {
        let origin = &self.0.origin;
        let places = (origin.host.to_string(), origin.port).to_socket_addrs()?;
        let mut last = io::Error::from(io::ErrorKind::AddrNotAvailable);
        for place in places {
            match TcpStream::connect_timeout(&place, patience) {
                Ok(_) => return Ok(()),
                Err(error) => last = error,
            }
        }
        Err(last)
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Address, AddressError> {
        text.parse()
            .map(Address)
            .map_err(|error: re_sdk::external::re_uri::Error| AddressError { cause: error.to_string() })
    }
}

impl Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_of_every_flush() {
        let sink = FileSink::new(Path::new("/dev/full")).unwrap();
        for _ in 0..2 {
            let error = sink.flush_blocking(Duration::MAX).unwrap_err().to_string();
            assert!(error.contains("No space left"), "{error}");
        }
        assert!(sink.close().is_err());
    }

    #[test]
    fn an_address_is_parsed_and_a_closed_port_is_an_error() {
        let address: Address = Address::DEFAULT.parse().unwrap();
        assert_eq!(address.to_string(), Address::DEFAULT);
        assert!("127.0.0.1".parse::<Address>().is_err());
        let closed: Address = "rerun+http://127.0.0.1:1/proxy".parse().unwrap();
        assert!(closed.answers(Duration::from_millis(500)).is_err());
    }
}
