//! One element of film pulled from equilibrium to equilibrium: a coupon without its inertia (theory.md, equation 161).

use std::mem;

use thiserror::Error;

use super::loading;
use super::mount::section;
use crate::mesh::{self, MeshError, Meshing, Outline, Side};
use crate::model::{Face, Model};
use membrane::engine::{Film, Nodes, Section, UndefinedFibreDirection, Vectors};
use membrane::material::Law;
use nalgebra::{Matrix2, Vector2};

/// Boundary condition across the film between two jaws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// The width is held, as under `[loading.stretch]`, where all nodes of a single element are in the jaws.
    Held,
    /// The transverse force is zero: a strip that is long compared with its width. Of a plastic film the force that shears
    /// it is zero too; fibres of fabric at an angle keep the stretches that (methods.md, equation 180) gives them.
    Free,
    /// No force acts on the long sides, across or along them: a long strip, whose film shears where its direction is
    /// none of the film's own.
    Strip,
    /// The film is strained alike in both directions: equibiaxial tension.
    Equal,
}

/// Why the curve of a single element cannot be computed.
#[derive(Debug, Error)]
pub enum PullError {
    /// The element cannot be meshed.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A fibre has no direction in the element.
    #[error(transparent)]
    FibreDirection(#[from] UndefinedFibreDirection),
    /// The loading, a strain or a time cannot be one of a pull, or no width is in equilibrium.
    #[error("{0}")]
    Other(String),
}

/// Nominal stress (Pa) of the film of `model` at `strains`, which it is stretched to one after the other: one
/// element of the size of the specimen, with the history variables of its law and the strain rate of the jaws. Beyond
/// the break strain the stress is zero; a rupture criterion of its own does not act, since what an element carries while it
/// tears depends on its size. A plastic film takes a strain in steps of a fifth of its yield strain: the return of one large
/// step is not that of its path. Film that warms up takes it in steps of 0.001.
///
/// # Errors
/// Another loading than a stretch, a strain of −1 or less, no transverse equilibrium.
pub fn pull(model: &Model, strains: &[f64], across: Across) -> Result<Vec<f64>, PullError> {
    let mut element = SingleElement::from_model(model)?;
    let (mut before, rate) = (0.0, element.rate);
    let stress = |strain: &f64| {
        let dt = (strain - before).abs() / rate;
        before = *strain;
        element.stress(*strain, dt, across)
    };
    strains.iter().map(stress).collect()
}

/// Stresses at the points `[time (s), strain]` of a path, which starts without strain at the time zero; between two
/// points of one strain the film is held.
///
/// # Errors
/// As [`pull`], and a time before the one of the previous point.
pub fn pull_along(model: &Model, path: &[[f64; 2]], across: Across) -> Result<Vec<f64>, PullError> {
    let mut element = SingleElement::from_model(model)?;
    let mut before = 0.0;
    let stress = |[time, strain]: &[f64; 2]| {
        if !(time.is_finite() && *time >= before) {
            return Err(PullError::Other(format!(
                "expected times from zero on that do not go back, found {time} s after {before} s"
            )));
        }
        let dt = time - before;
        before = *time;
        element.stress(*strain, dt, across)
    };
    path.iter().map(stress).collect()
}

/// Stress-free cross-section (m²) of the film between the jaws of a stretch test; none of another loading.
pub fn section_between_jaws(model: &Model) -> Option<f64> {
    loading::stretch(model).map(|stretch| stretch.section)
}

/// One element of the size of the specimen.
struct SingleElement {
    film: Film,
    /// Undeformed positions of its nodes, m.
    flat: Vectors,
    nodes: Nodes,
    /// Nodes on x+ and on y+.
    sides: [Vec<u32>; 2],
    /// Stress-free cross-section, m².
    section: f64,
    /// Strain rate of the jaws, 1/s.
    rate: f64,
    /// Strain at which a plastic film yields.
    yield_strain: Option<f64>,
    /// Engineering strain.
    strain: f64,
    /// Transverse stretch.
    width: f64,
    /// Displacement along the film over the distance across it.
    shear: f64,
    /// Changes of width and shear over that of the strain in the last step.
    trend: [f64; 2],
}

/// Largest step of the logarithmic strain of a plastic film, over its yield strain.
const STEP: f64 = 0.2;

/// Largest step of the logarithmic strain of other film that shears.
const SHEARED_STEP: f64 = 0.02;

/// Largest step of the logarithmic strain of film that warms up: its stress is that of the heat one step before.
const WARM_STEP: f64 = 1e-3;

/// Most halvings of a step of Newton's method that leaves more force than there was.
const HALVINGS: usize = 12;

/// Most steps from one strain to the next.
const MOST_STEPS: f64 = 1e5;

/// Difference of stretches by which the stiffness across a strip is found.
const DIFFERENCE: f64 = 1e-7;

/// Transverse force over the force along the film that counts as balanced.
const FORCE_TOLERANCE: f64 = 1e-9;

/// Difference of two transverse stretches that count as equal: without stress, forces are round-off alone.
const STRETCH_TOLERANCE: f64 = 1e-12;

/// Factor on the width from one guess to the next until two bracket the root.
const BRACKETING_FACTOR: f64 = 1.05;

/// Most iterations, of bracketing and of the false position.
const MOST_ITERATIONS: usize = 100;

impl SingleElement {
    fn from_model(model: &Model) -> Result<SingleElement, PullError> {
        let (Some(stretch), Outline::Rectangle { x, y }, [face]) =
            (loading::stretch(model), &model.specimen.shape, &model.faces[..])
        else {
            let message = "only a scenario with `[loading.stretch]` can be pulled: there is no direction without it";
            return Err(PullError::Other(message.to_owned()));
        };
        let face =
            Face { meshing: Meshing { element: face.meshing.element, size: x.max(*y), grading: None }, ..face.clone() };
        let mesh = mesh::build(&model.specimen.shape, [false; 2], &face.meshing)?;
        let mut nodes = Nodes::default();
        let section = Section { rupture: None, ..section(&face, 1.0) };
        let mut film = Film::mount(&mesh, &section, face.height, &mut nodes)?;
        let flat = nodes.position.clone();
        // Film with a Prony series is mounted before its first strain, however fast that is reached.
        load(&mut film, &mut nodes, &flat, UNSTRETCHED, 0.0);
        let sides = [Side::XPlus, Side::YPlus].map(|side| mesh.sides[side as usize].clone());
        let yield_strain = match &face.material.law {
            Law::Plastic(law) => Some(law.yield_strain()),
            _ => None,
        };
        let (section, rate) = (stretch.section, stretch.velocity / x);
        let [_, width, shear] = UNSTRETCHED;
        Ok(SingleElement {
            film,
            flat,
            nodes,
            sides,
            section,
            rate,
            yield_strain,
            strain: 0.0,
            width,
            shear,
            trend: [0.0; 2],
        })
    }

    /// Number of steps to `strain`.
    fn steps(&self, strain: f64, across: Across) -> usize {
        let plastic = self.yield_strain.map(|yield_strain| STEP * yield_strain);
        // Newton's method starts from the width and the shear before.
        let sheared = (across == Across::Strip).then_some(SHEARED_STEP);
        let warm = self.film.warms_up().then_some(WARM_STEP);
        let Some(longest) = [plastic.or(sheared), warm].into_iter().flatten().reduce(f64::min) else { return 1 };
        let change = (strain - self.strain).abs() / (1.0 + strain.min(self.strain));
        (change / longest).ceil().clamp(1.0, MOST_STEPS) as usize
    }

    /// Nominal stress (Pa) at `strain`, reached within `dt` (s).
    fn stress(&mut self, strain: f64, dt: f64, across: Across) -> Result<f64, PullError> {
        if !(strain.is_finite() && strain > -1.0) {
            return Err(PullError::Other(format!("expected an engineering strain above -1, found {strain}")));
        }
        let (steps, before) = (self.steps(strain, across), self.strain);
        let (change, dt) = ((strain - before) / steps as f64, dt / steps as f64);
        for step in 1..steps {
            self.step(before + change * step as f64, dt, across)?;
        }
        Ok(self.step(strain, dt, across)? / self.section)
    }

    /// Force (N) along the film at `strain`, reached in one step within `dt` (s).
    fn step(&mut self, strain: f64, dt: f64, across: Across) -> Result<f64, PullError> {
        let (along, before) = (1.0 + strain, [self.width, self.shear]);
        let no_width = || PullError::Other(format!("no width of the film is in equilibrium at the strain {strain}"));
        let free = |found: Option<[f64; 2]>| found.ok_or_else(no_width);
        [self.width, self.shear] = match across {
            Across::Held => [1.0, 0.0],
            Across::Strip => free(self.free_sides(along, dt).or_else(|| self.free_sides_by_brackets(along, dt)))?,
            Across::Free if self.yield_strain.is_some() => free(self.free_sides(along, dt))?,
            Across::Free => free(self.transverse_stretch(along, dt).map(|width| [width, 0.0]))?,
            Across::Equal => [along, 0.0],
        };
        let change = strain - self.strain;
        self.trend = match change == 0.0 {
            true => [0.0; 2],
            false => [(self.width - before[0]) / change, (self.shear - before[1]) / change],
        };
        self.strain = strain;
        Ok(self.pulled([along, self.width, self.shear], dt))
    }

    /// Force (N) along the film that is stretched and sheared within `dt` (s); updates its history and breaks the fibres
    /// that are past their break strain.
    fn pulled(&mut self, stretch: Stretch, dt: f64) -> f64 {
        load(&mut self.film, &mut self.nodes, &self.flat, stretch, dt);
        if self.film.fail(self.nodes.position.axes(), dt, false).broken > 0 {
            load(&mut self.film, &mut self.nodes, &self.flat, stretch, 0.0);
        }
        -self.nodes.total_force(&self.sides[0], 0)
    }

    /// Transverse stretch in equilibrium where the film is stretched by `along` within `dt` (s).
    fn transverse_stretch(&self, along: f64, dt: f64) -> Option<f64> {
        let mut nodes = self.nodes.clone();
        root(self.width, narrowed, &mut |width| self.forces(&mut nodes, [along, width, 0.0], dt).balanced()[0])
    }

    /// Forces of the film that is stretched and sheared within `dt` (s), whose history stays as it is.
    fn forces(&self, nodes: &mut Nodes, stretch: Stretch, dt: f64) -> Forces {
        load(&mut self.film.clone(), nodes, &self.flat, stretch, dt);
        let [pull, across] = [0, 1].map(|axis| -nodes.total_force(&self.sides[axis], axis));
        Forces { pull, side: [across, -nodes.total_force(&self.sides[1], 0)] }
    }

    /// Transverse stretch and shear at which no force acts on the long sides of the film that is stretched by `along`
    /// within `dt` (s), by Newton's method from those before: steps are short. A step that leaves more force than there was
    /// is halved, since curves have corners.
    fn free_sides(&self, along: f64, dt: f64) -> Option<[f64; 2]> {
        let mut nodes = self.nodes.clone();
        let mut forces = |[width, shear]: [f64; 2]| {
            let Forces { pull, side } = self.forces(&mut nodes, [along, width, shear], dt);
            (pull, Vector2::from(side))
        };
        // The trend of the last step is a good guess unless the film is unloaded.
        let change = along - 1.0 - self.strain;
        let mut found = [self.width + self.trend[0] * change, self.shear + self.trend[1] * change];
        let (mut pull, mut unbalanced) = forces(found);
        for _ in 0..MOST_ITERATIONS {
            if unbalanced.amax() <= FORCE_TOLERANCE * pull.abs() {
                return Some(found);
            }
            let [width, shear] = found;
            let moved = [[width + DIFFERENCE, shear], [width, shear + DIFFERENCE]].map(|moved| forces(moved).1);
            let stiffness = Matrix2::from_columns(&moved.map(|moved| (moved - unbalanced) / DIFFERENCE));
            let mut change = stiffness.try_inverse()? * unbalanced;
            let before = unbalanced.norm();
            for halving in 0..=HALVINGS {
                found = [width - change.x, shear - change.y];
                (pull, unbalanced) = forces(found);
                if unbalanced.norm() < before || change.amax() <= STRETCH_TOLERANCE {
                    break;
                }
                if halving == HALVINGS {
                    return None;
                }
                change *= 0.5;
            }
            if change.amax() <= STRETCH_TOLERANCE {
                return Some(found);
            }
        }
        None
    }

    /// The same by false position, of the shear at each width and of the width: slower, but sure where the stiffness of
    /// curves that hardly rise misleads Newton's method.
    fn free_sides_by_brackets(&self, along: f64, dt: f64) -> Option<[f64; 2]> {
        let mut nodes = self.nodes.clone();
        let mut forces = |width, shear| self.forces(&mut nodes, [along, width, shear], dt).balanced();
        let mut shear = self.shear;
        let mut unbalanced = |width: f64| {
            shear = root(shear, sheared(), &mut |shear| forces(width, shear)[1]).unwrap_or(f64::NAN);
            forces(width, shear)[0]
        };
        let width = root(self.width, narrowed, &mut unbalanced).filter(|width| unbalanced(*width).is_finite())?;
        Some([width, shear])
    }
}

/// Forces of the film, N.
struct Forces {
    /// Along the film.
    pull: f64,
    /// On a long side, across and along it.
    side: [f64; 2],
}

impl Forces {
    /// Those on a long side, zero where they are balanced.
    fn balanced(&self) -> [f64; 2] {
        self.side.map(|force| if force.abs() <= FORCE_TOLERANCE * self.pull.abs() { 0.0 } else { force })
    }
}

/// The first step of the shear until two bracket the root, and its growth from step to step.
const SHEAR_STEP: f64 = 1e-3;
const SHEAR_GROWTH: f64 = 1.6;

/// Stretches along and across, and the displacement along over the distance across.
type Stretch = [f64; 3];

/// Film as it is mounted.
const UNSTRETCHED: Stretch = [1.0, 1.0, 0.0];

/// The transverse stretch after this one until two bracket the root: a tensile transverse force makes the film narrower.
fn narrowed(width: f64, is_tensile: bool) -> f64 {
    width * if is_tensile { 1.0 / BRACKETING_FACTOR } else { BRACKETING_FACTOR }
}

/// The same of shears: a force along the shear reduces it.
fn sheared() -> impl FnMut(f64, bool) -> f64 {
    let mut step = SHEAR_STEP;
    move |shear, is_along| {
        let next = shear + if is_along { -step } else { step };
        step *= SHEAR_GROWTH;
        next
    }
}

/// The root of the force, between two guesses from `guess` on, by the Illinois variant of the false position (Dowell and
/// Jarratt, BIT 11, 1971). `next` gives the guess after one, by whether the force at the first is positive.
fn root(guess: f64, mut next: impl FnMut(f64, bool) -> f64, unbalanced: &mut impl FnMut(f64) -> f64) -> Option<f64> {
    let mut last = (guess, unbalanced(guess));
    let is_positive = last.1 > 0.0;
    let bracket = (0..MOST_ITERATIONS).find_map(|_| {
        let place = next(last.0, is_positive);
        let now = (place, unbalanced(place));
        let before = mem::replace(&mut last, now);
        (before.1 * now.1 <= 0.0).then_some([now, before])
    });
    let [mut other, mut last] = bracket?;
    for _ in 0..MOST_ITERATIONS {
        if last.1 == 0.0 || (other.0 - last.0).abs() <= STRETCH_TOLERANCE {
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

/// Stretches and shears the film, `flat` before, within `dt` (s), and sets the forces of its nodes.
fn load(film: &mut Film, nodes: &mut Nodes, flat: &Vectors, [along, across, shear]: Stretch, dt: f64) {
    for (n, [x, y, z]) in flat.iter().enumerate() {
        nodes.position.set(n, [along * x + shear * y, across * y, z]);
    }
    nodes.clear_forces();
    film.add_forces(nodes, dt);
}
