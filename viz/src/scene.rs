//! Content of a recording, as plain values: lengths in m, times in s.

use crate::VizError;
use crate::diagram::Diagram;
use crate::quantity::{Quantity, Stroke};

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
    /// Films, in the order by which snapshots name them.
    pub films: Vec<FilmTrack>,
    /// The impactors, in the order by which their poses name them.
    pub bodies: Vec<BodyTrack>,
    /// Points that move beside the films.
    pub points: Vec<PointTrack>,
    /// Signals that the charts show.
    pub signals: Vec<SignalTrack>,
    /// Charts beside the films, from top to bottom.
    pub charts: Vec<Chart>,
    /// Further charts, in tabs.
    pub more_charts: Vec<Chart>,
    /// Diagrams, each in a tab.
    pub diagrams: Vec<Diagram>,
    /// Events of the log.
    pub events: Vec<Event>,
}

/// A film; its snapshots are logged one by one.
#[derive(Clone, Debug, Default)]
pub struct FilmTrack {
    /// Name in entity paths, e.g. `face-1`.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Corners of each element, counter-clockwise seen from +z; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
    /// Edges by which a frame or jaws hold it, as pairs of nodes.
    pub held: Vec<[u32; 2]>,
    /// Springs between the frame and its edges.
    pub springs: Vec<SpringTrack>,
    /// Factors on x, y and z of the mirror images that complete the picture.
    pub images: Vec<[f32; 3]>,
}

/// A spring between a frame that stands still and the edge of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringTrack {
    /// Its end on the frame, m.
    pub anchor: [f32; 3],
    /// Nodes between which its other end is.
    pub nodes: [u32; 2],
    /// Their weights.
    pub shares: [f32; 2],
}

/// A film at one time.
#[derive(Clone, Debug, Default)]
pub struct FilmSnapshot {
    /// Time, s.
    pub time: f64,
    /// Positions, m, one entry a node.
    pub positions: Vec<[f32; 3]>,
    /// Values of each of the scene's quantities, in its unit, one entry a node.
    pub values: Vec<Vec<f32>>,
    /// Whether an element is intact, one entry a patch.
    pub visible: Vec<bool>,
    /// Nodes in contact with a body.
    pub in_contact: Vec<u32>,
}

/// A rigid body that moves.
#[derive(Clone, Debug)]
pub struct BodyTrack {
    /// Name in entity paths, e.g. `impactor`.
    pub name: String,
    /// Points of its surface in its own axes, m.
    pub points: Vec<[f32; 3]>,
    /// Corners of each patch, counter-clockwise seen from outside; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
    /// Its poses in ascending time.
    pub poses: Vec<Pose>,
}

/// The pose of a body at one time.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Time, s.
    pub time: f64,
    /// Position of the origin of its axes, m.
    pub position: [f32; 3],
    /// Unit quaternion i, j, k, w.
    pub rotation: [f32; 4],
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
        self.signals.iter().try_for_each(SignalTrack::check)
    }
}

impl FilmTrack {
    /// Refuses a snapshot that is not of this film with so many quantities.
    pub(crate) fn check(&self, snapshot: &FilmSnapshot, quantities: usize) -> Result<(), VizError> {
        let edges = self.held.iter().chain(self.springs.iter().map(|spring| &spring.nodes)).flatten();
        let named = self.patches.iter().flatten().chain(edges).chain(&snapshot.in_contact).max();
        let nodes = named.map_or(0, |node| *node as usize + 1).max(self.nodes);
        let mismatch =
            |what: String| Err(VizError::Mismatch(format!("film `{}` at {} s: {what}", self.name, snapshot.time)));
        let mut lists = std::iter::once(snapshot.positions.len()).chain(snapshot.values.iter().map(Vec::len));
        if let Some(found) = lists.find(|found| *found != nodes) {
            return mismatch(format!("{found} positions or values for {nodes} nodes"));
        }
        let found = snapshot.values.len();
        if found != quantities {
            return mismatch(format!("values of {found} quantities where there are {quantities}"));
        }
        let (found, expected) = (snapshot.visible.len(), self.patches.len());
        if found == expected { Ok(()) } else { mismatch(format!("{found} visibilities for {expected} elements")) }
    }

    /// The triangles of the elements that are intact in a snapshot.
    pub(crate) fn visible(&self, snapshot: &FilmSnapshot) -> impl Iterator<Item = [u32; 3]> {
        let left = self.patches.iter().zip(&snapshot.visible).filter(|(_, is_visible)| **is_visible);
        triangles(left.map(|(patch, _)| *patch))
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
    /// Paths of the signals it shows.
    pub signals: Vec<String>,
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
    /// Extended by the corners of the visible elements of `film` in a snapshot, and by the frame on whose springs it hangs.
    pub fn with(self, film: &FilmTrack, snapshot: &FilmSnapshot) -> Extent {
        let corners = film.visible(snapshot).flatten().filter_map(|node| snapshot.positions.get(node as usize));
        let images = |extent: Extent, point: &[f32; 3]| {
            film.images.iter().fold(extent.around(*point), |extent, image| extent.around(mirrored(*point, *image)))
        };
        let anchors = film.springs.iter().map(|spring| &spring.anchor);
        corners.chain(anchors).fold(self, images)
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

/// The triangles of patches, two of each that is not one itself.
pub(crate) fn triangles(patches: impl Iterator<Item = [u32; 4]>) -> impl Iterator<Item = [u32; 3]> {
    patches.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]].into_iter().take(if c == d { 1 } else { 2 }))
}

pub(crate) fn mirrored(point: [f32; 3], image: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|axis| point[axis] * image[axis])
}
