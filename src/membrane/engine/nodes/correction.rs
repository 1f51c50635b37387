//! Correction of the nodes after they have moved: impulses by contact.

use crate::engine::disjoint::Disjoint;
use crate::lane::{LANES, Lane, Lane3, splat};

use super::vectors::{Vectors, consecutive};

/// Nodes that several threads correct at the same time, each its own.
pub(in crate::engine) struct Correction<'a> {
    pub(super) position: [Disjoint<'a, f64>; 3],
    pub(super) velocity: [Disjoint<'a, f64>; 3],
    pub(super) effective_inverse_mass: &'a Vectors,
}

impl Correction<'_> {
    /// Applies `impulse` (N s), zero where `active` is not one, to nodes of which no active one is repeated, and moves
    /// them by the change of velocity times `dt` (s). Returns their velocities.
    ///
    /// # Safety
    /// No other thread may access these nodes.
    #[inline(always)]
    pub(in crate::engine) unsafe fn apply_impulses(
        &self,
        nodes: &[u32; LANES],
        active: &Lane,
        impulse: &Lane3,
        dt: f64,
    ) -> Lane3 {
        let mut after = [splat(0.0); 3];
        let Some(range) = consecutive(nodes) else {
            for l in (0..LANES).filter(|l| active[*l] > 0.0) {
                let impulse = [impulse[0][l], impulse[1][l], impulse[2][l]];
                // SAFETY: by the contract no other thread accesses these nodes.
                let velocity = unsafe { self.apply_impulse(nodes[l] as usize, &impulse, dt) };
                for axis in 0..3 {
                    after[axis][l] = velocity[axis];
                }
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
    fn only_nodes_with_an_impulse_move() {
        for group in [[8, 9, 10, 11, 12, 13, 14, 15], [36, 42, 43, 43, 43, 43, 43, 43]] {
            let mut nodes = Nodes::default();
            nodes.extend((0..60).map(|n| [f64::from(n), 0.0, 0.0]), &[2.0; 60]);
            nodes.hold([42], [true, false, false]);
            let mut active = splat(0.0);
            (0..3).for_each(|l| active[l] = 1.0);
            let impulse = [active.map(|a| 4.0 * a), active.map(|a| 6.0 * a), splat(0.0)];
            // SAFETY: there is one thread.
            unsafe { nodes.correction().apply_impulses(&group, &active, &impulse, 0.5) };
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
