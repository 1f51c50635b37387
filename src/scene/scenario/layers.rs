//! `[layers]` and `[[layer]]`: number and height of layers of film.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::material::Material;
use super::schema;
use super::specimen::Meshing;
use base::units::{Angle, Length};

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
    #[serde(default = "level")]
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

fn level() -> Length {
    Length(0.0)
}

fn ground() -> Vec<Length> {
    vec![level()]
}
