//! Faults of mesh files.

use thiserror::Error;

use base::file::FileError;

/// Why a file is not a mesh of a film or of an impactor. Elements are counted from 0, quadrilaterals before triangles
/// where a file holds both; positions in m.
#[derive(Debug, Error)]
pub enum Fault {
    /// The extension is unknown.
    #[error("expected a file .stl, .obj, .vtu or .msh")]
    Format,
    /// The file is unreadable.
    #[error("{0}")]
    Read(#[from] FileError),
    /// The file is not OBJ.
    #[error("{0}")]
    Obj(#[from] tobj::LoadError),
    /// The file is not VTU.
    #[error("{0}")]
    Vtu(#[from] VtuFault),
    /// The file is not MSH.
    #[error("{0}")]
    Msh(#[from] MshFault),
    /// There is no element.
    #[error("the file has no triangles or quadrilaterals")]
    NoElements,
    /// A face is neither triangle nor quadrilateral.
    #[error("expected triangles and quadrilaterals, found a face with {corners} corners")]
    Corners {
        /// Number of its corners.
        corners: usize,
    },
    /// A corner is not a node.
    #[error("element {element} refers to node {node} of {nodes}")]
    NodeOutOfRange {
        /// Index of the element.
        element: usize,
        /// The node.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// A coordinate is not finite.
    #[error("a coordinate of node {node} is not finite")]
    NotFinite {
        /// The node.
        node: usize,
    },
    /// An element is degenerate.
    #[error("element {element} has zero area")]
    ZeroArea {
        /// Index of the element.
        element: usize,
    },
    /// A corner of a quadrilateral has 180° or more.
    #[error("element {element} is concave or twisted")]
    Concave {
        /// Index of the element.
        element: usize,
    },
    /// An element is parallel to z.
    #[error("element {element} is vertical; a film is a single-valued surface over the plane z = 0")]
    Vertical {
        /// Index of the element.
        element: usize,
    },
    /// Two elements have the same directed edge seen from +z.
    #[error("the film is folded at {at:?}; a film is a single-valued surface over the plane z = 0")]
    Folded {
        /// Middle of the edge, m.
        at: [f64; 3],
    },
    /// More than two elements share an edge.
    #[error("{elements} elements share the edge at {at:?}; expected at most two")]
    NotManifold {
        /// Number of the elements.
        elements: u32,
        /// Middle of the edge, m.
        at: [f64; 3],
    },
    /// An edge of an impactor's surface belongs to one triangle alone.
    #[error("the surface is open at {at:?}; an impactor has a closed one")]
    Open {
        /// Middle of the edge, m.
        at: [f64; 3],
    },
    /// Two triangles of an impactor's surface have the same directed edge.
    #[error("the triangles at the edge {at:?} have opposite orientations")]
    Opposed {
        /// Middle of the edge, m.
        at: [f64; 3],
    },
    /// A node of the part that symmetry leaves out.
    #[error(
        "a node at {at:?} lies beyond the mirror plane {axis} = 0; with symmetry the mesh is the part at {axis} >= 0"
    )]
    BeyondMirror {
        /// Normal of the mirror plane.
        axis: char,
        /// Position of the node, m.
        at: [f64; 3],
    },
    /// The mesh does not reach a mirror plane.
    #[error("no edge lies on the mirror plane {axis} = 0")]
    NotOnMirror {
        /// Normal of the mirror plane.
        axis: char,
    },
}

/// Why a file is not a mesh of Gmsh.
#[derive(Debug, Error)]
pub enum MshFault {
    /// The file is binary.
    #[error("the file is binary; export it as ASCII (in Gmsh: Mesh.Binary = 0)")]
    Binary,
    /// The version is not read.
    #[error("version {version} of the format is not supported; export 2.2 or 4.1 (in Gmsh: Mesh.MshFileVersion)")]
    Version {
        /// Its version.
        version: String,
    },
    /// A section is missing.
    #[error("`${section}` is missing")]
    Missing {
        /// Its name.
        section: &'static str,
    },
    /// A section ends too early.
    #[error("`${section}` ends too early")]
    Ends {
        /// Its name.
        section: &'static str,
    },
    /// A word is not a number of the kind that belongs there.
    #[error("expected a number in `${section}`, found `{text}`")]
    Number {
        /// The word.
        text: String,
        /// Name of the section.
        section: &'static str,
    },
    /// Two nodes have one tag.
    #[error("two nodes have the tag {tag}")]
    Twice {
        /// The tag.
        tag: u64,
    },
    /// An element refers to a node that the file does not have.
    #[error("an element refers to node {tag}, which is missing")]
    NoNode {
        /// The tag.
        tag: u64,
    },
    /// An element is neither triangle nor quadrilateral.
    #[error(
        "expected triangles (2) and quadrilaterals (3), found Gmsh type {kind}; mesh the surface alone, of order 1"
    )]
    Element {
        /// Its type.
        kind: u64,
    },
}

/// Why a file is not a VTU mesh.
#[derive(Debug, Error)]
pub enum VtuFault {
    /// The file is not XML.
    #[error("{0}")]
    Xml(#[from] roxmltree::Error),
    /// An element of the XML, or an array by its name, is missing.
    #[error("`{element}` is missing")]
    Missing {
        /// Its name.
        element: &'static str,
    },
    /// The arrays are compressed.
    #[error("the arrays are compressed; open the file in ParaView and save it as VTU with data mode ASCII")]
    Compressed,
    /// A snapshot that droptower wrote: it is compressed, and mirror images have nodes of their own.
    #[error(
        "this is a snapshot of a run, with compressed arrays and mirror images that do not share nodes; give the mesh of \
         that run, or in ParaView apply Clean to Grid, which joins the nodes, and save it as VTU with data mode ASCII"
    )]
    Snapshot,
    /// An array is not inline.
    #[error("array format `{format}` is not supported; save the file as ASCII or as inline binary")]
    Format {
        /// Its format.
        format: String,
    },
    /// The type of an array is unknown.
    #[error("array type `{kind}` is not supported")]
    Type {
        /// Its type.
        kind: String,
    },
    /// A word of an ASCII array is not a number.
    #[error("expected a number, found `{text}`")]
    Number {
        /// The word.
        text: String,
    },
    /// A binary array is not base64.
    #[error("{0}")]
    Base64(#[from] base64::DecodeError),
    /// The length of a binary array is not a multiple of that of its numbers.
    #[error("an array of `{kind}` ends within a number")]
    Truncated {
        /// Its type.
        kind: String,
    },
    /// A cell is neither triangle nor quadrilateral.
    #[error("expected triangles (5) and quadrilaterals (9), found VTK type {kind} in cell {cell}")]
    Cell {
        /// Index of the cell.
        cell: usize,
        /// Its VTK type.
        kind: f64,
    },
    /// The offsets do not match.
    #[error("the corners of cell {cell} do not match its type or the connectivity")]
    Corners {
        /// Index of the cell.
        cell: usize,
    },
    /// An entry of the connectivity is not a node.
    #[error("expected a node number, found {value}")]
    Node {
        /// The entry.
        value: f64,
    },
}
