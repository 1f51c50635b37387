//! The motion of a face at the times of a field that a run is compared with.

use serde::{Deserialize, Serialize};

use super::film::Film;
use crate::model;
use membrane::engine::View;

/// The motion of one face at given times. Unlike snapshots it is stored with a run whose figures are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceMotion {
    /// Index of the face.
    pub face: usize,
    /// Nodes at the corners of each element; a triangle has its last corner twice.
    pub corners: Vec<[u32; 4]>,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub mirrored: [bool; 2],
    /// Positions of the nodes in the reference configuration, the state in which the test starts, m.
    pub reference: Vec<[f64; 3]>,
    /// The states that the run has reached, ascending in time.
    pub states: Vec<FaceState>,
}

/// A face at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaceState {
    /// Time, s.
    pub time: f64,
    /// Displacements of the nodes from the reference configuration, m.
    pub displacements: Vec<[f32; 3]>,
}

/// Positions of a face as they are recorded: the part of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MotionRecord {
    reference: Vec<[f64; 3]>,
    states: Vec<FaceState>,
}

impl MotionRecord {
    /// Whether a state is wanted at `time` (s).
    pub(super) fn is_due(&self, wanted: &model::Motion, time: f64) -> bool {
        self.reference.is_empty() || wanted.times.get(self.states.len()).is_some_and(|due| *due <= time)
    }

    /// Records what is due. A wanted time lies within the step before that of `view`, from whose state it is extrapolated by
    /// the velocity: the error is one of the second order in the time step.
    pub(super) fn record(&mut self, wanted: &model::Motion, view: &View<'_>) {
        let Some(film) = view.films.get(wanted.face) else { return };
        if self.reference.is_empty() {
            self.reference = film.nodes.clone().map(|node| view.nodes.position.value_at(node)).collect();
        }
        while let Some(due) = wanted.times.get(self.states.len()).filter(|due| **due <= view.time) {
            let back = view.time - due;
            let displacement = |(node, reference): (usize, &[f64; 3])| {
                let (position, velocity) = (view.nodes.position.value_at(node), view.velocity(node));
                [0, 1, 2].map(|axis| (position[axis] - reference[axis] - back * velocity[axis]) as f32)
            };
            let displacements = film.nodes.clone().zip(&self.reference).map(displacement).collect();
            self.states.push(FaceState { time: *due, displacements });
        }
    }

    /// The motion of its face, whose topology is in `films`.
    pub(super) fn finish(self, wanted: &model::Motion, films: &[Film]) -> Option<FaceMotion> {
        let film = films.get(wanted.face).filter(|_| !self.reference.is_empty())?;
        Some(FaceMotion {
            face: wanted.face,
            corners: film.outlines().collect(),
            mirrored: film.mirrored,
            reference: self.reference,
            states: self.states,
        })
    }
}
