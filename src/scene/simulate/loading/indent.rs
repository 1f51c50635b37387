//! Indentation: an impactor is pressed slowly into the film.

use nalgebra::Isometry3;

use super::{LoadCase, slow};
use crate::model::{Model, loading};
use crate::simulate::fault::RunError;
use crate::simulate::mount::{self, Mounting};
use crate::simulate::tracks::Tracks;
use lab::signal::{Recording, column};
use membrane::engine::{self, Contact, Film, Loads, Nodes, RigidBody};

/// Decay times of a free oscillation in the duration of the indentation. The force is recorded throughout, so damping
/// must not add to it.
const DECAYS: f64 = 10.0;

/// Gap over the impactor's size that counts as closed.
const CLOSED: f64 = 1e-9;

/// Least step down over the impactor's size: beside nodes that it passes closely, steps of the gap alone would be too
/// many.
const LEAST_STEP: f64 = 1e-3;

/// An impactor that moves down by `depth` (m) at `velocity` (m/s).
pub(super) struct Indent<'a> {
    model: &'a Model,
    depth: f64,
    velocity: f64,
}

impl<'a> Indent<'a> {
    /// The loading of `model`.
    pub(super) fn new(model: &'a Model, loading: &loading::Indent) -> Indent<'a> {
        Indent { model, depth: loading.depth, velocity: loading.velocity }
    }
}

impl LoadCase for Indent<'_> {
    fn excess(&self, _: f64) -> f64 {
        let stretch = |_: &_, radius: f64| (self.depth / radius).hypot(1.0);
        slow::periods(self.model, self.model.run_time(), stretch) / slow::PERIODS
    }

    fn damping(&self) -> f64 {
        2.0 * DECAYS / self.model.run_time()
    }

    fn apply(&self, films: &[Film], nodes: &Nodes, _: &mut Loads) -> Result<Vec<engine::Impact>, RunError> {
        if self.model.impactors.is_empty() {
            return Ok(vec![]);
        }
        let (contact, mut pose) = mount::above_film(0, self.model, films, nodes)?;
        pose.translation.vector.z -= travel_to_contact(&contact, &pose, nodes).ok_or(RunError::Missed)?;
        let body = RigidBody::prescribed(pose, -self.velocity);
        Ok(vec![engine::Impact::new(body, contact).starting_in_contact(true)])
    }

    fn approach(&self, _body: &RigidBody) -> [f64; 2] {
        [self.velocity, 0.0]
    }

    /// Depth below first contact and the force on the impactor: the impulse of the film between two samples over that
    /// time.
    fn signals(&self, tracks: &Tracks, _: &Mounting) -> Recording {
        let force = |k: usize| tracks.bodies.iter().map(|body| body.contact_force(k)).sum();
        let row = |k: usize| [self.velocity * k as f64 * tracks.sampling.interval, force(k)];
        let rows: Vec<_> = (0..tracks.whole()).map(row).collect();
        tracks.table(&[column::DEPTH.name, column::FORCE.name], &rows)
    }
}

/// Travel (m) of the impactor at `pose` down to first contact; none where it passes all nodes. No gap closes faster
/// than the impactor goes down, so each step is the smallest gap, but at least the least step; if a node is then
/// inside, contact is found by bisection.
fn travel_to_contact(contact: &Contact, pose: &Isometry3<f64>, nodes: &Nodes) -> Option<f64> {
    let surface = contact.surface();
    let mut travel = 0.0;
    let lowest = nodes.position.iter().fold(f64::INFINITY, |low, x| low.min(x[2]));
    let gap_at = |travel: f64| {
        let mut at = *pose;
        at.translation.vector.z -= travel;
        contact.smallest_gap(nodes, &at)
    };
    let (closed, least_step) = (CLOSED * surface.size(), LEAST_STEP * surface.size());
    let mut gap = gap_at(travel);
    while gap >= closed {
        let before = travel;
        travel += gap.max(least_step);
        if pose.translation.vector.z - travel + surface.bounding_radius() <= lowest {
            return None;
        }
        gap = gap_at(travel);
        if gap < 0.0 {
            return Some(bisected(before, travel, closed, gap_at));
        }
    }
    Some(travel)
}

/// Travel (m) between one without contact and one with a node inside at which the gap is below `closed`.
fn bisected(mut clear: f64, mut inside: f64, closed: f64, gap_at: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (clear + inside);
        let gap = gap_at(middle);
        if gap < 0.0 {
            inside = middle;
        } else {
            clear = middle;
        }
        if (0.0..closed).contains(&gap) {
            break;
        }
    }
    clear
}
