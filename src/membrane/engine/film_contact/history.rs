//! History of contact between films, saved and restored.

use serde::{Deserialize, Serialize};

use super::constraint::Carried;
use super::crossing::Crossing;
use super::crossings::Crossings;
use super::self_contact::{SelfContact, SelfContactHistory};
use super::tracking::Tracked;
use super::{FilmContact, FilmWork};
use crate::engine::film::Film;
use crate::engine::nodes::Vectors;

/// History of contact between films: its state from step to step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FilmContactHistory {
    tracked: [Vec<Tracked>; 2],
    crossings: Vec<Crossing>,
    carried: Vec<Carried>,
    stale: Vec<u32>,
    is_near: bool,
    itself: Option<SelfContactHistory>,
    path: f64,
    detected: Vectors,
    margin: f64,
    last_motion: f64,
    pushed: f64,
    steps: u64,
    lost: u64,
    unresolved: u64,
    work: FilmWork,
}

impl FilmContactHistory {
    /// Whether it fits the faces of `contact`.
    pub(in crate::engine) fn fits(&self, contact: &FilmContact) -> bool {
        let (nodes, surface) = (contact.tracking[0].triangle.len(), &contact.surface);
        let edges = surface.edges.len();
        self.tracked.iter().flatten().all(|tracked| tracked.fits(nodes, surface))
            && self.crossings.iter().all(|crossing| crossing.fits(edges))
            && self.carried.iter().all(|carried| carried.fits(nodes, edges))
            && self.detected.is_whole()
            && [0, nodes].contains(&self.detected.len())
            && self.stale.iter().all(|edge| (*edge as usize) < edges)
            && self.itself.is_some() == contact.itself.is_some()
            && self.itself.as_ref().is_none_or(|itself| itself.fits(nodes, surface))
    }
}

impl FilmContact {
    /// The history after the last step.
    pub(in crate::engine) fn save(&self) -> FilmContactHistory {
        FilmContactHistory {
            tracked: [0, 1].map(|side| self.tracking[side].save()),
            crossings: self.crossings.iter().collect(),
            carried: self.carried.clone(),
            stale: self.stale.clone(),
            is_near: self.is_near,
            itself: self.itself.as_ref().map(SelfContact::save),
            path: self.path,
            detected: self.detected.clone(),
            margin: self.margin,
            last_motion: self.last_motion,
            pushed: self.pushed,
            steps: self.steps,
            lost: self.lost,
            unresolved: self.unresolved,
            work: self.work,
        }
    }

    /// Restores the history of a scene of the same `films`, whose elements have failed as they had then.
    pub(in crate::engine) fn restore(&mut self, history: FilmContactHistory, films: &[Film]) {
        // Before the tracking, whose neighbours across edges it changes.
        self.surface.remove_deleted(films);
        for (tracking, tracked) in self.tracking.iter_mut().zip(&history.tracked) {
            tracking.restore(tracked, &self.surface);
        }
        self.is_near = history.is_near;
        if let (Some(itself), Some(history)) = (&mut self.itself, history.itself) {
            itself.restore(history, &self.surface);
        }
        self.path = history.path;
        self.detected = history.detected;
        self.crossings = Crossings::new(self.surface.edges.len());
        // In the order in which they were listed: sweeps go through them in it, and another order gives other bits.
        history.crossings.into_iter().for_each(|crossing| self.crossings.push(crossing, &self.surface));
        self.carried = history.carried;
        self.stale = history.stale;
        self.margin = history.margin;
        self.last_motion = history.last_motion;
        self.pushed = history.pushed;
        self.steps = history.steps;
        self.lost = history.lost;
        self.unresolved = history.unresolved;
        self.work = history.work;
    }
}
