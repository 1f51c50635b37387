//! `[frame]`: the mounting frame.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The mounting frame.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-future" = {
    "bars": "the frame has no thickness", "clamp": "clamped edges do not slip: `hold` names them"
}))]
pub struct Frame {
    /// Clamped edges: all of them, none, or the sides listed. Under `loading.stretch` the jaws clamp the sides
    /// x- and x+, and no other edge can be clamped.
    #[schemars(extend("default" = "all"))]
    pub hold: Option<Hold>,
}

/// Clamped edges. The validator has reported mistakes before serde tries the two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Hold {
    /// All edges or none.
    Word(EdgeChoice),
    /// The sides listed.
    Sides(#[schemars(length(min = 1, max = 4))] Vec<Side>),
}

/// All edges or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum EdgeChoice {
    /// Every edge is clamped.
    All,
    /// No edge is clamped.
    None,
}

/// A straight edge of a rectangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Side {
    /// The side at the smallest x.
    #[serde(rename = "x-")]
    XMinus,
    /// The side at the largest x.
    #[serde(rename = "x+")]
    XPlus,
    /// The side at the smallest y.
    #[serde(rename = "y-")]
    YMinus,
    /// The side at the largest y.
    #[serde(rename = "y+")]
    YPlus,
}
