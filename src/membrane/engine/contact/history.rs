//! History of contact, saved and restored.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::neighbours::NeighbourList;
use super::node_contact::NodeContacts;
use super::{Contact, Work};
use crate::engine::film::Film;
use crate::engine::footprint::bytes;

/// History of contact: its state from step to step. The neighbour list is part of it: when it was built decides which
/// elements are candidates for face contact until the next one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ContactHistory {
    neighbours: NeighbourList,
    /// At the nodes of the list, in its order; all others are zero.
    normals: Vec<[f64; 3]>,
    work: Work,
}

impl ContactHistory {
    /// Whether it fits a scene of `nodes` nodes.
    pub(in crate::engine) fn fits(&self, nodes: usize) -> bool {
        self.neighbours.fits(nodes) && self.normals.len() == self.neighbours.nodes.len()
    }
}

impl Contact {
    /// The history after the last step.
    pub(in crate::engine) fn save(&self) -> ContactHistory {
        let normals = self.neighbours.nodes.iter().map(|n| self.normals[*n as usize].into()).collect();
        ContactHistory { neighbours: self.neighbours.clone(), normals, work: self.work }
    }

    /// Restores the history of a scene of the same `films`.
    pub(in crate::engine) fn restore(&mut self, history: ContactHistory, films: &[Film]) {
        self.normals.fill(Vector3::zeros());
        for (node, normal) in history.neighbours.nodes.iter().zip(&history.normals) {
            self.normals[*node as usize] = Vector3::from(*normal);
        }
        self.neighbours = history.neighbours;
        self.rounded = self.surface.with_edges(self.neighbours.edge);
        self.neighbours.partition(films);
        self.work = history.work;
    }

    /// Bytes of the arrays that grow with the mesh.
    pub(in crate::engine) fn bytes(&self) -> usize {
        let NeighbourList { nodes, ranges, impulse_nodes, elements, face_candidates, followed, clearances, .. } =
            &self.neighbours;
        let listed = bytes(nodes)
            + bytes(ranges)
            + bytes(impulse_nodes)
            + bytes(elements)
            + bytes(face_candidates)
            + bytes(followed)
            + bytes(clearances);
        listed
            + bytes(&self.offset)
            + bytes(&self.normals)
            + bytes(&self.nearest)
            + self.previous_velocity.bytes()
            + bytes(&self.predicted)
            + self.swept.as_deref().map_or(0, bytes)
            + self.contacts.iter().map(NodeContacts::bytes).sum::<usize>()
    }
}
