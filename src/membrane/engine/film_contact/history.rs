//! History of contact between films, saved and restored.

use serde::{Deserialize, Serialize};

use super::crossing::{Crossing, Crossings};
use super::self_contact::{SelfContact, SelfContactHistory};
use super::tracking::Tracked;
use super::{FilmContact, History};
use crate::engine::film::Film;

/// State of contact between films from step to step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FilmContactHistory {
    history: History,
    tracked: [Vec<Tracked>; 2],
    crossings: Vec<Crossing>,
    itself: Option<SelfContactHistory>,
}

impl FilmContactHistory {
    /// Whether it fits the faces of `contact`.
    pub(in crate::engine) fn fits(&self, contact: &FilmContact) -> bool {
        let (nodes, surface) = (contact.tracking[0].triangle.len(), &contact.surface);
        let edges = surface.edges.len();
        self.tracked.iter().flatten().all(|tracked| tracked.fits(nodes, surface))
            && self.crossings.iter().all(|crossing| crossing.fits(edges))
            && self.history.carried.iter().all(|carried| carried.fits(nodes, edges))
            && self.history.detected.is_whole()
            && [0, nodes].contains(&self.history.detected.len())
            && self.history.stale.iter().all(|edge| (*edge as usize) < edges)
            && self.itself.is_some() == contact.itself.is_some()
            && self.itself.as_ref().is_none_or(|itself| itself.fits(nodes, surface))
    }
}

impl FilmContact {
    /// The history after the last step.
    pub(in crate::engine) fn save(&self) -> FilmContactHistory {
        FilmContactHistory {
            history: self.history.clone(),
            tracked: [0, 1].map(|side| self.tracking[side].save()),
            crossings: self.crossings.iter().collect(),
            itself: self.itself.as_ref().map(SelfContact::save),
        }
    }

    /// Restores the history of a scene of the same `films`, whose elements have failed as they had then.
    pub(in crate::engine) fn restore(&mut self, saved: FilmContactHistory, films: &[Film]) {
        // Before the tracking, whose neighbours across edges it changes.
        self.surface.remove_deleted(films);
        for (tracking, tracked) in self.tracking.iter_mut().zip(&saved.tracked) {
            tracking.restore(tracked, &self.surface);
        }
        if let (Some(itself), Some(history)) = (&mut self.itself, saved.itself) {
            itself.restore(history, &self.surface);
        }
        self.crossings = Crossings::new(self.surface.edges.len());
        // In the order in which they were listed: sweeps go through them in it, and another order gives other bits.
        saved.crossings.into_iter().for_each(|crossing| self.crossings.push(crossing, &self.surface));
        self.history = saved.history;
    }
}
