//! A look at the whole touch, for the audit.

use nalgebra::{Isometry3, Point3};

use super::Contact;
use crate::engine::nodes::Nodes;

/// What a look at the present touch found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Inspection {
    /// Deepest point of film in the impactor, m.
    pub penetration: f64,
    /// Longest edge of an element in touch, m.
    pub longest_edge: f64,
    /// Whether a node that is held lies inside.
    pub frame_hit: bool,
}

impl Contact {
    /// Looks at the whole touch as it is now.
    pub fn inspect(&self, nodes: &Nodes, pose: &Isometry3<f64>) -> Inspection {
        let mut out = Inspection::default();
        let tolerance = 1e-4 * self.surface.size();
        for (first, second) in &self.near.elements {
            let deepest = [Some(first), second.as_ref()].into_iter().flatten().filter_map(|triangle| {
                let corners = triangle.map(|n| Point3::from(nodes.position[n as usize]));
                let offset = self.offset[triangle[0] as usize];
                self.surface.deepest(pose, &corners, offset + tolerance).map(|found| offset - found.touch.gap)
            });
            let Some(depth) = deepest.reduce(f64::max) else { continue };
            out.penetration = out.penetration.max(depth);
            out.longest_edge = out.longest_edge.max(longest_edge(first, second.as_ref(), nodes));
        }
        let held = |n: &&u32| nodes.inverse_mass[**n as usize][2] == 0.0;
        out.frame_hit = self.near.nodes.iter().filter(held).any(|n| {
            let gap = self.surface.touch(pose, &Point3::from(nodes.position[*n as usize])).gap;
            gap < self.offset[*n as usize] - tolerance
        });
        out
    }
}

/// Longest outer edge of an element given as its triangles, m.
fn longest_edge(first: &[u32; 3], second: Option<&[u32; 3]>, nodes: &Nodes) -> f64 {
    let [a, b, c] = first.map(|n| Point3::from(nodes.position[n as usize]));
    let d = second.map(|t| Point3::from(nodes.position[t[2] as usize]));
    let last = d.unwrap_or(c);
    [(a, b), (b, c), (c, last), (last, a)].iter().map(|(p, q)| nalgebra::distance(p, q)).fold(0.0, f64::max)
}
