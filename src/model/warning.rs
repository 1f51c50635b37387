//! Warnings about a scenario that is valid but hardly meant.

use std::fmt;
use std::path::Path;

use serde_json::{Map, Value};

use super::Model;
use crate::finding::{Code, Report, codes};
use crate::mesh::import;
use crate::number::significant;
use crate::scenario::{Document, Implausible};

codes! {
    IMPLAUSIBLE_VALUE = "implausible-value", Warning,
        "a value of the scenario, or the extent of a mesh, is far from what such tests have",
        "check its unit: a bare number is in the SI unit, coordinates of meshes are in m; no change is needed where it is meant";
}

/// Largest extent of a mesh that is likely, m.
const LARGEST_MESH: f64 = 10.0;

/// Longest mesh file whose extent is checked, bytes.
const LONGEST_MESH: u64 = 64 << 20;

/// What is hardly meant in a scenario.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// A value is outside its likely range.
    Value(Implausible),
    /// A mesh is as large as if its coordinates were in another unit.
    Extent {
        /// Path of the key that names the file.
        key: &'static str,
        /// Largest extent along x, y or z, m.
        extent: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::Value(Implausible { key, found, likely, meant, .. }) => {
                write!(f, "`{key}` is {found}, which is implausible: usual are {likely}")?;
                meant.iter().try_for_each(|meant| write!(f, "; did you mean \"{meant}\"?"))
            }
            Warning::Extent { key, extent } => {
                let metres = significant(*extent, 3);
                write!(f, "the mesh of `{key}` is {metres} m wide, which is implausible; did you mean {metres} mm? ")?;
                write!(f, "coordinates are read in m: scale the file by 0.001")
            }
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        &IMPLAUSIBLE_VALUE
    }

    fn figures(&self) -> Map<String, Value> {
        let figures: [(&str, Value); 2] = match self {
            Warning::Value(value) => [("key", value.key.as_str().into()), ("value", value.value.into())],
            Warning::Extent { key, extent } => [("key", (*key).into()), ("extent_m", (*extent).into())],
        };
        figures.map(|(name, value)| (name.into(), value)).into_iter().collect()
    }
}

/// What is hardly meant in the scenario `document`, which was checked to be `model`.
pub fn warnings(document: &Document, model: &Model) -> Vec<Warning> {
    let values = document.implausible().into_iter().map(Warning::Value);
    values.chain(model.meshes().filter_map(|(key, path)| wide(key, path))).collect()
}

/// The warning of a mesh that is too wide. A file that cannot be read is a mistake of its own.
fn wide(key: &'static str, path: &Path) -> Option<Warning> {
    let length = std::fs::metadata(path).ok()?.len();
    let extent = (length <= LONGEST_MESH).then(|| import::extent(path).ok()).flatten()?;
    (extent > LARGEST_MESH).then_some(Warning::Extent { key, extent })
}
