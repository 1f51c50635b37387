//! Quadrilateral cells of a whole outline, before symmetry and triangles.

use nalgebra::Point3;

use super::topology;
use super::{Element, Mesh, MeshError};

/// Node numbers are `u32`, and there is about one node per cell.
pub(crate) const LIMIT: usize = u32::MAX as usize / 4;

/// Cells of a whole outline, in any sense of rotation.
#[derive(Debug, Default)]
pub(crate) struct Grid {
    /// m.
    pub nodes: Vec<Point3<f64>>,
    /// Corners of each cell; a split into triangles follows the diagonal from the first to the third.
    pub cells: Vec<[u32; 4]>,
}

impl Grid {
    /// The mesh of the part on this side of the mirror planes, of one kind of element.
    pub(crate) fn mesh(self, mirrored: [bool; 2], element: Element) -> Mesh {
        let grid = self.cut(mirrored).counter_clockwise();
        let mut mesh = Mesh { nodes: grid.nodes, ..Mesh::default() };
        match element {
            Element::Quad4 | Element::Quad4Full => mesh.quads = grid.cells,
            Element::Tri3 => mesh.tris = grid.cells.into_iter().flat_map(split).collect(),
        }
        topology::label(&mut mesh, mirrored);
        mesh
    }

    /// The cells at x >= 0 and/or y >= 0; the mirror planes are lines of nodes.
    pub(crate) fn cut(self, mirrored: [bool; 2]) -> Grid {
        let inside = |p: &Point3<f64>| (0..2).all(|axis| !mirrored[axis] || p[axis] >= 0.0);
        let mut renumbered = vec![u32::MAX; self.nodes.len()];
        let mut nodes = Vec::new();
        for (old, point) in self.nodes.iter().enumerate().filter(|(_, p)| inside(p)) {
            renumbered[old] = nodes.len() as u32;
            nodes.push(*point);
        }
        let cells = self
            .cells
            .into_iter()
            .map(|cell| cell.map(|node| renumbered[node as usize]))
            .filter(|cell| !cell.contains(&u32::MAX))
            .collect();
        Grid { nodes, cells }
    }

    /// The nodes numbered as the cells name them first; nodes of no cell are left out.
    pub(crate) fn in_order_of_use(self) -> Grid {
        let mut numbers = vec![u32::MAX; self.nodes.len()];
        let mut nodes = Vec::with_capacity(self.nodes.len());
        let mut number = |node: u32| {
            let number = &mut numbers[node as usize];
            if *number == u32::MAX {
                *number = nodes.len() as u32;
                nodes.push(self.nodes[node as usize]);
            }
            *number
        };
        let cells = self.cells.into_iter().map(|cell| cell.map(&mut number)).collect();
        Grid { nodes, cells }
    }

    /// The cells with their corners counter-clockwise.
    pub(crate) fn counter_clockwise(mut self) -> Grid {
        for cell in &mut self.cells {
            let [a, b, c, d] = cell.map(|node| self.nodes[node as usize]);
            if (c - a).xy().perp(&(d - b).xy()) < 0.0 {
                cell.swap(1, 3);
            }
        }
        self
    }
}

/// Refuses lengths and sizes that are not positive, and meshes whose nodes cannot be numbered.
pub(crate) fn check(lengths: [f64; 2], size: f64, elements: usize) -> Result<(), MeshError> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    if !positive(size) {
        return Err(MeshError::Size { size });
    }
    if !lengths.into_iter().all(positive) {
        let [x, y] = lengths;
        return Err(MeshError::Outline { x, y });
    }
    if elements > LIMIT {
        return Err(MeshError::TooMany { elements, limit: LIMIT });
    }
    Ok(())
}

/// The two triangles on either side of the diagonal from the first to the third corner.
pub(crate) fn split([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// The cell, with the other diagonal first where `odd`, so that the diagonals of neighbours alternate.
pub(crate) fn alternate([a, b, c, d]: [u32; 4], odd: bool) -> [u32; 4] {
    if odd { [b, c, d, a] } else { [a, b, c, d] }
}
