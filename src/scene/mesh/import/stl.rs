//! STL, ASCII or binary, as stl_io reads it.

use std::io::BufReader;
use std::path::Path;

use nalgebra::Point3;

use super::Fault;
use crate::mesh::Mesh;
use base::file::{self, FileError};

/// The triangles of the file; corners at one position have one number.
pub(crate) fn read(path: &Path) -> Result<Mesh, Fault> {
    let mut file = BufReader::new(file::open(path)?);
    let stl = stl_io::read_stl(&mut file).map_err(FileError::Io)?;
    let point = |v: &stl_io::Vertex| Point3::from(v.0.map(f64::from));
    Ok(Mesh {
        nodes: stl.vertices.iter().map(point).collect(),
        tris: stl.faces.iter().map(|face| face.vertices.map(|node| node as u32)).collect(),
        ..Mesh::default()
    })
}
