//! A look at the whole touch, for the audit.

use nalgebra::{Isometry3, Point3};

use super::Contact;
use crate::engine::film::Film;
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
    pub fn inspect(&self, films: &[Film], nodes: &Nodes, pose: &Isometry3<f64>) -> Inspection {
        let mut out = Inspection::default();
        let tolerance = 1e-4 * self.surface.size();
        for film in films {
            film.for_each_intact(|corners| {
                let gap = |n: u32| {
                    let offset = self.offset[n as usize];
                    self.surface.touch(pose, &Point3::from(nodes.position[n as usize])).gap - offset
                };
                let centre = Point3::from(pose.translation.vector);
                let longest = longest_edge(corners, nodes);
                let far = self.surface.reach() + longest + tolerance;
                if nalgebra::distance(&Point3::from(nodes.position[corners[0] as usize]), &centre) > far {
                    return;
                }
                let inside: Vec<u32> = corners.iter().copied().filter(|n| gap(*n) < tolerance).collect();
                if inside.is_empty() {
                    return;
                }
                let held = |n: &u32| gap(*n) < -tolerance && nodes.inverse_mass[*n as usize][2] == 0.0;
                out.frame_hit |= inside.iter().any(held);
                out.longest_edge = out.longest_edge.max(longest);
                for k in 2..corners.len() {
                    let triangle =
                        [corners[0], corners[k - 1], corners[k]].map(|n| Point3::from(nodes.position[n as usize]));
                    let offset = self.offset[corners[0] as usize];
                    if let Some(found) = self.surface.deepest(pose, &triangle, offset) {
                        out.penetration = out.penetration.max(offset - found.touch.gap);
                    }
                }
            });
        }
        out
    }
}

fn longest_edge(corners: &[u32], nodes: &Nodes) -> f64 {
    let at = |n: u32| Point3::from(nodes.position[n as usize]);
    let edge = |k: usize| nalgebra::distance_squared(&at(corners[k]), &at(corners[(k + 1) % corners.len()]));
    (0..corners.len()).map(edge).fold(0.0, f64::max).sqrt()
}
