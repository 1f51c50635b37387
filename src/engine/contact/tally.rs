//! Work of the impulses of a step.

use std::ops::Add;

use nalgebra::Vector3;

use super::{Impulse, Work};
use crate::engine::rigid_body::RigidBody;
use crate::lane::{LANES, Lane, Lane3, cross, dot};

/// Sums over impulses: all that the work of a step needs besides the motion of the body.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    normal: Sum,
    tangential: Sum,
}

/// Sum over one kind of impulse.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    /// N s.
    impulse: Vector3<f64>,
    /// About the centre of mass, N m s.
    moment: Vector3<f64>,
    /// Times the mean of the film's velocities before and after, J.
    film: f64,
}

/// The same, a sum a lane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LaneTally {
    normal: LaneSum,
    tangential: LaneSum,
}

#[derive(Clone, Copy, Debug, Default)]
struct LaneSum {
    impulse: Lane3,
    moment: Lane3,
    film: Lane,
}

impl LaneTally {
    /// Adds impulses, a lane each, on film that moved at `film` (m/s) in the mean of the velocities before and after.
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
    pub(super) fn total(&self) -> Tally {
        let sum = |of: &LaneSum| Sum {
            impulse: of.impulse.map(|axis| axis.iter().sum()).into(),
            moment: of.moment.map(|axis| axis.iter().sum()).into(),
            film: of.film.iter().sum(),
        };
        Tally { normal: sum(&self.normal), tangential: sum(&self.tangential) }
    }
}

impl Tally {
    /// Adds an impulse on film that moved at `film` (m/s) in the mean of the velocities before and after.
    #[inline(always)]
    pub(super) fn add(&mut self, impulse: &Impulse, film: &Vector3<f64>) {
        for (sum, part) in [(&mut self.normal, &impulse.normal), (&mut self.tangential, &impulse.tangential)] {
            sum.impulse += part;
            sum.moment += impulse.arm.cross(part);
            sum.film += part.dot(film);
        }
    }
}

impl Tally {
    /// N s.
    pub(super) fn impulse(&self) -> Vector3<f64> {
        self.normal.impulse + self.tangential.impulse
    }

    /// About the centre of mass, N m s.
    pub(super) fn moment(&self) -> Vector3<f64> {
        self.normal.moment + self.tangential.moment
    }
}

impl Add for Tally {
    type Output = Tally;

    fn add(self, other: Tally) -> Tally {
        let both =
            |a: Sum, b: Sum| Sum { impulse: a.impulse + b.impulse, moment: a.moment + b.moment, film: a.film + b.film };
        Tally { normal: both(self.normal, other.normal), tangential: both(self.tangential, other.tangential) }
    }
}

impl Work {
    /// Adds a step's impulses, each times the mean of the velocities before and after it (theory.md, equation 22); the body
    /// moved as `before`, then as `after`.
    pub(super) fn add(&mut self, tally: &Tally, multiplicity: f64, after: &RigidBody, before: &RigidBody) {
        let surface = |sum: &Sum| after.work_of(&sum.impulse, &sum.moment, before);
        let (normal, tangential) = (surface(&tally.normal), surface(&tally.tangential));
        self.impulse -= multiplicity * (tally.normal.impulse.z + tally.tangential.impulse.z);
        self.given += multiplicity * (normal + tangential);
        self.ahead = 0.5 * multiplicity * (normal + tangential);
        self.impact_loss += multiplicity * (normal - tally.normal.film);
        self.friction_loss += multiplicity * (tangential - tally.tangential.film);
    }
}
