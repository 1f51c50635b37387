//! Meshes as files that [`super::import`] reads.

use std::fmt::Write;

use super::Mesh;

/// VTK's XML of an unstructured grid, with ASCII arrays: nodes (m) and the elements of four, then of three nodes.
pub fn vtu(mesh: &Mesh) -> String {
    let quads = mesh.quads.iter().map(|quad| quad.as_slice());
    let cells: Vec<&[u32]> = quads.chain(mesh.tris.iter().map(|tri| tri.as_slice())).collect();
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
         <UnstructuredGrid>\n",
    );
    // What is written to a string cannot fail.
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", mesh.nodes.len(), cells.len());
    text += "<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
    for node in &mesh.nodes {
        let _ = writeln!(text, "{} {} {}", node.x, node.y, node.z);
    }
    text += "</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n";
    for cell in &cells {
        let corners: Vec<String> = cell.iter().map(u32::to_string).collect();
        let _ = writeln!(text, "{}", corners.join(" "));
    }
    text += "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
    let mut end = 0;
    for cell in &cells {
        end += cell.len();
        let _ = writeln!(text, "{end}");
    }
    text += "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n";
    for cell in &cells {
        text += if cell.len() == 4 { "9\n" } else { "5\n" };
    }
    text + "</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
}

#[cfg(test)]
mod tests {
    use std::fs;

    use nalgebra::Point3;

    use super::*;
    use crate::mesh::{Element, import};

    #[test]
    fn what_is_written_is_imported() {
        let point = |x: f64, y: f64| Point3::new(x, y, 0.25);
        let nodes = vec![point(0.0, 0.0), point(0.1, 0.0), point(0.1, 1.0 / 3.0), point(0.0, 0.3), point(0.2, 0.1)];
        let mesh = Mesh { nodes, quads: vec![[0, 1, 2, 3]], tris: vec![[1, 4, 2]], ..Mesh::default() };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.vtu");
        fs::write(&path, vtu(&mesh)).unwrap();
        let read = import::film(&path, 1.0, [false; 2], Element::Quad4).unwrap();
        assert_eq!((read.nodes, read.quads, read.tris), (mesh.nodes, mesh.quads, mesh.tris));
    }
}
