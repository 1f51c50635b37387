//! Meshes of films: rectangles, circles and polygons, and meshes from files.

pub mod import;
pub mod quality;

mod disc;
mod error;
mod grading;
mod grid;
mod polygon;
mod quadtree;
mod smoothing;
mod structured;
mod topology;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

pub use error::MeshError;
pub use grading::{Grading, Zone};
pub use membrane::engine::Mesh;
pub use polygon::{Polygon, PolygonFault};
pub use quality::Quality;
pub(crate) use topology::extent;
pub use topology::{directed_edges, outer_edges};

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

/// A straight edge of a rectangle, or the outermost nodes of another outline in that direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// Towards −x.
    XMinus,
    /// Towards +x.
    XPlus,
    /// Towards −y.
    YMinus,
    /// Towards +y.
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

/// Kind of membrane element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Element {
    /// Four nodes, one integration point, stabilised against hourglass modes.
    Quad4,
    /// Four nodes, 2×2 integration points.
    Quad4Full,
    /// Three nodes, constant strain.
    Tri3,
}

/// The mesh of a film of `outline`; `mirrored` is whether x = 0 and y = 0 are mirror planes, beyond which nothing is
/// meshed.
///
/// Rectangles and circles lie in the plane z = 0; imported meshes keep the z of their file.
///
/// # Errors
/// [`MeshError`]: lengths that are not positive, more elements than can be numbered, or a file that is not a mesh of a
/// film.
pub fn build(outline: &Outline, mirrored: [bool; 2], meshing: &Meshing) -> Result<Mesh, MeshError> {
    match outline {
        Outline::Rectangle { x, y } => structured::rectangle([*x, *y], mirrored, meshing),
        Outline::Circle { radius } => disc::disc(*radius, mirrored, meshing),
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
