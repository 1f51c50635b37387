//! Better shapes for the elements of a plane mesh whose connectivity stays.

use nalgebra::Point3;

use super::quality::scaled_jacobian;
use super::topology::{directed, undirected};

/// Passes over the nodes; later ones change little.
const PASSES: usize = 12;

/// Improvement of the least scaled Jacobian below which a node stays, so that regular parts do.
const WORTH: f64 = 1e-6;

/// Moves nodes towards the mean of their neighbours, in passes, each where this improves the least scaled Jacobian of
/// its elements. Nodes of the outline, whose edges belong to one element, stay.
pub(crate) fn smooth<const N: usize>(nodes: &mut [Point3<f64>], elements: &[[u32; N]]) {
    let around = Around::new(nodes.len(), elements);
    for _ in 0..PASSES {
        // All nodes move at once, so that mirror images do alike.
        let moved: Vec<Option<Point3<f64>>> =
            (0..nodes.len()).map(|node| around.better(node, nodes, elements)).collect();
        let before = nodes.to_vec();
        for (node, to) in nodes.iter_mut().zip(&moved) {
            *node = to.unwrap_or(*node);
        }
        // Neighbours that moved together may have made it worse.
        let worse: Vec<usize> = (0..nodes.len())
            .filter(|node| moved[*node].is_some())
            .filter(|node| around.least(*node, None, nodes, elements) < around.least(*node, None, &before, elements))
            .collect();
        worse.into_iter().for_each(|node| nodes[node] = before[node]);
    }
}

/// Elements and neighbours of each node; none of those that stay.
struct Around {
    elements: Vec<Vec<u32>>,
    neighbours: Vec<Vec<u32>>,
}

impl Around {
    fn new<const N: usize>(nodes: usize, elements: &[[u32; N]]) -> Around {
        let mut around = Around { elements: vec![vec![]; nodes], neighbours: vec![vec![]; nodes] };
        let mut edges = vec![];
        for (element, corners) in (0u32..).zip(elements) {
            corners.iter().for_each(|node| around.elements[*node as usize].push(element));
            edges.extend(directed(corners).map(undirected));
        }
        edges.sort_unstable();
        for uses in edges.chunk_by(|a, b| a == b) {
            let [a, b] = uses[0];
            around.neighbours[a as usize].push(b);
            around.neighbours[b as usize].push(a);
        }
        for uses in edges.chunk_by(|a, b| a == b).filter(|uses| uses.len() == 1) {
            uses[0].iter().for_each(|node| around.elements[*node as usize].clear());
        }
        around
    }

    /// Half-way to the mean of its neighbours, if the elements of the node are better with it there.
    fn better<const N: usize>(&self, node: usize, nodes: &[Point3<f64>], elements: &[[u32; N]]) -> Option<Point3<f64>> {
        if self.elements[node].is_empty() {
            return None;
        }
        let neighbours = &self.neighbours[node];
        let sum: nalgebra::Vector3<f64> = neighbours.iter().map(|other| nodes[*other as usize].coords).sum();
        let to = nalgebra::center(&nodes[node], &Point3::from(sum / neighbours.len() as f64));
        let gain = self.least(node, Some(to), nodes, elements) - self.least(node, None, nodes, elements);
        (gain > WORTH).then_some(to)
    }

    /// Least scaled Jacobian of the elements of a node, with it at `place`.
    fn least<const N: usize>(
        &self,
        node: usize,
        place: Option<Point3<f64>>,
        nodes: &[Point3<f64>],
        elements: &[[u32; N]],
    ) -> f64 {
        let point = |corner: u32| match place {
            Some(place) if corner as usize == node => place,
            _ => nodes[corner as usize],
        };
        let of = |element: &u32| scaled_jacobian(&elements[*element as usize].map(point));
        self.elements[node].iter().map(of).fold(f64::INFINITY, f64::min)
    }
}
