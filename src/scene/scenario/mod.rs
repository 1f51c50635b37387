//! The scenario language as written: one file a table, every key with its unit, range, default and
//! one sentence. The schema for editors, `droptower explain` and the validator all follow
//! from these structs. Relations between keys are checked by the model.

mod curve_file;
mod document;
pub mod grammar;
mod impactor;
mod material;
mod output;
mod resolved;
mod schema;
mod specimen;
mod tree;
mod validate;
mod variation;

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::mesh::{Element, Side};
pub use curve_file::Point;
pub use document::Document;
pub use grammar::Rule;
pub use impactor::*;
pub use material::*;
pub use output::*;
pub use resolved::{Assumption, assumptions, leaves};
pub use schema::{FileKind, open as schema_for_editors};
pub use specimen::*;
pub use tree::{Assignment, Entry, Node, Table, Value, parse as parse_tree};
pub use validate::{Implausible, validate};
pub use variation::{Correlation, Method, Variation, VariedKey};

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
    /// What varies from run to run of `droptower sweep`; other commands leave it out. Each key, in quotes, has a list of values,
    /// `{ range = ["1 m", "2 m"], count = 5 }` or a distribution: `{ uniform = [low, high] }`,
    /// `{ normal = { mean = …, deviation = … } }`, `{ lognormal = { mean = …, deviation = … } }` or
    /// `{ weibull = { scale = …, shape = … } }`, each with or without `truncate = { low = …, high = … }`.
    pub variation: Option<Variation>,
}

impl Scenario {
    /// Number of faces of film.
    pub fn faces(&self) -> usize {
        self.layers.as_ref().map_or(1, |layers| layers.faces.len()).max(self.layer.len())
    }
}
