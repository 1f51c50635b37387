//! The present state of contact: penetration, element size, contact at the frame.

use nalgebra::{Isometry3, Point3};

use super::Contact;
use super::neighbours::NeighbourElement;
use super::surface::Projection;
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
        // Film that a node contact has put onto the surface must not count as penetrating by round-off.
        let tolerance = 1e-4 * self.surface.size();
        let mut elements = self.bounded_elements(nodes, pose);
        // Where the deepest come first, most others need not be looked at.
        elements.sort_by(|a, b| b.penetration.total_cmp(&a.penetration));
        for Bounded { positions, offset, penetration } in &elements {
            let edge = longest_edge(positions);
            let mut within = offset + tolerance + self.neighbours.edge;
            // Neither of both results can grow by such an element.
            if *penetration <= -tolerance || (edge <= out.longest_edge && *penetration <= out.penetration) {
                continue;
            }
            if edge <= out.longest_edge {
                // Only a deeper point matters then, and the search ends sooner the less it is to find; rounding moves
                // edges inwards by up to `edge`.
                within = within.min(offset - out.penetration + self.neighbours.edge);
            }
            let Some(found) = self.rounded.deepest_point(pose, positions, within) else { continue };
            // `extent` is measured to the edges as given, not to the rounded ones that were searched.
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

    /// The elements next to the impactor at `pose`, with bounds on their penetration.
    fn bounded_elements(&self, nodes: &Nodes, pose: &Isometry3<f64>) -> Vec<Bounded> {
        // Of each node, once it is asked for.
        let mut nearest = self.nearest.clone();
        let mut known: Vec<Option<Projection>> =
            vec![None; if self.surface.is_convex() { nodes.mass.len() } else { 0 }];
        let mut project = |n: u32| {
            let place = n as usize;
            *known[place].get_or_insert_with(|| {
                let arm = nodes.position_of(place).coords - pose.translation.vector;
                match nearest.get_mut(place) {
                    Some(nearest) => self.surface.project_on_mesh(pose, &arm, None, nearest),
                    None => self.rounded.project(pose, &nodes.position_of(place)),
                }
            })
        };
        let bounded = |NeighbourElement { corners, .. }: &NeighbourElement| {
            let positions = corners.map(|n| nodes.position_of(n as usize));
            let offset = self.offset[corners[0] as usize];
            let penetration = if self.surface.is_convex() {
                // No point of the element lies below the tangents at its corners (theory.md, equation 212).
                let least = (0..4).map(|k| {
                    let Projection { distance, normal } = project(corners[k]);
                    let over = |at: &Point3<f64>| distance + normal.dot(&(at - positions[k]));
                    positions.iter().map(over).fold(f64::INFINITY, f64::min)
                });
                offset - least.fold(f64::NEG_INFINITY, f64::max) + self.neighbours.edge
            } else {
                self.surface.penetration_bound(pose, &positions) + offset
            };
            Bounded { positions, offset, penetration }
        };
        self.neighbours.elements.iter().map(bounded).collect()
    }
}

/// An element next to the impactor.
struct Bounded {
    positions: [Point3<f64>; 4],
    /// Of its mid-surface from the impactor in contact, m.
    offset: f64,
    /// Bound on its penetration, m; negative where it is not in contact.
    penetration: f64,
}

/// Longest edge of an element, m.
fn longest_edge(corners: &[Point3<f64>; 4]) -> f64 {
    (0..4).map(|a| nalgebra::distance(&corners[a], &corners[(a + 1) % 4])).fold(0.0, f64::max)
}
