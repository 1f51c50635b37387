//! A contact constraint between two faces: a node and a triangle, or two edges.

use nalgebra::Vector3;

use crate::engine::nodes::{Nodes, Vectors};

/// What a constraint belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Source {
    /// A node tracked on one of two sides.
    Node { side: usize, node: u32 },
    /// A crossing of two edges, by its place in the list.
    Crossing(usize),
}

/// The least normal velocity between two points of film: that of four nodes with weights that add up to zero, so that
/// its impulses keep the momentum of the film (theory.md, equation 56).
#[derive(Clone, Debug)]
pub(super) struct Constraint {
    pub(super) source: Source,
    pub(super) nodes: [u32; 4],
    pub(super) weights: [f64; 4],
    /// Along which the points are apart.
    pub(super) normal: Vector3<f64>,
    /// Velocity of each node per impulse between the points, 1/kg: weight over mass, zero along held directions.
    response: [Vector3<f64>; 4],
    /// Normal velocity per impulse along the normal, 1/kg.
    inverse_effective_mass: f64,
    /// The same of nodes that are held in no direction, 1/kg: a bound for every direction.
    inverse_free_mass: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
    /// Least normal velocity, m/s.
    target: f64,
    /// Along the normal, N s.
    normal_impulse: f64,
    /// N s.
    tangential_impulse: Vector3<f64>,
    /// The part of the impulse by which the nodes have been moved already, N s.
    moved: Vector3<f64>,
}

/// Share of a distance that is missing already before a step which is recovered in it, so that film that is too close
/// does not gain velocity.
const RECOVERY: f64 = 0.1;

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

/// Where two points of film are and move.
pub(super) struct Pair {
    pub(super) nodes: [u32; 4],
    pub(super) weights: [f64; 4],
    pub(super) normal: Vector3<f64>,
    /// Distance along the normal at the end of the step as predicted, m.
    pub(super) distance: f64,
    /// Least allowed distance, m.
    pub(super) bound: f64,
}

impl Constraint {
    /// The constraint of `pair` over a step of `dt` (s), without an impulse.
    pub(super) fn new(source: Source, pair: Pair, nodes: &Nodes, dt: f64) -> Result<Constraint, Unusable> {
        let Pair { nodes: of, weights, normal, distance, bound } = pair;
        let response: [Vector3<f64>; 4] =
            std::array::from_fn(|k| Vector3::from(nodes.effective_inverse_mass().at(of[k] as usize)) * weights[k]);
        let along = |k: usize| weights[k] * response[k].component_mul(&normal).dot(&normal);
        let inverse_effective_mass: f64 = (0..4).map(along).sum();
        let free = |k: usize| {
            weights[k] * response[k].iter().fold(0.0, |most: f64, of| most.max(of.abs())).copysign(weights[k])
        };
        let inverse_free_mass: f64 = (0..4).map(free).sum();
        if inverse_effective_mass <= LEAST_RESPONSE * inverse_free_mass {
            return Err(Unusable::Held);
        }
        let mut constraint = Constraint {
            source,
            nodes: of,
            weights,
            normal,
            response,
            inverse_effective_mass,
            inverse_free_mass,
            bound,
            target: 0.0,
            normal_impulse: 0.0,
            tangential_impulse: Vector3::zeros(),
            moved: Vector3::zeros(),
        };
        let velocity = constraint.relative_velocity(&nodes.velocity).dot(&normal);
        let before = distance - velocity * dt;
        if before < -DEEPEST * bound {
            return Err(Unusable::Beyond);
        }
        // A distance that the step began with is kept; what was missing then comes back slowly.
        let missing = bound - before;
        constraint.target = if missing > 0.0 { RECOVERY * missing / dt } else { missing / dt };
        Ok(constraint)
    }

    /// Velocity of the one point over the other, m/s.
    fn relative_velocity(&self, velocity: &Vectors) -> Vector3<f64> {
        (0..4).map(|k| Vector3::from(velocity.at(self.nodes[k] as usize)) * self.weights[k]).sum()
    }

    fn apply(&self, impulse: &Vector3<f64>, velocity: &mut Vectors) {
        for k in 0..4 {
            velocity.add(self.nodes[k] as usize, self.response[k].component_mul(impulse).into());
        }
    }

    /// Starts with the impulse that the same contact had in the last step.
    pub(super) fn start_from(&mut self, [normal, x, y, z]: [f64; 4], velocity: &mut Vectors) {
        let tangential = Vector3::new(x, y, z);
        self.normal_impulse = normal;
        self.tangential_impulse = tangential - self.normal * tangential.dot(&self.normal);
        self.apply(&(self.normal * normal + self.tangential_impulse), velocity);
    }

    /// Projected Gauss–Seidel: corrects the normal impulse, which stays compressive, then the tangential one, which stays
    /// within Coulomb's cone of `friction`. Returns the change of the normal velocity, m/s.
    pub(super) fn solve(&mut self, friction: f64, velocity: &mut Vectors) -> f64 {
        let mut relative = self.relative_velocity(velocity);
        let violation = self.target - relative.dot(&self.normal);
        let normal_impulse = (self.normal_impulse + violation / self.inverse_effective_mass).max(0.0);
        let change = normal_impulse - self.normal_impulse;
        if change != 0.0 {
            self.apply(&(self.normal * change), velocity);
            self.normal_impulse = normal_impulse;
        }
        if friction > 0.0 && (normal_impulse > 0.0 || self.tangential_impulse != Vector3::zeros()) {
            relative = self.relative_velocity(velocity);
            let slip = relative - self.normal * relative.dot(&self.normal);
            let sticking = self.tangential_impulse - slip / self.inverse_free_mass;
            let (bound, size) = (friction * normal_impulse, sticking.norm());
            let tangential = if size <= bound { sticking } else { sticking * (bound / size) };
            self.apply(&(tangential - self.tangential_impulse), velocity);
            self.tangential_impulse = tangential;
        }
        change.abs() * self.inverse_effective_mass
    }

    /// Whether the points press on each other.
    pub(super) fn is_active(&self) -> bool {
        self.normal_impulse > 0.0
    }

    /// The impulse, N s: along the normal, then tangential.
    pub(super) fn impulse(&self) -> [f64; 4] {
        let [x, y, z] = self.tangential_impulse.into();
        [self.normal_impulse, x, y, z]
    }

    /// Moves the nodes by the change of their velocity since the last call times `dt` (s).
    pub(super) fn move_nodes(&mut self, position: &mut Vectors, dt: f64) {
        let impulse = self.normal * self.normal_impulse + self.tangential_impulse;
        self.apply(&((impulse - self.moved) * dt), position);
        self.moved = impulse;
    }

    /// Work of the normal and of the tangential impulse on the film, J, for velocities `before` and `after` the step.
    pub(super) fn work(&self, before: &Vectors, after: &Vectors) -> [f64; 2] {
        let mean = (self.relative_velocity(before) + self.relative_velocity(after)) * 0.5;
        [self.normal_impulse * mean.dot(&self.normal), self.tangential_impulse.dot(&mean)]
    }
}
