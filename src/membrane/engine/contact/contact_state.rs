//! The present state of contact: penetration, element size, contact at the frame.

use nalgebra::{Isometry3, Point3};

use super::Contact;
use super::neighbours::NeighbourElement;
use crate::engine::nodes::Nodes;

/// State of contact at one time.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactState {
    /// Largest penetration of a point of film, m.
    pub penetration: f64,
    /// Longest edge of an element in contact, m.
    pub longest_edge: f64,
    /// Whether a held node penetrates the impactor.
    pub frame_hit: bool,
}

impl Contact {
    /// Smallest gap between the impactor at `pose` and the film at any node, m; negative where a node penetrates.
    pub fn smallest_gap(&self, nodes: &Nodes, pose: &Isometry3<f64>) -> f64 {
        let gap = |n: usize| self.surface.project(pose, &nodes.position_of(n)).distance - self.offset[n];
        (0..nodes.position.len()).map(gap).fold(f64::INFINITY, f64::min)
    }

    /// The state of contact with the impactor at `pose`.
    pub(in crate::engine) fn state(&self, nodes: &Nodes, pose: &Isometry3<f64>) -> ContactState {
        let mut out = ContactState::default();
        let tolerance = 1e-4 * self.surface.size();
        for NeighbourElement { corners, .. } in &self.neighbours.elements {
            let positions = corners.map(|n| nodes.position_of(n as usize));
            let offset = self.offset[corners[0] as usize];
            let edge = longest_edge(&positions);
            let mut within = offset + tolerance + self.neighbours.edge;
            if edge <= out.longest_edge {
                if self.surface.penetration_bound(pose, &positions) <= out.penetration - offset {
                    continue;
                }
                within = within.min(offset - out.penetration + self.neighbours.edge);
            }
            let Some(found) = self.rounded.deepest_point(pose, &positions, within) else { continue };
            out.penetration = out.penetration.max(offset - found.extent);
            out.longest_edge = out.longest_edge.max(edge);
        }
        let held = |n: &&u32| nodes.is_held(**n as usize);
        out.frame_hit = self.neighbours.nodes.iter().filter(held).any(|n| {
            let distance = self.surface.project(pose, &nodes.position_of(*n as usize)).distance;
            distance < self.offset[*n as usize] - tolerance
        });
        out
    }
}

/// Longest edge of an element, m.
fn longest_edge(corners: &[Point3<f64>; 4]) -> f64 {
    (0..4).map(|a| nalgebra::distance(&corners[a], &corners[(a + 1) % 4])).fold(0.0, f64::max)
}
