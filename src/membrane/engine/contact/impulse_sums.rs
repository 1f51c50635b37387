//! Impulses of a step: their friction, their sums and work, and their part in the work of mass-proportional damping.

use std::ops::Add;

use nalgebra::Vector3;

use super::{Contact, Impulse, Work};
use crate::engine::nodes::Nodes;
use crate::engine::rigid_body::RigidBody;
use crate::lane::{LANES, Lane, Lane3, cross, dot, lanes};

/// Sums over the impulses on the film, from which their work follows with the motion of the body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ImpulseSums {
    normal: Sum,
    tangential: Sum,
}

/// Sum over the impulses of one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    /// N s.
    impulse: Vector3<f64>,
    /// About the centre of mass, N m s.
    moment: Vector3<f64>,
    /// Work on the film: times the mean of its velocities before and after, J.
    film: f64,
}

/// Impulse sums, one a lane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LaneImpulseSums {
    normal: LaneSum,
    tangential: LaneSum,
}

#[derive(Clone, Copy, Debug, Default)]
struct LaneSum {
    impulse: Lane3,
    moment: Lane3,
    film: Lane,
}

impl LaneImpulseSums {
    /// Adds impulses, a lane each, on film whose velocities before and after have the mean `film` (m/s).
    #[inline(always)]
    pub(super) fn add(&mut self, normal: &Lane3, tangential: &Lane3, arm: &Lane3, film: &Lane3) {
        for (sum, part) in [(&mut self.normal, normal), (&mut self.tangential, tangential)] {
            let (moment, work) = (cross(arm, part), dot(part, film));
            for l in 0..LANES {
                sum.film[l] += work[l];
            }
            for axis in 0..3 {
                for l in 0..LANES {
                    sum.impulse[axis][l] += part[axis][l];
                    sum.moment[axis][l] += moment[axis][l];
                }
            }
        }
    }

    /// The sums over all lanes.
    pub(super) fn total(&self) -> ImpulseSums {
        let sum = |of: &LaneSum| Sum {
            impulse: of.impulse.map(|axis| axis.iter().sum()).into(),
            moment: of.moment.map(|axis| axis.iter().sum()).into(),
            film: of.film.iter().sum(),
        };
        ImpulseSums { normal: sum(&self.normal), tangential: sum(&self.tangential) }
    }
}

impl ImpulseSums {
    /// Adds an impulse on film whose velocities before and after have the mean `film` (m/s).
    #[inline(always)]
    pub(super) fn add(&mut self, impulse: &Impulse, film: &Vector3<f64>) {
        for (sum, part) in [(&mut self.normal, &impulse.normal), (&mut self.tangential, &impulse.tangential)] {
            sum.impulse += part;
            sum.moment += impulse.arm.cross(part);
            sum.film += part.dot(film);
        }
    }

    /// Sum of the impulses, N s.
    pub(super) fn impulse(&self) -> Vector3<f64> {
        self.normal.impulse + self.tangential.impulse
    }

    /// Sum of their moments about the centre of mass, N m s.
    pub(super) fn moment(&self) -> Vector3<f64> {
        self.normal.moment + self.tangential.moment
    }
}

impl Add for ImpulseSums {
    type Output = ImpulseSums;

    fn add(self, other: ImpulseSums) -> ImpulseSums {
        let both =
            |a: Sum, b: Sum| Sum { impulse: a.impulse + b.impulse, moment: a.moment + b.moment, film: a.film + b.film };
        ImpulseSums { normal: both(self.normal, other.normal), tangential: both(self.tangential, other.tangential) }
    }
}

impl Work {
    /// Adds the work of the impulses of a step, each times the mean of the velocities before and after it (theory.md,
    /// equation 22), of a body that moved as `before`, then as `after`.
    pub(super) fn add(&mut self, sums: &ImpulseSums, multiplicity: f64, after: &RigidBody, before: &RigidBody) {
        let surface = |sum: &Sum| after.work_of(&sum.impulse, &sum.moment, before);
        let (normal, tangential) = (surface(&sums.normal), surface(&sums.tangential));
        self.impulse -= multiplicity * (sums.normal.impulse.z + sums.tangential.impulse.z);
        self.on_film += multiplicity * (normal + tangential);
        self.ahead = 0.5 * multiplicity * (normal + tangential);
        self.impact_loss += multiplicity * (normal - sums.normal.film);
        self.friction_loss += multiplicity * (tangential - sums.tangential.film);
    }
}

/// The pair of surfaces that slip on each other at a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pair {
    /// The body and the first face.
    BodyOnFilm,
    /// A further face and the one before it, through which the body presses on it.
    FilmOnFilm,
}

/// Coefficient of each pair of surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    pub(super) body_on_film: f64,
    film_on_film: f64,
    /// Number of nodes of the first face, which come first.
    first_face: usize,
}

impl Friction {
    /// Friction of a single face on the body.
    pub(super) fn of_body(coefficient: f64) -> Friction {
        Friction { body_on_film: coefficient, film_on_film: coefficient, first_face: usize::MAX }
    }

    /// This friction with the coefficient `film_on_film` at the nodes from `first_face` on.
    pub(super) fn with_faces(self, film_on_film: f64, first_face: usize) -> Friction {
        Friction { film_on_film, first_face, ..self }
    }

    /// The surfaces that slip at a node.
    pub(super) fn pair(&self, node: usize) -> Pair {
        if node < self.first_face { Pair::BodyOnFilm } else { Pair::FilmOnFilm }
    }

    /// Coefficient of a pair of surfaces.
    pub(super) fn coefficient_of(&self, pair: Pair) -> f64 {
        match pair {
            Pair::BodyOnFilm => self.body_on_film,
            Pair::FilmOnFilm => self.film_on_film,
        }
    }

    /// Coefficient at each of some nodes.
    #[inline(always)]
    pub(super) fn lanes(&self, nodes: &[u32; LANES]) -> Lane {
        lanes(|l| self.coefficient_of(self.pair(nodes[l] as usize)))
    }
}

impl Contact {
    /// Records the predicted velocities of the nodes that may get an impulse.
    pub(in crate::engine) fn record_prediction(&mut self, nodes: &Nodes) {
        self.predicted.clear();
        self.predicted.extend(self.neighbours.impulse_nodes.iter().map(|n| nodes.velocity_of(*n as usize)));
    }

    /// Σ m v̄·½Δv with the mean `v̄` of the velocities before the step and of the predictor and the change `Δv` by the
    /// corrector, kg m²/s²: the damping force is that of the predictor, but its work is done along the corrected
    /// motion. Nodes that are `counted` elsewhere are left out.
    pub(in crate::engine) fn damping_correction(&self, nodes: &Nodes, counted: impl Fn(u32) -> bool) -> f64 {
        let of = |(n, predicted): (&u32, &Vector3<f64>)| {
            let n = *n as usize;
            0.25 * nodes.mass[n]
                * (nodes.velocity_of(n) - predicted)
                    .dot(&(Vector3::from(self.previous_velocity.value_at(n)) + predicted))
        };
        let own = self.neighbours.impulse_nodes.iter().zip(&self.predicted).filter(|(n, _)| !counted(**n));
        own.map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_faces_slip_on_film() {
        let one = Friction::of_body(0.3);
        assert!((0..9).all(|node| one.pair(node) == Pair::BodyOnFilm));
        let two = one.with_faces(0.1, 4);
        let coefficients = [3, 4].map(|node| two.coefficient_of(two.pair(node)));
        assert_eq!(coefficients, [0.3, 0.1]);
    }
}
