//! Indentation: an impactor is pressed slowly into the film.

use nalgebra::Isometry3;

use super::{Inertia, LoadCase, MassScaling, slow};
use crate::engine::{self, Contact, Film, Loads, Nodes, RigidBody};
use crate::model::Model;
use crate::signal::{Recording, column};
use crate::simulate::fault::RunError;
use crate::simulate::mount::{self, Mounting};
use crate::simulate::tracks::Tracks;

/// Times in which damping takes a free oscillation to 1/e, over the time of the indentation: the force is read throughout,
/// so that damping must not add to it.
const DECAYS: f64 = 10.0;

/// Gap over the impactor's size at which it is in touch.
const TOUCH: f64 = 1e-9;

/// Least way down at once over the impactor's size: past nodes that it nearly touches, but never will, the gap alone would
/// take for ever.
const STRIDE: f64 = 1e-3;

/// An impactor that goes `depth` (m) down at `velocity` (m/s).
pub(super) struct Indent<'a> {
    pub(super) model: &'a Model,
    pub(super) depth: f64,
    pub(super) velocity: f64,
    pub(super) mass_scaling: Option<f64>,
}

impl LoadCase for Indent<'_> {
    fn inertia(&self) -> Inertia {
        Inertia::Negligible
    }

    fn mass_scaling(&self) -> MassScaling {
        self.mass_scaling.into()
    }

    fn excess(&self, _: f64) -> f64 {
        let stretch = |_: &_, radius: f64| (self.depth / radius).hypot(1.0);
        slow::periods(self.model, self.model.run_time(), stretch) / slow::PERIODS
    }

    fn damping(&self) -> f64 {
        2.0 * DECAYS / self.model.run_time()
    }

    fn apply(&self, films: &[Film], nodes: &Nodes, _: &mut Loads) -> Result<Option<engine::Impact>, RunError> {
        let Some(impactor) = &self.model.impactor else { return Ok(None) };
        let (contact, mut pose) = mount::over_film(impactor, self.model, films, nodes)?;
        pose.translation.vector.z -= way_to_contact(&contact, &pose, nodes).ok_or(RunError::Missed)?;
        Ok(Some(engine::Impact { body: RigidBody::driven(pose, -self.velocity), contact }))
    }

    fn approach(&self) -> [f64; 2] {
        [self.velocity, 0.0]
    }

    /// Depth below first contact and the force on the impactor: the momentum that it got from the film between two samples,
    /// over that time.
    fn signals(&self, tracks: &Tracks, _: &Mounting) -> Recording {
        let row = |k: usize| [self.velocity * k as f64 * tracks.sample, tracks.contact_force(k)];
        let rows: Vec<_> = (0..tracks.whole().min(tracks.strains.rows.len())).map(row).collect();
        tracks.table(&[column::DEPTH.name, column::FORCE.name], &rows)
    }
}

/// How far the impactor at `pose` has to go down until a node touches, m; none where it passes all of them. No gap
/// closes faster than the impactor goes down, so it can always go down by the smallest; where that is less than a stride it
/// goes down by one, and back by halving if a node is then inside.
fn way_to_contact(contact: &Contact, pose: &Isometry3<f64>, nodes: &Nodes) -> Option<f64> {
    let surface = contact.surface();
    let mut way = 0.0;
    let lowest = nodes.position.iter().fold(f64::INFINITY, |low, x| low.min(x[2]));
    let gap_at = |way: f64| {
        let mut at = *pose;
        at.translation.vector.z -= way;
        contact.smallest_gap(nodes, &at)
    };
    let (touch, stride) = (TOUCH * surface.size(), STRIDE * surface.size());
    let mut gap = gap_at(way);
    while gap >= touch {
        let before = way;
        way += gap.max(stride);
        if pose.translation.vector.z - way + surface.bounding_radius() <= lowest {
            return None;
        }
        gap = gap_at(way);
        if gap < 0.0 {
            return Some(halved(before, way, touch, gap_at));
        }
    }
    Some(way)
}

/// Way (m) between one without touch and one with a node inside at which the gap is closed but for `touch`.
fn halved(mut clear: f64, mut inside: f64, touch: f64, gap_at: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (clear + inside);
        let gap = gap_at(middle);
        if gap < 0.0 {
            inside = middle;
        } else {
            clear = middle;
        }
        if (0.0..touch).contains(&gap) {
            break;
        }
    }
    clear
}
