//! Why a run has no outcome, or only part of one.

use thiserror::Error;

use super::outcome::Outcome;
use super::warning::ImpactorName;
use crate::mesh::{self, MeshError, Side};
use crate::model::{Impactor, Model};
use base::number;
use membrane::engine::{self, StateMismatch, SurfaceError, UndefinedFibreDirection};

/// Why there is no outcome.
#[derive(Debug, Error)]
pub enum RunError {
    /// The film or the impactor could not be meshed.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The surface of the impactor cannot be used for contact.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// A fibre has no direction in an element.
    #[error(transparent)]
    FibreDirection(#[from] UndefinedFibreDirection),
    /// The checkpoint belongs to another scene.
    #[error("the checkpoint does not fit: {0}")]
    StateMismatch(#[from] StateMismatch),
    /// The impactor starts inside the film.
    #[error("{name} starts {} mm inside the film", number::significant(1e3 * depth, 3))]
    Overlap {
        /// Its place among the impactors.
        impactor: usize,
        /// Its name.
        name: ImpactorName,
        /// How deep, m.
        depth: f64,
    },
    /// Two impactors start inside each other.
    #[error(
        "the impactors \"{}\" and \"{}\" start {} mm inside each other",
        names[0],
        names[1],
        number::significant(1e3 * depth, 3)
    )]
    ImpactorsOverlap {
        /// Their names.
        names: [String; 2],
        /// How deep, m.
        depth: f64,
    },
    /// An impactor starts inside the frame's bars.
    #[error(
        "{name} starts {} mm inside the bars of the frame",
        number::significant(1e3 * depth, 3)
    )]
    InFrame {
        /// Its place among the impactors.
        impactor: usize,
        /// Its name.
        name: ImpactorName,
        /// How deep, m.
        depth: f64,
    },
    /// Several faces are met from below, or from beside.
    #[error("{name} starts below the first of several faces, which is not supported")]
    Below {
        /// Its place among the impactors.
        impactor: usize,
        /// Its name.
        name: ImpactorName,
    },
    /// The pre-strain pulls film out of the frame's clamp.
    #[error(
        "the pre-strain of face {face} pulls with {} N/m at its edge, and the clamp holds {} N/m",
        number::significant(*pull, 4),
        number::significant(*held, 4)
    )]
    ClampTooWeak {
        /// The face, counted from one.
        face: usize,
        /// Largest force of the pre-strain over the length of an edge, N/m.
        pull: f64,
        /// Largest force of friction in the clamp over the length of the edge, N/m.
        held: f64,
        /// Force of the clamp that holds it, N.
        needed: f64,
    },
    /// A spring cannot have its preload within its length.
    #[error(
        "the pre-strain of face {face} pulls at a spring of the frame with {} N, which elongates it by {} mm: more than its length",
        number::significant(*force, 4),
        number::significant(1e3 * elongation, 4)
    )]
    SpringTooShort {
        /// The face, counted from one.
        face: usize,
        /// Its preload, N.
        force: f64,
        /// Its elongation, m.
        elongation: f64,
    },
    /// Springs cannot be spread evenly.
    #[error("{count} springs cannot be spread evenly over {edges} held edges of the computed part")]
    SpringsUneven {
        /// Their number on the computed part.
        count: usize,
        /// The number of edges.
        edges: usize,
    },
    /// A held side of rectangular film hangs on no spring.
    #[error("no spring stands on the held side `{}`", side.name())]
    SideWithoutSpring {
        /// The side.
        side: Side,
    },
    /// Springs have no edge to stand on: a side of an imported outline may be a corner.
    #[error("face {face} has no held edge on which springs stand")]
    NoHeldEdge {
        /// The face, counted from one.
        face: usize,
    },
    /// A cut passes through the middle of no element.
    #[error("a cut passes through no element of face {face}")]
    CutMisses {
        /// Its place among the cuts.
        cut: usize,
        /// The face, counted from one.
        face: usize,
    },
    /// Cuts part film between the jaws.
    #[error("the cuts part face {face} in two: nothing is stretched between the jaws")]
    CutsPart {
        /// The face, counted from one.
        face: usize,
    },
    /// Cuts free a piece of film.
    #[error("the cuts free a piece of face {face}, which nothing holds")]
    CutsFree {
        /// The face, counted from one.
        face: usize,
    },
    /// Faces lie inside each other at the start.
    #[error("two faces pass through each other before the test")]
    FacesCross,
    /// The impactor passes beside the film.
    #[error("there is no film below the impactor")]
    Missed,
    /// The run was cancelled.
    #[error("the run was cancelled")]
    Cancelled,
    /// The run failed numerically.
    #[error("{0}")]
    Failure(Box<Failure>),
}

impl RunError {
    /// Two bodies of `model` that start inside each other, by their places, and how deep, m; the last may be the bars.
    pub(super) fn of_overlap(model: &Model, ([first, second], depth): ([usize; 2], f64)) -> RunError {
        let name = |place: usize| model.impactors.get(place).map(|impactor| impactor.words().to_owned());
        match (name(first), name(second)) {
            (Some(first), Some(second)) => RunError::ImpactorsOverlap { names: [first, second], depth },
            // The bars are the last body.
            _ => RunError::InFrame { impactor: first, name: ImpactorName::of_impactor(model, first), depth },
        }
    }

    /// Whether the same run may succeed another time: it was cancelled, or the file of a mesh could not be read. What is
    /// wrong with the content of a file stays wrong as long as the file is the same.
    pub fn may_pass(&self) -> bool {
        matches!(
            self,
            RunError::Mesh(MeshError::File { fault: mesh::import::Fault::Read(_), .. }) | RunError::Cancelled
        )
    }

    /// Remedy in the scenario, if there is one.
    pub fn hint(&self) -> Option<String> {
        Some(match self {
            RunError::Overlap { .. } => "change its `position`, or leave out its height".to_owned(),
            RunError::ImpactorsOverlap { .. } | RunError::InFrame { .. } => {
                "change a `position`, or give a height".to_owned()
            }
            RunError::Below { .. } => {
                "the faces are stacked below the first: start above it, or mount one face".to_owned()
            }
            RunError::ClampTooWeak { needed, .. } => {
                // Rounded up, so that it holds.
                format!("a force of {} N holds it", (needed * (1.0 + 1e-9)).ceil())
            }
            RunError::SpringTooShort { .. } => {
                "use stiffer or more springs, a larger `length` or less pre-strain, or give a `preload`".to_owned()
            }
            RunError::SpringsUneven { edges, .. } => format!("use a multiple of {edges} springs on the computed part"),
            RunError::SideWithoutSpring { .. } => {
                "use more springs, or name the sides that hang on some in `frame.hold`".to_owned()
            }
            RunError::NoHeldEdge { .. } => "name sides that are edges, or hold \"all\"".to_owned(),
            RunError::FacesCross => {
                "mount them further apart, or leave contact between them out with `contact.film = false`".to_owned()
            }
            RunError::CutMisses { .. } => {
                "give points on the film, with symmetry on its computed part, further apart than an element".to_owned()
            }
            RunError::CutsPart { .. } => "end the cut further from an edge of the film, or from another cut".to_owned(),
            RunError::CutsFree { .. } => {
                "leave a part between the ends of a cut; a hole is one of `specimen.shape.polygon.holes`".to_owned()
            }
            RunError::Missed => "change `impactor.position`".to_owned(),
            RunError::Mesh(_)
            | RunError::Surface(_)
            | RunError::FibreDirection(_)
            | RunError::StateMismatch(_)
            | RunError::Cancelled
            | RunError::Failure(_) => return None,
        })
    }
}

/// A run that failed numerically, with what was computed until then.
#[derive(Debug, Error)]
#[error("{cause}")]
pub struct Failure {
    /// Time, place and cause.
    pub cause: Fault,
    /// Outcome until then.
    pub so_far: Outcome,
}

/// Why a run failed numerically.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    /// The engine stopped.
    #[error(transparent)]
    Engine(#[from] engine::Fault),
    /// An impactor is released where there is film or another impactor.
    #[error(
        "the impactor \"{name}\" is released at {time:.6} s {} mm inside {}: change its `position`, or release it at \
         another time",
        number::significant(1e3 * .depth, 3),
        .inside
    )]
    ReleasedInside {
        /// Its name.
        name: String,
        /// Time of the release, s.
        time: f64,
        /// Name of what it is inside: the film, the bars of the frame, or an impactor with its name.
        inside: String,
        /// How deep, m.
        depth: f64,
    },
    /// Inertia matters in a test that must be quasi-static.
    #[error(
        "not quasi-static: at {time:.6} s the film's kinetic energy is {} % of the energy that it took up",
        number::significant(100.0 * .share, 2)
    )]
    NotQuasiStatic {
        /// Time of the largest share, s.
        time: f64,
        /// Kinetic energy over the energy that the film took up.
        share: f64,
    },
    /// An inflated film still moves at the end.
    #[error(
        "not at rest: at the end, {time:.6} s, the deflection still changed by {} % in the last tenth of the run",
        number::significant(100.0 * .change, 2)
    )]
    NotAtRest {
        /// End of the run, s.
        time: f64,
        /// Change of the deflection over the last tenth of the run, over the deflection.
        change: f64,
    },
    /// The energy balance is lost.
    #[error(
        "the energy balance is off by {} % of the energy exchanged at {time:.6} s",
        number::significant(100.0 * .error, 2)
    )]
    EnergyBalance {
        /// Time of the last balance, s.
        time: f64,
        /// Error over the energy exchanged.
        error: f64,
    },
}

impl Fault {
    /// The fault of the engine in a run of `model`, with the names of its impactors.
    pub(super) fn of_engine(fault: engine::Fault, model: &Model) -> Fault {
        let name = |number: usize| model.impactors.get(number - 1).map_or("impactor", Impactor::words).to_owned();
        match fault {
            engine::Fault::ReleasedInFilm { time, impactor, depth } => {
                Fault::ReleasedInside { name: name(impactor), time, inside: "the film".to_owned(), depth }
            }
            engine::Fault::ReleasedInImpactor { time, impactor, other, depth } => {
                let inside = match model.impactors.get(other - 1) {
                    Some(other) => format!("the impactor \"{}\"", other.words()),
                    None => "the bars of the frame".to_owned(),
                };
                Fault::ReleasedInside { name: name(impactor), time, inside, depth }
            }
            fault => fault.into(),
        }
    }
}
