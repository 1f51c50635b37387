//! Why a run has no outcome, or only part of one; what it refuses before its first step, found without running it.

use thiserror::Error;

use super::outcome::Outcome;
use super::warning::ImpactorName;
use super::{build, mount};
use crate::mesh::{MeshError, MeshErrorKind, Outline};
use crate::model::{Impactor, Model};
use crate::scenario::Document;
use base::diagnostic::Diagnostic;
use base::number;
use membrane::engine::{self, StateMismatch, SurfaceError, UndefinedFibreDirection};

/// Why film or bodies cannot be mounted.
#[derive(Clone, Debug, Error)]
#[error("{message}")]
pub struct Refusal {
    message: String,
    /// Remedy in the scenario.
    hint: String,
    place: Place,
}

/// The key that a refusal is about.
#[derive(Clone, Debug)]
enum Place {
    /// Path of a key.
    Key(String),
    /// The `position` of the impactor at this place.
    Position(usize),
}

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
    /// Film or bodies cannot be mounted as the scenario has them.
    #[error(transparent)]
    Mounting(#[from] Refusal),
    /// The run was cancelled.
    #[error("the run was cancelled")]
    Cancelled,
    /// The run failed numerically.
    #[error("{0}")]
    Failure(Box<Failure>),
}

impl RunError {
    /// A refusal of the key at `path`.
    pub(super) fn at_key(path: &str, message: impl Into<String>, hint: impl Into<String>) -> RunError {
        Refusal { message: message.into(), hint: hint.into(), place: Place::Key(path.to_owned()) }.into()
    }

    /// A refusal of the `position` of the impactor at this place.
    pub(super) fn at_position(impactor: usize, message: impl Into<String>, hint: impl Into<String>) -> RunError {
        Refusal { message: message.into(), hint: hint.into(), place: Place::Position(impactor) }.into()
    }

    /// Two bodies of `model` that start inside each other, by their places, and how deep, m; the last may be the bars.
    pub(super) fn of_overlap(model: &Model, ([first, second], depth): ([usize; 2], f64)) -> RunError {
        let (depth, hint) = (number::significant(1e3 * depth, 3), "change a `position`, or give a height");
        match (model.impactors.get(first), model.impactors.get(second)) {
            (Some(one), Some(other)) => {
                let names = format!("\"{}\" and \"{}\"", one.words(), other.words());
                RunError::at_position(second, format!("the impactors {names} start {depth} mm inside each other"), hint)
            }
            // The bars are the last body.
            _ => {
                let name = ImpactorName::of_impactor(model, first);
                RunError::at_position(first, format!("{name} starts {depth} mm inside the bars of the frame"), hint)
            }
        }
    }

    /// Whether the same run may succeed another time: it was cancelled, or the file of a mesh could not be read. What is
    /// wrong with the content of a file stays wrong as long as the file is the same.
    pub fn may_pass(&self) -> bool {
        match self {
            RunError::Mesh(error) => error.kind == MeshErrorKind::Unreadable,
            _ => matches!(self, RunError::Cancelled),
        }
    }

    /// Remedy in the scenario, if there is one.
    pub fn hint(&self) -> Option<String> {
        let RunError::Mounting(refusal) = self else { return None };
        Some(refusal.hint.clone())
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
        // Before film has taken up anything, it is any number.
        if *.share > 100.0 { "more than 10000".to_owned() } else { number::significant(100.0 * .share, 2) }
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

/// Checks that the scene of `model`, which `document` was checked to be, can be mounted: as a run does, but for what
/// depends on the equilibrium of the film before the test.
///
/// # Errors
/// Why not, at its place.
pub fn check(document: &Document, model: &Model) -> Result<(), Vec<Diagnostic>> {
    let surfaces = model.impactors.iter().enumerate();
    let surfaces = surfaces.filter_map(|(place, impactor)| Some((place, mount::surface(&impactor.shape).err()?)));
    let at = |key: String, error: RunError| {
        let mistake = Diagnostic::new(error.to_string()).at(&document.span(&key));
        mistake.hint_if(error.hint())
    };
    let mut mistakes: Vec<Diagnostic> =
        surfaces.map(|(place, error)| at(document.impactor_key(place, "shape"), error)).collect();
    if mistakes.is_empty() {
        mistakes.extend(refusal(model).map(|error| at(place_of(&error, document, model), error)));
    }
    if mistakes.is_empty() { Ok(()) } else { Err(mistakes) }
}

/// Why the scene cannot be mounted, if so.
fn refusal(model: &Model) -> Option<RunError> {
    let scene = match build::scene(model) {
        Ok(scene) => scene,
        Err(error) => return Some(error),
    };
    // Film that settles lifts bodies in contact with it, together.
    let overlap = scene.engine.overlap_of_impactors(|[a, b]| a.in_contact == b.in_contact)?;
    Some(RunError::of_overlap(model, overlap))
}

/// Path of the key of `document` that an error is about.
fn place_of(error: &RunError, document: &Document, model: &Model) -> String {
    match error {
        RunError::Mesh(error) => match (error.kind, &model.specimen.shape) {
            (MeshErrorKind::Size, _) => "specimen.mesh".to_owned(),
            (_, Outline::Mesh { .. }) => "specimen.shape.mesh".to_owned(),
            _ => "specimen.shape".to_owned(),
        },
        RunError::FibreDirection(_) => "specimen.md_angle".to_owned(),
        RunError::Mounting(Refusal { place: Place::Key(path), .. }) => path.clone(),
        RunError::Mounting(Refusal { place: Place::Position(impactor), .. }) => {
            document.impactor_key(*impactor, "position")
        }
        // Those of the impactors are known before.
        RunError::Surface(_) => "frame.bars.radius".to_owned(),
        RunError::StateMismatch(_) | RunError::Cancelled | RunError::Failure(_) => String::new(),
    }
}
