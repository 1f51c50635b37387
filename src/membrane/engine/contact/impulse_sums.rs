//! Impulses of a step: their sums and work, and the coefficients of friction, which node and face contact apply.

use std::ops::Add;

use nalgebra::Vector3;

use super::{Impulse, Work};
use crate::engine::energy::StepEnergy;
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
    /// Work on the film, in the half step before the full one and in that after it, J.
    film: [f64; 2],
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
    film: [Lane; 2],
}

impl LaneImpulseSums {
    /// Adds impulses, a lane each, on film with these velocities before and after (m/s).
    #[inline(always)]
    pub(super) fn add(&mut self, normal: &Lane3, tangential: &Lane3, arm: &Lane3, film: [&Lane3; 2]) {
        for (sum, part) in [(&mut self.normal, normal), (&mut self.tangential, tangential)] {
            sum.impulse += *part;
            sum.moment += cross(arm, part);
            sum.film[0] += 0.5 * dot(part, film[0]);
            sum.film[1] += 0.5 * dot(part, film[1]);
        }
    }

    /// The sums over all lanes.
    pub(super) fn total(&self) -> ImpulseSums {
        let sum = |of: &LaneSum| Sum {
            impulse: of.impulse.map(|axis| axis.iter().sum()).into(),
            moment: of.moment.map(|axis| axis.iter().sum()).into(),
            film: of.film.map(|half| half.iter().sum()),
        };
        ImpulseSums { normal: sum(&self.normal), tangential: sum(&self.tangential) }
    }
}

impl ImpulseSums {
    /// Adds an impulse on film with these velocities before and after (m/s).
    #[inline(always)]
    pub(super) fn add(&mut self, impulse: &Impulse, film: [&Vector3<f64>; 2]) {
        for (sum, part) in [(&mut self.normal, &impulse.normal), (&mut self.tangential, &impulse.tangential)] {
            sum.impulse += part;
            sum.moment += impulse.arm.cross(part);
            for half in 0..2 {
                sum.film[half] += 0.5 * part.dot(film[half]);
            }
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
        let both = |a: Sum, b: Sum| Sum {
            impulse: a.impulse + b.impulse,
            moment: a.moment + b.moment,
            film: [a.film[0] + b.film[0], a.film[1] + b.film[1]],
        };
        ImpulseSums { normal: both(self.normal, other.normal), tangential: both(self.tangential, other.tangential) }
    }
}

impl Work {
    /// Adds the work of the impulses of a step, each times the mean of the velocities before and after it (theory.md,
    /// equation 22), of a body that moved as the first of `bodies` before, as the second afterwards.
    pub(super) fn add(&mut self, sums: &ImpulseSums, multiplicity: f64, bodies: [&RigidBody; 2]) {
        let surface = |sum: &Sum| bodies.map(|body| body.half_work(&sum.impulse, &sum.moment));
        let (normal, tangential) = (surface(&sums.normal), surface(&sums.tangential));
        let add = |to: &mut StepEnergy, of: &dyn Fn(usize) -> f64| to.add([multiplicity * of(0), multiplicity * of(1)]);
        self.impulse -= multiplicity * (sums.normal.impulse.z + sums.tangential.impulse.z);
        add(&mut self.on_film, &|half| normal[half] + tangential[half]);
        add(&mut self.loss.impact, &|half| normal[half] - sums.normal.film[half]);
        add(&mut self.loss.friction, &|half| tangential[half] - sums.tangential.film[half]);
    }
}

/// Coulomb's coefficients at the nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    /// Of the body and the first face.
    pub(super) body_on_film: f64,
    /// Of a further face and the one before it, through which the body presses on it.
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

    /// Coefficient at a node.
    #[inline(always)]
    pub(super) fn at(&self, node: u32) -> f64 {
        if (node as usize) < self.first_face { self.body_on_film } else { self.film_on_film }
    }

    /// Coefficient at each of some nodes.
    #[inline(always)]
    pub(super) fn lanes(&self, nodes: &[u32; LANES]) -> Lane {
        lanes(|l| self.at(nodes[l]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_faces_slip_on_film() {
        let one = Friction::of_body(0.3);
        assert!((0..9).all(|node| one.at(node) == 0.3));
        let two = one.with_faces(0.1, 4);
        assert_eq!([3, 4].map(|node| two.at(node)), [0.3, 0.1]);
    }
}
