//! MSH: meshes of Gmsh, ASCII, versions 2.2 and 4.1.

use std::collections::HashMap;
use std::path::Path;

use nalgebra::Point3;

use crate::mesh::{Mesh, MeshError, fault};
use base::file;

/// Longest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;
/// Gmsh's numbers of the element types that a film is made of.
const TRIANGLE: u64 = 2;
const QUAD: u64 = 3;
/// Lines and points, which are edges and corners of a model, and the number of their nodes.
const LINES: [(u64, usize); 4] = [(1, 2), (8, 3), (15, 1), (26, 4)];

/// The triangles and quadrilaterals of the file.
pub(crate) fn read(path: &Path) -> Result<Mesh, MeshError> {
    let bytes = file::read(path, MOST_BYTES)?;
    // Names of groups may be in any encoding; what is read is ASCII.
    parse(&String::from_utf8_lossy(&bytes))
}

fn parse(text: &str) -> Result<Mesh, MeshError> {
    let mut words = section(text, "MeshFormat")?;
    let (version, binary) = (words.text()?, words.whole()?);
    if binary != 0 {
        return Err(fault!("the file is binary; export it as ASCII (in Gmsh: Mesh.Binary = 0)"));
    }
    let layout = match version {
        "2" | "2.1" | "2.2" => Layout::Listed,
        "4.1" => Layout::Blocks,
        _ => {
            return Err(fault!(
                "version {version} of the format is not supported; export 2.2 or 4.1 (in Gmsh: Mesh.MshFileVersion)"
            ));
        }
    };
    let mut mesh = Mesh::default();
    let numbers = nodes(&mut section(text, "Nodes")?, layout, &mut mesh)?;
    elements(&mut section(text, "Elements")?, layout, &numbers, &mut mesh)?;
    Ok(mesh)
}

/// How nodes and elements are written.
#[derive(Clone, Copy)]
enum Layout {
    /// One to a line, as in version 2.
    Listed,
    /// In blocks of one entity of the model, as in version 4.1.
    Blocks,
}

/// Reads the nodes; their indices by their tags.
fn nodes(words: &mut Words<'_>, layout: Layout, mesh: &mut Mesh) -> Result<HashMap<u64, u32>, MeshError> {
    let mut numbers = HashMap::new();
    let mut add = |tag: u64, point: Point3<f64>| {
        let next = mesh.nodes.len() as u32;
        mesh.nodes.push(point);
        match numbers.insert(tag, next) {
            None => Ok(()),
            Some(_) => Err(fault!("two nodes have the tag {tag}")),
        }
    };
    match layout {
        Layout::Listed => {
            for _ in 0..words.whole()? {
                let tag = words.whole()?;
                add(tag, words.point()?)?;
            }
        }
        Layout::Blocks => {
            let blocks = words.whole()?;
            words.skip(3)?;
            for _ in 0..blocks {
                let dimension = words.whole()?;
                words.skip(1)?;
                let (parametric, count) = (words.whole()?, words.whole()?);
                let tags = words.list(count)?;
                for tag in tags {
                    add(tag, words.point()?)?;
                    words.skip(if parametric == 0 { 0 } else { dimension })?;
                }
            }
        }
    }
    Ok(numbers)
}

fn elements(
    words: &mut Words<'_>,
    layout: Layout,
    numbers: &HashMap<u64, u32>,
    mesh: &mut Mesh,
) -> Result<(), MeshError> {
    match layout {
        Layout::Listed => {
            for _ in 0..words.whole()? {
                words.skip(1)?;
                let kind = words.whole()?;
                let tags = words.whole()?;
                words.skip(tags)?;
                element(words, kind, numbers, mesh)?;
            }
        }
        Layout::Blocks => {
            let blocks = words.whole()?;
            words.skip(3)?;
            for _ in 0..blocks {
                words.skip(2)?;
                let (kind, count) = (words.whole()?, words.whole()?);
                for _ in 0..count {
                    words.skip(1)?;
                    element(words, kind, numbers, mesh)?;
                }
            }
        }
    }
    Ok(())
}

/// Reads the nodes of one element.
fn element(words: &mut Words<'_>, kind: u64, numbers: &HashMap<u64, u32>, mesh: &mut Mesh) -> Result<(), MeshError> {
    let mut node = || {
        let tag = words.whole()?;
        numbers.get(&tag).copied().ok_or_else(|| fault!("an element refers to node {tag}, which is missing"))
    };
    if kind == TRIANGLE {
        mesh.tris.push([node()?, node()?, node()?]);
    } else if kind == QUAD {
        mesh.quads.push([node()?, node()?, node()?, node()?]);
    } else {
        let line = LINES.iter().find(|(line, _)| *line == kind);
        let (_, corners) = line.ok_or_else(|| {
            fault!("expected triangles (2) and quadrilaterals (3), found Gmsh type {kind}; mesh the surface alone, of order 1")
        })?;
        (0..*corners).try_for_each(|_| node().map(|_| ()))?;
    }
    Ok(())
}

/// The words between `$name` and `$Endname`.
fn section<'a>(text: &'a str, name: &'static str) -> Result<Words<'a>, MeshError> {
    let is = |line: &str, prefix: &str| line.trim().strip_prefix(prefix) == Some(name);
    let mut start = None;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        match start {
            None if is(line, "$") => start = Some(at + line.len()),
            Some(start) if is(line, "$End") => {
                return Ok(Words { words: text[start..at].split_ascii_whitespace(), name });
            }
            _ => {}
        }
        at += line.len();
    }
    Err(fault!("`${name}` is missing"))
}

struct Words<'a> {
    words: std::str::SplitAsciiWhitespace<'a>,
    /// Name of the section.
    name: &'static str,
}

impl<'a> Words<'a> {
    fn text(&mut self) -> Result<&'a str, MeshError> {
        self.words.next().ok_or_else(|| fault!("`${}` ends too early", self.name))
    }

    fn parsed<T: std::str::FromStr>(&mut self) -> Result<T, MeshError> {
        let text = self.text()?;
        let shown = || text.chars().take(40).collect::<String>();
        text.parse().map_err(|_| fault!("expected a number in `${}`, found `{}`", self.name, shown()))
    }

    fn whole(&mut self) -> Result<u64, MeshError> {
        self.parsed()
    }

    fn point(&mut self) -> Result<Point3<f64>, MeshError> {
        Ok(Point3::new(self.parsed()?, self.parsed()?, self.parsed()?))
    }

    fn list(&mut self, count: u64) -> Result<Vec<u64>, MeshError> {
        (0..count).map(|_| self.whole()).collect()
    }

    fn skip(&mut self, count: u64) -> Result<(), MeshError> {
        (0..count).try_for_each(|_| self.text().map(|_| ()))
    }
}
