//! `[impactor]`, `[[impactor]]`: the rigid bodies that load the film.

use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize};

use super::schema;
use super::specimen::Round;
use base::units::{Angle, AngularVelocity, Force, ForcePerSpeed, Inertia, Length, Mass, Time, Velocity};

/// Most impactors of a scene.
const MOST: usize = 16;

keys! {
    /// A rigid body that loads the film.
    pub struct Impactor {
        /// Name of the body among several, with which the names of its signals and figures begin: a letter, then letters, digits
        /// and underscores.
        name: Option<String>;
        /// Shape of the body; its axis is z, its tip points down.
        shape: ImpactorShape, schemars(schema_with = "shape_schema");
        /// Mass of the body and all that moves with it; required where it falls. Usual are up to 6 kg with a head of ASTM D1709, up
        /// to 100 kg with another hemisphere.
        mass: Option<Mass>, above 0, likely [1e-3, 2e3], title "Mass of the impactor";
        /// Moments of inertia about the body's own x, y and z through its centre of mass; those of a homogeneous body, without
        /// the rounding of edges, where they are left out.
        inertia: Option<[Inertia; 3]>, positive;
        /// Its degrees of freedom.
        guide: Guide, default;
        /// Friction of the guide, against the motion along it; none where it is left out. `droptower reduce drop` prints
        /// that of a recorded fall.
        guide_friction: Option<GuideFriction>, default;
        /// Coulomb coefficient between impactor and film; between two impactors, or an impactor and the frame's bars, the smaller
        /// of theirs.
        friction: f64, from 0, to 10, likely [1e-3, 2.0], title "Friction of impactor and film";
        /// Coefficient of restitution where impactors meet, of which a pair has the smaller, and where this one meets the
        /// frame's bars: 0 where they stay together, 1 where no energy is lost.
        restitution: f64, default, from 0, to 1;
        /// When it is released with its velocity; until then it stands still at its position and touches nothing. One that is
        /// released later than at the start needs a height in `position`.
        at: Time, default, from 0, likely [1e-6, 5.0];
        /// Position of its centre of mass at the start: x, y, and its height z, from which `layers.faces` count too. Without a
        /// height it is placed on the film as mounted.
        position: Vec<Length>, default "centre", least 2, most 3, likely [-10.0, 10.0];
        /// Rotation from the upright position, about an axis through its centre of mass.
        orientation: Option<Orientation>;
        /// Velocity of its centre of mass at the start, in place of the downward speed of `loading.impact`.
        velocity: Option<[Velocity; 3]>, likely [-500.0, 500.0];
        /// Angular velocity at the start, about the axes of the scene; of a free impactor, and of one on a hinge the part along
        /// its axis.
        spin: Option<[AngularVelocity; 3]>;
    }

    /// A rotation about an axis.
    #[derive(Copy, PartialEq)]
    pub struct Orientation {
        /// Direction of the axis, of any length.
        axis: [f64; 3];
        /// Angle about it, by the right-hand rule.
        angle: Angle;
    }

    /// A body of several parts.
    pub struct Compound {
        /// A body of several shapes of one density.
        compound: Vec<Part>, least 1;
    }

    /// A part of a compound body.
    pub struct Part {
        /// Its shape.
        shape: BodyShape;
        /// Position of the middle of its height on its axis, or of the origin of its file's coordinates, in the body: x, y, z.
        at: [Length; 3], default;
        /// Its rotation about that point.
        orientation: Option<Orientation>;
    }

    /// A shape.
    pub enum BodyShape {
        /// A ball.
        Sphere(Round<300>),
        /// A dart: a shaft with a hemispherical tip (ASTM D1709).
        Hemisphere {
            /// Of tip and shaft.
            #[serde(flatten)]
            round: Round<300>,
            /// Length of the shaft behind the tip; four radii where it is left out.
            #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
            length: Option<Length>,
        },
        /// A cylinder with a hemisphere at each end, axis along z.
        Capsule {
            /// Of cylinder and hemispheres.
            #[serde(flatten)]
            round: Round<300>,
            /// Length of the cylinder between the hemispheres.
            #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
            length: Length,
        },
        /// A flat-ended cylinder, axis along z.
        Cylinder {
            /// Of the flat end.
            #[serde(flatten)]
            round: Round<300>,
            /// Length along z.
            #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
            length: Length,
            /// Radius of its edges; sharp where it is left out.
            #[serde(default)]
            #[schemars(extend("minimum" = 0, "maximum" = 1e3, "x-likely" = [1e-5, 1.0]))]
            edge: Length,
        },
        /// A cone with its tip down, axis along z.
        Cone {
            /// Of the flat end.
            #[serde(flatten)]
            round: Round<300>,
            /// Length along z, with a sharp tip.
            #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e3, "x-likely" = [1e-4, 3.0]))]
            length: Length,
            /// Radius of tip and edge, inside the flanks; sharp where it is left out.
            #[serde(default)]
            #[schemars(extend("minimum" = 0, "maximum" = 1e3, "x-likely" = [1e-5, 1.0]))]
            edge: Length,
        },
        /// A box.
        Box {
            /// Its lengths along x, y and z.
            #[schemars(transform = schema::positive_items)]
            size: [Length; 3],
            /// Radius of its edges; sharp where it is left out.
            #[serde(default)]
            #[schemars(extend("minimum" = 0, "maximum" = 1e3, "x-likely" = [1e-5, 1.0]))]
            edge: Length,
        },
        /// A closed surface from an STL or OBJ file.
        Mesh(MeshFile),
    }

    /// A file with a mesh: its path, with coordinates in m, or with their unit. The validator has reported mistakes
    /// before serde tries the two forms.
    pub enum MeshFile of forms {
        /// Coordinates in m.
        Path(#[schemars(extend("x-path" = true))] PathBuf),
        /// With unit and scale.
        Table(MeshTable),
    }

    /// A file with a mesh and the unit of its coordinates.
    pub struct MeshTable {
        /// The file.
        file: PathBuf, path;
        /// Unit of its coordinates.
        unit: MeshUnit, default;
        /// Factor on all coordinates besides.
        scale: f64, default "schema::one::<f64>", above 0;
    }

    /// Unit of the coordinates of a file.
    #[derive(Default)]
    pub enum MeshUnit of words {
        /// Metre.
        #[default]
        M,
        /// Centimetre.
        Cm,
        /// Millimetre.
        Mm,
        /// Inch.
        In,
    }

    /// Force of the guide against the motion of the impactor.
    pub struct GuideFriction with defaults {
        /// Part that does not depend on the speed; it holds an impactor at rest against a smaller force.
        constant: Force, from 0, likely [1e-3, 1e3];
        /// Part that is proportional to the speed.
        per_speed: ForcePerSpeed, from 0, likely [1e-4, 1e3];
        /// Part that depends on the speed in any other way: speed and force of each point, the speeds ascending; straight
        /// between the points, constant before the first and beyond the last.
        curve: Vec<FrictionPoint>, or empty;
    }

    /// Degrees of freedom of the impactor.
    #[derive(Copy, Default, PartialEq)]
    pub enum Guide {
        /// Translation along z only.
        #[default]
        Z,
        /// Six degrees of freedom.
        Free,
        /// None: it stays where it is.
        Fixed,
        /// Translation along a line, e.g. `{ line = [1, 0, -2] }`: its direction, of any length.
        Line([f64; 3]),
        /// Rotation about an axis that stays where it is; the impactor starts with `spin`.
        Hinge(Hinge),
    }

    /// An axis about which the impactor rotates.
    #[derive(Copy, PartialEq)]
    pub struct Hinge {
        /// Direction of the axis, of any length.
        axis: [f64; 3];
        /// A point of the axis: x, y, z.
        at: [Length; 3];
    }
}

/// One table, or a list of them. The validator has reported mistakes before serde tries the two forms.
#[derive(Deserialize)]
#[serde(untagged)]
enum OneOrSeveral {
    Several(Vec<Impactor>),
    One(Box<Impactor>),
}

/// Reads one impactor or several.
pub(super) fn one_or_several<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Impactor>, D::Error> {
    Ok(match OneOrSeveral::deserialize(from)? {
        OneOrSeveral::Several(several) => several,
        OneOrSeveral::One(one) => vec![*one],
    })
}

/// The schema of one impactor, or of several.
pub(super) fn one_or_several_schema(generator: &mut SchemaGenerator) -> Schema {
    let one = generator.subschema_for::<Impactor>();
    json_schema!({ "anyOf": [one, { "type": "array", "items": one, "minItems": 1, "maxItems": MOST }] })
}

fn centre() -> Vec<Length> {
    vec![Length(0.0); 2]
}

/// Shape of the impactor: one of the shapes, or several of them. The validator has reported mistakes before serde tries
/// the two forms.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ImpactorShape {
    /// Several parts.
    Compound(Compound),
    /// One shape.
    One(BodyShape),
}

/// The schema of one shape, with that of a compound as one more choice.
fn shape_schema(generator: &mut SchemaGenerator) -> Schema {
    let mut shape = BodyShape::json_schema(generator);
    let compound = Compound::json_schema(generator).to_value();
    if let Some(choices) = shape.get_mut("oneOf").and_then(|choices| choices.as_array_mut()) {
        choices.push(compound);
    }
    shape
}

impl MeshUnit {
    /// Its length, m.
    pub fn metres(self) -> f64 {
        match self {
            MeshUnit::M => 1.0,
            MeshUnit::Cm => 1e-2,
            MeshUnit::Mm => 1e-3,
            MeshUnit::In => 0.0254,
        }
    }
}

/// Force of the guide at one speed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FrictionPoint(#[schemars(range(min = 0))] pub Velocity, #[schemars(range(min = 0))] pub Force);
