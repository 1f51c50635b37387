//! A contact constraint between two faces: a node and a triangle, or two edges.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::self_contact::Parts;
use super::surface::{Surface, are_below};
use crate::engine::constraint::{Constraint, Response, WeightedNodes};
use crate::engine::nodes::Nodes;

/// Node or crossing that a constraint belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) enum Source {
    /// A node tracked on one of two sides.
    Node { side: usize, node: u32 },
    /// A crossing of two edges.
    Crossing([u32; 2]),
    /// Parts of one face.
    Itself(Parts),
}

/// The constraint of two points of film.
#[derive(Clone, Debug)]
pub(super) struct FilmConstraint {
    pub(super) source: Source,
    /// Of the one point less the other.
    pub(super) contact: Constraint<WeightedNodes>,
    /// Least allowed distance, m.
    pub(super) bound: f64,
}

/// The impulse of a contact in the last step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Carried {
    pub(super) source: Source,
    nodes: [u32; 4],
    weights: [f64; 4],
    normal: [f64; 3],
    /// As of [`Constraint`].
    pub(super) pressing: f64,
    pub(super) dragging: [f64; 3],
}

impl Carried {
    /// Applies `factor` times the impulse to the nodes, and moves them on for `dt` (s).
    #[inline]
    pub(super) fn apply(&self, factor: f64, nodes: &mut Nodes, dt: f64) {
        let (normal, dragging) = (Vector3::from(self.normal), Vector3::from(self.dragging));
        let impulse = (normal * self.pressing + dragging) * factor;
        for k in 0..4 {
            nodes.apply_impulse(self.nodes[k] as usize, &(impulse * self.weights[k]), dt);
        }
    }

    /// Whether it fits a scene of so many nodes on `surface`.
    pub(super) fn fits(&self, nodes: usize, surface: &Surface) -> bool {
        let has_source = match self.source {
            Source::Node { side, node } => side < 2 && are_below(&[node], nodes),
            Source::Crossing(edges) => are_below(&edges, surface.edges.len()),
            Source::Itself(parts) => parts.fits(nodes, surface),
        };
        has_source && are_below(&self.nodes, nodes)
    }
}

/// Share of a distance that is missing already before a step which is recovered in it, so that film that is too close
/// does not gain velocity.
const RECOVERY: f64 = 0.05;

/// Distance over the least allowed one by which films may have passed each other before a step: sweeps that have not
/// converged leave less. What is deeper does not belong together, as on both sides of a fold.
const DEEPEST: f64 = 1.0;

/// Response along the normal over that of free nodes below which a pair counts as held: beside mirror planes a pair of
/// edges may have its normal along a direction that is held, and would take any impulse.
const LEAST_RESPONSE: f64 = 0.25;

/// Why there is no constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unusable {
    /// All nodes are held, or nearly so along the normal.
    Held,
    /// The points lie on the wrong sides of each other.
    Beyond,
}

/// Two points of film that may come too close: a node and one over a triangle, or one on each of two edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) nodes: [u32; 4],
    /// Of the nodes in the one point, less those in the other.
    pub(super) weights: [f64; 4],
    /// Unit normal on the side on which the first of the points belongs.
    pub(super) normal: Vector3<f64>,
    /// Distance along the normal at the end of the step as predicted, m.
    pub(super) distance: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
}

impl Pair {
    /// Distance along the normal before a step of `dt` (s), m: back from its predicted end.
    #[inline]
    pub(super) fn before(&self, nodes: &Nodes, dt: f64) -> f64 {
        let mut velocity = Vector3::zeros();
        for k in 0..4 {
            velocity += nodes.velocity_of(self.nodes[k] as usize) * self.weights[k];
        }
        self.distance - velocity.dot(&self.normal) * dt
    }
}

impl FilmConstraint {
    /// The constraint of `pair` over a step of `dt` (s), without an impulse.
    #[inline]
    pub(super) fn new(source: Source, pair: &Pair, nodes: &Nodes, dt: f64) -> Result<FilmConstraint, Unusable> {
        let Pair { nodes: of, weights, normal, bound, .. } = *pair;
        let points = WeightedNodes::new(of, weights, nodes);
        let response = points.response(&normal).dot(&normal);
        // Also true where all nodes are held and both are zero.
        if response <= LEAST_RESPONSE * points.inverse_free_mass() {
            return Err(Unusable::Held);
        }
        // Only the distance before the step tells what was missing already.
        let before = pair.before(nodes, dt);
        if before < -DEEPEST * bound {
            return Err(Unusable::Beyond);
        }
        let mut contact = Constraint::new(points, normal, response);
        // A distance that the step began with is kept; what was missing then comes back slowly.
        let missing = bound - before;
        contact.target = if missing > 0.0 { RECOVERY * missing / dt } else { missing / dt };
        Ok(FilmConstraint { source, contact, bound })
    }

    /// Impulse that the next step starts from.
    pub(super) fn carried(&self) -> Carried {
        let Constraint { points: WeightedNodes { nodes, weights, .. }, normal, pressing, dragging, .. } = self.contact;
        Carried { source: self.source, nodes, weights, normal: normal.into(), pressing, dragging: dragging.into() }
    }
}
