//! Edges of different faces that cross each other.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::surface::{NONE, Surface};
use super::tracking::{BESIDE, Tracking, normal_of, project};
use crate::engine::nodes::Vectors;

/// Square of the sine between two edges below which they count as parallel: nodes then carry the contact.
pub(super) const PARALLEL: f64 = 1e-4;

/// Triangles over which an edge is followed at most.
const LONGEST: usize = 512;

/// An edge of one face that crosses an edge of another.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Crossing {
    /// That of the first of the two faces, then that of the second.
    pub(super) edges: [u32; 2],
    /// Factor on the product of the first edge and the second that makes it point from the second to the first; zero where
    /// they are parallel, or contact was given up.
    pub(super) sign: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
    /// The last impulse, N s: along the normal, then tangential.
    pub(super) impulse: [f64; 4],
    /// The step in which that was.
    pub(super) pressed: u64,
}

impl Crossing {
    /// Nodes of the first edge, then of the second.
    pub(super) fn nodes(&self, surface: &Surface) -> [u32; 4] {
        let [[a, b], [c, d]] = self.edges.map(|edge| surface.edges[edge as usize]);
        [a, b, c, d]
    }

    /// Whether it fits a scene with so many edges.
    pub(super) fn fits(&self, edges: usize) -> bool {
        self.edges.iter().all(|edge| (*edge as usize) < edges)
    }
}

/// Adds the crossings of the edge `walker` over the faces on which its nodes are tracked by `tracking`. Where these are two
/// faces, since the outline of one ends between the nodes, it is followed over each.
pub(super) fn find(surface: &Surface, position: &Vectors, tracking: &Tracking, walker: u32, out: &mut Vec<Crossing>) {
    let ends = surface.edges[walker as usize];
    let face = |n: u32| {
        let (triangle, sign) = (tracking.triangle[n as usize], tracking.sign[n as usize]);
        (triangle != NONE && sign != 0.0).then(|| surface.face_of(triangle))
    };
    let [first, second] = ends.map(face);
    if first.is_some() {
        walk(surface, position, tracking, walker, ends, out);
    }
    if second.is_some() && second != first {
        walk(surface, position, tracking, walker, [ends[1], ends[0]], out);
    }
}

/// Follows the edge `walker` from one of its nodes to the other over the face on which the first is tracked.
fn walk(
    surface: &Surface,
    position: &Vectors,
    tracking: &Tracking,
    walker: u32,
    [from, to]: [u32; 2],
    out: &mut Vec<Crossing>,
) {
    let [start, end] = [from, to].map(|n| Vector3::from(position.at(n as usize)));
    let direction = {
        let [a, b] = surface.edges[walker as usize].map(|n| Vector3::from(position.at(n as usize)));
        b - a
    };
    let (sign, bound) = (tracking.sign[from as usize], tracking.bound[from as usize]);
    let (mut triangle, mut entered) = (tracking.triangle[from as usize], NONE);
    for _ in 0..LONGEST {
        let (at_start, normal, _) = project(surface, position, &start, triangle);
        let (at_end, ..) = project(surface, position, &end, triangle);
        let edges = surface.edges_of[triangle as usize];
        let leaves = |k: &usize| at_end[*k] < -BESIDE && at_end[*k] < at_start[*k] && edges[*k] != entered;
        let share = |k: usize| at_start[k] / (at_start[k] - at_end[k]);
        let exit = (0..3).filter(leaves).fold(None, |first: Option<usize>, k| match first {
            Some(other) if share(other) <= share(k) => Some(other),
            _ => Some(k),
        });
        let Some(k) = exit else { return };
        let other = edges[k];
        let [c, d] = surface.edges[other as usize].map(|n| Vector3::from(position.at(n as usize)));
        let across = direction.cross(&(d - c));
        let up = across.dot(&normal) * sign;
        let is_across = across.norm_squared() > PARALLEL * direction.norm_squared() * (d - c).norm_squared();
        let sign = if is_across { 1.0_f64.copysign(up) } else { 0.0 };
        // In the other order both the product and the direction are reversed, and the sign is the same.
        let edges = [walker.min(other), walker.max(other)];
        out.push(Crossing { edges, sign, bound, impulse: [0.0; 4], pressed: 0 });
        let next = surface.across[triangle as usize][k];
        // Past a sharp fold the edge lies under the surface that it is followed over.
        if next == NONE || normal_of(surface, position, next).dot(&normal) < 0.0 {
            return;
        }
        (triangle, entered) = (next, other);
    }
}
