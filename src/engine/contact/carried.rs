//! What contact carries from step to step, and what it takes of memory.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::near::NearList;
use super::touching::Piece;
use super::{Contact, Work};
use crate::engine::film::Film;
use crate::engine::footprint::bytes;

/// What contact carries from step to step, as plain numbers. The neighbour list is in it, because when it was made
/// decides which faces are watched until the next one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Carried {
    near: NearList,
    /// At the nodes of the list, in its order; all others are zero.
    normals: Vec<[f64; 3]>,
    work: Work,
}

impl Carried {
    /// Whether it can be of a scene with so many nodes.
    pub(in crate::engine) fn is_of(&self, nodes: usize) -> bool {
        self.near.is_of(nodes) && self.normals.len() == self.near.nodes.len()
    }
}

impl Contact {
    /// What it carries to the next step.
    pub(in crate::engine) fn carried(&self) -> Carried {
        let normals = self.near.nodes.iter().map(|n| self.normals[*n as usize].into()).collect();
        Carried { near: self.near.clone(), normals, work: self.work }
    }

    /// Puts back what was carried in a scene of these `films`.
    pub(in crate::engine) fn restore(&mut self, carried: Carried, films: &[Film]) {
        self.normals.fill(Vector3::zeros());
        for (node, normal) in carried.near.nodes.iter().zip(&carried.normals) {
            self.normals[*node as usize] = Vector3::from(*normal);
        }
        self.near = carried.near;
        self.near.divide(films);
        self.work = carried.work;
    }

    /// Bytes of the arrays that grow with the mesh.
    pub(in crate::engine) fn bytes(&self) -> usize {
        let NearList { nodes, pieces, remembered, elements, watched, margin: _, pace: _ } = &self.near;
        let listed = bytes(nodes) + bytes(pieces) + bytes(remembered) + bytes(elements) + bytes(watched);
        listed
            + bytes(&self.offset)
            + bytes(&self.normals)
            + self.earlier.bytes()
            + self.pieces.iter().map(Piece::bytes).sum::<usize>()
    }
}
