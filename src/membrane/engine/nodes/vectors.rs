//! Vectors at all nodes, one array an axis.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::lane::{LANES, Lane, Lane3, lanes};

/// A vector at every node, one array an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vectors {
    axes: [Vec<f64>; 3],
}

impl Vectors {
    /// Zero at `count` nodes.
    pub fn zero(count: usize) -> Vectors {
        Vectors { axes: [vec![0.0; count], vec![0.0; count], vec![0.0; count]] }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.axes[0].len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.axes[0].is_empty()
    }

    /// The vector at one node.
    #[inline(always)]
    pub fn value_at(&self, node: usize) -> [f64; 3] {
        [self.axes[0][node], self.axes[1][node], self.axes[2][node]]
    }

    /// Replaces the vector at one node.
    #[inline(always)]
    pub fn set(&mut self, node: usize, vector: [f64; 3]) {
        for axis in 0..3 {
            self.axes[axis][node] = vector[axis];
        }
    }

    /// Adds to the vector at one node.
    #[inline(always)]
    pub fn add(&mut self, node: usize, vector: [f64; 3]) {
        for axis in 0..3 {
            self.axes[axis][node] += vector[axis];
        }
    }

    /// The vectors at some nodes, a lane each.
    #[inline(always)]
    pub(in crate::engine) fn gather(&self, nodes: &[u32; LANES]) -> Lane3 {
        let [x, y, z] = &self.axes;
        Lane3([gather(x, nodes), gather(y, nodes), gather(z, nodes)])
    }

    /// The vectors of all nodes.
    pub fn iter(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        (0..self.len()).map(|node| self.value_at(node))
    }

    /// The vectors of some nodes, an array an axis.
    #[inline(always)]
    pub fn range(&self, nodes: Range<usize>) -> [&[f64]; 3] {
        let [x, y, z] = &self.axes;
        [&x[nodes.clone()], &y[nodes.clone()], &z[nodes]]
    }

    /// The vectors of all nodes, an array an axis.
    pub fn axes(&self) -> [&[f64]; 3] {
        self.range(0..self.len())
    }

    /// The vectors of all nodes, mutable, an array an axis.
    pub fn axes_mut(&mut self) -> [&mut [f64]; 3] {
        self.axes.each_mut().map(Vec::as_mut_slice)
    }

    /// Whether all axes have the same number of nodes, which may not be so after deserialization.
    pub(in crate::engine) fn is_whole(&self) -> bool {
        self.axes.iter().all(|axis| axis.len() == self.len())
    }

    /// Appends zero vectors or removes the last ones.
    pub(super) fn resize(&mut self, count: usize) {
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

/// Values at some nodes, a lane each.
#[inline(always)]
pub(in crate::engine) fn gather(values: &[f64], nodes: &[u32; LANES]) -> Lane {
    match consecutive(nodes) {
        Some(range) => {
            let values = &values[range];
            lanes(|l| values[l])
        }
        None => lanes(|l| values[nodes[l] as usize]),
    }
}

/// The range of nodes that `nodes` are, if they are consecutive. A group padded with its last node is none.
#[inline(always)]
pub(super) fn consecutive(nodes: &[u32; LANES]) -> Option<Range<usize>> {
    let mut follow = true;
    for l in 0..LANES {
        follow &= nodes[l] == nodes[0] + l as u32;
    }
    let first = nodes[0] as usize;
    follow.then_some(first..first + LANES)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Consecutive nodes, gaps, padding and other orders.
    #[test]
    fn gather_reads_the_values_of_its_nodes() {
        let values: Vec<f64> = (0..60).map(f64::from).collect();
        let cases: [[u32; LANES]; 4] = [
            [8, 9, 10, 11, 12, 13, 14, 15],
            [36, 42, 43, 43, 43, 43, 43, 43],
            [5, 5, 5, 5, 5, 5, 5, 5],
            [0, 2, 1, 3, 4, 5, 6, 7],
        ];
        for nodes in cases {
            assert_eq!(*gather(&values, &nodes), nodes.map(f64::from));
        }
    }
}
