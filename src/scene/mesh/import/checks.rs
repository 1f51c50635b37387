//! Checks of meshes from files.

use std::collections::HashSet;

use nalgebra::{Point3, Vector3};

use super::Fault;
use crate::mesh::topology::{self, directed, outlines, undirected};
use crate::mesh::{Mesh, quality};

/// Area over the square of the longest edge below which an element is degenerate.
const ZERO_AREA: f64 = 1e-9;
/// z component of the unit normal below which an element is vertical.
const VERTICAL: f64 = 1e-6;
/// Distance over the mesh's extent below which a node is on a mirror plane.
const ON_PLANE: f64 = 1e-6;

/// There are elements, their corners are nodes of the mesh, and coordinates are finite.
pub(crate) fn elements(mesh: &Mesh) -> Result<(), Fault> {
    if mesh.quads.is_empty() && mesh.tris.is_empty() {
        return Err(Fault::NoElements);
    }
    let nodes = mesh.nodes.len();
    for (element, corners) in outlines(mesh).enumerate() {
        if let Some(&node) = corners.iter().find(|node| **node as usize >= nodes) {
            return Err(Fault::NodeOutOfRange { element, node, nodes });
        }
    }
    let finite = |point: &Point3<f64>| point.iter().all(|c| c.is_finite());
    match mesh.nodes.iter().position(|point| !finite(point)) {
        Some(node) => Err(Fault::NotFinite { node }),
        None => Ok(()),
    }
}

/// No element is degenerate.
pub(crate) fn shapes(mesh: &Mesh) -> Result<(), Fault> {
    let flat = |corners: &[u32]| {
        let points = points(mesh, corners);
        let [_, longest] = quality::edge_range(&points);
        // A longest edge of zero counts as well.
        let covers = quality::area_vector(&points).norm() > ZERO_AREA * longest * longest;
        !covers
    };
    match outlines(mesh).position(flat) {
        Some(element) => Err(Fault::ZeroArea { element }),
        None => Ok(()),
    }
}

/// No quadrilateral has a corner of 180° or more.
pub(crate) fn convex(mesh: &Mesh) -> Result<(), Fault> {
    let concave = |corners: &[u32]| quality::scaled_jacobian(&points(mesh, corners)) <= 0.0;
    match outlines(mesh).position(concave) {
        Some(element) => Err(Fault::Concave { element }),
        None => Ok(()),
    }
}

/// At most two elements share an edge.
pub(crate) fn manifold(mesh: &Mesh) -> Result<(), Fault> {
    match topology::uses(mesh).find(|(_, uses)| *uses > 2) {
        Some((edge, elements)) => Err(Fault::NotManifold { elements, at: middle(mesh, edge) }),
        None => Ok(()),
    }
}

/// Every edge is shared by two triangles of the same orientation.
pub(crate) fn closed(mesh: &Mesh) -> Result<(), Fault> {
    let mut seen = HashSet::new();
    for edge in outlines(mesh).flat_map(directed) {
        if !seen.insert(edge) {
            let at = middle(mesh, edge);
            return Err(Fault::Opposed { at });
        }
    }
    let alone = |[from, to]: &[u32; 2]| !seen.contains(&[*to, *from]);
    match outlines(mesh).flat_map(directed).find(alone) {
        Some(edge) => Err(Fault::Open { at: middle(mesh, edge) }),
        None => Ok(()),
    }
}

/// Reverses all triangles of a closed surface whose volume is negative.
pub(crate) fn face_out(mesh: &mut Mesh) {
    let volume = |tri: &[u32; 3]| {
        let [a, b, c] = tri.map(|node| mesh.nodes[node as usize].coords);
        a.dot(&b.cross(&c))
    };
    if mesh.tris.iter().map(volume).sum::<f64>() < 0.0 {
        mesh.tris.iter_mut().for_each(|tri| tri.swap(1, 2));
    }
}

/// Orients every element counter-clockwise seen from +z; a folded film is refused.
pub(crate) fn face_up(mesh: &mut Mesh) -> Result<(), Fault> {
    let upward = |corners: &[u32]| area(mesh, corners).normalize().z;
    let vertical = |corners: &[u32]| upward(corners).abs() < VERTICAL;
    if let Some(element) = outlines(mesh).position(vertical) {
        return Err(Fault::Vertical { element });
    }
    let down: Vec<bool> = outlines(mesh).map(|corners| upward(corners) < 0.0).collect();
    let (quads, tris) = down.split_at(mesh.quads.len());
    for (quad, _) in mesh.quads.iter_mut().zip(quads).filter(|(_, down)| **down) {
        quad.swap(1, 3);
    }
    for (tri, _) in mesh.tris.iter_mut().zip(tris).filter(|(_, down)| **down) {
        tri.swap(1, 2);
    }
    let mut seen = HashSet::new();
    match outlines(mesh).flat_map(directed).find(|edge| !seen.insert(*edge)) {
        Some(edge) => Err(Fault::Folded { at: middle(mesh, edge) }),
        None => Ok(()),
    }
}

/// Moves nodes next to a mirror plane onto it; none may lie beyond, and an edge must lie on it.
pub(crate) fn snap_to_mirrors(mesh: &mut Mesh, mirrored: [bool; 2]) -> Result<(), Fault> {
    let near = ON_PLANE * topology::extent(mesh);
    for axis in (0..2).filter(|axis| mirrored[*axis]) {
        let name = ['x', 'y'][axis];
        if let Some(point) = mesh.nodes.iter().find(|point| point[axis] < -near) {
            return Err(Fault::BeyondMirror { axis: name, at: (*point).into() });
        }
        for point in mesh.nodes.iter_mut().filter(|p| p[axis] <= near) {
            point[axis] = 0.0;
        }
        let on_plane = |edge: [u32; 2]| edge.iter().all(|n| mesh.nodes[*n as usize][axis] == 0.0);
        if !topology::uses(mesh).any(|(edge, _)| on_plane(edge)) {
            return Err(Fault::NotOnMirror { axis: name });
        }
    }
    Ok(())
}

fn points(mesh: &Mesh, corners: &[u32]) -> Vec<Point3<f64>> {
    let point = |node: &u32| mesh.nodes[*node as usize];
    corners.iter().map(point).collect()
}

fn area(mesh: &Mesh, corners: &[u32]) -> Vector3<f64> {
    quality::area_vector(&points(mesh, corners))
}

fn middle(mesh: &Mesh, edge: [u32; 2]) -> [f64; 3] {
    let [a, b] = undirected(edge).map(|node| mesh.nodes[node as usize]);
    nalgebra::center(&a, &b).into()
}
