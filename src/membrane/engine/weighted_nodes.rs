//! What contact constrains: points of film, or differences of two, as sums of four nodes with weights; and the impulse that a
//! contact accumulates.

use nalgebra::Vector3;

use super::nodes::{Nodes, Vectors};

/// Four nodes with weights, of which some may be zero.
#[derive(Clone, Debug)]
pub(super) struct WeightedNodes {
    pub(super) nodes: [u32; 4],
    pub(super) weights: [f64; 4],
    /// Velocity of each node per impulse on the sum along a free direction, 1/kg: weight over mass, zero where all are held.
    response: [f64; 4],
    /// Axes along which a node is held, three bits a node.
    held: u16,
    /// How many of them count: those behind have the weight zero.
    count: u8,
}

impl WeightedNodes {
    /// `of` some nodes, with `weights`.
    #[inline]
    pub(super) fn new(of: [u32; 4], weights: [f64; 4], nodes: &Nodes) -> WeightedNodes {
        let mut response = [0.0; 4];
        let (mut held, mut count) = (0, 0);
        for k in 0..4 {
            let [x, y, z] = nodes.effective_inverse_mass().value_at(of[k] as usize);
            response[k] = x.max(y).max(z) * weights[k];
            held |= held_axes([x, y, z]) << (3 * k);
            if weights[k] != 0.0 {
                count = k as u8 + 1;
            }
        }
        WeightedNodes { nodes: of, weights, response, held, count }
    }

    /// One node.
    #[inline]
    pub(super) fn of_node(node: u32, nodes: &Nodes) -> WeightedNodes {
        let [x, y, z] = nodes.effective_inverse_mass().value_at(node as usize);
        WeightedNodes {
            nodes: [node; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            response: [x.max(y).max(z), 0.0, 0.0, 0.0],
            held: held_axes([x, y, z]),
            count: 1,
        }
    }

    /// The nodes whose weight is not zero.
    pub(super) fn weighted(&self) -> impl Iterator<Item = u32> {
        self.nodes.into_iter().zip(self.weights).filter(|(_, weight)| *weight != 0.0).map(|(node, _)| node)
    }

    /// Velocity of a node per impulse on the sum along each axis, 1/kg.
    #[inline(always)]
    fn response(&self, k: usize) -> [f64; 3] {
        let held = self.held >> (3 * k);
        let mut along = [self.response[k]; 3];
        // Seldom any: film is held at the frame and on mirror planes.
        if held & 0b111 != 0 {
            for axis in 0..3 {
                if held >> axis & 1 != 0 {
                    along[axis] = 0.0;
                }
            }
        }
        along
    }

    /// The sum of what the nodes have: of their velocities, that of the point, m/s.
    #[inline(always)]
    pub(super) fn sum(&self, of: &Vectors) -> Vector3<f64> {
        // Loops, not iterators: sums of vectors and maps of arrays are generic functions of other crates, each a call
        // in a build without optimisation across units.
        let mut sum = [0.0; 3];
        for k in 0..usize::from(self.count) {
            let value = of.value_at(self.nodes[k] as usize);
            for axis in 0..3 {
                sum[axis] += value[axis] * self.weights[k];
            }
        }
        Vector3::new(sum[0], sum[1], sum[2])
    }

    /// Adds what an `impulse` (N s) on the sum does to the velocities of the nodes; multiplied by a time, to their
    /// positions.
    #[inline(always)]
    pub(super) fn apply(&self, impulse: &Vector3<f64>, to: &mut Vectors) {
        for k in 0..usize::from(self.count) {
            let [x, y, z] = self.response(k);
            to.add(self.nodes[k] as usize, [x * impulse.x, y * impulse.y, z * impulse.z]);
        }
    }

    /// Velocity of the sum per impulse along each axis, 1/kg.
    #[inline]
    pub(super) fn inverse_mass(&self) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for k in 0..4 {
            sum += Vector3::from(self.response(k)) * self.weights[k];
        }
        sum
    }

    /// Inverse mass of nodes that are held in no direction, 1/kg: a bound for every direction. A node that is held in
    /// all of them has no part in it.
    #[inline]
    pub(super) fn inverse_free_mass(&self) -> f64 {
        let mut sum = 0.0;
        for k in 0..4 {
            sum += self.response[k] * self.weights[k];
        }
        sum
    }
}

/// The axes along which a node with this velocity per impulse is held, a bit each.
#[inline(always)]
fn held_axes([x, y, z]: [f64; 3]) -> u16 {
    u16::from(x == 0.0) | u16::from(y == 0.0) << 1 | u16::from(z == 0.0) << 2
}

/// Impulse of a contact, accumulated over the sweeps of a step: compressive along its normal, within Coulomb's cone across
/// it. Its sum is clamped, not its changes: a later contact may take back what this one pushed too much, but never pull.
#[derive(Clone, Debug)]
pub(super) struct ContactImpulse {
    /// Unit vector along which the contact pushes.
    pub(super) normal: Vector3<f64>,
    /// Along the normal, N s.
    pub(super) pressing: f64,
    /// Across the normal, N s.
    pub(super) dragging: Vector3<f64>,
    /// The part by which nodes have been moved already, N s.
    moved: Vector3<f64>,
}

impl ContactImpulse {
    /// None so far, along `normal`.
    #[inline(always)]
    pub(super) fn none(normal: Vector3<f64>) -> ContactImpulse {
        ContactImpulse { normal, pressing: 0.0, dragging: Vector3::zeros(), moved: Vector3::zeros() }
    }

    /// An impulse of the parts `pressed` and `dragging` (N s) that has moved the nodes already.
    pub(super) fn acted(pressed: Vector3<f64>, dragging: Vector3<f64>) -> ContactImpulse {
        let pressing = pressed.norm();
        ContactImpulse { normal: pressed / pressing, pressing, dragging, moved: pressed + dragging }
    }

    /// N s.
    #[inline(always)]
    pub(super) fn total(&self) -> Vector3<f64> {
        self.normal * self.pressing + self.dragging
    }

    /// Whether it presses.
    pub(super) fn is_active(&self) -> bool {
        self.pressing > 0.0
    }

    /// Adds `change` (N s) to the normal part, as far as that stays compressive. Returns the change that it took.
    #[inline(always)]
    pub(super) fn press(&mut self, change: f64) -> f64 {
        let pressing = (self.pressing + change).max(0.0);
        let change = pressing - self.pressing;
        self.pressing = pressing;
        change
    }

    /// Takes `slip` (N s) from the tangential part, the impulse of what slips, as far as that stays within the cone of
    /// `friction`. Returns the change that it took.
    #[inline(always)]
    pub(super) fn drag(&mut self, slip: Vector3<f64>, friction: f64) -> Vector3<f64> {
        let sticking = self.dragging - slip;
        let (size, bound) = (sticking.norm(), friction * self.pressing);
        let dragging = if size <= bound { sticking } else { sticking * (bound / size) };
        let change = dragging - self.dragging;
        self.dragging = dragging;
        change
    }

    /// Moves the nodes of `points` by the change of their velocity since the last call times `dt` (s).
    #[inline]
    pub(super) fn move_nodes(&mut self, points: &WeightedNodes, position: &mut Vectors, dt: f64) {
        let total = self.total();
        points.apply(&((total - self.moved) * dt), position);
        self.moved = total;
    }
}
