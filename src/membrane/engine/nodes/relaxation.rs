//! Steps of a dynamic relaxation.

use std::ops::Range;

use super::Nodes;

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
