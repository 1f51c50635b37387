//! The nodes of all faces: their state, its integration in time, its correction by contact.

mod integration;
mod vectors;

pub(super) use integration::{Correction, Kick, StepSums, VelocityRecord};
pub use vectors::Vectors;
pub(super) use vectors::gather;

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::disjoint::Disjoint;

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
    /// 1/kg, of held nodes as well.
    inverse_mass: Vec<f64>,
    /// Velocity per impulse along each axis, 1/kg; zero along directions that are held or prescribed.
    effective_inverse_mass: Vectors,
    /// Nodes that are held along an axis or more, ascending.
    constrained: Vec<u32>,
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
        self.effective_inverse_mass.extend(masses.iter().map(|mass| [1.0 / mass; 3]));
    }

    /// Adds mass (kg) to a node.
    pub(super) fn add_mass(&mut self, node: usize, mass: f64) {
        self.mass[node] += mass;
        let inverse = 1.0 / self.mass[node];
        self.inverse_mass[node] = inverse;
        let free = self.effective_inverse_mass.value_at(node);
        self.effective_inverse_mass.set(node, free.map(|old| if old == 0.0 { 0.0 } else { inverse }));
    }

    /// Position of one node.
    #[inline]
    pub fn position_of(&self, node: usize) -> Point3<f64> {
        Point3::from(self.position.value_at(node))
    }

    /// Velocity of one node.
    #[inline]
    pub fn velocity_of(&self, node: usize) -> Vector3<f64> {
        Vector3::from(self.velocity.value_at(node))
    }

    /// Velocity per impulse, 1/kg; zero along directions that are held or prescribed.
    pub(super) fn effective_inverse_mass(&self) -> &Vectors {
        &self.effective_inverse_mass
    }

    /// Whether a node is held in every direction.
    #[inline]
    pub fn is_held(&self, node: usize) -> bool {
        let [x, y, z] = self.effective_inverse_mass.value_at(node);
        x == 0.0 && y == 0.0 && z == 0.0
    }

    /// Sets all forces to zero.
    pub fn clear_forces(&mut self) {
        self.force.axes_mut().into_iter().for_each(|axis| axis.fill(0.0));
    }

    /// Shares the nodes for a correction by several threads.
    pub(super) fn correction(&mut self) -> Correction<'_> {
        Correction {
            position: self.position.axes_mut().map(Disjoint::new),
            velocity: self.velocity.axes_mut().map(Disjoint::new),
            effective_inverse_mass: &self.effective_inverse_mass,
        }
    }

    /// Applies `impulse` (N s) to a node and moves it by the change of velocity times `dt` (s).
    #[inline]
    pub(super) fn apply_impulse(&mut self, node: usize, impulse: &Vector3<f64>, dt: f64) {
        let inverse_mass = self.effective_inverse_mass.value_at(node);
        let change = [impulse.x * inverse_mass[0], impulse.y * inverse_mass[1], impulse.z * inverse_mass[2]];
        self.position.add(node, [change[0] * dt, change[1] * dt, change[2] * dt]);
        self.velocity.add(node, change);
    }

    /// Sums of squares of the forces on some nodes, with their weight under `gravity` (m/s²), along free directions and
    /// along held ones, N².
    pub(super) fn squared_forces(&self, nodes: Range<usize>, gravity: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for n in nodes {
            let ([x, y, z], free) = (self.force.value_at(n), self.effective_inverse_mass.value_at(n));
            for (force, free) in [x, y, z - self.mass[n] * gravity].into_iter().zip(free) {
                sums[usize::from(free == 0.0)] += force * force;
            }
        }
        sums
    }

    /// Multiplies all velocities along z.
    pub(super) fn scale_vertical_velocity(&mut self, factor: f64) {
        let [_, _, z] = self.velocity.axes_mut();
        z.iter_mut().for_each(|velocity| *velocity *= factor);
    }

    /// Sets all velocities to zero.
    pub(super) fn stop(&mut self) {
        self.velocity.axes_mut().into_iter().for_each(|axis| axis.fill(0.0));
    }

    /// Sum of the forces on some nodes along an axis, N.
    pub fn total_force(&self, nodes: &[u32], axis: usize) -> f64 {
        nodes.iter().map(|n| self.force.value_at(*n as usize)[axis]).sum()
    }

    /// The same of those that are held in every direction: what has left a clamp is not.
    pub fn held_force(&self, nodes: &[u32], axis: usize) -> f64 {
        let held = nodes.iter().map(|n| *n as usize).filter(|n| self.is_held(*n));
        held.map(|n| self.force.value_at(n)[axis]).sum()
    }

    /// Along which axes a node is neither held nor prescribed.
    pub fn free_axes(&self, node: usize) -> [bool; 3] {
        self.effective_inverse_mass.value_at(node).map(|inverse_mass| inverse_mass > 0.0)
    }

    /// Lets go of a node along the marked axes.
    pub(super) fn release(&mut self, node: usize, axes: [bool; 3]) {
        let (held, inverse_mass) = (self.effective_inverse_mass.value_at(node), self.inverse_mass[node]);
        let free = [0, 1, 2].map(|axis| if axes[axis] { inverse_mass } else { held[axis] });
        self.effective_inverse_mass.set(node, free);
        if !free.contains(&0.0) {
            self.constrained.retain(|n| *n as usize != node);
        }
    }

    /// Holds some nodes along the marked axes, where their velocity stays constant.
    pub fn hold(&mut self, nodes: impl IntoIterator<Item = usize>, axes: [bool; 3]) {
        for n in nodes {
            let inverse_mass = self.effective_inverse_mass.value_at(n);
            self.effective_inverse_mass.set(n, [0, 1, 2].map(|axis| if axes[axis] { 0.0 } else { inverse_mass[axis] }));
        }
        let constrained = (0..self.mass.len()).filter(|n| self.effective_inverse_mass.value_at(*n).contains(&0.0));
        self.constrained = constrained.map(|n| n as u32).collect();
    }
}

/// A step of a relaxation.
pub(in crate::engine) struct RelaxationStep {
    /// The time step before it, s.
    pub last: f64,
    /// Its time step, s.
    pub dt: f64,
    /// Time over which it changes velocities, s.
    pub kick: f64,
    /// m/s².
    pub gravity: f64,
    /// Factor by which the mass against vertical motion is reduced.
    pub lightness: f64,
}

impl RelaxationStep {
    fn lightness(&self, axis: usize) -> f64 {
        if axis == 2 { self.lightness } else { 1.0 }
    }
}

impl Nodes {
    /// Steps some nodes, without damping. Returns their kinetic energy with the masses of the step, J.
    pub(in crate::engine) fn relax(&mut self, nodes: Range<usize>, step: &RelaxationStep) -> f64 {
        let mut kinetic = 0.0;
        for n in nodes {
            let (mut v, mut x) = (self.velocity.value_at(n), self.position.value_at(n));
            for axis in 0..3 {
                let Some(kick) = self.kick(n, axis, step) else { continue };
                v[axis] += kick;
                x[axis] += v[axis] * step.dt;
                kinetic += 0.5 * self.mass[n] / step.lightness(axis) * v[axis] * v[axis];
            }
            self.velocity.set(n, v);
            self.position.set(n, x);
        }
        kinetic
    }

    /// Puts some nodes, which [`Nodes::relax`] has just stepped, back to the middle of the step before.
    pub(in crate::engine) fn return_to_peak(&mut self, nodes: Range<usize>, step: &RelaxationStep) {
        for n in nodes {
            let (v, mut x) = (self.velocity.value_at(n), self.position.value_at(n));
            for axis in 0..3 {
                let Some(kick) = self.kick(n, axis, step) else { continue };
                x[axis] -= v[axis] * step.dt + 0.5 * (v[axis] - kick) * step.last;
            }
            self.position.set(n, x);
        }
    }

    /// Change of a node's velocity in a step along an axis, m/s; none where it is held.
    #[inline(always)]
    fn kick(&self, node: usize, axis: usize, step: &RelaxationStep) -> Option<f64> {
        let inverse_mass = self.effective_inverse_mass.axes()[axis][node];
        let field = if axis == 2 { -step.gravity } else { 0.0 };
        let kick = step.kick * step.lightness(axis) * (self.force.axes()[axis][node] * inverse_mass + field);
        (inverse_mass > 0.0).then_some(kick)
    }
}
