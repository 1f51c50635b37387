//! `[specimen]`, `[layers]`, `[[layer]]`, `[frame]`, `[contact]` and `[air]`: the film and what is around it.

use std::borrow::Cow;
use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::impactor::{MeshFile, MeshUnit};
use super::material::Material;
use super::schema;
use crate::mesh::{Element, Side};
use base::units::{Angle, Area, AreaDensity, Density, Force, Length, Pressure, Rate, Stiffness, Time};

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
    #[serde(default)]
    pub md_angle: Angle,
    /// Element type and size of a face.
    #[serde(default)]
    pub mesh: Meshing,
    /// Mirror planes through the origin; only the part at positive x and/or y is computed.
    #[serde(default)]
    pub symmetry: Symmetry,
    /// Mass-proportional damping of the film; none where it is left out.
    #[serde(default)]
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

impl Symmetry {
    /// Whether x = 0 and y = 0 are mirror planes.
    pub fn mirrors(self) -> [bool; 2] {
        [matches!(self, Symmetry::HalfX | Symmetry::Quarter), matches!(self, Symmetry::HalfY | Symmetry::Quarter)]
    }

    /// How many copies of the computed part the whole is made of.
    pub fn copies(self) -> f64 {
        self.mirrors().iter().map(|mirror| if *mirror { 2.0 } else { 1.0 }).product()
    }
}

/// Faces of film that differ in height only.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Layers {
    /// Layers per face; n layers act as one membrane of n times the thickness.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 10_000))]
    pub count: u32,
    /// Height of every face, the highest first.
    #[serde(default = "ground")]
    #[schemars(length(min = 1, max = 64), extend("x-likely" = [-10.0, 10.0]))]
    pub faces: Vec<Length>,
    /// Engineering strain with which the film is mounted on the frame.
    #[serde(default)]
    pub prestrain: Prestrain,
    /// Whether film is brought to equilibrium with its pre-strain and its weight before the test.
    #[serde(default = "yes")]
    pub settle: bool,
}

impl Default for Layers {
    fn default() -> Layers {
        Layers { count: one(), faces: ground(), prestrain: Prestrain::default(), settle: yes() }
    }
}

/// One face of film with its own material, angle and mesh.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Layer {
    /// Height of the undeformed face.
    #[serde(default)]
    #[schemars(extend("x-likely" = [-10.0, 10.0]))]
    pub height: Length,
    /// Layers in this face.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 10_000))]
    pub count: u32,
    /// Material of one layer; the specimen's where it is left out.
    #[serde(default)]
    #[schemars(schema_with = "schema::path_or_table::<Material>")]
    pub material: Option<Material>,
    /// Angle from the x axis to MD; the specimen's where it is left out.
    pub md_angle: Option<Angle>,
    /// Engineering strain with which this face is mounted.
    #[serde(default)]
    pub prestrain: Prestrain,
    /// Whether this face is brought to equilibrium with its pre-strain and its weight before the test.
    #[serde(default = "yes")]
    pub settle: bool,
    /// Element type and size; what is left out is the specimen's.
    #[serde(default)]
    pub mesh: Meshing,
}

/// Engineering strain before the test: the film's own length is the span / (1 + strain).
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Prestrain {
    /// Along the machine direction.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = -1, "maximum" = 100, "x-likely" = [-1.0, 5.0]))]
    #[schemars(title = "Pre-strain along MD")]
    pub md: f64,
    /// Along the transverse direction.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = -1, "maximum" = 100, "x-likely" = [-1.0, 5.0]))]
    #[schemars(title = "Pre-strain along TD")]
    pub td: f64,
}

fn one() -> u32 {
    1
}

fn yes() -> bool {
    true
}

fn ground() -> Vec<Length> {
    vec![Length(0.0)]
}

/// The mounting frame.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Frame {
    /// Clamped edges: all of them, none, or the sides listed. Under `loading.stretch` the jaws clamp the sides
    /// x- and x+, and no other edge can be clamped.
    #[schemars(extend("default" = "all"))]
    pub hold: Option<Hold>,
    /// Bars along the held edges, over which film bends: the edge lies on their crest. Between two faces they are as high as
    /// these are apart. Impactors that reach them meet them. Left out, the frame has no thickness.
    pub bars: Option<Bars>,
    /// A clamp in which film slips; left out, it is held.
    pub clamp: Option<Clamp>,
    /// Springs on which film hangs, between its held edges and the frame; left out, these edges are fixed.
    pub springs: Option<Springs>,
}

/// Bars along the held edges of film.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Bars {
    /// Of the bars, over which film bends.
    #[serde(flatten)]
    pub round: Round<50>,
    /// Coulomb coefficient between bars and film; between bars and an impactor the smaller of theirs.
    #[schemars(range(min = 0, max = 10), extend("x-likely" = [1e-3, 2.0]))]
    pub friction: f64,
}

/// A clamp in which film slips.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Clamp {
    /// Force with which the clamp presses on each face of film, along all of its held edges together.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-2, 1e6]))]
    pub force: Force,
    /// Coulomb coefficient between the clamp and each side of the film.
    #[schemars(range(max = 10), extend("exclusiveMinimum" = 0, "x-likely" = [1e-3, 2.0]))]
    pub friction: f64,
    /// Length of film within the clamp, after which it has slipped out of it; left out, it never does.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-4, 1.0]))]
    pub width: Option<Length>,
}

/// Linear springs between the held edges of film and the frame: each points outward, in the plane of the film and across its
/// edge. One that is shorter than without force is slack.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Springs {
    /// Stiffness of one spring.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1.0, 1e9]))]
    pub stiffness: Stiffness,
    /// Number of springs along the held edges of the whole film, of each face, evenly along each stretch of them and round
    /// its corners.
    #[schemars(range(min = 1, max = 100_000))]
    pub count: u32,
    /// Distance from the edge of film, as it is mounted, to the frame.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-4, 10.0]))]
    pub length: Length,
    /// Force of one spring at that length; left out, what the pre-strain of the film pulls with across its edge.
    #[schemars(range(min = 0), extend("x-likely" = [1e-3, 1e6]))]
    pub preload: Option<Force>,
}

/// Clamped edges. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Hold {
    /// All edges or none.
    Word(EdgeChoice),
    /// The sides listed.
    Sides(#[schemars(length(min = 1, max = 4))] Vec<Side>),
}

/// All edges or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum EdgeChoice {
    /// Every edge is clamped.
    All,
    /// No edge is clamped.
    None,
}

/// Contact of film with film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    /// Whether faces meet each other, also where the impactor is not; without it each face meets the impactor alone,
    /// through the film above it.
    #[serde(default)]
    pub film: bool,
    /// Whether each face meets itself, where it folds and where the lips of a cut or a tear meet; without it film passes
    /// through itself.
    #[serde(default)]
    pub itself: bool,
    /// Coulomb coefficient of film on film. Where it is left out, film is assumed to have the coefficient that it has on the
    /// impactor; impactors that differ in `friction` need it, and so does `loading.pressure`.
    #[schemars(range(min = 0, max = 10), extend("x-likely" = [1e-3, 2.0]))]
    pub film_friction: Option<f64>,
}

/// The air around the film, which has no effect where the table is left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Air {
    /// How the air between the two faces of film behaves that the impactor compresses; no such air where it is left
    /// out. Torn film lets it out.
    pub cushion: Option<Compression>,
    /// Area of all openings through which the air between the faces leaves; closed where it is left out.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 100))]
    pub vent: Area,
    /// Discharge coefficient of the openings: the share of their area that a jet fills.
    #[serde(default = "discharge")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub discharge: f64,
    /// Mass of air per area of film that moves with it, on both sides together; it has inertia and no weight.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 10))]
    pub added_mass: AreaDensity,
    /// Density of the air.
    #[serde(default = "density")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 100))]
    pub density: Density,
    /// Pressure of the air.
    #[serde(default = "pressure")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e7, "x-likely" = [1e4, 2e5]))]
    pub pressure: Pressure,
}

/// How enclosed air is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Compression {
    /// Without exchange of heat: too fast for it.
    Adiabatic,
    /// At constant temperature.
    Isothermal,
}

impl Compression {
    /// Exponent of pressure over density.
    pub fn exponent(self) -> f64 {
        match self {
            Compression::Adiabatic => 1.4,
            Compression::Isothermal => 1.0,
        }
    }
}

fn discharge() -> f64 {
    0.6
}

fn density() -> Density {
    Density(1.2)
}

fn pressure() -> Pressure {
    Pressure(101_325.0)
}

/// Radius or diameter; the validator has refused both and neither. A radius above `LIKELY` cm is implausible.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Round<const LIKELY: u32> {
    /// The radius.
    pub radius: Option<Length>,
    /// The diameter, in place of the radius.
    pub diameter: Option<Length>,
}

/// Least radius that is plausible, m.
const LEAST: f64 = 1e-4;

/// Largest radius, m.
const LARGEST: f64 = 1e3;

impl<const LIKELY: u32> Round<LIKELY> {
    /// The radius, m.
    pub fn radius(self) -> f64 {
        match (self.radius, self.diameter) {
            (Some(radius), _) => radius.0,
            (None, Some(diameter)) => 0.5 * diameter.0,
            (None, None) => f64::NAN,
        }
    }
}

impl<const LIKELY: u32> JsonSchema for Round<LIKELY> {
    fn schema_name() -> Cow<'static, str> {
        format!("Round{LIKELY}").into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut length = |sentence: &str, factor: f64| {
            let mut schema = Length::json_schema(generator);
            let likely = [LEAST, 1e-2 * f64::from(LIKELY)].map(|radius| factor * radius);
            schema.insert("description".into(), sentence.into());
            schema.insert("exclusiveMinimum".into(), 0.into());
            schema.insert("maximum".into(), (factor * LARGEST).into());
            schema.insert("x-likely".into(), likely.to_vec().into());
            schema
        };
        let (radius, diameter) = (length("Radius.", 1.0), length("Diameter, in place of the radius.", 2.0));
        json_schema!({
            "type": "object",
            "properties": { "radius": radius, "diameter": diameter },
            "oneOf": [{ "required": ["radius"] }, { "required": ["diameter"] }],
        })
    }
}
