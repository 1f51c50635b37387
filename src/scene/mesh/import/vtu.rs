//! VTU: VTK's XML files of unstructured grids, with ASCII or inline base64 arrays.

use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use nalgebra::Point3;
use roxmltree::{Document, Node};

use crate::mesh::{Mesh, MeshError, fault};
use base::file;
use lab::signal::catalogue::Binary;

/// Longest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;
/// An array that every snapshot of droptower's film has.
const SNAPSHOT_ARRAY: &str = "reference_thickness_m";
/// VTK's numbers of the cell types that a film is made of.
const TRIANGLE: f64 = 5.0;
const QUAD: f64 = 9.0;

/// The triangles and quadrilaterals of all pieces of the file.
pub(crate) fn read(path: &Path) -> Result<Mesh, MeshError> {
    let text = file::read_text(path, MOST_BYTES)?;
    parse(&text)
}

fn parse(text: &str) -> Result<Mesh, MeshError> {
    let document = Document::parse(text)?;
    let file = document.root_element();
    if file.has_attribute("compressor") {
        let is_own = |node: Node| node.attribute("Name") == Some(SNAPSHOT_ARRAY);
        return Err(if document.descendants().any(is_own) {
            fault!(
                "this is a snapshot of a run, with compressed arrays and mirror images that do not share nodes; give the mesh \
                 of that run, or in ParaView apply Clean to Grid, which joins the nodes, and save it as VTU with data mode \
                 ASCII"
            )
        } else {
            fault!("the arrays are compressed; open the file in ParaView and save it as VTU with data mode ASCII")
        });
    }
    let layout = Layout {
        big_endian: file.attribute("byte_order") == Some("BigEndian"),
        header: match file.attribute("header_type") {
            Some("UInt64") => 8,
            _ => 4,
        },
    };
    let grid = child(file, "UnstructuredGrid")?;
    let mut mesh = Mesh::default();
    for piece in grid.children().filter(|node| node.has_tag_name("Piece")) {
        append(&mut mesh, piece, layout)?;
    }
    Ok(mesh)
}

fn append(mesh: &mut Mesh, piece: Node, layout: Layout) -> Result<(), MeshError> {
    let first = mesh.nodes.len();
    let points = layout.numbers(child(child(piece, "Points")?, "DataArray")?)?;
    let point = |p: &[f64]| Point3::new(p[0], p[1], p[2]);
    mesh.nodes.extend(points.chunks_exact(3).map(point));

    let cells = child(piece, "Cells")?;
    let connectivity = layout.numbers(child(cells, "connectivity")?)?;
    let offsets = layout.numbers(child(cells, "offsets")?)?;
    let kinds = layout.numbers(child(cells, "types")?)?;
    let nodes = connectivity.into_iter().map(|value| node_number(value, first)).collect::<Result<Vec<u32>, _>>()?;
    let corners_of = |cell: usize| fault!("the corners of cell {cell} do not match its type or the connectivity");
    let mut start = 0;
    for (cell, (end, kind)) in offsets.into_iter().zip(kinds).enumerate() {
        let end = end as usize;
        let corners = nodes.get(start..end).ok_or_else(|| corners_of(cell))?;
        match (kind, corners) {
            (TRIANGLE, &[a, b, c]) => mesh.tris.push([a, b, c]),
            (QUAD, &[a, b, c, d]) => mesh.quads.push([a, b, c, d]),
            (TRIANGLE | QUAD, _) => return Err(corners_of(cell)),
            _ => {
                return Err(fault!(
                    "expected triangles (5) and quadrilaterals (9), found VTK type {kind} in cell {cell}"
                ));
            }
        }
        start = end;
    }
    Ok(())
}

/// Number in the whole mesh of a node that its piece calls `value`.
fn node_number(value: f64, first: usize) -> Result<u32, MeshError> {
    let number = value + first as f64;
    if value >= 0.0 && value.fract() == 0.0 && number < f64::from(u32::MAX) {
        Ok(number as u32)
    } else {
        Err(fault!("expected a node number, found {value}"))
    }
}

/// The child that is an element of this name, or an array called so.
fn child<'a, 'b>(parent: Node<'a, 'b>, name: &'static str) -> Result<Node<'a, 'b>, MeshError> {
    let mut children = parent.children();
    let found = children.find(|node| node.has_tag_name(name) || node.attribute("Name") == Some(name));
    found.ok_or_else(|| fault!("`{name}` is missing"))
}

/// How binary arrays of the file are laid out.
#[derive(Clone, Copy)]
struct Layout {
    big_endian: bool,
    /// Bytes of the length that stands before each array.
    header: usize,
}

impl Layout {
    /// Values of a `DataArray`; whole numbers stay exact up to 2^53.
    fn numbers(self, array: Node) -> Result<Vec<f64>, MeshError> {
        let text = array.text().unwrap_or_default();
        match array.attribute("format") {
            Some("ascii") | None => ascii(text),
            Some("binary") => self.binary(text, array.attribute("type").unwrap_or_default()),
            Some(format) => {
                Err(fault!("array format `{format}` is not supported; save the file as ASCII or as inline binary"))
            }
        }
    }

    fn binary(self, text: &str, kind: &str) -> Result<Vec<f64>, MeshError> {
        let (meant, width) = number_format(kind).ok_or_else(|| fault!("array type `{kind}` is not supported"))?;
        let bytes = BASE64_STANDARD.decode(text.trim())?;
        let values = bytes.get(self.header..).unwrap_or_default().chunks_exact(width);
        let is_whole = values.remainder().is_empty();
        let numbers = is_whole.then(|| values.map(|value| meant.number(value, self.big_endian)).collect()).flatten();
        numbers.ok_or_else(|| fault!("an array of `{kind}` ends within a number"))
    }
}

fn ascii(text: &str) -> Result<Vec<f64>, MeshError> {
    let number = |word: &str| word.parse().map_err(|_| fault!("expected a number, found `{word}`"));
    text.split_ascii_whitespace().map(number).collect()
}

/// How the numbers of the VTK type `kind` are meant, and their bytes, from the bits in its name.
fn number_format(kind: &str) -> Option<(Binary, usize)> {
    let (name, bits) = kind.split_at(kind.find(|c: char| c.is_ascii_digit())?);
    let place = ["8", "16", "32", "64"].iter().position(|known| *known == bits)?;
    match name {
        "Float" if place > 1 => Some((Binary::Float, 1 << place)),
        "UInt" => Some((Binary::Unsigned, 1 << place)),
        "Int" => Some((Binary::Signed, 1 << place)),
        _ => None,
    }
}
