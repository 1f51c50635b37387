//! Recordings read as plain values.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use re_sdk::external::arrow::array::{Array, ListArray};
use re_sdk::external::re_log_encoding::DecoderApp;
use re_sdk::log::{Chunk, LogMsg};
use re_sdk_types::archetypes::{Mesh3D, Points3D, Scalars, Transform3D};
use re_sdk_types::components::{Color, Position3D, RotationQuat, Scalar, Translation3D, TriangleIndices};
use re_sdk_types::external::re_types_core::Loggable;
use re_sdk_types::{ComponentDescriptor, ComponentIdentifier};
use thiserror::Error;

/// The timeline of recordings, as in `viz/src/quantity.rs`.
const TIME: &str = "time";

/// Name of the colours among the components of a film, as in `viz/src/film.rs`.
const COLOURS: &str = "Colours";

/// Rows of one component in the order of their times, ns on the timeline `time`. Static rows come first, at `i64::MIN`.
pub type Rows<T> = Vec<(i64, Vec<T>)>;

/// A recording and its blueprint.
#[derive(Debug, Default)]
pub struct Playback {
    recording: BTreeMap<String, Vec<Chunk>>,
    blueprint: BTreeMap<String, Vec<Chunk>>,
}

/// Why a recording cannot be read.
#[derive(Debug, Error)]
pub enum PlaybackError {
    /// The file cannot be opened.
    #[error(transparent)]
    File(#[from] io::Error),
    /// The file is not a recording, or is damaged.
    #[error("not a recording, or a damaged one: {cause}")]
    Damaged {
        /// The error of the decoder.
        cause: String,
    },
}

impl Playback {
    /// Reads the file at `path` whole.
    ///
    /// # Errors
    /// The file cannot be read, or is not a recording.
    pub fn read(path: &Path) -> Result<Playback, PlaybackError> {
        let mut playback = Playback::default();
        for message in DecoderApp::decode_lazy(BufReader::new(File::open(path)?)) {
            let LogMsg::ArrowMsg(store, message) = message.map_err(damaged)? else { continue };
            let chunk = Chunk::from_arrow_msg(&message).map_err(damaged)?;
            let entities = if store.is_blueprint() { &mut playback.blueprint } else { &mut playback.recording };
            entities.entry(chunk.entity_path().to_string()).or_default().push(chunk);
        }
        Ok(playback)
    }

    /// Paths of all entities, in alphabetical order.
    pub fn entities(&self) -> impl Iterator<Item = &str> {
        self.recording.keys().map(String::as_str)
    }

    /// Paths of all parts of the blueprint, in alphabetical order.
    pub fn blueprint(&self) -> impl Iterator<Item = &str> {
        self.blueprint.keys().map(String::as_str)
    }

    /// Nodes of a film, m, on the timeline `time`.
    pub fn nodes(&self, entity: &str) -> Rows<[f32; 3]> {
        self.points(entity, &Mesh3D::descriptor_vertex_positions())
    }

    /// Points, m, on the timeline `time`.
    pub fn marks(&self, entity: &str) -> Rows<[f32; 3]> {
        self.points(entity, &Points3D::descriptor_positions())
    }

    /// Triangles of a film, on the timeline `time`.
    pub fn triangles(&self, entity: &str) -> Rows<[u32; 3]> {
        let rows = self.rows::<TriangleIndices>(TIME, entity, Mesh3D::descriptor_triangle_indices().component);
        rows.into_iter().map(|(at, triangles)| (at, triangles.into_iter().map(|t| t.0.0).collect())).collect()
    }

    /// Colours of the nodes of a film by one of its quantities, sRGB, on the timeline `time`.
    pub fn colours(&self, entity: &str, quantity: &str) -> Rows<[u8; 3]> {
        let component = ComponentIdentifier::try_new(format!("{COLOURS}:{quantity}"));
        let rows = component.map_or_else(|_| Rows::new(), |name| self.rows::<Color>(TIME, entity, name));
        let plain = |colour: Color| {
            let [r, g, b, _] = colour.0.to_array();
            [r, g, b]
        };
        rows.into_iter().map(|(at, colours)| (at, colours.into_iter().map(plain).collect())).collect()
    }

    /// Position of a body, m, on the timeline `time`.
    pub fn places(&self, entity: &str) -> Rows<[f32; 3]> {
        let rows = self.rows::<Translation3D>(TIME, entity, Transform3D::descriptor_translation().component);
        rows.into_iter().map(|(at, places)| (at, places.into_iter().map(|place| place.0.0).collect())).collect()
    }

    /// Orientation of a body, unit quaternions i, j, k, w, on the timeline `time`.
    pub fn rotations(&self, entity: &str) -> Rows<[f32; 4]> {
        let rows = self.rows::<RotationQuat>(TIME, entity, Transform3D::descriptor_quaternion().component);
        rows.into_iter().map(|(at, turns)| (at, turns.into_iter().map(|turn| turn.0.0).collect())).collect()
    }

    /// Values of a signal, on a timeline.
    pub fn values(&self, timeline: &'static str, entity: &str) -> Vec<(i64, f64)> {
        let rows = self.rows::<Scalar>(timeline, entity, Scalars::descriptor_scalars().component);
        rows.into_iter().filter_map(|(at, values)| Some((at, values.first()?.0.0))).collect()
    }

    /// Rows of any component of an entity; those that cannot be read as such are left out.
    pub fn rows<T: Loggable>(&self, timeline: &'static str, entity: &str, component: ComponentIdentifier) -> Rows<T> {
        rows(self.recording.get(entity), timeline, component)
    }

    /// Messages of the blueprint.
    pub fn blueprint_rows<T: Loggable>(&self, entity: &str, component: ComponentIdentifier) -> Rows<T> {
        rows(self.blueprint.get(entity), "blueprint", component)
    }

    fn points(&self, entity: &str, component: &ComponentDescriptor) -> Rows<[f32; 3]> {
        let rows = self.rows::<Position3D>(TIME, entity, component.component);
        rows.into_iter().map(|(at, points)| (at, points.into_iter().map(|point| point.0.0).collect())).collect()
    }
}

fn rows<T: Loggable>(chunks: Option<&Vec<Chunk>>, timeline: &'static str, component: ComponentIdentifier) -> Rows<T> {
    let mut rows = Vec::new();
    for chunk in chunks.into_iter().flatten() {
        let Some(column) = chunk.components().get_array(component) else { continue };
        let places = chunk.timelines().get(&re_sdk::TimelineName::from_static_str(timeline));
        let place = |row: usize| places.map_or(i64::MIN, |places| places.times_raw()[row]);
        let row = |row: usize| Some((place(row), values(column, row)?));
        rows.extend((0..chunk.num_rows()).filter_map(row));
    }
    rows.sort_by_key(|(at, _)| *at);
    rows
}

fn values<T: Loggable>(column: &ListArray, row: usize) -> Option<Vec<T>> {
    column.is_valid(row).then(|| T::from_arrow(&column.value(row)).ok())?
}

fn damaged(error: impl std::error::Error) -> PlaybackError {
    PlaybackError::Damaged { cause: error.to_string() }
}
