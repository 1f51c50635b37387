//! What is wrong with a mesh file.

use thiserror::Error;

use crate::file::FileError;

/// What is wrong with a mesh file. Elements are counted from 0, quadrilaterals before triangles
/// where a file holds both; positions in m.
#[derive(Debug, Error)]
pub enum Fault {
    #[error("meshes are read from .stl, .obj and .vtu files")]
    Format,
    #[error("{0}")]
    Read(#[from] FileError),
    #[error("{0}")]
    Obj(#[from] tobj::LoadError),
    #[error("{0}")]
    Vtu(#[from] VtuFault),
    #[error("there are no triangles or quadrilaterals in it")]
    NoElements,
    #[error("a face has {corners} corners; a film has triangles and quadrilaterals")]
    Corners { corners: usize },
    #[error("element {element} names node {node} of {nodes}")]
    NodeOutOfRange { element: usize, node: u32, nodes: usize },
    #[error("node {node} has a coordinate that is not finite")]
    NotFinite { node: usize },
    #[error("element {element} has no area")]
    NoArea { element: usize },
    #[error("element {element} is concave or twisted")]
    Concave { element: usize },
    #[error("element {element} stands upright; a film must be seen whole from +z")]
    Upright { element: usize },
    #[error("the film folds over at {at:?}; it must be seen whole from +z")]
    Folded { at: [f64; 3] },
    #[error("{elements} elements share the edge at {at:?}; an edge joins two at most")]
    NotManifold { elements: u32, at: [f64; 3] },
    #[error("the surface is open at {at:?}; an impactor needs a closed one")]
    Open { at: [f64; 3] },
    #[error("two triangles that share the edge at {at:?} face opposite ways")]
    Opposed { at: [f64; 3] },
    #[error(
        "a node at {at:?} lies beyond the mirror plane {axis} = 0; with symmetry the file holds only the part at {axis} >= 0"
    )]
    BeyondMirror { axis: char, at: [f64; 3] },
    #[error("no edge lies on the mirror plane {axis} = 0")]
    NotOnMirror { axis: char },
}

/// What is wrong with a VTU file.
#[derive(Debug, Error)]
pub enum VtuFault {
    #[error("{0}")]
    Xml(#[from] roxmltree::Error),
    #[error("`{element}` is missing")]
    Missing { element: &'static str },
    #[error("its arrays are compressed; save it without compression")]
    Compressed,
    #[error("array format `{format}` is not read; save it as ASCII or as inline binary")]
    Format { format: String },
    #[error("array type `{kind}` is unknown")]
    Type { kind: String },
    #[error("`{text}` is not a number")]
    Number { text: String },
    #[error("{0}")]
    Base64(#[from] base64::DecodeError),
    #[error("an array of `{kind}` ends within a number")]
    Truncated { kind: String },
    #[error("cell {cell} is of VTK type {kind}; a film has triangles (5) and quadrilaterals (9)")]
    Cell { cell: usize, kind: f64 },
    #[error("cell {cell}: its corners do not fit its type or the connectivity")]
    Corners { cell: usize },
    #[error("`{value}` is not the number of a node")]
    Node { value: f64 },
}
