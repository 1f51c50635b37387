//! Time integration of the nodes: kick and drift of central differences (theory.md, equation 15), and their correction by
//! impulses of contact after they have moved.

use std::ops::Range;

use super::Nodes;
use super::vectors::{Vectors, consecutive};
use crate::engine::disjoint::Disjoint;
use crate::lane::{LANES, Lane3, Mask, Width, at_width, larger, splat};

/// Coefficients of a kick, v := decay·v + gain·F/m (theory.md, equation 15).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::engine) struct Kick {
    /// Factor on the velocities, below one with damping.
    decay: f64,
    /// Factor on the accelerations, s.
    gain: f64,
}

impl Kick {
    /// A kick over `dt` (s) with mass-proportional `damping` (1/s).
    pub(in crate::engine) fn new(dt: f64, damping: f64) -> Kick {
        let half = 0.5 * damping * dt;
        Kick { decay: (1.0 - half) / (1.0 + half), gain: dt / (1.0 + half) }
    }

    /// Velocity after it of a free node, m/s, under an acceleration without damping (m/s²).
    pub(in crate::engine) fn after(&self, velocity: f64, acceleration: f64) -> f64 {
        self.decay * velocity + self.gain * acceleration
    }
}

/// Report of a step on the nodes that it moved.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::engine) struct StepSums {
    /// Square of the largest speed, m²/s².
    pub(in crate::engine) largest_speed_squared: f64,
    /// Σ m v̄² over free directions, with the mean v̄ of the velocities before and after, kg m²/s²; zero without
    /// damping.
    pub(in crate::engine) damped: f64,
}

impl StepSums {
    /// The sums over these nodes and others.
    pub(in crate::engine) fn and(&self, others: &StepSums) -> StepSums {
        StepSums {
            largest_speed_squared: larger(self.largest_speed_squared, others.largest_speed_squared),
            damped: self.damped + others.damped,
        }
    }
}

/// One axis of some nodes while they move.
struct Axis<'a> {
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    force: &'a mut [f64],
    /// Acceleration by gravity, m/s².
    field: f64,
}

/// Nodes whose values stay in the first-level cache while all axes are moved.
const CACHED: usize = 256;

/// Nodes that several threads integrate at the same time, each its own range.
pub(in crate::engine) struct Integration<'a> {
    position: [Disjoint<'a, f64>; 3],
    velocity: [Disjoint<'a, f64>; 3],
    force: [Disjoint<'a, f64>; 3],
    mass: &'a [f64],
    inverse_mass: &'a [f64],
    effective_inverse_mass: &'a Vectors,
    constrained: &'a [u32],
    kick: Kick,
    dt: f64,
    records: Vec<VelocityRecord<'a>>,
}

/// Nodes whose velocities are recorded before the kick.
pub(in crate::engine) struct VelocityRecord<'a> {
    /// Ascending.
    pub(in crate::engine) nodes: &'a [u32],
    /// The recorded velocities, with an entry for every node of the scene, m/s.
    pub(in crate::engine) velocity: [Disjoint<'a, f64>; 3],
}

impl Nodes {
    /// Shares the nodes for a step: velocities enter the `records`, then follow the `kick` and a drift over `dt` (s).
    pub(in crate::engine) fn integration<'a>(
        &'a mut self,
        kick: Kick,
        dt: f64,
        records: Vec<VelocityRecord<'a>>,
    ) -> Integration<'a> {
        Integration {
            position: self.position.axes_mut().map(Disjoint::new),
            velocity: self.velocity.axes_mut().map(Disjoint::new),
            force: self.force.axes_mut().map(Disjoint::new),
            mass: &self.mass,
            inverse_mass: &self.inverse_mass,
            effective_inverse_mass: &self.effective_inverse_mass,
            constrained: &self.constrained,
            kick,
            dt,
            records,
        }
    }
}

impl Integration<'_> {
    /// v := decay·v + gain·(F/m + g), x := x + v Δt, F := 0 for a range of nodes under `gravity` (m/s², downward).
    ///
    /// # Safety
    /// No other thread may access these nodes.
    pub(in crate::engine) unsafe fn advance(&self, width: Width, nodes: Range<usize>, gravity: f64) -> StepSums {
        let mut sums = StepSums::default();
        // SAFETY: by the contract no other thread accesses these nodes.
        unsafe { self.record(nodes.clone()) };
        // In pieces, as three axes of a whole range would leave the cache before the speeds are taken.
        for start in nodes.clone().step_by(CACHED) {
            let some = start..nodes.end.min(start + CACHED);
            // SAFETY: by the contract no other thread accesses these nodes.
            let [x, y, z] = [0, 1, 2].map(|axis| unsafe {
                Axis {
                    position: self.position[axis].range(some.clone()),
                    velocity: self.velocity[axis].range(some.clone()),
                    force: self.force[axis].range(some.clone()),
                    field: if axis == 2 { -gravity } else { 0.0 },
                }
            });
            let mut axes = [x, y, z];
            // Held directions then need no branch in the loop below; what damping would count of them is taken off
            // again.
            sums.damped -= self.set_reactions(some.clone(), &mut axes);
            sums = sums.and(&advance(width, self.kick, self.dt, &self.inverse_mass[some], &mut axes));
        }
        sums
    }

    /// Records the velocities of the nodes of `range` that each record lists.
    ///
    /// # Safety
    /// No other thread may access these nodes.
    unsafe fn record(&self, range: Range<usize>) {
        for VelocityRecord { nodes, velocity } in &self.records {
            let from = nodes.partition_point(|n| (*n as usize) < range.start);
            for n in nodes[from..].iter().map(|n| *n as usize).take_while(|n| *n < range.end) {
                for axis in 0..3 {
                    // SAFETY: by the contract no other thread accesses these nodes.
                    unsafe { *velocity[axis].entry(n) = *self.velocity[axis].entry(n) };
                }
            }
        }
    }

    /// Sets the forces of held directions to those under which their velocity is constant; with damping, returns their
    /// Σ m v², kg m²/s².
    fn set_reactions(&self, some: Range<usize>, axes: &mut [Axis<'_>; 3]) -> f64 {
        let mut squares = 0.0;
        let from = self.constrained.partition_point(|n| (*n as usize) < some.start);
        for &n in self.constrained[from..].iter().take_while(|n| (**n as usize) < some.end) {
            let (n, at) = (n as usize, n as usize - some.start);
            let inverse_mass = self.effective_inverse_mass.value_at(n);
            for axis in (0..3).filter(|axis| inverse_mass[*axis] == 0.0) {
                let axis = &mut axes[axis];
                axis.force[at] = -axis.field * self.mass[n];
                if self.kick.decay != 1.0 {
                    let v = axis.velocity[at];
                    axis.force[at] += (1.0 - self.kick.decay) * v * self.mass[n] / self.kick.gain;
                    squares += v * v * self.mass[n];
                }
            }
        }
        squares
    }
}

at_width! {
    fn advance[](kick: Kick, dt: f64, inverse_mass: &[f64], axes: &mut [Axis<'_>; 3]) -> StepSums {
        let mut damped = 0.0;
        for axis in axes.iter_mut() {
            // Two loops are compiled: without damping, nothing of it is computed, and velocities keep their bits.
            if kick.decay == 1.0 {
                move_axis::<false>(kick, dt, inverse_mass, axis);
            } else {
                damped += move_axis::<true>(kick, dt, inverse_mass, axis);
            }
        }
        let [x, y, z] = &*axes;
        let count = inverse_mass.len();
        let (x, y, z) = (&x.velocity[..count], &y.velocity[..count], &z.velocity[..count]);
        let mut squared = splat::<LANES>(0.0);
        for start in (0..count).step_by(LANES) {
            let some = start..count.min(start + LANES);
            let (x, y, z) = (&x[some.clone()], &y[some.clone()], &z[some]);
            for l in 0..x.len() {
                squared[l] = larger(x[l] * x[l] + y[l] * y[l] + z[l] * z[l], squared[l]);
            }
        }
        StepSums { largest_speed_squared: squared.into_iter().fold(0.0, larger), damped }
    }
}

/// Kick and drift of one axis; with damping, returns Σ m v̄² with the mean v̄ of the velocities before and after.
#[inline(always)]
fn move_axis<const DAMPED: bool>(kick: Kick, dt: f64, inverse_mass: &[f64], axis: &mut Axis<'_>) -> f64 {
    let count = inverse_mass.len();
    let field = axis.field;
    let (position, velocity, force) =
        (&mut axis.position[..count], &mut axis.velocity[..count], &mut axis.force[..count]);
    let mut sum = 0.0;
    for n in 0..count {
        let decayed = if DAMPED { kick.decay * velocity[n] } else { velocity[n] };
        let v = decayed + kick.gain * (force[n] * inverse_mass[n] + field);
        if DAMPED {
            let mean = 0.5 * (velocity[n] + v);
            // Damping works along the mean velocity, as contact does (theory.md, equations 15 and 22).
            sum += mean * mean / inverse_mass[n];
        }
        velocity[n] = v;
        position[n] += v * dt;
        // Here, where it is in the cache: the next step adds to it.
        force[n] = 0.0;
    }
    sum
}

/// Nodes that several threads correct at the same time, each its own.
pub(in crate::engine) struct Correction<'a> {
    pub(super) position: [Disjoint<'a, f64>; 3],
    pub(super) velocity: [Disjoint<'a, f64>; 3],
    pub(super) effective_inverse_mass: &'a Vectors,
}

impl Correction<'_> {
    /// Applies `impulse` (N s), zero but where `active`, to nodes of which no active one is repeated, and moves
    /// them by the change of velocity times `dt` (s). Returns their velocities.
    ///
    /// # Safety
    /// No other thread may access these nodes.
    #[inline(always)]
    pub(in crate::engine) unsafe fn apply_impulses(
        &self,
        nodes: &[u32; LANES],
        active: Mask,
        impulse: &Lane3,
        dt: f64,
    ) -> Lane3 {
        let mut after = Lane3::ZERO;
        let Some(range) = consecutive(nodes) else {
            for l in active.lanes() {
                // SAFETY: by the contract no other thread accesses these nodes.
                let velocity = unsafe { self.apply_impulse(nodes[l] as usize, &impulse.vector(l).into(), dt) };
                after.set(l, &velocity.into());
            }
            return after;
        };
        let inverse_mass = self.effective_inverse_mass.range(range.clone());
        for axis in 0..3 {
            // SAFETY: as above.
            let (x, v) =
                unsafe { (self.position[axis].range(range.clone()), self.velocity[axis].range(range.clone())) };
            for l in 0..LANES {
                let change = impulse[axis][l] * inverse_mass[axis][l];
                x[l] += change * dt;
                let velocity = v[l] + change;
                v[l] = velocity;
                after[axis][l] = velocity;
            }
        }
        after
    }

    /// Applies `impulse` (N s) to a node and moves it by the change of velocity times `dt` (s). Returns its velocity.
    ///
    /// # Safety
    /// No other thread may access this node.
    #[inline(always)]
    pub(in crate::engine) unsafe fn apply_impulse(&self, node: usize, impulse: &[f64; 3], dt: f64) -> [f64; 3] {
        let inverse_mass = self.effective_inverse_mass.value_at(node);
        let mut after = [0.0; 3];
        for axis in 0..3 {
            let change = impulse[axis] * inverse_mass[axis];
            // SAFETY: by the contract no other thread accesses this node.
            let (x, v) = unsafe { (self.position[axis].entry(node), self.velocity[axis].entry(node)) };
            *x += change * dt;
            *v += change;
            after[axis] = *v;
        }
        after
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::nodes::Nodes;

    #[test]
    fn nodes_that_are_let_go_hold_nothing() {
        let mut nodes = Nodes::default();
        nodes.extend([[0.0; 3]; 3], &[1.0; 3]);
        nodes.hold(0..3, [true; 3]);
        (0..3).for_each(|n| nodes.force.set(n, [10.0_f64.powi(n as i32), 0.0, 0.0]));
        // One on a mirror plane stays held across it.
        nodes.release(1, [true, false, true]);
        assert_eq!((nodes.held_force(&[0, 1, 2], 0), nodes.total_force(&[0, 1, 2], 0)), (101.0, 111.0));
    }

    #[test]
    fn only_nodes_with_an_impulse_move() {
        for group in [[8, 9, 10, 11, 12, 13, 14, 15], [36, 42, 43, 43, 43, 43, 43, 43]] {
            let mut nodes = Nodes::default();
            nodes.extend((0..60).map(|n| [f64::from(n), 0.0, 0.0]), &[2.0; 60]);
            nodes.hold([42], [true, false, false]);
            let active = Mask::first(3);
            let impulse = Lane3([active.select(4.0, 0.0), active.select(6.0, 0.0), splat(0.0)]);
            // SAFETY: there is one thread.
            unsafe { nodes.correction().apply_impulses(&group, active, &impulse, 0.5) };
            for n in 0..60 {
                let has_impulse = group[..3].contains(&(n as u32));
                let along_x = if has_impulse && n != 42 { 2.0 } else { 0.0 };
                let along_y = if has_impulse { 3.0 } else { 0.0 };
                assert_eq!(nodes.velocity.value_at(n), [along_x, along_y, 0.0], "node {n}");
                assert_eq!(nodes.position.value_at(n), [n as f64 + 0.5 * along_x, 0.5 * along_y, 0.0], "node {n}");
            }
        }
    }
}
