//! A contact constraint between two faces: a node and a triangle, or two edges.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::self_contact::Parts;
use super::surface::{Surface, are_below};
use crate::engine::nodes::{Nodes, Vectors};
use crate::engine::weighted_nodes::{ContactImpulse, WeightedNodes};

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

/// The least normal velocity between two points of film: that of four nodes with weights that add up to zero, so that
/// its impulses keep the momentum of the film (theory.md, equation 56).
#[derive(Clone, Debug)]
pub(super) struct Constraint {
    pub(super) source: Source,
    /// The one point less the other.
    pub(super) points: WeightedNodes,
    /// Its normal is that along which the points are apart.
    pub(super) impulse: ContactImpulse,
    /// Velocity of one point over the other per impulse along each axis, 1/kg.
    inverse_mass: Vector3<f64>,
    /// Normal velocity per impulse along the normal, 1/kg.
    inverse_effective_mass: f64,
    /// Impulse along the normal per normal velocity, kg.
    effective_mass: f64,
    /// Impulse per velocity of nodes that are held in no direction, kg: a bound for every direction.
    free_mass: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
    /// Least normal velocity, m/s.
    target: f64,
}

/// The impulse of a contact in the last step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Carried {
    pub(super) source: Source,
    nodes: [u32; 4],
    weights: [f64; 4],
    normal: [f64; 3],
    /// As of [`ContactImpulse`].
    pressing: f64,
    dragging: [f64; 3],
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

impl Constraint {
    /// The constraint of `pair` over a step of `dt` (s), without an impulse.
    #[inline]
    pub(super) fn new(source: Source, pair: &Pair, nodes: &Nodes, dt: f64) -> Result<Constraint, Unusable> {
        let Pair { nodes: of, weights, normal, distance, bound } = *pair;
        let points = WeightedNodes::new(of, weights, nodes);
        let inverse_mass = points.inverse_mass();
        let inverse_effective_mass = product(&inverse_mass, &normal).dot(&normal);
        let inverse_free_mass = points.inverse_free_mass();
        // Also true where all nodes are held and both are zero.
        if inverse_effective_mass <= LEAST_RESPONSE * inverse_free_mass {
            return Err(Unusable::Held);
        }
        let mut constraint = Constraint {
            source,
            points,
            impulse: ContactImpulse::none(normal),
            inverse_mass,
            inverse_effective_mass,
            effective_mass: 1.0 / inverse_effective_mass,
            free_mass: 1.0 / inverse_free_mass,
            bound,
            target: 0.0,
        };
        // Back from the predicted end of the step: only the distance before it tells what was missing already.
        let velocity = constraint.points.sum(&nodes.velocity).dot(&normal);
        let before = distance - velocity * dt;
        if before < -DEEPEST * bound {
            return Err(Unusable::Beyond);
        }
        // A distance that the step began with is kept; what was missing then comes back slowly.
        let missing = bound - before;
        constraint.target = if missing > 0.0 { RECOVERY * missing / dt } else { missing / dt };
        Ok(constraint)
    }

    /// Starts with the impulse that the same contact had in the last step.
    #[inline]
    pub(super) fn start_from(&mut self, carried: &Carried, velocity: &mut Vectors) {
        let (normal, dragging) = (self.impulse.normal, Vector3::from(carried.dragging));
        self.impulse.pressing = carried.pressing;
        self.impulse.dragging = dragging - normal * dragging.dot(&normal);
        self.points.apply(&self.impulse.total(), velocity);
    }

    /// Projected Gauss–Seidel: corrects the normal impulse, which stays compressive, then the tangential one, which
    /// stays within Coulomb's cone of `friction`. Returns the change of the normal velocity, m/s.
    #[inline]
    pub(super) fn solve(&mut self, friction: f64, velocity: &mut Vectors) -> f64 {
        let relative = self.points.sum(velocity);
        let normal = self.impulse.normal;
        let violation = self.target - relative.dot(&normal);
        // Two thirds of the constraints: film that is close and does not press. Without a normal impulse there is no
        // tangential one.
        if self.impulse.pressing == 0.0 && violation <= 0.0 {
            return 0.0;
        }
        let change = self.impulse.press(violation * self.effective_mass);
        let mut impulse = normal * change;
        if friction > 0.0 {
            // The velocity after the normal impulse, from the response instead of a second sum over four nodes.
            let relative = relative + product(&self.inverse_mass, &impulse);
            let slip = relative - normal * relative.dot(&normal);
            // The free mass bounds the response of every direction, so the step never overshoots where nodes are held
            // in one.
            impulse += self.impulse.drag(slip * self.free_mass, friction);
        }
        self.points.apply(&impulse, velocity);
        change.abs() * self.inverse_effective_mass
    }

    /// Moves the nodes by the change of the impulse since the last call.
    #[inline]
    pub(super) fn move_nodes(&mut self, position: &mut Vectors, dt: f64) {
        self.impulse.move_nodes(&self.points, position, dt);
    }

    /// Impulse that the next step starts from.
    pub(super) fn carried(&self) -> Carried {
        Carried {
            source: self.source,
            nodes: self.points.nodes,
            weights: self.points.weights,
            normal: self.impulse.normal.into(),
            pressing: self.impulse.pressing,
            dragging: self.impulse.dragging.into(),
        }
    }

    /// Work of the normal and of the tangential impulse on the film in the half step in which it has these velocities, J.
    pub(super) fn half_work(&self, velocity: &Vectors) -> [f64; 2] {
        let half = self.points.sum(velocity) * 0.5;
        [self.impulse.pressing * half.dot(&self.impulse.normal), self.impulse.dragging.dot(&half)]
    }
}

/// Products of the components of two vectors, written out: nalgebra's own is a call in a build without optimisation
/// across units.
#[inline(always)]
fn product(a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}
