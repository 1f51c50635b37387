//! The scenario language as written: one file a table, every key with its unit, range, default and
//! one sentence. The schema for editors, `droptower explain` and the validator all follow
//! from these structs. Relations between keys are checked by the model.

#[macro_use]
mod keys;
mod curve_file;
mod document;
pub mod grammar;
mod impactor;
mod loading;
mod material;
mod output;
mod resolved;
mod schema;
mod specimen;
mod tree;
mod validate;
mod variation;

use std::path::PathBuf;

pub use crate::mesh::{Element, Side};
pub use curve_file::Point;
pub use document::Document;
pub use grammar::Rule;
pub use impactor::*;
pub use loading::*;
pub use material::*;
pub use output::*;
pub use resolved::{Assumption, assumptions, is_same_value, leaves};
pub use schema::{FileKind, open as schema_for_editors};
pub use specimen::*;
pub use tree::{Assignment, Entry, Node, Table, Value, parse as parse_tree};
pub use validate::{Implausible, validate};
pub(crate) use variation::distribution_rule;
pub use variation::{Correlation, Method, Variation, VariedKey};

keys! {
    /// A scenario as written: the film, its loading, and what is recorded.
    #[schemars(extend("not" = { "required": ["layers", "layer"] }))]
    pub struct Scenario {
        /// One line that describes the scenario; the name of its file where it is left out.
        title: Option<String>;
        /// A scenario file whose keys this one extends and replaces; relative to this file.
        extends: Option<PathBuf>, path;
        /// Key paths of the file named by `extends` that are left out, e.g. `["specimen.mesh.size"]`.
        unset: Vec<String>, or empty;
        /// The film: outline, material, mesh.
        specimen: Specimen;
        /// Number and height of layers, all of the specimen's material.
        layers: Option<Layers>;
        /// One entry a face, in place of `layers`: each with its own height, material, angle and mesh.
        layer: Vec<Layer>, or empty, least 1, most 64;
        /// The mounting frame.
        frame: Frame, default;
        /// The rigid bodies that load the film, only where the loading needs them: `[impactor]`, or one `[[impactor]]` each.
        impactor: Vec<Impactor>, serde(default, deserialize_with = "impactor::one_or_several", skip_serializing_if = "Vec::is_empty"),
            schemars(schema_with = "impactor::one_or_several_schema");
        /// The loading of the specimen.
        loading: Loading;
        /// Contact between faces of film.
        contact: Contact, default;
        /// The air around the film.
        air: Option<Air>;
        /// Time stepping.
        solver: Solver, default;
        /// What a run records.
        output: Output, default;
        /// A recording that the run is compared with.
        reference: Option<Reference>;
        /// Processing of the results.
        post: Option<Post>;
        /// What varies from run to run of `droptower sweep`; other commands leave it out. Each key, in quotes, has a list of values,
        /// `{ range = ["1 m", "2 m"], count = 5 }` or a distribution: `{ uniform = [low, high] }`,
        /// `{ normal = { mean = …, deviation = … } }`, `{ lognormal = { mean = …, deviation = … } }` or
        /// `{ weibull = { scale = …, shape = … } }`, each with or without `truncate = { low = …, high = … }`.
        variation: Option<Variation>;
    }
}

impl Scenario {
    /// Number of faces of film.
    pub fn faces(&self) -> usize {
        self.layers.as_ref().map_or(1, |layers| layers.faces.len()).max(self.layer.len())
    }
}
