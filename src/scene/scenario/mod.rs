//! The scenario language as written: one file a table, every key with its unit, range, default and
//! one sentence. The schema for editors, `droptower explain` and the validator all follow
//! from these structs. Relations between keys are checked by the model.

mod air;
mod assignment;
mod contact;
mod field;
mod file_kind;
mod curve_file;
mod document;
mod expectations;
mod frame;
pub mod grammar;
mod hyperelastic;
mod impactor;
mod layers;
mod loading;
mod material;
mod merge;
mod output;
mod plastic;
mod plausible;
mod reader;
mod reference;
mod resolved;
mod round;
mod rupture;
mod schema;
mod specimen;
mod tree;
mod validate;
mod variation;
mod viscous;

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use air::{Air, Compression};
pub use assignment::Assignment;
pub use contact::Contact;
pub use curve_file::Point;
pub use document::Document;
pub use expectations::{Amount, Expectations, FigureBounds, FindingBounds, NumberBounds, SignalBounds};
pub use field::{Align, FieldFiles, FieldRate, FieldReference, FieldTimes, Marker};
pub use file_kind::FileKind;
pub use frame::{Bars, Clamp, EdgeChoice, Frame, Hold, Side, Springs};
pub use grammar::Rule;
pub use hyperelastic::{Energy, Hyperelastic, Moduli};
pub use impactor::{
    BodyShape, Compound, FrictionPoint, Guide, Hinge, Impactor, ImpactorShape, MeshFile, MeshTable, MeshUnit,
    Orientation, Part,
};
pub use layers::{Layer, Layers, Prestrain};
pub use loading::*;
pub use material::{Elastic, Fabric, Fibre, Material, MountingCurve, RateCurve, Scale, Shear, Thermal};
pub use output::{Filter, Output, Post, Solver};
pub use plastic::{FlowCurve, FlowStress, HillRatios, Plastic, Voce};
pub use plausible::Implausible;
pub use reference::{Phase, Reference, Window};
pub use resolved::{Assumption, assumptions, leaves};
pub use round::Round;
pub use rupture::{Level, Rupture, RuptureCriterion};
pub use specimen::{Around, AroundChoice, Element, Meshing, Polygon, Shape, Specimen, Symmetry};
pub use tree::{Node, Table, Value, parse as parse_tree};
pub use variation::{Correlation, Method, Variation, VariedKey};
pub use viscous::{Arrhenius, PronyOf, PronyTerm, Shift, Wlf};

/// A scenario as written: the film, its loading, and what is recorded.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("not" = { "required": ["layers", "layer"] }))]
pub struct Scenario {
    /// One line that describes the scenario; the name of its file where it is left out.
    pub title: Option<String>,
    /// A scenario file whose keys this one extends and replaces; relative to this file.
    #[schemars(extend("x-path" = true))]
    pub extends: Option<PathBuf>,
    /// Key paths of the file named by `extends` that are left out, e.g. `["specimen.mesh.size"]`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unset: Vec<String>,
    /// The film: outline, material, mesh.
    pub specimen: Specimen,
    /// Number and height of layers, all of the specimen's material.
    pub layers: Option<Layers>,
    /// One entry a face, in place of `layers`: each with its own height, material, angle and mesh.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(min = 1, max = 64))]
    pub layer: Vec<Layer>,
    /// The mounting frame.
    #[serde(default)]
    pub frame: Frame,
    /// The rigid bodies that load the film, only where the loading needs them: `[impactor]`, or one `[[impactor]]` each.
    #[serde(default, deserialize_with = "impactor::one_or_several", skip_serializing_if = "Vec::is_empty")]
    #[schemars(schema_with = "impactor::one_or_several_schema")]
    pub impactor: Vec<Impactor>,
    /// The loading of the specimen.
    pub loading: Loading,
    /// Contact between faces of film.
    #[serde(default)]
    pub contact: Contact,
    /// The air around the film.
    pub air: Option<Air>,
    /// Time stepping.
    #[serde(default)]
    pub solver: Solver,
    /// What a run records.
    #[serde(default)]
    pub output: Output,
    /// A recording that the run is compared with.
    pub reference: Option<Reference>,
    /// Processing of the results.
    pub post: Option<Post>,
    /// What varies from run to run of `droptower sweep`; other commands leave it out.
    pub variation: Option<Variation>,
}
