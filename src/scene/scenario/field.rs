//! `[reference.field]`: the displacement field that a run is compared with.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::impactor::MeshUnit;
use base::units::{Frequency, Length, Time};

/// A displacement field over time, measured by digital image correlation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FieldReference {
    /// Its files, one per image, in the order of the numbers in their names: a folder, a pattern such as `"dic/*.csv"`, or a
    /// list. Exports of VIC-3D, MatchID, ARAMIS and DICe with undeformed places and displacements in space.
    pub files: FieldFiles,
    /// When they were recorded, on the time axis of the run: a table with a column of time, a list, or a rate.
    pub times: FieldTimes,
    /// Unit of places and displacements where a file states none.
    pub unit: Option<MeshUnit>,
    /// Number of the face that was measured, counted from the first that comes into contact.
    #[serde(default = "first")]
    #[schemars(range(min = 1, max = 64))]
    pub face: u32,
    /// Rigid motion from the axes of the field to those of the run.
    #[serde(default)]
    pub align: Align,
}

fn first() -> u32 {
    1
}

/// The files of a field. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FieldFiles {
    /// A folder, a pattern or a single file.
    Pattern(#[schemars(extend("x-path" = true))] PathBuf),
    /// Every file.
    List(#[schemars(schema_with = "paths")] Vec<PathBuf>),
}

/// A list of paths.
fn paths(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({ "type": "array", "items": { "type": "string", "x-path": true }, "minItems": 1 })
}

/// The times of the files of a field.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FieldTimes {
    /// A table with a column of time.
    Table(#[schemars(extend("x-path" = true))] PathBuf),
    /// A time for every file.
    List(#[schemars(length(min = 1))] Vec<Time>),
    /// A constant rate.
    Rate(FieldRate),
}

/// Images at a constant rate.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FieldRate {
    /// Images per second.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate: Frequency,
    /// Time of the first file.
    #[serde(default = "at_once")]
    pub start: Time,
}

fn at_once() -> Time {
    Time(0.0)
}

/// How a field is brought into the axes of the run.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Align {
    /// By the rigid motion for which its places lie on the undeformed film and its displacements are closest to those of
    /// the run.
    #[default]
    Rigid,
    /// Its axes are those of the run.
    None,
    /// By the rigid motion that brings at least three points of it onto points of the undeformed film.
    Markers(#[schemars(length(min = 3))] Vec<Marker>),
}

/// A point in the axes of the field and in those of the run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Marker {
    /// x, y, z in the axes of the field.
    pub field: [Length; 3],
    /// x, y, z in those of the run.
    pub film: [Length; 3],
}
