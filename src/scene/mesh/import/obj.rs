//! OBJ as tobj reads it: faces of all its objects and groups; materials are not opened.

use std::io::BufReader;
use std::path::Path;

use nalgebra::Point3;

use super::Fault;
use crate::mesh::Mesh;
use base::file;

/// The triangles and quadrilaterals of the file; objects do not share nodes yet.
pub(crate) fn read(path: &Path) -> Result<Mesh, Fault> {
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..tobj::LoadOptions::default() };
    let mut file = BufReader::new(file::open(path)?);
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut file, &options, no_materials)?;
    let mut mesh = Mesh::default();
    for model in &models {
        append(&mut mesh, &model.mesh)?;
    }
    Ok(mesh)
}

fn append(mesh: &mut Mesh, part: &tobj::Mesh) -> Result<(), Fault> {
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
                let corners = face.len();
                return Err(Fault::Corners { corners });
            }
        }
        rest = after;
    }
    Ok(())
}
