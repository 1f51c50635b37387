//! `[reference]`: the recording that a run is compared with.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::units::{Length, Time};

/// The recording that a run is compared with.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Recording (CSV or ISO-MME). Signals from first contact on where its columns are called `acceleration_m_s2`
    /// and/or `displacement_m` (with `time_s`) and neither channel is named beside this key; anything else is the raw recording of
    /// a drop from the rest before the release on, an accelerometer and perhaps a laser, and is reduced first.
    #[schemars(extend("x-path" = true))]
    pub signals: PathBuf,
    /// Accelerometer of a raw recording; the only channel that is an acceleration where it is left out.
    pub acceleration: Option<String>,
    /// Laser of a raw recording, upward from the film's upper face; the only channel that is a length where it is
    /// left out.
    pub displacement: Option<String>,
    /// Height from which a raw recording's impactor fell. Without it the search for contact starts from the ideal fall to the run's own
    /// speed, which also closes the fall where there is no laser.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub drop_height: Option<Length>,
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
