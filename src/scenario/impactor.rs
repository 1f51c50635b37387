//! `[impactor]`: the rigid body that loads the film.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::units::{Force, ForcePerSpeed, Length, Mass, Velocity};

/// What there is in place of an oblique impact.
const DOWN: &str = "the impactor starts straight down: `loading.impact.velocity` is its speed";

/// What there is in place of a rotating or inclined impactor.
const UPRIGHT: &str = "the impactor starts upright and without rotation; with `guide = \"free\"` contact may rotate it";

/// What there is in place of a guide as a table.
const GUIDES: &str = "`guide = \"z\"` lets it move along z without friction, `guide = \"free\"` in all six directions";

/// What there is in place of a third coordinate.
const HEIGHT: &str =
    "the impactor starts in contact with the film: `position` is x, y; `loading.impact.drop_height` its fall";

/// The rigid body that loads the film.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-future" = {
    "velocity": DOWN, "direction": DOWN, "spin": UPRIGHT, "rotation": UPRIGHT, "orientation": UPRIGHT,
    "name": "there is one impactor", "at": "the impactor is released at the start"
}))]
pub struct Impactor {
    /// Shape of the body; its axis is z, its tip points down.
    pub shape: ImpactorShape,
    /// Mass of the body and all that moves with it; required where it falls.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-3, 2e3]))]
    pub mass: Option<Mass>,
    /// Its degrees of freedom.
    #[serde(default)]
    #[schemars(extend("x-future-table" = { "a guide with an axis or friction of its own": GUIDES }))]
    pub guide: Guide,
    /// Friction of the guide, against the motion along it; none where it is left out. `droptower signal drop` prints
    /// that of a recorded fall.
    #[serde(default)]
    pub guide_friction: Option<GuideFriction>,
    /// Coulomb coefficient between impactor and film.
    #[schemars(range(min = 0, max = 10), extend("x-likely" = [1e-3, 2.0]))]
    pub friction: f64,
    /// Position of its axis over the film at the start: x, y.
    #[serde(default = "centre")]
    #[schemars(extend("x-likely" = [-10.0, 10.0], "x-future-list" = { "a height of the impactor": HEIGHT }))]
    pub position: [Length; 2],
}

fn centre() -> [Length; 2] {
    [Length(0.0); 2]
}

/// The shapes that there are.
const SHAPES: &str = "a closed surface from STL or OBJ has any shape: `mesh`";

/// Shape of the impactor.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-future" = { "capsule": SHAPES, "cone": SHAPES, "box": SHAPES, "compound": SHAPES }))]
#[serde(rename_all = "lowercase")]
pub enum ImpactorShape {
    /// A ball.
    Sphere {
        /// Radius of the ball.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
        radius: Length,
    },
    /// A dart: a shaft with a hemispherical tip (ASTM D1709).
    Hemisphere {
        /// Radius of tip and shaft.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
        radius: Length,
        /// Length of the shaft behind the tip; four radii where it is left out.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
        length: Option<Length>,
    },
    /// A flat-ended cylinder, axis along z.
    Cylinder {
        /// Radius of the flat end.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
        radius: Length,
        /// Length along z.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
        length: Length,
    },
    /// A closed surface from an STL or OBJ file, coordinates in m.
    Mesh(#[schemars(extend("x-path" = true))] PathBuf),
}

/// Force of the guide against the motion of the impactor.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct GuideFriction {
    /// Part that does not depend on the speed; it holds an impactor at rest against a smaller force.
    #[serde(default = "no_force")]
    #[schemars(range(min = 0), extend("x-likely" = [1e-3, 1e3]))]
    pub constant: Force,
    /// Part that is proportional to the speed.
    #[serde(default = "no_force_per_speed")]
    #[schemars(range(min = 0), extend("x-likely" = [1e-4, 1e3]))]
    pub per_speed: ForcePerSpeed,
    /// Part that depends on the speed in any other way: speed and force of each point, the speeds ascending; straight
    /// between the points, constant before the first and beyond the last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve: Vec<FrictionPoint>,
}

/// Force of the guide at one speed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FrictionPoint(#[schemars(range(min = 0))] pub Velocity, #[schemars(range(min = 0))] pub Force);

fn no_force() -> Force {
    Force(0.0)
}

fn no_force_per_speed() -> ForcePerSpeed {
    ForcePerSpeed(0.0)
}

/// Degrees of freedom of the impactor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Guide {
    /// Translation along z only.
    #[default]
    Z,
    /// Six degrees of freedom.
    Free,
}
