//! A look at the whole touch, for the audit.

use nalgebra::{Isometry3, Point3};

use super::Contact;
use super::near::NearElement;
use crate::engine::nodes::Nodes;

/// What a look at the present touch found.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactState {
    /// Deepest point of film in the impactor, m.
    pub penetration: f64,
    /// Longest edge of an element in touch, m.
    pub longest_edge: f64,
    /// Whether a node that is held lies inside.
    pub frame_hit: bool,
}

impl Contact {
    /// Smallest distance from any node, within its film, to the impactor at `pose`, m; negative inside.
    pub fn smallest_gap(&self, nodes: &Nodes, pose: &Isometry3<f64>) -> f64 {
        let gap = |n: usize| self.surface.touch(pose, &nodes.place(n)).gap - self.offset[n];
        (0..nodes.position.len()).map(gap).fold(f64::INFINITY, f64::min)
    }

    /// Looks at the whole touch as it is now.
    pub fn state(&self, nodes: &Nodes, pose: &Isometry3<f64>) -> ContactState {
        let mut out = ContactState::default();
        let tolerance = 1e-4 * self.surface.size();
        for NearElement { corners, .. } in &self.near.elements {
            let places = corners.map(|n| nodes.place(n as usize));
            let offset = self.offset[corners[0] as usize];
            let edge = longest_edge(&places);
            if edge <= out.longest_edge && self.surface.deepest_at_most(pose, &places) <= out.penetration - offset {
                continue;
            }
            let Some(found) = self.surface.deepest(pose, &places, offset + tolerance) else { continue };
            out.penetration = out.penetration.max(offset - found.touch.gap);
            out.longest_edge = out.longest_edge.max(edge);
        }
        let held = |n: &&u32| nodes.is_held(**n as usize);
        out.frame_hit = self.near.nodes.iter().filter(held).any(|n| {
            let gap = self.surface.touch(pose, &nodes.place(*n as usize)).gap;
            gap < self.offset[*n as usize] - tolerance
        });
        out
    }
}

/// Longest edge of an element, m.
fn longest_edge(corners: &[Point3<f64>; 4]) -> f64 {
    (0..4).map(|a| nalgebra::distance(&corners[a], &corners[(a + 1) % 4])).fold(0.0, f64::max)
}
