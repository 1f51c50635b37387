//! What a recording shows, as plain values: lengths in m, times in s.

use crate::VizError;
use crate::diagram::Diagram;
use crate::series::{Chart, Moment, SignalTrack};

/// Everything in one recording.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name of the recording in the viewer.
    pub name: String,
    /// Texts, the one that is open first.
    pub documents: Vec<Document>,
    pub films: Vec<FilmTrack>,
    pub body: Option<BodyTrack>,
    pub signals: Vec<SignalTrack>,
    /// Pictures of signals, from top to bottom.
    pub charts: Vec<Chart>,
    pub diagrams: Vec<Diagram>,
    pub events: Vec<Event>,
}

/// A film that moves, stretches and breaks.
#[derive(Clone, Debug, Default)]
pub struct FilmTrack {
    pub name: String,
    /// Corners of each triangle, counter-clockwise seen from +z.
    pub triangles: Vec<[u32; 3]>,
    /// Mirror planes x = 0 and y = 0 that complete the picture.
    pub mirrored: [bool; 2],
    /// Values that get the first and the last colour.
    pub range: [f32; 2],
    pub frames: Vec<FilmFrame>,
}

/// A film at one time.
#[derive(Clone, Debug, Default)]
pub struct FilmFrame {
    pub time: f64,
    /// One entry a node.
    pub positions: Vec<[f32; 3]>,
    /// What the film is coloured by, one entry a node.
    pub values: Vec<f32>,
    /// Whether a triangle is there still, one entry a triangle.
    pub visible: Vec<bool>,
}

/// A rigid body that moves.
#[derive(Clone, Debug)]
pub struct BodyTrack {
    pub name: String,
    pub shape: BodyShape,
    pub poses: Vec<Pose>,
}

/// Shape of a body in its own axes.
#[derive(Clone, Debug)]
pub enum BodyShape {
    Sphere {
        radius: f32,
    },
    /// Surface made by turning a line about the z axis; its points are distance from the axis and z,
    /// from the top to the bottom.
    Revolved {
        profile: Vec<[f32; 2]>,
    },
    /// Points and triangles, counter-clockwise seen from outside.
    Surface {
        points: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
    },
}

/// Where a body is at one time.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    pub time: f64,
    pub position: [f32; 3],
    /// Unit quaternion i, j, k, w.
    pub rotation: [f32; 4],
}

/// A text beside the pictures.
#[derive(Clone, Debug)]
pub struct Document {
    /// Entity path, e.g. `summary`.
    pub path: String,
    pub title: String,
    /// Markdown.
    pub text: String,
}

/// Something that happened, for the log.
#[derive(Clone, Debug)]
pub struct Event {
    pub at: Moment,
    pub severity: Severity,
    pub text: String,
}

/// How much an event matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    Info,
    Warning,
}

impl Scene {
    /// Refuses lists whose lengths do not fit each other.
    pub(crate) fn check(&self) -> Result<(), VizError> {
        self.films.iter().try_for_each(FilmTrack::check)?;
        self.signals.iter().try_for_each(SignalTrack::check)?;
        self.diagrams.iter().try_for_each(Diagram::check)
    }
}

impl FilmTrack {
    fn check(&self) -> Result<(), VizError> {
        let named = self.triangles.iter().flatten().max();
        let needed = named.map_or(0, |node| *node as usize + 1);
        let expected = self.frames.first().map_or(0, |f| f.positions.len()).max(needed);
        for frame in &self.frames {
            let found = [frame.positions.len(), frame.values.len()];
            if let Some(&found) = found.iter().find(|found| **found != expected) {
                return Err(VizError::Nodes { film: self.name.clone(), time: frame.time, found, expected });
            }
            if frame.visible.len() != self.triangles.len() {
                return Err(VizError::Triangles {
                    film: self.name.clone(),
                    time: frame.time,
                    found: frame.visible.len(),
                    expected: self.triangles.len(),
                });
            }
        }
        Ok(())
    }
}
