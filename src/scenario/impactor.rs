//! `[impactor]`: the rigid body that meets the film.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::units::{Length, Mass};

/// The rigid body that meets the film.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Impactor {
    /// Shape of the body; its axis is z, its tip points down.
    pub shape: ImpactorShape,
    /// All that moves with it; needed where it falls.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass: Option<Mass>,
    /// What the guide lets it do.
    #[serde(default)]
    pub guide: Guide,
    /// Coulomb coefficient between impactor and film.
    #[schemars(range(min = 0, max = 10))]
    pub friction: f64,
    /// Where its axis stands over the film at the start: x, y.
    #[serde(default = "centre")]
    pub position: [Length; 2],
}

fn centre() -> [Length; 2] {
    [Length(0.0); 2]
}

/// Shape of the impactor.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ImpactorShape {
    /// A ball.
    Sphere {
        /// Radius of the ball.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
    },
    /// A dart: a shaft with a hemispherical tip (ASTM D1709).
    Hemisphere {
        /// Radius of tip and shaft.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// Length of the shaft behind the tip; four radii where it is left out.
        #[schemars(extend("exclusiveMinimum" = 0))]
        length: Option<Length>,
    },
    /// A flat-ended cylinder, axis along z.
    Cylinder {
        /// Radius of the flat end.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: Length,
        /// Length along z.
        #[schemars(extend("exclusiveMinimum" = 0))]
        length: Length,
    },
    /// A closed surface from an STL or OBJ file, coordinates in m.
    Mesh(#[schemars(extend("x-path" = true))] PathBuf),
}

/// What the guide lets the impactor do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Guide {
    /// Only moves along z.
    #[default]
    Z,
    /// Six degrees of freedom.
    Free,
}
