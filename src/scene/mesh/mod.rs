//! Meshes of films: rectangles, circles and polygons, and meshes from files; their edges, rims and mirror planes, and the
//! quality of their elements.

pub mod import;
mod polygon;
mod quadtree;
mod structured;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};
use std::fmt;
use std::path::PathBuf;

use nalgebra::{Point3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use base::file::FileError;
pub use membrane::engine::Mesh;
pub use polygon::Polygon;
pub use quadtree::{Grading, Zone};

/// Outline of a film in the plane z = 0, centred on the origin. Lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Outline {
    /// Full side lengths along x and y.
    Rectangle {
        /// Along x.
        x: f64,
        /// Along y.
        y: f64,
    },
    /// A circle.
    Circle {
        /// Its radius.
        radius: f64,
    },
    /// A polygon with holes, of which the edges of the outline alone are held. With symmetry it is the computed part.
    Polygon(Polygon),
    /// Nodes and elements from an STL, OBJ, VTU or MSH file.
    Mesh {
        /// The file.
        path: PathBuf,
        /// Length of one unit of its coordinates, m.
        scale: f64,
    },
}

impl Outline {
    /// Area of the film, of a polygon its computed part, m²; none where a file gives it.
    pub fn area(&self) -> Option<f64> {
        match self {
            Outline::Rectangle { x, y } => Some(x * y),
            Outline::Circle { radius } => Some(PI * radius * radius),
            Outline::Polygon(polygon) => Some(polygon.area()),
            Outline::Mesh { .. } => None,
        }
    }

    /// Distance of a point (m) from the film or its computed part, m, zero on it; none where a file gives the film.
    pub fn distance(&self, [x, y]: [f64; 2]) -> Option<f64> {
        Some(match self {
            Outline::Rectangle { x: width, y: height } => {
                let beyond = |at: f64, length: &f64| (at.abs() - 0.5 * length).max(0.0);
                beyond(x, width).hypot(beyond(y, height))
            }
            Outline::Circle { radius } => (x.hypot(y) - radius).max(0.0),
            Outline::Polygon(polygon) => polygon.distance([x, y]),
            Outline::Mesh { .. } => return None,
        })
    }
}

/// A straight edge of a rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Side {
    /// The side at the smallest x.
    #[serde(rename = "x-")]
    XMinus,
    /// The side at the largest x.
    #[serde(rename = "x+")]
    XPlus,
    /// The side at the smallest y.
    #[serde(rename = "y-")]
    YMinus,
    /// The side at the largest y.
    #[serde(rename = "y+")]
    YPlus,
}

impl Side {
    /// As `frame.hold` names it.
    pub fn name(self) -> &'static str {
        match self {
            Side::XMinus => "x-",
            Side::XPlus => "x+",
            Side::YMinus => "y-",
            Side::YPlus => "y+",
        }
    }
}

/// How a face is divided into elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meshing {
    /// Kind of its elements.
    pub element: Element,
    /// Target edge length, the largest of a graded mesh; m. Not used by imported meshes.
    pub size: f64,
    /// Where elements are smaller.
    pub grading: Option<Grading>,
}

/// Type of membrane element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Element {
    /// Four nodes, one integration point, stabilised against hourglass modes.
    #[serde(rename = "quad4")]
    Quad4,
    /// Four nodes, 2×2 integration points.
    #[serde(rename = "quad4-full")]
    Quad4Full,
    /// Three nodes, constant strain.
    #[serde(rename = "tri3")]
    Tri3,
}

/// The mesh of a film of `outline`; `mirrored` is whether x = 0 and y = 0 are mirror planes, beyond which nothing is
/// meshed.
///
/// Rectangles and circles lie in the plane z = 0; imported meshes keep the z of their file.
///
/// # Errors
/// Lengths that are not positive, more elements than can be numbered, or a file that is not a mesh of a
/// film.
pub fn build(outline: &Outline, mirrored: [bool; 2], meshing: &Meshing) -> Result<Mesh, MeshError> {
    match outline {
        Outline::Rectangle { x, y } => structured::rectangle([*x, *y], mirrored, meshing),
        Outline::Circle { radius } => structured::disc(*radius, mirrored, meshing),
        Outline::Polygon(polygon) => polygon::mesh(polygon, mirrored, meshing),
        Outline::Mesh { path, scale } => import::film(path, *scale, mirrored, meshing.element),
    }
}

/// Elements of one quadrilateral cell.
fn elements_per_cell(element: Element) -> usize {
    match element {
        Element::Quad4 | Element::Quad4Full => 1,
        Element::Tri3 => 2,
    }
}

/// Distance over the mesh's extent below which a node is on a plane or an outermost edge.
const TOLERANCE: f64 = 1e-6;

/// An edge as its two nodes, the smaller number first.
pub(crate) type Edge = [u32; 2];

/// Fills in the rim, sides and mirror nodes of a mesh whose nodes and elements are given.
pub(crate) fn label(mesh: &mut Mesh, mirrored: [bool; 2]) {
    let near = TOLERANCE * extent(mesh);
    mesh.mirrors = [0, 1].map(|axis| match mirrored[axis] {
        true => nodes_where(mesh, |p| p[axis].abs() <= near),
        false => Vec::new(),
    });
    mesh.rim = rim(mesh);
    mesh.sides = [0, 1, 2, 3].map(|side| side_nodes(mesh, mirrored, side, near));
}

/// Corners of every element, quadrilaterals first.
pub(crate) fn outlines(mesh: &Mesh) -> impl Iterator<Item = &[u32]> {
    let quads = mesh.quads.iter().map(|quad| quad.as_slice());
    quads.chain(mesh.tris.iter().map(|tri| tri.as_slice()))
}

/// Directed edges of one element or another loop of corners.
pub(crate) fn directed<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 2]> + '_ {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(from, to)| [*from, *to])
}

/// Every edge of every element, with the element to its left: those between two elements once in each direction.
pub fn directed_edges(mesh: &Mesh) -> impl Iterator<Item = [u32; 2]> + '_ {
    outlines(mesh).flat_map(directed)
}

/// The edge without its direction.
pub(crate) fn undirected([from, to]: [u32; 2]) -> Edge {
    [from.min(to), from.max(to)]
}

/// Every edge once, ascending, with the number of elements that share it.
pub(crate) fn uses(mesh: &Mesh) -> impl Iterator<Item = (Edge, u32)> {
    // Sorted and not hashed: the order of nodes that follows from it is that of every run.
    let mut edges: Vec<Edge> = outlines(mesh).flat_map(directed).map(undirected).collect();
    edges.sort_unstable();
    let mut rest = 0;
    std::iter::from_fn(move || {
        let edge = *edges.get(rest)?;
        let uses = edges[rest..].iter().take_while(|other| **other == edge).count();
        rest += uses;
        Some((edge, uses as u32))
    })
}

/// Edges of the film's own outline, not on a mirror plane, ascending.
pub fn outer_edges(mesh: &Mesh) -> impl Iterator<Item = Edge> + '_ {
    // Edges on a mirror plane belong to one element too, but the film goes on behind it.
    let on = |plane: &[u32], node: &u32| plane.binary_search(node).is_ok();
    let mirror = move |edge: &Edge| {
        let holds = |plane: &Vec<u32>| edge.iter().all(|node| on(plane, node));
        mesh.mirrors.iter().any(holds)
    };
    uses(mesh).filter(move |(edge, uses)| *uses == 1 && !mirror(edge)).map(|(edge, _)| edge)
}

fn rim(mesh: &Mesh) -> Vec<u32> {
    let mut rim: Vec<u32> = outer_edges(mesh).flatten().collect();
    rim.sort_unstable();
    rim.dedup();
    rim
}

/// Outermost rim nodes towards `side`; none where a mirror plane replaces that side.
fn side_nodes(mesh: &Mesh, mirrored: [bool; 2], side: usize, near: f64) -> Vec<u32> {
    let (axis, sign) = (side / 2, if side.is_multiple_of(2) { -1.0 } else { 1.0 });
    if mirrored[axis] && sign < 0.0 {
        return Vec::new();
    }
    let coordinate = |node: &u32| sign * mesh.nodes[*node as usize][axis];
    let outermost = mesh.rim.iter().map(coordinate).fold(f64::MIN, f64::max);
    let is_outermost = |node: &&u32| coordinate(node) >= outermost - near;
    mesh.rim.iter().filter(is_outermost).copied().collect()
}

fn nodes_where(mesh: &Mesh, holds: impl Fn(&nalgebra::Point3<f64>) -> bool) -> Vec<u32> {
    let numbered = (0u32..).zip(&mesh.nodes);
    numbered.filter(|(_, point)| holds(point)).map(|(node, _)| node).collect()
}

/// Largest coordinate in magnitude, m.
pub(crate) fn extent(mesh: &Mesh) -> f64 {
    let largest = |p: &nalgebra::Point3<f64>| p.coords.amax();
    mesh.nodes.iter().map(largest).fold(0.0, f64::max)
}

/// Extremes over the elements of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Number of elements.
    pub elements: usize,
    /// Shortest and longest edge, m.
    pub edges: [f64; 2],
    /// Smallest and largest area of an element, m².
    pub areas: [f64; 2],
    /// Area of all elements, m².
    pub area: f64,
    /// Largest ratio of the longest to the shortest edge of an element.
    pub aspect: f64,
    /// Smallest scaled Jacobian: 1 for squares and equilateral triangles, 0 or less where inverted.
    pub jacobian: f64,
    /// Largest equiangle skew: 0 for squares and equilateral triangles, 1 where degenerate.
    pub skew: f64,
}

impl Quality {
    /// Measures every element of `mesh`.
    pub fn from_mesh(mesh: &Mesh) -> Quality {
        let none = Quality {
            elements: 0,
            edges: [f64::INFINITY, 0.0],
            areas: [f64::INFINITY, 0.0],
            area: 0.0,
            aspect: 1.0,
            jacobian: 1.0,
            skew: 0.0,
        };
        let corner = |node: &u32| mesh.nodes[*node as usize];
        outlines(mesh)
            .map(|corners| corners.iter().map(corner).collect::<Vec<_>>())
            .fold(none, |quality, points| quality.with(&points))
    }

    fn with(self, points: &[Point3<f64>]) -> Quality {
        let edges = edge_range(points);
        let area = area_vector(points).norm();
        let wider = |[low, high]: [f64; 2], [a, b]: [f64; 2]| [low.min(a), high.max(b)];
        Quality {
            elements: self.elements + 1,
            edges: wider(self.edges, edges),
            areas: wider(self.areas, [area, area]),
            area: self.area + area,
            aspect: self.aspect.max(edges[1] / edges[0]),
            jacobian: self.jacobian.min(scaled_jacobian(points)),
            skew: self.skew.max(skew(points)),
        }
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [shortest, longest] = self.edges.map(|edge| edge * 1e3);
        write!(
            f,
            "{} elements, edges {shortest:.3} to {longest:.3} mm, aspect ratio up to {:.2}, \
             scaled Jacobian from {:.2}, skew up to {:.2}, area {:.6} m2",
            self.elements, self.aspect, self.jacobian, self.skew, self.area
        )
    }
}

/// Normal of an element, as long as its area (m²); for a twisted one that of its mean plane.
pub fn area_vector(points: &[Point3<f64>]) -> Vector3<f64> {
    // The sum does not depend on the corner that the fan starts from, as the fan of a twisted element itself does.
    let origin = points[0];
    let fan = points.windows(2).map(|w| (w[0] - origin).cross(&(w[1] - origin)));
    fan.sum::<Vector3<f64>>() / 2.0
}

/// Shortest and longest edge, m.
pub fn edge_range(points: &[Point3<f64>]) -> [f64; 2] {
    corners(points)
        .map(|[_, here, next]| (next - here).norm())
        .fold([f64::INFINITY, 0.0], |[low, high], edge| [low.min(edge), high.max(edge)])
}

/// Smallest sine of a corner's angle, signed by the element's normal and scaled so that the regular
/// element has 1.
pub fn scaled_jacobian(points: &[Point3<f64>]) -> f64 {
    let normal = area_vector(points).normalize();
    let sine = |[before, here, next]: [Point3<f64>; 3]| {
        // Of unit vectors, so that only the angle counts; by the sign a re-entrant corner is worse than any other.
        let (out, back) = ((next - here).normalize(), (before - here).normalize());
        out.cross(&back).dot(&normal)
    };
    let smallest = corners(points).map(sine).fold(f64::INFINITY, f64::min);
    smallest / regular_angle(points).sin()
}

/// How far the angles are from those of the regular element, 0 to 1.
fn skew(points: &[Point3<f64>]) -> f64 {
    let regular = regular_angle(points);
    let angle = |[before, here, next]: [Point3<f64>; 3]| (next - here).angle(&(before - here));
    corners(points)
        .map(angle)
        .map(|angle| {
            let wide = (angle - regular) / (std::f64::consts::PI - regular);
            wide.max((regular - angle) / regular)
        })
        .fold(0.0, f64::max)
}

fn regular_angle(points: &[Point3<f64>]) -> f64 {
    if points.len() == 3 { FRAC_PI_3 } else { FRAC_PI_2 }
}

/// Each corner between the one before and the one after it.
fn corners(points: &[Point3<f64>]) -> impl Iterator<Item = [Point3<f64>; 3]> + '_ {
    let n = points.len();
    (0..n).map(move |i| [points[(i + n - 1) % n], points[i], points[(i + 1) % n]])
}

/// Why a film or a surface cannot be meshed, or a file is neither a mesh nor a drawing of one. Elements are counted from 0,
/// quadrilaterals before triangles where a file holds both, lines from 1; positions in m.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct MeshError {
    /// What is at fault.
    pub kind: MeshErrorKind,
    message: String,
}

/// What is at fault where something cannot be meshed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshErrorKind {
    /// The size of the elements.
    Size,
    /// The outline, or the content of its file.
    Outline,
    /// A hole of a polygon, counted from 0.
    Hole(usize),
    /// A file is unreadable.
    Unreadable,
    /// A drawing gives no unit.
    NoUnit,
    /// A drawing gives another unit than the scenario.
    OtherUnit,
}

impl MeshError {
    fn new(kind: MeshErrorKind, message: impl fmt::Display) -> MeshError {
        MeshError { kind, message: message.to_string() }
    }
}

/// An error of an outline or the content of its file: its message, as of `format!`.
macro_rules! fault {
    ($($message:tt)*) => { $crate::mesh::MeshError::new($crate::mesh::MeshErrorKind::Outline, format!($($message)*)) };
}
use fault;

impl From<FileError> for MeshError {
    fn from(error: FileError) -> MeshError {
        MeshError::new(MeshErrorKind::Unreadable, error)
    }
}

/// Errors of readers, with the words that these have.
macro_rules! of_readers {
    ($($error:ty),*) => {
        $(impl From<$error> for MeshError {
            fn from(error: $error) -> MeshError {
                MeshError::new(MeshErrorKind::Outline, error)
            }
        })*
    };
}

of_readers!(tobj::LoadError, roxmltree::Error, base64::DecodeError);
