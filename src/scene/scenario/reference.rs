//! `[reference]`: the recording and the field that a run is compared with.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::field::FieldReference;
use base::units::{Force, Length, Time, Velocity};

/// The recording that a run is compared with: signals, a displacement field, or both.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Recording (table, ISO-MME, TDMS, …): signals from first contact on where it has the columns `acceleration_m_s2` and/or
    /// `displacement_m` (with `time_s`) and neither `acceleration` nor `displacement` is given; anything else is the
    /// raw recording of a drop, from the rest before the release on, by an accelerometer and possibly a laser, and is
    /// reduced first.
    #[schemars(extend("x-path" = true))]
    pub signals: Option<PathBuf>,
    /// Displacement field of a face of film, measured by digital image correlation.
    pub field: Option<FieldReference>,
    /// Name of the impactor that it was recorded of, of several; the first where it is left out.
    pub impactor: Option<String>,
    /// Accelerometer of a raw recording; the only channel that is an acceleration where it is left out.
    pub acceleration: Option<String>,
    /// Laser of a raw recording, upward from the film's upper face; the only channel that is a length where it is
    /// left out.
    pub displacement: Option<String>,
    /// Drop height of a raw recording. Where neither height, speed nor time of contact is given, the impactor is taken to
    /// have reached the impact velocity of the run.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub drop_height: Option<Length>,
    /// Standard deviation of the drop height; half a per cent of it where it is left out.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub height_error: Option<Length>,
    /// Impact speed of a raw recording where it is known.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub speed: Option<Velocity>,
    /// Standard deviation of the impact speed: of that of a raw recording where it is given (half a per cent where it is left out),
    /// else of signals that count from first contact (none). A calibration takes it up.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub speed_error: Option<Velocity>,
    /// Time of first contact on the clock of a raw recording where it is known.
    pub contact_time: Option<Time>,
    /// Standard deviation of the time of first contact: of that of a raw recording where it is given (half a sample where it is
    /// left out), else of signals that count from first contact (none). A calibration takes it up.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub contact_error: Option<Time>,
    /// Time constant of the coupling of the accelerometer of a raw recording where it is known.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time_constant: Option<Time>,
    /// Friction of the guide of a raw recording and its standard deviation where they are known.
    pub guide_friction: Option<[Force; 2]>,
    /// Window of the errors: the loading phase, the whole recording, or from–to. Without signals, the loading phase is the
    /// whole run.
    #[serde(default)]
    pub window: Window,
}

/// Window of the errors. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Window {
    /// A named part.
    Phase(Phase),
    /// From, to.
    Range([Time; 2]),
}

impl Default for Window {
    fn default() -> Window {
        Window::Phase(Phase::Loading)
    }
}

/// A named part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// From first contact to the largest displacement of the reference.
    Loading,
    /// The whole recording.
    All,
}
