//! The nodes of all faces and the explicit central-difference step that moves them.

use std::ops::Range;

use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::disjoint::Disjoint;
use super::footprint::bytes;
use crate::lane::{LANES, Lane, Lane3, Width, at_width, larger, splat};

/// A vector at every node, one array an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vectors {
    axes: [Vec<f64>; 3],
}

/// Nodal quantities, one entry a node.
#[derive(Clone, Debug, Default)]
pub struct Nodes {
    /// m, at the full step.
    pub position: Vectors,
    /// m/s, at the half step.
    pub velocity: Vectors,
    /// N, at the full step.
    pub force: Vectors,
    /// kg.
    pub mass: Vec<f64>,
    /// 1/kg.
    inverse_mass: Vec<f64>,
    /// Velocity per impulse along each axis, 1/kg; zero along directions that are held or prescribed.
    mobility: Vectors,
    /// Nodes that are held along an axis or more, in order.
    constrained: Vec<u32>,
}

/// How velocities follow from the forces of a full step: v := keep·v + gain·F/m (theory.md, equation 15).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kick {
    /// Factor on the earlier velocities.
    pub keep: f64,
    /// Factor on the accelerations, s.
    pub gain: f64,
}

impl Vectors {
    /// Zero at so many nodes.
    pub fn zero(count: usize) -> Vectors {
        Vectors { axes: [vec![0.0; count], vec![0.0; count], vec![0.0; count]] }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.axes[0].len()
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        self.axes.iter().map(|axis| bytes(axis)).sum()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.axes[0].is_empty()
    }

    /// The vector at one node.
    #[inline(always)]
    pub fn at(&self, node: usize) -> [f64; 3] {
        [self.axes[0][node], self.axes[1][node], self.axes[2][node]]
    }

    /// Replaces the vector at one node.
    #[inline(always)]
    pub fn set(&mut self, node: usize, vector: [f64; 3]) {
        (0..3).for_each(|axis| self.axes[axis][node] = vector[axis]);
    }

    /// Adds to the vector at one node.
    #[inline(always)]
    pub fn add(&mut self, node: usize, vector: [f64; 3]) {
        (0..3).for_each(|axis| self.axes[axis][node] += vector[axis]);
    }

    /// The vectors at some nodes, a lane each.
    #[inline(always)]
    pub(super) fn gather(&self, nodes: &[u32; LANES]) -> Lane3 {
        let [x, y, z] = &self.axes;
        [gather(x, nodes), gather(y, nodes), gather(z, nodes)]
    }

    /// The vectors of all nodes.
    pub fn iter(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        (0..self.len()).map(|node| self.at(node))
    }

    /// The vectors of some nodes, an array an axis.
    #[inline(always)]
    pub fn range(&self, nodes: Range<usize>) -> [&[f64]; 3] {
        [0, 1, 2].map(|axis| &self.axes[axis][nodes.clone()])
    }

    /// The vectors of all nodes, an array an axis.
    pub fn axes(&self) -> [&[f64]; 3] {
        self.range(0..self.len())
    }

    /// The same, to be written.
    pub fn axes_mut(&mut self) -> [&mut [f64]; 3] {
        self.axes.each_mut().map(Vec::as_mut_slice)
    }

    /// Whether no axis has a number of nodes of its own, as it may have after reading.
    pub(super) fn is_whole(&self) -> bool {
        self.axes.iter().all(|axis| axis.len() == self.len())
    }

    fn resize(&mut self, count: usize) {
        self.axes.iter_mut().for_each(|axis| axis.resize(count, 0.0));
    }
}

impl Extend<[f64; 3]> for Vectors {
    fn extend<I: IntoIterator<Item = [f64; 3]>>(&mut self, vectors: I) {
        for vector in vectors {
            (0..3).for_each(|axis| self.axes[axis].push(vector[axis]));
        }
    }
}

impl Kick {
    /// A kick over `dt` (s) with mass-proportional `damping` (1/s).
    pub fn over(dt: f64, damping: f64) -> Kick {
        let half = 0.5 * damping * dt;
        Kick { keep: (1.0 - half) / (1.0 + half), gain: dt / (1.0 + half) }
    }
}

impl Nodes {
    /// Appends free nodes at rest.
    pub fn extend(&mut self, positions: impl IntoIterator<Item = [f64; 3]>, masses: &[f64]) {
        self.position.extend(positions);
        let count = self.position.len();
        self.velocity.resize(count);
        self.force.resize(count);
        self.mass.extend_from_slice(masses);
        self.inverse_mass.extend(masses.iter().map(|mass| 1.0 / mass));
        self.mobility.extend(masses.iter().map(|mass| [1.0 / mass; 3]));
    }

    /// Position of one node.
    #[inline]
    pub fn place(&self, node: usize) -> Point3<f64> {
        Point3::from(self.position.at(node))
    }

    /// Velocity of one node.
    #[inline]
    pub fn velocity_of(&self, node: usize) -> Vector3<f64> {
        Vector3::from(self.velocity.at(node))
    }

    /// Velocity per impulse, 1/kg; zero along directions that are held or prescribed.
    pub(super) fn mobility(&self) -> &Vectors {
        &self.mobility
    }

    /// Whether a node is held in every direction.
    #[inline]
    pub fn is_held(&self, node: usize) -> bool {
        self.mobility.at(node) == [0.0; 3]
    }

    /// Sets all forces to zero, as a step finds them.
    pub(super) fn forget_forces(&mut self) {
        self.force.axes.iter_mut().for_each(|axis| axis.fill(0.0));
    }

    /// Gets the nodes ready to be met by several threads.
    pub(super) fn met(&mut self) -> Met<'_> {
        Met {
            position: self.position.axes.each_mut().map(|axis| Disjoint::new(axis)),
            velocity: self.velocity.axes.each_mut().map(|axis| Disjoint::new(axis)),
            mobility: &self.mobility,
        }
    }

    /// Gives a node `impulse` (N s) and moves it on by what that changes in `dt` (s).
    pub(super) fn push(&mut self, node: usize, impulse: &Vector3<f64>, dt: f64) {
        // SAFETY: there is one thread.
        unsafe { self.met().push(node, &(*impulse).into(), dt) };
    }

    /// Bytes of its arrays.
    pub(super) fn bytes(&self) -> usize {
        let Nodes { position, velocity, force, mass, inverse_mass, mobility, constrained } = self;
        let vectors = position.bytes() + velocity.bytes() + force.bytes() + mobility.bytes();
        vectors + bytes(mass) + bytes(inverse_mass) + bytes(constrained)
    }

    /// Sum of the forces along an axis on some nodes, N.
    pub fn pull(&self, nodes: &[u32], axis: usize) -> f64 {
        nodes.iter().map(|n| self.force.at(*n as usize)[axis]).sum()
    }

    /// Holds some nodes along the marked axes: they keep the velocity they have.
    pub fn hold(&mut self, nodes: impl IntoIterator<Item = usize>, axes: [bool; 3]) {
        for n in nodes {
            let free = self.mobility.at(n);
            self.mobility.set(n, [0, 1, 2].map(|axis| if axes[axis] { 0.0 } else { free[axis] }));
        }
        let constrained = (0..self.mass.len()).filter(|n| self.mobility.at(*n).contains(&0.0));
        self.constrained = constrained.map(|n| n as u32).collect();
    }
}

/// Values at some nodes, a lane each.
#[inline(always)]
pub(super) fn gather(values: &[f64], nodes: &[u32; LANES]) -> Lane {
    match row(nodes) {
        Some(row) => lanes(&values[row]),
        None => nodes.map(|n| values[n as usize]),
    }
}

/// The range of nodes that some make up, if they do. A group that is filled up with its last node is none.
#[inline(always)]
fn row(nodes: &[u32; LANES]) -> Option<Range<usize>> {
    let mut follow = true;
    for l in 0..LANES {
        follow &= nodes[l] == nodes[0] + l as u32;
    }
    let first = nodes[0] as usize;
    follow.then_some(first..first + LANES)
}

#[inline(always)]
fn lanes(values: &[f64]) -> Lane {
    let mut out = splat(0.0);
    out.copy_from_slice(values);
    out
}

/// The nodes as several threads push them after they were moved, each its own.
pub(super) struct Met<'a> {
    position: [Disjoint<'a, f64>; 3],
    velocity: [Disjoint<'a, f64>; 3],
    mobility: &'a Vectors,
}

impl Met<'_> {
    /// Gives nodes, each named once but for those that get nothing, `impulse` (N s) where `given` is one, zero elsewhere, and moves them on by what that
    /// changes in `dt` (s); returns their velocities.
    ///
    /// # Safety
    /// No other thread may be at work on these nodes.
    #[inline(always)]
    pub(super) unsafe fn push_lanes(&self, nodes: &[u32; LANES], given: &Lane, impulse: &Lane3, dt: f64) -> Lane3 {
        let mut after = [splat(0.0); 3];
        let Some(row) = row(nodes) else {
            for l in (0..LANES).filter(|l| given[*l] > 0.0) {
                // SAFETY: the caller keeps other threads from these nodes.
                let velocity = unsafe { self.push(nodes[l] as usize, &[0, 1, 2].map(|axis| impulse[axis][l]), dt) };
                (0..3).for_each(|axis| after[axis][l] = velocity[axis]);
            }
            return after;
        };
        let mobility = self.mobility.range(row.clone());
        for axis in 0..3 {
            // SAFETY: as above.
            let (x, v) = unsafe { (self.position[axis].range(row.clone()), self.velocity[axis].range(row.clone())) };
            for l in 0..LANES {
                let change = impulse[axis][l] * mobility[axis][l];
                x[l] += change * dt;
                v[l] += change;
            }
            after[axis].copy_from_slice(v);
        }
        after
    }

    /// Gives a node `impulse` (N s) and moves it on by what that changes in `dt` (s); returns its velocity.
    ///
    /// # Safety
    /// No other thread may be at work on this node.
    #[inline(always)]
    pub(super) unsafe fn push(&self, node: usize, impulse: &[f64; 3], dt: f64) -> [f64; 3] {
        let mobility = self.mobility.at(node);
        let mut after = [0.0; 3];
        for axis in 0..3 {
            let change = impulse[axis] * mobility[axis];
            // SAFETY: the caller keeps other threads from this node.
            let (x, v) = unsafe { (self.position[axis].at(node), self.velocity[axis].at(node)) };
            *x += change * dt;
            *v += change;
            after[axis] = *v;
        }
        after
    }
}

/// What is to be known of nodes that were moved.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moved {
    /// Square of the largest speed, m²/s².
    pub(super) fastest: f64,
    /// Σ m v̄² with the mean v̄ of the velocities before and after, of what is not held, kg m²/s²; zero without damping.
    pub(super) damped: f64,
}

impl Moved {
    /// Of these nodes and others.
    pub(super) fn and(&self, others: &Moved) -> Moved {
        Moved { fastest: larger(self.fastest, others.fastest), damped: self.damped + others.damped }
    }
}

/// One axis of some nodes, as the step moves it.
struct Axis<'a> {
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    force: &'a mut [f64],
    /// Acceleration besides that of the forces, m/s².
    field: f64,
}

/// Nodes that stay in the fastest cache while all axes are moved.
const AT_ONCE: usize = 256;

/// The nodes as several threads move them, each its own range.
pub(super) struct Moving<'a> {
    position: [Disjoint<'a, f64>; 3],
    velocity: [Disjoint<'a, f64>; 3],
    force: [Disjoint<'a, f64>; 3],
    mass: &'a [f64],
    inverse_mass: &'a [f64],
    mobility: &'a Vectors,
    constrained: &'a [u32],
    kick: Kick,
    dt: f64,
    gravity: f64,
    remembered: Option<Remembered<'a>>,
}

/// Nodes whose velocities are taken before they are kicked.
pub(super) struct Remembered<'a> {
    /// In order.
    pub(super) nodes: &'a [u32],
    /// Where the velocities go, an entry for every node there is, m/s.
    pub(super) velocity: [Disjoint<'a, f64>; 3],
}

impl Nodes {
    /// Gets the nodes ready for a step: `kick`, then a drift over `dt` (s), with `gravity` (m/s², downward); what is to be
    /// `remembered` is taken first.
    pub(super) fn moving<'a>(
        &'a mut self,
        kick: Kick,
        dt: f64,
        gravity: f64,
        remembered: Option<Remembered<'a>>,
    ) -> Moving<'a> {
        Moving {
            position: self.position.axes.each_mut().map(|axis| Disjoint::new(axis)),
            velocity: self.velocity.axes.each_mut().map(|axis| Disjoint::new(axis)),
            force: self.force.axes.each_mut().map(|axis| Disjoint::new(axis)),
            mass: &self.mass,
            inverse_mass: &self.inverse_mass,
            mobility: &self.mobility,
            constrained: &self.constrained,
            kick,
            dt,
            gravity,
            remembered,
        }
    }
}

impl Moving<'_> {
    /// v := keep·v + gain·(F/m + g), x := x + v Δt, F := 0 for a range of nodes; returns the square of the largest speed, m²/s².
    ///
    /// # Safety
    /// No other thread may be at work on these nodes.
    pub(super) unsafe fn advance(&self, width: Width, nodes: Range<usize>) -> Moved {
        let mut moved = Moved::default();
        self.remember(nodes.clone());
        for start in nodes.clone().step_by(AT_ONCE) {
            let some = start..nodes.end.min(start + AT_ONCE);
            // SAFETY: the caller keeps other threads away from these nodes.
            let [x, y, z] = [0, 1, 2].map(|axis| unsafe {
                Axis {
                    position: self.position[axis].range(some.clone()),
                    velocity: self.velocity[axis].range(some.clone()),
                    force: self.force[axis].range(some.clone()),
                    field: if axis == 2 { -self.gravity } else { 0.0 },
                }
            });
            let mut axes = [x, y, z];
            moved.damped -= self.hold_back(some.clone(), &mut axes);
            moved = moved.and(&advance(width, self.kick, self.dt, &self.inverse_mass[some], &mut axes));
        }
        moved
    }

    fn remember(&self, range: Range<usize>) {
        let Some(Remembered { nodes, velocity }) = &self.remembered else { return };
        let from = nodes.partition_point(|n| (*n as usize) < range.start);
        for n in nodes[from..].iter().map(|n| *n as usize).take_while(|n| *n < range.end) {
            // SAFETY: the caller keeps other threads away from these nodes.
            (0..3).for_each(|axis| unsafe { *velocity[axis].at(n) = *self.velocity[axis].at(n) });
        }
    }

    /// Gives held nodes the force under which they keep their velocity; with damping, returns their Σ m v², kg m²/s².
    fn hold_back(&self, some: Range<usize>, axes: &mut [Axis<'_>; 3]) -> f64 {
        let mut squares = 0.0;
        let from = self.constrained.partition_point(|n| (*n as usize) < some.start);
        for &n in self.constrained[from..].iter().take_while(|n| (**n as usize) < some.end) {
            let (n, at) = (n as usize, n as usize - some.start);
            let free = self.mobility.at(n);
            for axis in (0..3).filter(|axis| free[*axis] == 0.0) {
                let of = &mut axes[axis];
                of.force[at] = -of.field * self.mass[n];
                if self.kick.keep != 1.0 {
                    let v = of.velocity[at];
                    of.force[at] += (1.0 - self.kick.keep) * v * self.mass[n] / self.kick.gain;
                    squares += v * v * self.mass[n];
                }
            }
        }
        squares
    }
}

at_width! {
    fn advance[](kick: Kick, dt: f64, inverse_mass: &[f64], axes: &mut [Axis<'_>; 3]) -> Moved = advance_lanewise
}

#[inline(always)]
fn advance_lanewise(kick: Kick, dt: f64, inverse_mass: &[f64], axes: &mut [Axis<'_>; 3]) -> Moved {
    let mut damped = 0.0;
    for axis in axes.iter_mut() {
        if kick.keep == 1.0 {
            move_axis::<false>(kick, dt, inverse_mass, axis);
        } else {
            damped += move_axis::<true>(kick, dt, inverse_mass, axis);
        }
    }
    let [x, y, z] = axes.each_ref().map(|axis| &*axis.velocity);
    let mut squared = splat::<LANES>(0.0);
    for ((x, y), z) in x.chunks(LANES).zip(y.chunks(LANES)).zip(z.chunks(LANES)) {
        for l in 0..x.len() {
            squared[l] = larger(x[l] * x[l] + y[l] * y[l] + z[l] * z[l], squared[l]);
        }
    }
    Moved { fastest: squared.into_iter().fold(0.0, larger), damped }
}

/// Kicks and moves one axis; with damping, returns Σ m v̄² with the mean v̄ of the velocities before and after.
#[inline(always)]
fn move_axis<const DAMPED: bool>(kick: Kick, dt: f64, inverse_mass: &[f64], axis: &mut Axis<'_>) -> f64 {
    let count = inverse_mass.len();
    let field = axis.field;
    let (position, velocity, force) =
        (&mut axis.position[..count], &mut axis.velocity[..count], &mut axis.force[..count]);
    let mut sum = 0.0;
    for n in 0..count {
        let kept = if DAMPED { kick.keep * velocity[n] } else { velocity[n] };
        let v = kept + kick.gain * (force[n] * inverse_mass[n] + field);
        if DAMPED {
            let mean = 0.5 * (velocity[n] + v);
            sum += mean * mean / inverse_mass[n];
        }
        velocity[n] = v;
        position[n] += v * dt;
        force[n] = 0.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows are read as rows; gaps, fill and other orders lane by lane.
    #[test]
    fn lanes_hold_the_nodes_that_were_asked_for() {
        let values: Vec<f64> = (0..60).map(f64::from).collect();
        let cases: [[u32; LANES]; 4] = [
            [8, 9, 10, 11, 12, 13, 14, 15],
            [36, 42, 43, 43, 43, 43, 43, 43],
            [5, 5, 5, 5, 5, 5, 5, 5],
            [0, 2, 1, 3, 4, 5, 6, 7],
        ];
        for nodes in cases {
            assert_eq!(gather(&values, &nodes), nodes.map(f64::from));
        }
    }

    #[test]
    fn only_those_given_momentum_move() {
        for group in [[8, 9, 10, 11, 12, 13, 14, 15], [36, 42, 43, 43, 43, 43, 43, 43]] {
            let mut nodes = Nodes::default();
            nodes.extend((0..60).map(|n| [f64::from(n), 0.0, 0.0]), &[2.0; 60]);
            nodes.hold([42], [true, false, false]);
            let mut given = splat(0.0);
            (0..3).for_each(|l| given[l] = 1.0);
            let impulse = [given.map(|g| 4.0 * g), given.map(|g| 6.0 * g), splat(0.0)];
            // SAFETY: there is one thread.
            unsafe { nodes.met().push_lanes(&group, &given, &impulse, 0.5) };
            for n in 0..60 {
                let pushed = group[..3].contains(&(n as u32));
                let along_x = if pushed && n != 42 { 2.0 } else { 0.0 };
                let along_y = if pushed { 3.0 } else { 0.0 };
                assert_eq!(nodes.velocity.at(n), [along_x, along_y, 0.0], "node {n}");
                assert_eq!(nodes.position.at(n), [n as f64 + 0.5 * along_x, 0.5 * along_y, 0.0], "node {n}");
            }
        }
    }
}
