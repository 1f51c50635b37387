//! Meshes from files: STL, OBJ, VTU and MSH (Gmsh), triangles and quadrilaterals, coordinates in m, and their checks. Outlines
//! from DXF and SVG.

mod drawing;
mod msh;
mod obj;
mod svg;
mod vtu;

use std::collections::{HashMap, HashSet, VecDeque};
use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use nalgebra::{Point3, Vector3};

use super::quadtree::split;
use super::{Element, Mesh, MeshError, directed, fault, outlines, undirected};
use crate::mesh;
use base::file::{self, FileError};
pub use drawing::polygon;

/// Reads a film, `scale` (m) the length of one unit of the file's coordinates: every element is oriented
/// counter-clockwise seen from +z, nodes within a millionth of the extent from a mirror plane are moved onto it, and
/// nodes without an element are left out.
///
/// With symmetry the file contains the computed half or quarter only. For elements of three nodes, quadrilaterals are
/// split along their shorter diagonal; triangles of a file stay triangles.
///
/// # Errors
/// The file is not such a mesh.
pub fn film(path: &Path, scale: f64, mirrored: [bool; 2], element: Element) -> Result<Mesh, MeshError> {
    let read = || -> Result<Mesh, MeshError> {
        let mut mesh = Mesh::clone(&*checked(path)?);
        mesh.nodes.iter_mut().for_each(|node| *node *= scale);
        snap_to_mirrors(&mut mesh, mirrored)?;
        face_up(&mut mesh)?;
        convex(&mesh)?;
        if element == Element::Tri3 {
            split_quads(&mut mesh);
        }
        mesh::label(&mut mesh, mirrored);
        Ok(mesh)
    };
    read().map_err(|fault| in_file(path, fault))
}

/// Points (m) and triangles of a closed surface.
pub type Surface = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// Reads the closed surface of an impactor; triangles are oriented outwards.
///
/// # Errors
/// The file is not such a mesh.
pub fn surface(path: &Path) -> Result<Surface, MeshError> {
    let read = || -> Result<Surface, MeshError> {
        let mut mesh = Mesh::clone(&*checked(path)?);
        split_quads(&mut mesh);
        closed(&mesh)?;
        face_out(&mut mesh);
        Ok((mesh.nodes, mesh.tris))
    };
    read().map_err(|fault| in_file(path, fault))
}

/// Largest extent of the nodes along x, y or z, m.
///
/// # Errors
/// The file is not such a mesh.
pub fn extent(path: &Path) -> Result<f64, MeshError> {
    let mesh = checked(path).map_err(|fault| in_file(path, fault))?;
    let along = |axis: usize| {
        let range = mesh
            .nodes
            .iter()
            .map(|node| node[axis])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        range[1] - range[0]
    };
    Ok((0..3).map(along).fold(0.0, f64::max))
}

/// An error in a file with its path.
fn in_file(path: &Path, error: MeshError) -> MeshError {
    MeshError::new(error.kind, format!("{}: {error}", path.display()))
}

/// The mesh of a file, its elements and edges checked; of a file that did not change since it was read last, that mesh.
fn checked(path: &Path) -> Result<Arc<Mesh>, MeshError> {
    let state = FileState::from_path(path);
    let is_same = |(known, _): &&(FileState, Arc<Mesh>)| Some(known) == state.as_ref();
    if let Some((_, mesh)) = stored().iter().find(is_same) {
        return Ok(Arc::clone(mesh));
    }
    let mesh = Arc::new(read(path)?);
    // A file that changed while it was read is read again the next time.
    if let Some(state) =
        state.filter(|before| before.length <= LONGEST_STORED && FileState::from_path(path).as_ref() == Some(before))
    {
        let mut stored = stored();
        if stored.len() >= MOST_STORED {
            stored.pop_front();
        }
        stored.push_back((state, Arc::clone(&mesh)));
    }
    Ok(mesh)
}

/// Length of the longest file whose mesh is stored after it was read, bytes.
const LONGEST_STORED: u64 = 64 << 20;

/// Most meshes that are stored.
const MOST_STORED: usize = 4;

/// The meshes that were read last: a check, a run and the trials of a search read the same files.
fn stored() -> MutexGuard<'static, VecDeque<(FileState, Arc<Mesh>)>> {
    static STORED: Mutex<VecDeque<(FileState, Arc<Mesh>)>> = Mutex::new(VecDeque::new());
    STORED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// By what a file is known again.
#[derive(Debug, PartialEq)]
struct FileState {
    path: PathBuf,
    length: u64,
    changed: SystemTime,
}

impl FileState {
    fn from_path(path: &Path) -> Option<FileState> {
        let found = fs::metadata(path).ok()?;
        Some(FileState { path: fs::canonicalize(path).ok()?, length: found.len(), changed: found.modified().ok()? })
    }
}

fn read(path: &Path) -> Result<Mesh, MeshError> {
    let raw = match extension(path).as_str() {
        "stl" => merge_equal(read_stl(path)?),
        "obj" => merge_equal(obj::read(path)?),
        "vtu" => vtu::read(path)?,
        "msh" => msh::read(path)?,
        _ => return Err(fault!("expected a file .stl, .obj, .vtu or .msh")),
    };
    elements(&raw)?;
    let mesh = without_unused_nodes(raw);
    shapes(&mesh)?;
    manifold(&mesh)?;
    Ok(mesh)
}

fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_ascii_lowercase()
}

/// Merges nodes at the same position.
fn merge_equal(mesh: Mesh) -> Mesh {
    let mut numbers = HashMap::new();
    let mut nodes = Vec::new();
    let mut merged = Vec::with_capacity(mesh.nodes.len());
    for point in &mesh.nodes {
        // Adding zero makes -0 equal to 0.
        let bits = point.coords.map(|c| (c + 0.0).to_bits());
        let number = *numbers.entry(<[u64; 3]>::from(bits)).or_insert_with(|| {
            nodes.push(*point);
            nodes.len() as u32 - 1
        });
        merged.push(number);
    }
    let new = |node: u32| merged.get(node as usize).copied().unwrap_or(u32::MAX);
    renumber(mesh, nodes, new)
}

/// Removes the nodes of no element: they would have no mass.
fn without_unused_nodes(mut mesh: Mesh) -> Mesh {
    let mut numbers = vec![u32::MAX; mesh.nodes.len()];
    for node in mesh::outlines(&mesh).flatten() {
        numbers[*node as usize] = 0;
    }
    let mut used = Vec::new();
    for (point, number) in std::mem::take(&mut mesh.nodes).into_iter().zip(&mut numbers) {
        if *number == 0 {
            *number = used.len() as u32;
            used.push(point);
        }
    }
    renumber(mesh, used, |node| numbers[node as usize])
}

fn renumber(mesh: Mesh, nodes: Vec<Point3<f64>>, new: impl Fn(u32) -> u32) -> Mesh {
    Mesh {
        nodes,
        quads: mesh.quads.into_iter().map(|q| q.map(&new)).collect(),
        tris: mesh.tris.into_iter().map(|t| t.map(&new)).collect(),
        ..Mesh::default()
    }
}

fn split_quads(mesh: &mut Mesh) {
    let distance = |a: u32, b: u32| (mesh.nodes[a as usize] - mesh.nodes[b as usize]).norm();
    let tris = mesh.quads.iter().flat_map(|&[a, b, c, d]| {
        if distance(a, c) <= distance(b, d) { split([a, b, c, d]) } else { split([b, c, d, a]) }
    });
    let tris: Vec<_> = tris.collect();
    mesh.tris.extend(tris);
    mesh.quads.clear();
}

/// The triangles of the file; corners at one position have one number.
fn read_stl(path: &Path) -> Result<Mesh, MeshError> {
    let mut file = BufReader::new(file::open(path)?);
    let stl = stl_io::read_stl(&mut file).map_err(FileError::Io)?;
    let point = |v: &stl_io::Vertex| Point3::from(v.0.map(f64::from));
    Ok(Mesh {
        nodes: stl.vertices.iter().map(point).collect(),
        tris: stl.faces.iter().map(|face| face.vertices.map(|node| node as u32)).collect(),
        ..Mesh::default()
    })
}

/// Area over the square of the longest edge below which an element is degenerate.
const ZERO_AREA: f64 = 1e-9;
/// z component of the unit normal below which an element is vertical.
const VERTICAL: f64 = 1e-6;
/// Distance over the mesh's extent below which a node is on a mirror plane.
const ON_PLANE: f64 = 1e-6;

/// The error of what is found in a mesh.
fn refuse<T>(found: Option<T>, error: impl FnOnce(T) -> MeshError) -> Result<(), MeshError> {
    found.map_or(Ok(()), |found| Err(error(found)))
}

/// There are elements, their corners are nodes of the mesh, and coordinates are finite.
pub(crate) fn elements(mesh: &Mesh) -> Result<(), MeshError> {
    if mesh.quads.is_empty() && mesh.tris.is_empty() {
        return Err(fault!("the file has no triangles or quadrilaterals"));
    }
    let nodes = mesh.nodes.len();
    for (element, corners) in outlines(mesh).enumerate() {
        if let Some(&node) = corners.iter().find(|node| **node as usize >= nodes) {
            return Err(fault!("element {element} refers to node {node} of {nodes}"));
        }
    }
    let finite = |point: &Point3<f64>| point.iter().all(|c| c.is_finite());
    refuse(mesh.nodes.iter().position(|point| !finite(point)), |node| {
        fault!("a coordinate of node {node} is not finite")
    })
}

/// No element is degenerate.
pub(crate) fn shapes(mesh: &Mesh) -> Result<(), MeshError> {
    let flat = |corners: &[u32]| {
        let points = points(mesh, corners);
        let [_, longest] = mesh::edge_range(&points);
        // A longest edge of zero counts as well.
        let covers = mesh::area_vector(&points).norm() > ZERO_AREA * longest * longest;
        !covers
    };
    refuse(outlines(mesh).position(flat), |element| fault!("element {element} has zero area"))
}

/// No quadrilateral has a corner of 180° or more.
pub(crate) fn convex(mesh: &Mesh) -> Result<(), MeshError> {
    let concave = |corners: &[u32]| mesh::scaled_jacobian(&points(mesh, corners)) <= 0.0;
    refuse(outlines(mesh).position(concave), |element| fault!("element {element} is concave or twisted"))
}

/// At most two elements share an edge.
fn manifold(mesh: &Mesh) -> Result<(), MeshError> {
    refuse(mesh::uses(mesh).find(|(_, uses)| *uses > 2), |(edge, elements)| {
        fault!("{elements} elements share the edge at {:?}; expected at most two", middle(mesh, edge))
    })
}

/// Every edge is shared by two triangles of the same orientation.
pub(crate) fn closed(mesh: &Mesh) -> Result<(), MeshError> {
    let mut seen = HashSet::new();
    for edge in outlines(mesh).flat_map(directed) {
        if !seen.insert(edge) {
            return Err(fault!("the triangles at the edge {:?} have opposite orientations", middle(mesh, edge)));
        }
    }
    let alone = |[from, to]: &[u32; 2]| !seen.contains(&[*to, *from]);
    refuse(outlines(mesh).flat_map(directed).find(alone), |edge| {
        fault!("the surface is open at {:?}; an impactor has a closed one", middle(mesh, edge))
    })
}

/// Reverses all triangles of a closed surface whose volume is negative.
fn face_out(mesh: &mut Mesh) {
    let volume = |tri: &[u32; 3]| {
        let [a, b, c] = tri.map(|node| mesh.nodes[node as usize].coords);
        a.dot(&b.cross(&c))
    };
    if mesh.tris.iter().map(volume).sum::<f64>() < 0.0 {
        mesh.tris.iter_mut().for_each(|tri| tri.swap(1, 2));
    }
}

/// Orients every element counter-clockwise seen from +z; a folded film is refused.
fn face_up(mesh: &mut Mesh) -> Result<(), MeshError> {
    let upward = |corners: &[u32]| area(mesh, corners).normalize().z;
    let vertical = |corners: &[u32]| upward(corners).abs() < VERTICAL;
    if let Some(element) = outlines(mesh).position(vertical) {
        return Err(fault!("element {element} is vertical; a film is a single-valued surface over the plane z = 0"));
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
    refuse(outlines(mesh).flat_map(directed).find(|edge| !seen.insert(*edge)), |edge| {
        let at = middle(mesh, edge);
        fault!("the film is folded at {at:?}; a film is a single-valued surface over the plane z = 0")
    })
}

/// Moves nodes next to a mirror plane onto it; none may lie beyond, and an edge must lie on it.
fn snap_to_mirrors(mesh: &mut Mesh, mirrored: [bool; 2]) -> Result<(), MeshError> {
    let near = ON_PLANE * mesh::extent(mesh);
    for axis in (0..2).filter(|axis| mirrored[*axis]) {
        let name = ['x', 'y'][axis];
        if let Some(point) = mesh.nodes.iter().find(|point| point[axis] < -near) {
            let at: [f64; 3] = (*point).into();
            return Err(fault!(
                "a node at {at:?} lies beyond the mirror plane {name} = 0; with symmetry the mesh is the part at {name} >= 0"
            ));
        }
        for point in mesh.nodes.iter_mut().filter(|p| p[axis] <= near) {
            point[axis] = 0.0;
        }
        let on_plane = |edge: [u32; 2]| edge.iter().all(|n| mesh.nodes[*n as usize][axis] == 0.0);
        if !mesh::uses(mesh).any(|(edge, _)| on_plane(edge)) {
            return Err(fault!("no edge lies on the mirror plane {name} = 0"));
        }
    }
    Ok(())
}

fn points(mesh: &Mesh, corners: &[u32]) -> Vec<Point3<f64>> {
    let point = |node: &u32| mesh.nodes[*node as usize];
    corners.iter().map(point).collect()
}

fn area(mesh: &Mesh, corners: &[u32]) -> Vector3<f64> {
    mesh::area_vector(&points(mesh, corners))
}

fn middle(mesh: &Mesh, edge: [u32; 2]) -> [f64; 3] {
    let [a, b] = undirected(edge).map(|node| mesh.nodes[node as usize]);
    nalgebra::center(&a, &b).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_read_once_until_its_file_changes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.obj");
        let write = |side: f64| {
            let text = format!("v 0 0 0\nv {side} 0 0\nv {side} 1 0\nv 0 1 0\nf 1 2 3 4\n");
            fs::write(&path, text).unwrap();
        };
        write(2.0);
        let first = checked(&path).unwrap();
        assert!((extent(&path).unwrap() - 2.0).abs() < 1e-12);
        assert!(Arc::ptr_eq(&first, &checked(&path).unwrap()), "the check of the extent and the run read it once");
        write(30.5);
        assert!((extent(&path).unwrap() - 30.5).abs() < 1e-12);
    }
}
