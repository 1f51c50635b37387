//! Meshes from files: STL, OBJ, VTU and MSH (Gmsh), triangles and quadrilaterals, coordinates in m. Outlines from DXF
//! and SVG.

mod checks;
mod drawing;
mod dxf;
mod fault;
mod msh;
mod obj;
mod outline;
mod svg;
mod vtu;

use std::collections::{HashMap, VecDeque};
use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use nalgebra::Point3;

use super::grid::split;
use super::{Element, Mesh, MeshError, topology};
use base::file::{self, FileError};

pub use drawing::DrawingFault;
pub use fault::{Fault, MshFault, VtuFault};
pub use outline::polygon;

/// Reads a film, `scale` (m) the length of one unit of the file's coordinates: every element is oriented
/// counter-clockwise seen from +z, nodes within a millionth of the extent from a mirror plane are moved onto it, and
/// nodes without an element are left out.
///
/// With symmetry the file contains the computed half or quarter only. For elements of three nodes, quadrilaterals are
/// split along their shorter diagonal; triangles of a file stay triangles.
///
/// # Errors
/// [`MeshError::File`].
pub fn film(path: &Path, scale: f64, mirrored: [bool; 2], element: Element) -> Result<Mesh, MeshError> {
    let read = || -> Result<Mesh, Fault> {
        let mut mesh = Mesh::clone(&*checked(path)?);
        mesh.nodes.iter_mut().for_each(|node| *node *= scale);
        checks::snap_to_mirrors(&mut mesh, mirrored)?;
        checks::face_up(&mut mesh)?;
        checks::convex(&mesh)?;
        if element == Element::Tri3 {
            split_quads(&mut mesh);
        }
        topology::label(&mut mesh, mirrored);
        Ok(mesh)
    };
    read().map_err(|fault| in_file(path, fault))
}

/// Points (m) and triangles of a closed surface.
pub type Surface = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// Reads the closed surface of an impactor; triangles are oriented outwards.
///
/// # Errors
/// [`MeshError::File`].
pub fn surface(path: &Path) -> Result<Surface, MeshError> {
    let read = || -> Result<Surface, Fault> {
        let mut mesh = Mesh::clone(&*checked(path)?);
        split_quads(&mut mesh);
        checks::closed(&mesh)?;
        checks::face_out(&mut mesh);
        Ok((mesh.nodes, mesh.tris))
    };
    read().map_err(|fault| in_file(path, fault))
}

/// Largest extent of the nodes along x, y or z, m.
///
/// # Errors
/// [`MeshError::File`].
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

fn in_file(path: &Path, fault: Fault) -> MeshError {
    let path = path.to_owned();
    MeshError::File { path, fault }
}

/// The mesh of a file, its elements and edges checked; of a file that did not change since it was read last, that mesh.
fn checked(path: &Path) -> Result<Arc<Mesh>, Fault> {
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

fn read(path: &Path) -> Result<Mesh, Fault> {
    let raw = match extension(path).as_str() {
        "stl" => merge_equal(read_stl(path)?),
        "obj" => merge_equal(obj::read(path)?),
        "vtu" => vtu::read(path)?,
        "msh" => msh::read(path)?,
        _ => return Err(Fault::Format),
    };
    checks::elements(&raw)?;
    let mesh = without_unused_nodes(raw);
    checks::shapes(&mesh)?;
    checks::manifold(&mesh)?;
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
    for node in topology::outlines(&mesh).flatten() {
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
fn read_stl(path: &Path) -> Result<Mesh, Fault> {
    let mut file = BufReader::new(file::open(path)?);
    let stl = stl_io::read_stl(&mut file).map_err(FileError::Io)?;
    let point = |v: &stl_io::Vertex| Point3::from(v.0.map(f64::from));
    Ok(Mesh {
        nodes: stl.vertices.iter().map(point).collect(),
        tris: stl.faces.iter().map(|face| face.vertices.map(|node| node as u32)).collect(),
        ..Mesh::default()
    })
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
