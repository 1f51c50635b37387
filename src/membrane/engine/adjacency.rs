//! Which nodes, edges and elements of a mesh lie next to each other.

/// What lies around each node, in order, one node after the other in memory.
#[derive(Clone, Debug)]
pub(super) struct Around<T> {
    all: Vec<T>,
    /// Where those of each node begin, and where the last ones end.
    first: Vec<u32>,
}

impl<T: Ord> Around<T> {
    /// Of `count` nodes, from pairs of a node and what lies around it.
    pub(super) fn new(count: usize, mut pairs: Vec<(u32, T)>) -> Around<T> {
        pairs.sort_unstable();
        let first = (0..=count).map(|node| pairs.partition_point(|(n, _)| (*n as usize) < node) as u32).collect();
        Around { all: pairs.into_iter().map(|(_, other)| other).collect(), first }
    }

    /// Number of nodes.
    pub(super) fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// What lies around a node.
    #[inline(always)]
    pub(super) fn at(&self, node: u32) -> &[T] {
        let node = node as usize;
        &self.all[self.first[node] as usize..self.first[node + 1] as usize]
    }
}

/// A side of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The smaller number first.
    pub(super) ends: [u32; 2],
    pub(super) triangle: u32,
    /// Corner of the triangle that lies opposite to it: 0 to 2.
    pub(super) corner: usize,
}

/// Sides of all triangles in order, so that those of one edge follow each other.
pub(super) fn sorted_sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides = vec![];
    for (triangle, corners) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let (a, b) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
            sides.push(Side { ends: [a.min(b), a.max(b)], triangle: triangle as u32, corner });
        }
    }
    sides.sort_unstable();
    sides
}
