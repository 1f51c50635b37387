//! The nodes of all faces and the explicit central-difference step that moves them.

use nalgebra::Vector3;

/// Nodal quantities, one entry a node.
#[derive(Clone, Debug, Default)]
pub struct Nodes {
    /// m, at the full step.
    pub position: Vec<[f64; 3]>,
    /// m/s, at the half step.
    pub velocity: Vec<[f64; 3]>,
    /// N, at the full step.
    pub force: Vec<[f64; 3]>,
    /// kg.
    pub mass: Vec<f64>,
    /// 1/kg, zero along directions that are held or prescribed.
    pub inverse_mass: Vec<[f64; 3]>,
}

impl Nodes {
    /// Appends free nodes at rest.
    pub fn extend(&mut self, positions: impl IntoIterator<Item = [f64; 3]>, masses: &[f64]) {
        self.position.extend(positions);
        let count = self.position.len();
        self.velocity.resize(count, [0.0; 3]);
        self.force.resize(count, [0.0; 3]);
        self.mass.extend_from_slice(masses);
        self.inverse_mass.extend(masses.iter().map(|m| if *m > 0.0 { [1.0 / m; 3] } else { [0.0; 3] }));
    }

    /// Sets the forces to the weight under gravity `g` (m/s², downward).
    pub fn start_forces(&mut self, g: f64) {
        for (force, mass) in self.force.iter_mut().zip(&self.mass) {
            *force = [0.0, 0.0, -g * mass];
        }
    }

    /// Factors on velocity and acceleration of a kick over `dt` (s) with mass-proportional `damping` (1/s).
    pub fn damped(dt: f64, damping: f64) -> (f64, f64) {
        let half = 0.5 * damping * dt;
        ((1.0 - half) / (1.0 + half), dt / (1.0 + half))
    }

    /// v := ((1 − αΔt/2) v + a Δt)/(1 + αΔt/2) with mass-proportional damping α (1/s) (theory.md, equation 15).
    pub fn kick(&mut self, dt: f64, damping: f64) {
        if damping == 0.0 {
            for ((v, f), w) in self.velocity.iter_mut().zip(&self.force).zip(&self.inverse_mass) {
                for axis in 0..3 {
                    v[axis] += dt * f[axis] * w[axis];
                }
            }
            return;
        }
        let (keep, gain) = Nodes::damped(dt, damping);
        for ((v, f), w) in self.velocity.iter_mut().zip(&self.force).zip(&self.inverse_mass) {
            for axis in 0..3 {
                let held = if w[axis] == 0.0 { 1.0 } else { keep };
                v[axis] = held * v[axis] + gain * f[axis] * w[axis];
            }
        }
    }

    /// x := x + v Δt; returns the largest speed, m/s.
    pub fn drift(&mut self, dt: f64) -> f64 {
        let mut fastest = 0.0;
        for (x, v) in self.position.iter_mut().zip(&self.velocity) {
            let squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            if squared > fastest {
                fastest = squared;
            }
            for axis in 0..3 {
                x[axis] += v[axis] * dt;
            }
        }
        f64::sqrt(fastest)
    }

    /// Velocity of one node.
    #[inline]
    pub fn velocity_of(&self, node: usize) -> Vector3<f64> {
        Vector3::from(self.velocity[node])
    }

    /// Whether a node is held in every direction.
    #[inline]
    pub fn is_held(&self, node: usize) -> bool {
        self.inverse_mass[node] == [0.0; 3]
    }

    /// Sum of the forces along x on some nodes, N.
    pub fn pull(&self, nodes: &[u32]) -> f64 {
        nodes.iter().map(|n| self.force[*n as usize][0]).sum()
    }

    /// Holds some nodes along the marked axes: they keep the velocity they have.
    pub fn hold(&mut self, nodes: impl IntoIterator<Item = usize>, axes: [bool; 3]) {
        for n in nodes {
            for axis in (0..3).filter(|a| axes[*a]) {
                self.inverse_mass[n][axis] = 0.0;
            }
        }
    }
}
