//! What contact between films stores from step to step, saved and restored.

use serde::{Deserialize, Serialize};

use super::crossing::Crossing;
use super::tracking::Tracked;
use super::{FilmContact, FilmWork};
use crate::engine::film::Film;

/// What contact between films stores from step to step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FilmContactHistory {
    tracked: [Vec<Tracked>; 2],
    crossings: Vec<Crossing>,
    stale: Vec<u32>,
    is_near: bool,
    margin: f64,
    last_motion: f64,
    steps: u64,
    lost: u64,
    work: FilmWork,
}

impl FilmContactHistory {
    /// Whether it fits the faces of `contact`.
    pub(in crate::engine) fn fits(&self, contact: &FilmContact) -> bool {
        let (nodes, surface) = (contact.tracking[0].triangle.len(), &contact.surface);
        let (triangles, edges) = (surface.corners.len(), surface.edges.len());
        self.tracked.iter().flatten().all(|tracked| tracked.fits(nodes, triangles))
            && self.crossings.iter().all(|crossing| crossing.fits(edges))
            && self.stale.iter().all(|edge| (*edge as usize) < edges)
    }
}

impl FilmContact {
    /// The history after the last step.
    pub(in crate::engine) fn save(&self) -> FilmContactHistory {
        FilmContactHistory {
            tracked: [0, 1].map(|side| self.tracking[side].save()),
            crossings: self.crossings.clone(),
            stale: self.stale.clone(),
            is_near: self.is_near,
            margin: self.margin,
            last_motion: self.last_motion,
            steps: self.steps,
            lost: self.lost,
            work: self.work,
        }
    }

    /// Restores the history of a scene of the same `films`, whose elements have failed as they had then.
    pub(in crate::engine) fn restore(&mut self, history: FilmContactHistory, films: &[Film]) {
        self.surface.remove_deleted(films);
        for (tracking, tracked) in self.tracking.iter_mut().zip(&history.tracked) {
            tracking.restore(tracked, &self.surface);
        }
        self.is_near = history.is_near;
        self.crossings = history.crossings;
        self.stale = history.stale;
        self.margin = history.margin;
        self.last_motion = history.last_motion;
        self.steps = history.steps;
        self.lost = history.lost;
        self.work = history.work;
    }
}
