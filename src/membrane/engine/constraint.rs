//! The contact constraint: the least normal velocity of one point over another. The points are of film and film, of film and a
//! body, or of two bodies; their impulses are accumulated over the sweeps of a step (projected Gauss–Seidel).

use nalgebra::Vector3;

use super::nodes::{Nodes, Vectors};

/// Two points that may press on each other.
pub(super) trait Response {
    /// What an `impulse` (N s) on the one, and its opposite on the other, would change of the velocity of the one over the other,
    /// m/s.
    fn response(&self, impulse: &Vector3<f64>) -> Vector3<f64>;
}

/// Two points whose velocities follow from a `Motion`.
pub(super) trait Points<Motion: ?Sized>: Response {
    /// Velocity of the one over the other, m/s.
    fn velocity(&self, motion: &Motion) -> Vector3<f64>;

    /// Applies `impulse` (N s) to the one and its opposite to the other.
    fn apply(&self, impulse: &Vector3<f64>, motion: &mut Motion);
}

/// A contact constraint with its impulse, which is compressive along the normal and within Coulomb's cone across it. The sum
/// over the sweeps is clamped, not its changes: a later contact may take back what this one pushed too much, but never pull.
#[derive(Clone, Debug)]
pub(super) struct Constraint<P> {
    pub(super) points: P,
    /// Unit vector along which the one point is pushed.
    pub(super) normal: Vector3<f64>,
    /// Least normal velocity, m/s.
    pub(super) target: f64,
    /// Impulse along the normal per normal velocity, kg; zero where neither point yields.
    pub(super) effective_mass: f64,
    /// Impulse along the normal, N s.
    pub(super) pressing: f64,
    /// Impulse across the normal, N s.
    pub(super) dragging: Vector3<f64>,
    /// The part by which nodes have been moved already, N s.
    moved: Vector3<f64>,
}

impl<P> Constraint<P> {
    /// Of `points` along `normal` without an impulse, which may not come nearer. Their normal velocity changes by `response`
    /// (1/kg) per impulse, or by less.
    #[inline]
    pub(super) fn new(points: P, normal: Vector3<f64>, response: f64) -> Constraint<P> {
        Constraint {
            points,
            normal,
            target: 0.0,
            effective_mass: if response > 0.0 { 1.0 / response } else { 0.0 },
            pressing: 0.0,
            dragging: Vector3::zeros(),
            moved: Vector3::zeros(),
        }
    }

    /// This constraint with the normal impulse `pressing` and the tangential one `dragging` (N s), which have acted already.
    pub(super) fn acted(self, pressing: f64, dragging: Vector3<f64>) -> Constraint<P> {
        let moved = self.normal * pressing + dragging;
        Constraint { pressing, dragging, moved, ..self }
    }

    /// N s.
    #[inline(always)]
    pub(super) fn impulse(&self) -> Vector3<f64> {
        self.normal * self.pressing + self.dragging
    }

    /// Whether it presses.
    #[inline(always)]
    pub(super) fn is_active(&self) -> bool {
        self.pressing > 0.0
    }

    /// Starts with the impulse that the same contact had in the last step: `pressing` (N s) along the present normal, and the part
    /// of `dragging` (N s) across it.
    #[inline]
    pub(super) fn start_from<M: ?Sized>(&mut self, pressing: f64, dragging: &Vector3<f64>, motion: &mut M)
    where
        P: Points<M>,
    {
        if pressing <= 0.0 {
            return;
        }
        self.pressing = pressing;
        self.dragging = dragging - self.normal * dragging.dot(&self.normal);
        self.points.apply(&self.impulse(), motion);
    }

    /// Corrects the normal impulse, which stays compressive, then the tangential one against the slip, within the cone of
    /// `friction`. Returns the change, N s.
    #[inline]
    pub(super) fn solve<M: ?Sized>(&mut self, friction: f64, motion: &mut M) -> Vector3<f64>
    where
        P: Points<M>,
    {
        let normal = self.normal;
        let velocity = self.points.velocity(motion);
        let violation = self.target - velocity.dot(&normal);
        // Most constraints: points that are close and do not press. Without a normal impulse there is no tangential one.
        if self.pressing == 0.0 && violation <= 0.0 {
            return Vector3::zeros();
        }
        let pressing = (self.pressing + violation * self.effective_mass).max(0.0);
        let mut change = normal * (pressing - self.pressing);
        self.pressing = pressing;
        if friction > 0.0 {
            // After the normal impulse, which may spin a body and so change the slip.
            let velocity = velocity + self.points.response(&change);
            let slip = velocity - normal * velocity.dot(&normal);
            // By the response to the slip: a spinning ball responds 3.5 times as much along its surface as across it. The least
            // squares of what is left of the slip, which do not grow where nodes are held in a direction of it.
            let response = self.points.response(&slip);
            let squared = response.norm_squared();
            let mass = if squared > 0.0 { slip.dot(&response) / squared } else { 0.0 };
            let dragging = self.within_cone(self.dragging - slip * mass, friction);
            change += dragging - self.dragging;
            self.dragging = dragging;
        }
        self.points.apply(&change, motion);
        change
    }

    /// A tangential impulse (N s), as far as it is within the cone of `friction`.
    #[inline(always)]
    fn within_cone(&self, dragging: Vector3<f64>, friction: f64) -> Vector3<f64> {
        let (size, bound) = (dragging.norm(), friction * self.pressing);
        if size <= bound { dragging } else { dragging * (bound / size) }
    }

    /// Work of the normal and of the tangential impulse in the half step in which the one point has this `velocity` (m/s) over
    /// the other, J.
    pub(super) fn half_work(&self, velocity: &Vector3<f64>) -> [f64; 2] {
        [0.5 * self.pressing * velocity.dot(&self.normal), 0.5 * self.dragging.dot(velocity)]
    }
}

impl<P: AsRef<WeightedNodes>> Constraint<P> {
    /// Moves the nodes of film by what the impulse has changed since the last call, over `dt` (s).
    #[inline]
    pub(super) fn move_nodes(&mut self, position: &mut Vectors, dt: f64) {
        let impulse = self.impulse();
        let unmoved = impulse - std::mem::replace(&mut self.moved, impulse);
        self.points.as_ref().apply(&(unmoved * dt), position);
    }
}

/// Four nodes with weights, of which some may be zero: the sum is a point of film, or one less another.
#[derive(Clone, Debug)]
pub(super) struct WeightedNodes {
    pub(super) nodes: [u32; 4],
    pub(super) weights: [f64; 4],
    /// Velocity of each node per impulse on the sum along a free direction, 1/kg: weight over mass, zero where all are held.
    yields: [f64; 4],
    /// Velocity of the sum per impulse along each axis, 1/kg.
    inverse_mass: [f64; 3],
    /// Axes along which a node is held, three bits a node.
    held: u16,
    /// How many of them count: those behind have the weight zero.
    count: u8,
}

impl WeightedNodes {
    /// `of` some nodes, with `weights`. A triangle repeats its last node.
    #[inline]
    pub(super) fn new(of: [u32; 4], mut weights: [f64; 4], nodes: &Nodes) -> WeightedNodes {
        if of[2] == of[3] {
            // One node with both weights, of which the square is not the sum of two.
            weights[2] += std::mem::take(&mut weights[3]);
        }
        let (mut yields, mut inverse_mass) = ([0.0; 4], [0.0; 3]);
        let (mut held, mut count) = (0, 0);
        for k in 0..4 {
            let free = nodes.effective_inverse_mass().value_at(of[k] as usize);
            yields[k] = free[0].max(free[1]).max(free[2]) * weights[k];
            for axis in 0..3 {
                inverse_mass[axis] += weights[k] * weights[k] * free[axis];
                held |= u16::from(free[axis] == 0.0) << (3 * k + axis);
            }
            if weights[k] != 0.0 {
                count = k as u8 + 1;
            }
        }
        WeightedNodes { nodes: of, weights, yields, inverse_mass, held, count }
    }

    /// One node.
    #[inline]
    pub(super) fn of_node(node: u32, nodes: &Nodes) -> WeightedNodes {
        WeightedNodes::new([node; 4], [1.0, 0.0, 0.0, 0.0], nodes)
    }

    /// The nodes whose weight is not zero.
    pub(super) fn weighted(&self) -> impl Iterator<Item = u32> {
        self.nodes.into_iter().zip(self.weights).filter(|(_, weight)| *weight != 0.0).map(|(node, _)| node)
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

    /// Bound on the velocity of the sum per impulse in any direction, 1/kg: that of nodes that are held in none. A node that is
    /// held in all of them has no part in it.
    #[inline]
    pub(super) fn inverse_free_mass(&self) -> f64 {
        let mut sum = 0.0;
        for k in 0..4 {
            sum += self.yields[k] * self.weights[k];
        }
        sum
    }

    /// Adds what an `impulse` (N s) on the sum does to the velocities of the nodes; multiplied by a time, to their
    /// positions.
    #[inline(always)]
    pub(super) fn apply(&self, impulse: &Vector3<f64>, to: &mut Vectors) {
        for k in 0..usize::from(self.count) {
            let (yields, held) = (self.yields[k], self.held >> (3 * k));
            let mut change = [yields * impulse.x, yields * impulse.y, yields * impulse.z];
            // Seldom any: film is held at the frame and on mirror planes.
            if held & 0b111 != 0 {
                for axis in 0..3 {
                    if held >> axis & 1 != 0 {
                        change[axis] = 0.0;
                    }
                }
            }
            to.add(self.nodes[k] as usize, change);
        }
    }
}

impl AsRef<WeightedNodes> for WeightedNodes {
    fn as_ref(&self) -> &WeightedNodes {
        self
    }
}

impl Response for WeightedNodes {
    #[inline(always)]
    fn response(&self, impulse: &Vector3<f64>) -> Vector3<f64> {
        // Written out: nalgebra's own is a call in a build without optimisation across units.
        let [x, y, z] = self.inverse_mass;
        Vector3::new(x * impulse.x, y * impulse.y, z * impulse.z)
    }
}

/// Film on film: one point less another, so that their weights add up to zero and impulses keep the momentum of the film
/// (theory.md, equation 56).
impl Points<Vectors> for WeightedNodes {
    #[inline(always)]
    fn velocity(&self, velocity: &Vectors) -> Vector3<f64> {
        self.sum(velocity)
    }

    #[inline(always)]
    fn apply(&self, impulse: &Vector3<f64>, velocity: &mut Vectors) {
        WeightedNodes::apply(self, impulse, velocity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of the corners, of which a triangle repeats the last, has 1/4 of two nodes and 1/2 of that one. Its effective mass
    /// is 1/(Σ w²/m), and an impulse changes its velocity by that.
    #[test]
    fn a_point_of_a_triangle_has_the_mass_of_the_closed_form() {
        let mut nodes = Nodes::default();
        nodes.extend([[0.0; 3]; 3], &[2.0, 3.0, 0.5]);
        let mut point = WeightedNodes::new([0, 1, 2, 2], [0.25; 4], &nodes);
        let expected = 0.0625 / 2.0 + 0.0625 / 3.0 + 0.25 / 0.5;
        assert!((point.inverse_free_mass() - expected).abs() < 1e-15, "{} for {expected}", point.inverse_free_mass());
        let impulse = Vector3::new(1.0, -2.0, 0.5);
        point.apply(&impulse, &mut nodes.velocity);
        assert!((point.sum(&nodes.velocity) - impulse * expected).norm() < 1e-15);
        assert!((point.response(&impulse) - impulse * expected).norm() < 1e-15);
        // Held along an axis, none of it moves there by its last node.
        nodes.hold([2], [true, false, false]);
        point = WeightedNodes::new([0, 1, 2, 2], [0.25; 4], &nodes);
        let across = point.response(&Vector3::x()).x;
        assert!((across - (expected - 0.25 / 0.5)).abs() < 1e-15, "{across}");
    }
}
