//! The scene of a run: the faces of film, the impactors and the bars of the frame, in the states that are kept of them.

use super::body::Body;
use scene::simulate::{Film, FilmSpring, FilmState, Image, Outcome, Snapshot};

/// Sides of a round impactor.
const SIDES: u32 = 72;

/// The parts and fields of a run that can be drawn.
///
/// A page holds it coarsened and with strains alone ([`StoredPage::scene`](super::StoredPage::scene)); an outcome holds
/// every element and every field of its snapshots ([`run_scene`](super::run_scene)).
#[derive(Clone, Debug)]
pub struct RunScene {
    /// The faces of film, in the order of [`Snapshot::films`].
    pub faces: Vec<SceneFace>,
    /// The impactors, and after them the frame's bars, in the order of [`Snapshot::impactors`].
    pub bodies: Vec<SceneBody>,
    /// The kept states, ascending in time; at least one.
    pub states: Vec<Snapshot>,
    /// Events of the run, ascending in time.
    pub moments: Vec<Moment>,
    /// Whether the faces have fewer patches than the run has elements.
    pub is_coarsened: bool,
}

/// Topology of one face.
#[derive(Clone, Debug)]
pub struct SceneFace {
    /// Number of nodes.
    pub nodes: usize,
    /// Nodes at the corners of each patch, an element or several; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Springs of the frame on which it hangs.
    pub springs: Vec<FilmSpring>,
}

/// Surface of a body about its centre of mass.
#[derive(Clone, Debug)]
pub struct SceneBody {
    /// Vertices, m.
    pub points: Vec<[f32; 3]>,
    /// Vertices at the corners of each patch, counter-clockwise seen from outside; a triangle has its last corner twice.
    pub patches: Vec<[u32; 4]>,
}

/// An event of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// The event, such as `lowest point`.
    pub words: String,
    /// Time, s.
    pub time: f64,
}

impl SceneFace {
    /// The lines of its springs, from the frame to the film.
    pub fn spring_lines(&self, film: &FilmState) -> impl Iterator<Item = [[f32; 3]; 2]> {
        self.springs.iter().map(|spring| [spring.anchor, spring.end(&film.positions)])
    }

    /// The face and its mirror images.
    pub fn images(&self) -> impl Iterator<Item = Image> + use<> {
        Image::all(self.mirrored)
    }
}

impl RunScene {
    /// Every element of `outcome` in all its snapshots; `None` without snapshots.
    pub(super) fn of_outcome(outcome: &Outcome, moments: Vec<Moment>) -> Option<RunScene> {
        let states = outcome.snapshots.clone();
        let face = |film: &Film| SceneFace {
            nodes: film.nodes,
            patches: film.outlines().collect(),
            mirrored: film.mirrored,
            springs: film.springs.clone(),
        };
        let body = |surface| {
            let Body { points, triangles } = Body::from_surface(surface, SIDES);
            SceneBody { points, patches: triangles.iter().map(|&[a, b, c]| [a, b, c, c]).collect() }
        };
        let scene = RunScene {
            faces: outcome.films.iter().map(face).collect(),
            bodies: outcome.impactors.iter().map(body).collect(),
            states,
            moments,
            is_coarsened: false,
        };
        (!scene.states.is_empty()).then_some(scene)
    }

    /// The state whose time is nearest to `time` (s).
    pub fn nearest(&self, time: f64) -> &Snapshot {
        let apart = |state: &Snapshot| (state.time - time).abs();
        let nearest = self.states.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
        nearest.unwrap_or_else(|| unreachable!("a scene has states"))
    }

    /// The first state at or after `time` (s), else the last: it shows what happens at that time.
    pub fn at_or_after(&self, time: f64) -> &Snapshot {
        // Times on a page are rounded.
        let after = self.states.iter().find(|state| state.time >= time * (1.0 - 1e-6));
        after.or(self.states.last()).unwrap_or_else(|| unreachable!("a scene has states"))
    }
}
