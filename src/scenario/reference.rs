//! `[reference]`: the recording that a run is compared with.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::units::Time;

/// The recording that a run is compared with.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// CSV file with `time_s` and `acceleration_m_s2` and/or `displacement_m`.
    #[schemars(extend("x-path" = true))]
    pub signals: PathBuf,
    /// Part of the run that errors are taken over: the loading phase, all of it, or from–to.
    #[serde(default)]
    pub window: Window,
}

/// Part of a run. The validator has already said where a mistake is when serde tries the two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Window {
    Phase(Phase),
    Range([Time; 2]),
}

impl Default for Window {
    fn default() -> Window {
        Window::Phase(Phase::Loading)
    }
}

/// A part of a run that has a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// From first contact to the largest displacement of the reference.
    Loading,
    /// The whole recording.
    All,
}
