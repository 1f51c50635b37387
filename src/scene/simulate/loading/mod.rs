//! The kinds of loading: what each applies, records and damps.

mod impact;
mod indent;
mod pressure;
mod slow;
mod stretch;
mod volume;

pub use impact::ends_loaded;
pub(super) use stretch::Stretch;

use super::fault::RunError;
use super::mount::{self, Mounting};
use super::tracks::Tracks;
use crate::mesh::Mesh;
use crate::model::{Hold, Loading, Model};
use lab::signal::Recording;
use membrane::engine::{self, Film, Jaw, Loads, Nodes, RigidBody};

/// A kind of loading as it acts on the film; what it answers about itself is its [`Kind`](crate::model::loading::Kind).
pub(super) trait LoadCase {
    /// Estimate of how many times longer than necessary the test is with the film's own mass, with which it takes
    /// `steps` steps. Above one, its square is the factor on the mass that is chosen; NaN where it cannot be estimated.
    fn excess(&self, _steps: f64) -> f64 {
        1.0
    }

    /// Mass-proportional damping of the film, 1/s (theory.md, equation 28).
    fn damping(&self) -> f64;

    /// Holds the nodes of `mesh`, of which `first` is the first of all `nodes`, and returns the jaws that move some of
    /// them.
    fn hold(&self, nodes: &mut Nodes, mesh: &Mesh, first: usize, hold: &Hold) -> Vec<Jaw> {
        mount::clamp(nodes, mesh, first, hold);
        vec![]
    }

    /// Adds what acts on the mounted `films` to `loads`, and returns the impactors.
    ///
    /// # Errors
    /// The surface of an impactor cannot be used, or has no film under it.
    fn apply(&self, films: &[Film], nodes: &Nodes, loads: &mut Loads) -> Result<Vec<engine::Impact>, RunError>;

    /// Speed of an impactor at the start (m/s, downward) and its downward acceleration (m/s²) before contact.
    fn approach(&self, _body: &RigidBody) -> [f64; 2] {
        [0.0; 2]
    }

    /// An energy of an impactor that the run exchanges at least, J; zero where none is known beforehand.
    fn energy_scale(&self, _body: &RigidBody) -> f64 {
        0.0
    }

    /// Whether the force on the mounting frame is recorded.
    fn has_frame_force(&self) -> bool {
        true
    }

    /// Whether the rise of the film is recorded.
    fn has_rise(&self) -> bool {
        false
    }

    /// The columns of `signals.csv`.
    fn signals(&self, tracks: &Tracks, mounting: &Mounting) -> Recording;
}

/// The loading of `model`.
pub(super) fn load_case(model: &Model) -> Box<dyn LoadCase + '_> {
    match &model.loading {
        Loading::Impact(loading) => Box::new(impact::Impact::new(model, loading)),
        Loading::Stretch(loading) => Box::new(Stretch::new(model, loading)),
        Loading::Indent(loading) => Box::new(indent::Indent::new(model, loading)),
        Loading::Pressure(loading) => Box::new(pressure::Pressure::new(model, loading)),
        Loading::Volume(loading) => Box::new(volume::Volume::new(model, loading)),
    }
}

/// The stretch of `model`; none under another loading.
pub(super) fn stretch(model: &Model) -> Option<Stretch> {
    match &model.loading {
        Loading::Stretch(loading) => Some(Stretch::new(model, loading)),
        _ => None,
    }
}
