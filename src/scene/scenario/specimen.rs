//! `[specimen]`: outline, material and mesh of the film.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::impactor::{MeshFile, MeshUnit};
use super::material::Material;
use super::round::Round;
use super::schema;
use base::units::{Angle, Length, Rate, Time};

/// The film: outline, material, mesh.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Specimen {
    /// Outline of the film's free span; rectangles and circles are centred on the origin.
    pub shape: Shape,
    /// What one layer is made of: the path of a material file, or the table itself.
    #[serde(default)]
    #[schemars(schema_with = "schema::path_or_table::<Material>")]
    pub material: Option<Material>,
    /// Angle from the x axis to the machine direction (MD).
    #[serde(default = "along_x")]
    pub md_angle: Angle,
    /// Element type and size of a face.
    #[serde(default)]
    pub mesh: Meshing,
    /// Mirror planes through the origin; only the part at positive x and/or y is computed.
    #[serde(default)]
    pub symmetry: Symmetry,
    /// Mass-proportional damping of the film; none where it is left out.
    #[serde(default = "undamped")]
    #[schemars(range(min = 0))]
    pub damping: Rate,
    /// Cuts through all faces, each a line through its points (x and y of each): the elements that it passes through are
    /// left out, at its ends those whose middle lies before them. With symmetry, of the computed part. A tear of film with `rupture` starts from their ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000), inner(length(min = 2, max = 10_000)), extend("x-likely" = [-20.0, 20.0]))]
    pub cuts: Vec<Vec<[Length; 2]>>,
    /// Time between mounting and loading of film with `prony`, which is mounted at once with its pre-strain; its stress has
    /// relaxed entirely where it is left out.
    #[schemars(extend("minimum" = 0))]
    pub rest: Option<Time>,
}

fn undamped() -> Rate {
    Rate(0.0)
}

fn along_x() -> Angle {
    Angle(0.0)
}

/// Outline of the film in the plane z = 0.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// Full side lengths along x and y.
    Rectangle(#[schemars(transform = schema::positive_items, extend("x-likely" = [1e-4, 20.0]))] [Length; 2]),
    /// A disc: its free span.
    Circle(Round<1000>),
    /// A polygon with holes, whose edges are free. With symmetry it is the computed part.
    Polygon(Polygon),
    /// Nodes and elements from an STL, OBJ, VTU or Gmsh (.msh) file.
    Mesh(MeshFile),
}

/// A polygon with holes: corners, or a drawing.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [{ "required": ["file"] }, { "required": ["points"] }]))]
pub struct Polygon {
    /// Drawing in a DXF file (LWPOLYLINE, POLYLINE, LINE, ARC and CIRCLE) or an SVG file (paths and basic shapes), in place of
    /// `points`; the largest loop is the outline, the others are holes.
    #[schemars(extend("x-path" = true))]
    pub file: Option<PathBuf>,
    /// Unit of the drawing's coordinates; required where the drawing does not give it (DXF: $INSUNITS; SVG: width and height
    /// with a unit).
    pub unit: Option<MeshUnit>,
    /// Corners of the outline in order, x and y of each.
    #[schemars(length(min = 3, max = 10_000), extend("x-likely" = [-20.0, 20.0]))]
    pub points: Option<Vec<[Length; 2]>>,
    /// Corners of each hole.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub holes: Vec<Vec<[Length; 2]>>,
}

/// Element type and size of a face.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Meshing {
    /// Type of membrane element.
    #[schemars(extend("default" = "quad4"))]
    pub element: Option<Element>,
    /// Target edge length, of a graded mesh the largest; required unless the mesh is imported.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-6, 0.5]))]
    pub size: Option<Length>,
    /// Target edge length around one place, from which elements grow to `size`; left out, all have one size.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-6, 0.5]))]
    pub fine: Option<Length>,
    /// Where elements are `fine`: where each impactor meets the film, or around a point of the undeformed film.
    #[schemars(extend("default" = "impactor"))]
    pub around: Option<Around>,
    /// Radius of the circle in which elements are `fine`; the impactor's radius seen from above where it is left out, and
    /// of a point zero.
    #[schemars(extend("minimum" = 0, "x-likely" = [1e-5, 5.0]))]
    pub within: Option<Length>,
    /// Growth of the edge length per distance from that circle, up to `size`.
    #[schemars(range(min = 0.02, max = 1), extend("default" = 0.25))]
    pub growth: Option<f64>,
}

/// Where elements are fine. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Around {
    /// Around the impactors.
    Word(AroundChoice),
    /// Around a point, x and y.
    Point([Length; 2]),
}

/// A place that other keys give.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum AroundChoice {
    /// Where each impactor meets the film.
    Impactor,
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

/// Mirror planes through the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// The whole film is computed.
    #[default]
    None,
    /// Only x >= 0 is computed.
    HalfX,
    /// Only y >= 0 is computed.
    HalfY,
    /// Only x >= 0 and y >= 0 is computed.
    Quarter,
}
