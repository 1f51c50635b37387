//! Edges of a mesh, its rim, sides and mirror planes.

use super::Mesh;

/// Distance over the mesh's extent below which a node is on a plane or an outermost edge.
const TOLERANCE: f64 = 1e-6;

/// An edge as its two nodes, the smaller number first.
pub(crate) type Edge = [u32; 2];

/// Fills in the rim, sides and mirror nodes of a mesh whose nodes and elements are given.
pub(crate) fn label(mesh: &mut Mesh, mirrored: [bool; 2]) {
    let near = TOLERANCE * extent(mesh);
    mesh.mirrors = [0, 1].map(|axis| match mirrored[axis] {
        true => nodes_where(mesh, |p| p[axis].abs() <= near),
        false => Vec::new(),
    });
    mesh.rim = rim(mesh);
    mesh.sides = [0, 1, 2, 3].map(|side| side_nodes(mesh, mirrored, side, near));
}

/// Corners of every element, quadrilaterals first.
pub(crate) fn outlines(mesh: &Mesh) -> impl Iterator<Item = &[u32]> {
    let quads = mesh.quads.iter().map(|quad| quad.as_slice());
    quads.chain(mesh.tris.iter().map(|tri| tri.as_slice()))
}

/// Directed edges of one element.
pub(crate) fn directed(corners: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(from, to)| [*from, *to])
}

/// Every edge of every element, with the element to its left: those between two elements once in each direction.
pub fn directed_edges(mesh: &Mesh) -> impl Iterator<Item = [u32; 2]> + '_ {
    outlines(mesh).flat_map(directed)
}

/// The edge without its direction.
pub(crate) fn undirected([from, to]: [u32; 2]) -> Edge {
    [from.min(to), from.max(to)]
}

/// Every edge once, ascending, with the number of elements that share it.
pub(crate) fn uses(mesh: &Mesh) -> impl Iterator<Item = (Edge, u32)> {
    // Sorted and not hashed: the order of nodes that follows from it is that of every run.
    let mut edges: Vec<Edge> = outlines(mesh).flat_map(directed).map(undirected).collect();
    edges.sort_unstable();
    let mut rest = 0;
    std::iter::from_fn(move || {
        let edge = *edges.get(rest)?;
        let uses = edges[rest..].iter().take_while(|other| **other == edge).count();
        rest += uses;
        Some((edge, uses as u32))
    })
}

/// Edges of the film's own outline, not on a mirror plane, ascending.
pub fn outer_edges(mesh: &Mesh) -> impl Iterator<Item = Edge> + '_ {
    // Edges on a mirror plane belong to one element too, but the film goes on behind it.
    let on = |plane: &[u32], node: &u32| plane.binary_search(node).is_ok();
    let mirror = move |edge: &Edge| {
        let holds = |plane: &Vec<u32>| edge.iter().all(|node| on(plane, node));
        mesh.mirrors.iter().any(holds)
    };
    uses(mesh).filter(move |(edge, uses)| *uses == 1 && !mirror(edge)).map(|(edge, _)| edge)
}

fn rim(mesh: &Mesh) -> Vec<u32> {
    let mut rim: Vec<u32> = outer_edges(mesh).flatten().collect();
    rim.sort_unstable();
    rim.dedup();
    rim
}

/// Outermost rim nodes towards `side`; none where a mirror plane replaces that side.
fn side_nodes(mesh: &Mesh, mirrored: [bool; 2], side: usize, near: f64) -> Vec<u32> {
    let (axis, sign) = (side / 2, if side.is_multiple_of(2) { -1.0 } else { 1.0 });
    if mirrored[axis] && sign < 0.0 {
        return Vec::new();
    }
    let coordinate = |node: &u32| sign * mesh.nodes[*node as usize][axis];
    let outermost = mesh.rim.iter().map(coordinate).fold(f64::MIN, f64::max);
    let is_outermost = |node: &&u32| coordinate(node) >= outermost - near;
    mesh.rim.iter().filter(is_outermost).copied().collect()
}

fn nodes_where(mesh: &Mesh, holds: impl Fn(&nalgebra::Point3<f64>) -> bool) -> Vec<u32> {
    let numbered = (0u32..).zip(&mesh.nodes);
    numbered.filter(|(_, point)| holds(point)).map(|(node, _)| node).collect()
}

/// Largest coordinate in magnitude, m.
pub(crate) fn extent(mesh: &Mesh) -> f64 {
    let largest = |p: &nalgebra::Point3<f64>| p.coords.amax();
    mesh.nodes.iter().map(largest).fold(0.0, f64::max)
}
