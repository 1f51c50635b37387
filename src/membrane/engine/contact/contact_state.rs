//! The present state of contact: penetration, element size, contact at the frame.

use nalgebra::{Isometry3, Point3, Vector3};

use super::Contact;
use super::neighbours::NeighbourElement;
use super::surface::{Nearest, Projection};
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
        let rounding = self.rounding();
        let mut elements = self.bounded_elements(nodes, pose, tolerance);
        // Where the deepest come first, most others need not be looked at.
        elements.sort_by(|a, b| b.estimate.total_cmp(&a.estimate));
        for Bounded { positions, at, offset, penetration, outward, nearest, is_touching, .. } in &elements {
            let mut within = offset + tolerance + self.neighbours.edge;
            // No point of it is as near as that.
            if offset - penetration + rounding >= within {
                continue;
            }
            let edge = longest_edge(positions);
            if *is_touching {
                out.longest_edge = out.longest_edge.max(edge);
            }
            if edge <= out.longest_edge {
                // Neither of both results can grow by such an element.
                let closer = |outward: &Vector3<f64>| {
                    offset - self.rounded.least_over_triangles(pose, positions, at, outward, *nearest) + rounding
                };
                if *penetration <= out.penetration
                    || outward.as_ref().is_some_and(|outward| closer(outward) <= out.penetration)
                {
                    continue;
                }
                // Only a deeper point matters then, and the search ends sooner the less it is to find.
                within = within.min(offset - out.penetration + rounding);
            }
            let Some(found) = self.rounded.deepest_point(pose, positions, within, penetration - offset) else {
                continue;
            };
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

    /// By how much less may penetrate the body that elements meet than the one with the edges that it was given, m. The
    /// edges of a mesh are as they are.
    fn rounding(&self) -> f64 {
        if self.surface.is_mesh() { 0.0 } else { self.neighbours.edge }
    }

    /// The elements next to the impactor at `pose`, with bounds on their penetration; what is nearer than the distance in
    /// contact and the `tolerance` (m) counts as touching.
    fn bounded_elements(&self, nodes: &Nodes, pose: &Isometry3<f64>, tolerance: f64) -> Vec<Bounded<'_>> {
        // Of each node, once it is asked for.
        let mut followed = self.nearest.clone();
        let mut known: Vec<Option<(Projection, bool)>> =
            vec![None; if self.surface.is_round() { 0 } else { nodes.mass.len() }];
        let is_convex = self.surface.is_convex();
        let mut project = |n: u32, within: f64| {
            let place = n as usize;
            *known[place].get_or_insert_with(|| {
                let arm = nodes.position_of(place).coords - pose.translation.vector;
                let Some(nearest) = followed.get_mut(place) else {
                    let projection = self.rounded.project(pose, &nodes.position_of(place));
                    return (projection, projection.distance < within);
                };
                // Farther nodes are not searched: any face tells by its plane that their element is not in contact.
                let found = self.surface.project_on_mesh(pose, &arm, Some(within), nearest);
                let is_far = found.normal == Vector3::zeros();
                let of_face = self.surface.face_of_mesh(pose, &arm, nearest).filter(|_| is_far && is_convex);
                (of_face.unwrap_or(found), found.distance < within)
            })
        };
        let bounded = |NeighbourElement { corners, .. }: &NeighbourElement| {
            let positions = corners.map(|n| nodes.position_of(n as usize));
            let offset = self.offset[corners[0] as usize];
            if self.surface.is_round() {
                let penetration = self.surface.penetration_bound(pose, &positions) + offset;
                return Bounded {
                    positions,
                    at: [Projection::UNKNOWN; 4],
                    offset,
                    penetration,
                    estimate: penetration,
                    outward: None,
                    nearest: None,
                    is_touching: false,
                };
            }
            let within = offset + tolerance + self.neighbours.edge;
            let corners_at = corners.map(|n| project(n, within));
            let at = corners_at.map(|(at, _)| at);
            let nearest = self.nearest.get(corners[0] as usize);
            let normals = at[0].normal + at[1].normal + at[2].normal + at[3].normal;
            let outward = normals.try_normalize(0.0).filter(|_| is_convex);
            let [least, at_mean] =
                self.rounded.least_distance(pose, &positions, &at, outward.as_ref(), nearest, within);
            let [penetration, estimate] = [least, at_mean].map(|distance| offset - distance + self.rounding());
            let is_touching = corners_at.iter().any(|(_, is_touching)| *is_touching);
            Bounded { positions, at, offset, penetration, estimate, outward, nearest, is_touching }
        };
        self.neighbours.elements.iter().map(bounded).collect()
    }
}

/// An element next to the impactor.
struct Bounded<'a> {
    positions: [Point3<f64>; 4],
    /// Projections of its corners; of those that are farther from the body, of which a face's plane or a bound tells.
    at: [Projection; 4],
    /// Of its mid-surface from the impactor in contact, m.
    offset: f64,
    /// Bound on its penetration, m.
    penetration: f64,
    /// About how deep its middle is, m.
    estimate: f64,
    /// Mean of the normals of a convex body at its corners.
    outward: Option<Vector3<f64>>,
    /// The triangle of a mesh nearest to a corner.
    nearest: Option<&'a Nearest>,
    /// Whether a corner is in contact.
    is_touching: bool,
}

/// Longest edge of an element, m.
fn longest_edge(corners: &[Point3<f64>; 4]) -> f64 {
    (0..4).map(|a| nalgebra::distance(&corners[a], &corners[(a + 1) % 4])).fold(0.0, f64::max)
}
