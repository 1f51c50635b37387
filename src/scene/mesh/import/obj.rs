//! OBJ as tobj reads it: faces of all its objects and groups; materials are not opened.

use std::path::Path;

use nalgebra::Point3;

use crate::mesh::{Mesh, MeshError, fault};
use base::file;

/// Longest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;

/// The triangles and quadrilaterals of the file; objects do not share nodes yet.
pub(crate) fn read(path: &Path) -> Result<Mesh, MeshError> {
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..tobj::LoadOptions::default() };
    let text = file::read(path, MOST_BYTES)?;
    let used: Vec<&[u8]> = text.split_inclusive(|byte| *byte == b'\n').filter(|line| is_used(line)).collect();
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut used.concat().as_slice(), &options, no_materials)?;
    let mut mesh = Mesh::default();
    for model in &models {
        append(&mut mesh, &model.mesh)?;
    }
    Ok(mesh)
}

/// Whether a line is of a mesh: normals and texture coordinates are not, and tobj does not check the numbers by which faces name
/// them.
fn is_used(line: &[u8]) -> bool {
    let word = str::from_utf8(line).ok().and_then(|line| line.split_whitespace().next());
    !matches!(word, Some("vn" | "vt"))
}

fn append(mesh: &mut Mesh, part: &tobj::Mesh) -> Result<(), MeshError> {
    let first = mesh.nodes.len() as u32;
    let point = |p: &[f64]| Point3::new(p[0], p[1], p[2]);
    mesh.nodes.extend(part.positions.chunks_exact(3).map(point));
    let nodes: Vec<u32> = part.indices.iter().map(|node| first + node).collect();
    // tobj leaves the list of corner counts empty where all faces are triangles.
    let corners = match part.face_arities.is_empty() {
        true => vec![3; nodes.len() / 3],
        false => part.face_arities.clone(),
    };
    let mut rest = nodes.as_slice();
    for corners in corners {
        let (face, after) = rest.split_at(corners as usize);
        match *face {
            [a, b, c] => mesh.tris.push([a, b, c]),
            [a, b, c, d] => mesh.quads.push([a, b, c, d]),
            _ => {
                return Err(fault!("expected triangles and quadrilaterals, found a face with {} corners", face.len()));
            }
        }
        rest = after;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn faces_may_name_normals_that_are_missing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.obj");
        let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n \u{a0}vt 0 0\n";
        for corner in ["1//-5", "1/-5/1", "1//6148914691236517206", "1/9223372036854775807/1"] {
            fs::write(&path, format!("{points}f {corner} 2//1 3//1\n")).unwrap();
            assert_eq!(read(&path).unwrap().tris.len(), 1, "{corner}");
        }
        fs::write(&path, format!("{points}f -5 2 3\n")).unwrap();
        assert!(read(&path).is_err());
    }
}
