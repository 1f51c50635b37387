//! Points of film, or differences of two, as sums of four nodes with weights: what contact constrains.

use nalgebra::Vector3;

use super::nodes::{Nodes, Vectors};

/// Four nodes with weights, of which some may be zero.
#[derive(Clone, Debug)]
pub(super) struct WeightedNodes {
    pub(super) nodes: [u32; 4],
    pub(super) weights: [f64; 4],
    /// Velocity of each node per impulse on the sum, 1/kg: weight over mass, zero along held directions.
    response: [Vector3<f64>; 4],
    /// How many of them count: those behind have the weight zero.
    count: usize,
}

impl WeightedNodes {
    /// `of` some nodes, with `weights`.
    #[inline]
    pub(super) fn new(of: [u32; 4], weights: [f64; 4], nodes: &Nodes) -> WeightedNodes {
        let mut response = [Vector3::zeros(); 4];
        let mut count = 0;
        for k in 0..4 {
            response[k] = Vector3::from(nodes.effective_inverse_mass().value_at(of[k] as usize)) * weights[k];
            if weights[k] != 0.0 {
                count = k + 1;
            }
        }
        WeightedNodes { nodes: of, weights, response, count }
    }

    /// The sum of what the nodes have: of their velocities, that of the point, m/s.
    #[inline(always)]
    pub(super) fn sum(&self, of: &Vectors) -> Vector3<f64> {
        // Loops, not iterators: sums of vectors and maps of arrays are generic functions of other crates, each a call
        // in a build without optimisation across units.
        let mut sum = [0.0; 3];
        for k in 0..self.count {
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
        for k in 0..self.count {
            let response = &self.response[k];
            to.add(self.nodes[k] as usize, [response.x * impulse.x, response.y * impulse.y, response.z * impulse.z]);
        }
    }

    /// Velocity of the sum per impulse along each axis, 1/kg.
    #[inline]
    pub(super) fn inverse_mass(&self) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for k in 0..4 {
            sum += self.response[k] * self.weights[k];
        }
        sum
    }

    /// Inverse mass of nodes that are held in no direction, 1/kg: a bound for every direction. A node that is held in
    /// all of them has no part in it.
    #[inline]
    pub(super) fn inverse_free_mass(&self) -> f64 {
        let free = |k: usize| {
            // The response of its free direction, as if all were free; zero only where none is.
            let response = &self.response[k];
            let largest = response.x.abs().max(response.y.abs()).max(response.z.abs());
            self.weights[k] * largest.copysign(self.weights[k])
        };
        (0..4).map(free).sum()
    }
}

/// The tangential impulse within Coulomb's cone: `sticking` (N s), which would stop the slip, or what of it is within
/// the `bound` (N s).
#[inline(always)]
pub(super) fn within_cone(sticking: Vector3<f64>, bound: f64) -> Vector3<f64> {
    let size = sticking.norm();
    if size <= bound { sticking } else { sticking * (bound / size) }
}
