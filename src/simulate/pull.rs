//! One element of film pulled from equilibrium to equilibrium: a coupon without its inertia (theory.md, equation 161).

use thiserror::Error;

use super::loading;
use super::mount::section;
use crate::engine::{Film, Nodes, UndefinedFibreDirection, Vectors};
use crate::mesh::{self, MeshError, Meshing, Outline, Side};
use crate::model::{Face, Model};

/// What jaws do to the width of the film between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// It stays as it is, as under `[loading.stretch]`: all nodes of a single element stand in the jaws.
    Held,
    /// It narrows or widens until nothing pulls across: a strip that is long for its width.
    Free,
}

/// Why film cannot be pulled.
#[derive(Debug, Error)]
pub enum PullError {
    /// There are no jaws.
    #[error("only a scenario with `[loading.stretch]` can be pulled: it says in which direction")]
    NotAStretch,
    /// The element cannot be made.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A fibre has no direction in the element.
    #[error(transparent)]
    FibreDirection(#[from] UndefinedFibreDirection),
    /// No film is shortened to nothing.
    #[error("no film has the engineering strain {strain}")]
    Strain { strain: f64 },
    /// No width is in equilibrium.
    #[error("no width of the film is in equilibrium at the strain {strain}")]
    NoWidth { strain: f64 },
}

/// Engineering stress (Pa) of the film of `model` at `strains`, to which it is pulled one after the other: a single element of the
/// whole specimen with its own element and law, which remembers its largest strains and feels the rate of the jaws. The stress
/// of film that is past its break strain is zero.
///
/// # Errors
/// Another loading than a stretch, a strain of −1 or less, film that finds no equilibrium across.
pub fn pull(model: &Model, strains: &[f64], across: Across) -> Result<Vec<f64>, PullError> {
    let mut element = SingleElement::of(model)?;
    let (mut width, mut before) = (1.0, 0.0);
    let stress = |strain: &f64| {
        if !(strain.is_finite() && *strain > -1.0) {
            return Err(PullError::Strain { strain: *strain });
        }
        let along = 1.0 + strain;
        let dt = (strain - before).abs() / element.rate;
        before = *strain;
        if across == Across::Free {
            width = element.width(along, width, dt).ok_or(PullError::NoWidth { strain: *strain })?;
        }
        Ok(element.pulled([along, width], dt) / element.section)
    };
    strains.iter().map(stress).collect()
}

/// One cell of film as large as the specimen.
struct SingleElement {
    film: Film,
    /// Where its nodes are undeformed, m.
    flat: Vectors,
    nodes: Nodes,
    /// Nodes on x+ and on y+.
    sides: [Vec<u32>; 2],
    /// Stress-free cross-section, m².
    section: f64,
    /// Strain rate of the jaws, 1/s.
    rate: f64,
}

/// Unbalanced force across the film over the pull along it.
const BALANCED: f64 = 1e-9;

/// Distance of two stretches across that are the same: where film is without stress, forces are rounding alone.
const ALIKE: f64 = 1e-12;

/// Factor on the width from one guess to the next until two enclose the one sought.
const STRIDE: f64 = 1.05;

/// Most guesses, before and after.
const GUESSES: usize = 100;

impl SingleElement {
    fn of(model: &Model) -> Result<SingleElement, PullError> {
        let (Some(stretch), Outline::Rectangle { x, y }, [face]) =
            (loading::stretch(model), &model.specimen.shape, &model.faces[..])
        else {
            return Err(PullError::NotAStretch);
        };
        let face = Face { meshing: Meshing { size: x.max(*y), ..face.meshing }, ..face.clone() };
        let mesh = mesh::build(&model.specimen.shape, [false; 2], &face.meshing)?;
        let mut nodes = Nodes::default();
        let film = Film::mount(&mesh, &section(&face, 1.0), face.height, &mut nodes)?;
        let sides = [Side::XPlus, Side::YPlus].map(|side| mesh.sides[side as usize].clone());
        let (flat, section, rate) = (nodes.position.clone(), stretch.section, stretch.velocity / x);
        Ok(SingleElement { film, flat, nodes, sides, section, rate })
    }

    /// Pull (N) along the film that is stretched along and across within `dt` (s); it remembers, and breaks.
    fn pulled(&mut self, stretch: [f64; 2], dt: f64) -> f64 {
        load(&mut self.film, &mut self.nodes, &self.flat, stretch, dt);
        let (failed, _) = self.film.delete_failed(self.nodes.position.axes());
        if failed > 0 { 0.0 } else { -self.nodes.pull(&self.sides[0], 0) }
    }

    /// Stretch across at which nothing pulls across film that is stretched by `along` within `dt` (s), looked for from `guess`.
    fn width(&self, along: f64, guess: f64, dt: f64) -> Option<f64> {
        let mut nodes = self.nodes.clone();
        let mut unbalanced = |across: f64| {
            load(&mut self.film.clone(), &mut nodes, &self.flat, [along, across], dt);
            let [pull, across] = [0, 1].map(|axis| -nodes.pull(&self.sides[axis], axis));
            if across.abs() <= BALANCED * pull.abs() { 0.0 } else { across }
        };
        let enclosed = enclose(guess, &mut unbalanced)?;
        balance(enclosed, &mut unbalanced)
    }
}

/// A stretch across and the force there, N.
type Guess = (f64, f64);

/// Two guesses between which the force changes its sign. Film that pulls inward gets narrower.
fn enclose(guess: f64, unbalanced: &mut impl FnMut(f64) -> f64) -> Option<[Guess; 2]> {
    let mut before = (guess, unbalanced(guess));
    let factor = if before.1 > 0.0 { 1.0 / STRIDE } else { STRIDE };
    for _ in 0..GUESSES {
        let now = (before.0 * factor, unbalanced(before.0 * factor));
        if before.1 * now.1 <= 0.0 {
            return Some([now, before]);
        }
        before = now;
    }
    None
}

/// Where the force is balanced, by the false position that halves the force of an end which stays (Dowell and Jarratt, BIT 11, 1971).
fn balance([mut other, mut last]: [Guess; 2], unbalanced: &mut impl FnMut(f64) -> f64) -> Option<f64> {
    for _ in 0..GUESSES {
        if last.1 == 0.0 || (other.0 - last.0).abs() <= ALIKE {
            return Some(last.0);
        }
        let place = (other.0 * last.1 - last.0 * other.1) / (last.1 - other.1);
        let now = (place, unbalanced(place));
        if now.1 * last.1 < 0.0 {
            other = last;
        } else {
            other.1 *= 0.5;
        }
        last = now;
    }
    None
}

/// Puts the nodes within `dt` (s) where the film, `flat` before, is stretched along x and y; they have its forces then.
fn load(film: &mut Film, nodes: &mut Nodes, flat: &Vectors, stretch: [f64; 2], dt: f64) {
    for (n, [x, y, z]) in flat.iter().enumerate() {
        nodes.position.set(n, [stretch[0] * x, stretch[1] * y, z]);
    }
    nodes.force.axes_mut().into_iter().for_each(|axis| axis.fill(0.0));
    film.add_forces(nodes, dt);
}
