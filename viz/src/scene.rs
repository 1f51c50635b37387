//! Content of a recording: lengths in m, times in s.

use crate::VizError;
use crate::quantity::{Quantity, Stroke};
use plot::Plot;
use report::geometry::{SceneBody, SceneFace};
use scene::simulate::FilmState;

/// Everything in one recording.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name of the recording in the viewer.
    pub name: String,
    /// Simulated time, s; playback takes a few seconds.
    pub duration: f64,
    /// Whether it is shown while it is computed: the viewer then follows its end.
    pub is_live: bool,
    /// Part of the films that is in view, and as how large as they are coordinates are rounded.
    pub extent: Extent,
    /// Texts, the open one first.
    pub documents: Vec<Document>,
    /// Quantities that colour the films, the default first.
    pub quantities: Vec<Quantity>,
    /// Faces of film, in the order of a snapshot.
    pub faces: Vec<SceneFace>,
    /// The impactors and the bars of the frame, in the order of a snapshot.
    pub bodies: Vec<Body>,
    /// Points that move beside the films.
    pub points: Vec<PointTrack>,
    /// Charts of signals.
    pub charts: Charts,
    /// Diagrams, each in a tab; their marks are left out.
    pub diagrams: Vec<Plot>,
    /// Events of the log.
    pub events: Vec<Event>,
}

/// A rigid body that moves.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name in entity paths, e.g. `impactor`.
    pub name: String,
    /// Its surface.
    pub surface: SceneBody,
    /// Height of its top at first, m.
    pub top: f32,
}

/// Points that move, such as measured ones.
#[derive(Clone, Debug, Default)]
pub struct PointTrack {
    /// Name in entity paths, e.g. `field`.
    pub name: String,
    /// Radius as which they are drawn, m.
    pub radius: f32,
    /// Their states in ascending time.
    pub states: Vec<PointState>,
}

/// Points at one time.
#[derive(Clone, Debug, Default)]
pub struct PointState {
    /// Time, s.
    pub time: f64,
    /// Positions, m.
    pub positions: Vec<[f32; 3]>,
    /// Colour of each, sRGB.
    pub colours: Vec<[u8; 3]>,
}

/// A text of the recording.
#[derive(Clone, Debug)]
pub struct Document {
    /// Entity path, e.g. `texts/summary`.
    pub path: String,
    /// Title of its tab.
    pub title: String,
    /// Markdown.
    pub text: String,
}

/// An event for the log.
#[derive(Clone, Debug)]
pub struct Event {
    /// When it happens, s.
    pub time: f64,
    /// How much it matters.
    pub severity: Severity,
    /// Description of the event.
    pub text: String,
}

/// How much an event matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Part of the course of a run.
    Info,
    /// Puts results in doubt.
    Warning,
}

impl Scene {
    /// Refuses lists of inconsistent lengths.
    pub(crate) fn check(&self) -> Result<(), VizError> {
        self.charts.tracks().try_for_each(SignalTrack::check)
    }
}

/// A curve over time.
#[derive(Clone, Debug)]
pub struct SignalTrack {
    /// Entity path, e.g. `signals/velocity_m_s`.
    pub path: String,
    /// Label in the legend.
    pub label: String,
    /// Times of its values, s.
    pub times: Vec<f64>,
    /// One value a time; `NaN` leaves a gap.
    pub values: Vec<f32>,
    /// Colour and width of its line.
    pub stroke: Stroke,
}

/// A chart of signals.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Quantity and unit.
    pub title: String,
    /// The signals it shows.
    pub tracks: Vec<SignalTrack>,
}

/// Charts of signals.
#[derive(Clone, Debug, Default)]
pub struct Charts {
    /// Those beside the films, from top to bottom.
    pub beside: Vec<Chart>,
    /// Further ones, in tabs.
    pub tabs: Vec<Chart>,
}

impl Charts {
    /// The signals of all charts.
    pub(crate) fn tracks(&self) -> impl Iterator<Item = &SignalTrack> {
        self.beside.iter().chain(&self.tabs).flat_map(|chart| &chart.tracks)
    }
}

impl SignalTrack {
    pub(crate) fn check(&self) -> Result<(), VizError> {
        let (found, expected) = (self.values.len(), self.times.len());
        if found == expected {
            return Ok(());
        }
        Err(VizError::Mismatch(format!("signal `{}`: {found} values at {expected} times", self.path)))
    }
}

/// A box around films with their mirror images, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    pub(crate) low: [f32; 3],
    pub(crate) high: [f32; 3],
}

impl Default for Extent {
    /// The empty box.
    fn default() -> Extent {
        Extent { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] }
    }
}

impl Extent {
    /// Extended by what is drawn of a face in a state, and by the frame on whose springs it hangs.
    pub fn with(self, face: &SceneFace, film: &FilmState) -> Extent {
        let drawn = face.drawn(film);
        let corners = triangles(face, &drawn).flatten().map(|node| film.positions[node as usize]);
        let anchors = face.springs.iter().map(|spring| spring.anchor);
        corners
            .chain(anchors)
            .fold(self, |extent, point| face.images().fold(extent, |extent, image| extent.around(image.reflect(point))))
    }

    /// Its longest side; zero where there is nothing.
    pub(crate) fn size(&self) -> f32 {
        [0, 1, 2].map(|k| self.high[k] - self.low[k]).into_iter().fold(0.0, f32::max)
    }

    fn around(self, point: [f32; 3]) -> Extent {
        let Extent { low, high } = self;
        Extent { low: [0, 1, 2].map(|k| low[k].min(point[k])), high: [0, 1, 2].map(|k| high[k].max(point[k])) }
    }

    pub(crate) fn or_a_metre(self) -> Extent {
        if self.low[0] <= self.high[0] { self } else { Extent { low: [-0.5; 3], high: [0.5; 3] } }
    }
}

/// The triangles of the patches of a face that are `drawn`.
pub(crate) fn triangles(face: &SceneFace, drawn: &[bool]) -> impl Iterator<Item = [u32; 3]> {
    let drawn = face.patches.iter().zip(drawn).filter(|(_, is_drawn)| **is_drawn);
    drawn.flat_map(|(&[a, b, c, d], _)| [[a, b, c], [a, c, d]].into_iter().take(if c == d { 1 } else { 2 }))
}
