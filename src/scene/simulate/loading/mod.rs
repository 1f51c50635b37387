//! The kinds of loading: what each applies, records and damps.

mod bodies;
mod inflation;

use std::f64::consts::TAU;

use super::fault::RunError;
use super::mount::{self, Mounting};
use super::tracks::Tracks;
use crate::mesh::{Mesh, Outline, Side};
use crate::model::{Face, Hold, Loading, Model};
pub(super) use bodies::Stretch;
pub use bodies::ends_loaded;
use lab::signal::Recording;
use membrane::engine::{self, Film, Jaw, Loads, Nodes, RigidBody};

/// A kind of loading as it acts on the film; what it answers about itself is in its [`Loading`].
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

    /// The columns of `signals.csv`.
    fn signals(&self, tracks: &Tracks, mounting: &Mounting) -> Recording;
}

/// The loading of `model`.
pub(super) fn load_case(model: &Model) -> Box<dyn LoadCase + '_> {
    match &model.loading {
        Loading::Impact(loading) => Box::new(bodies::Impact { model, loading }),
        Loading::Stretch(loading) => Box::new(Stretch::new(model, loading)),
        Loading::Indent(loading) => Box::new(bodies::Indent { model, loading }),
        Loading::Inflation(loading) => Box::new(inflation::Inflation { model, loading }),
    }
}

/// The stretch of `model`; none under another loading.
pub(super) fn stretch(model: &Model) -> Option<Stretch> {
    match &model.loading {
        Loading::Stretch(loading) => Some(Stretch::new(model, loading)),
        _ => None,
    }
}

/// Duration of the loading in periods of the film, where the factor on its mass is chosen.
const PERIODS: f64 = 50.0;

/// First zero of the Bessel function J₀: angular frequency of a round membrane over its wave speed and radius.
const ROUND: f64 = 2.404_826;

/// Periods of the softest face in `time` (s); none on springs, which give way. `stretch` is that of a face of a radius (m) at
/// the end of the test (theory.md, section 10): an estimate within a factor of two.
fn periods(model: &Model, time: f64, stretch: impl Fn(&Face, f64) -> f64) -> f64 {
    let radius = radius(&model.specimen.shape, &model.frame.hold).filter(|_| model.frame.springs.is_none());
    let Some(radius) = radius else { return 0.0 };
    let frequency =
        |face: &Face| ROUND * (tension_at_most(face, stretch(face, radius)) / face.material.density).sqrt() / radius;
    let softest = model.faces.iter().map(frequency).fold(f64::INFINITY, f64::min);
    time * softest / TAU
}

/// Radius of the largest disc between held edges, m; none for imported outlines.
fn radius(shape: &Outline, hold: &Hold) -> Option<f64> {
    match shape {
        Outline::Rectangle { x, .. } if !hold.holds(Side::YMinus) || !hold.holds(Side::YPlus) => Some(0.5 * x),
        Outline::Rectangle { y, .. } if !hold.holds(Side::XMinus) || !hold.holds(Side::XPlus) => Some(0.5 * y),
        Outline::Rectangle { x, y } => Some(0.5 * x.min(*y)),
        Outline::Circle { radius } => Some(*radius),
        // Exact for discs and squares.
        Outline::Polygon(polygon) => Some(2.0 * polygon.area() / polygon.perimeter()),
        Outline::Mesh { .. } => None,
    }
}

/// [`tension`] at `stretch`, or at the first of ever halved strains that the law admits.
fn tension_at_most(face: &Face, stretch: f64) -> f64 {
    let strains = std::iter::successors(Some(stretch - 1.0), |strain| Some(0.5 * strain)).take(50);
    strains.map(|strain| tension(face, 1.0 + strain)).find(|tension| !tension.is_nan()).unwrap_or(f64::NAN)
}

/// Mean stress of a face, Pa, that is stretched in all directions by `stretch` beyond its pre-strain.
fn tension(face: &Face, stretch: f64) -> f64 {
    let p = mount::of_face(face, stretch);
    0.5 * (p[0][0] + p[1][1])
}
