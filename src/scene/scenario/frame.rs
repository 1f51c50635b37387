//! `[frame]`: the mounting frame.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::round::Round;
use base::units::{Force, Length, Stiffness};

/// The mounting frame.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
pub struct Frame {
    /// Clamped edges: all of them, none, or the sides listed. Under `loading.stretch` the jaws clamp the sides
    /// x- and x+, and no other edge can be clamped.
    #[schemars(extend("default" = "all"))]
    pub hold: Option<Hold>,
    /// Bars along the held edges, over which film bends: the edge lies on their crest. Between two faces they are as high as
    /// these are apart. Impactors that reach them meet them. Left out, the frame has no thickness.
    pub bars: Option<Bars>,
    /// A clamp in which film slips; left out, it is held.
    pub clamp: Option<Clamp>,
    /// Springs on which film hangs, between its held edges and the frame; left out, these edges are fixed.
    pub springs: Option<Springs>,
}

/// Bars along the held edges of film.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Bars {
    /// Of the bars, over which film bends.
    #[serde(flatten)]
    pub round: Round<50>,
    /// Coulomb coefficient between bars and film; between bars and an impactor the smaller of theirs.
    #[schemars(range(min = 0, max = 10), extend("x-likely" = [1e-3, 2.0]))]
    pub friction: f64,
}

/// A clamp in which film slips.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Clamp {
    /// Force with which the clamp presses on each face of film, along all of its held edges together.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-2, 1e6]))]
    pub force: Force,
    /// Coulomb coefficient between the clamp and each side of the film.
    #[schemars(range(max = 10), extend("exclusiveMinimum" = 0, "x-likely" = [1e-3, 2.0]))]
    pub friction: f64,
    /// Length of film within the clamp, after which it has slipped out of it; left out, it never does.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-4, 1.0]))]
    pub width: Option<Length>,
}

/// Linear springs between the held edges of film and the frame: each points outward, in the plane of the film and across its
/// edge. One that is shorter than without force is slack.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Springs {
    /// Stiffness of one spring.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1.0, 1e9]))]
    pub stiffness: Stiffness,
    /// Number of springs along the held edges of the whole film, of each face, evenly along each stretch of them and round
    /// its corners.
    #[schemars(range(min = 1, max = 100_000))]
    pub count: u32,
    /// Distance from the edge of film, as it is mounted, to the frame.
    #[schemars(extend("exclusiveMinimum" = 0, "x-likely" = [1e-4, 10.0]))]
    pub length: Length,
    /// Force of one spring at that length; left out, what the pre-strain of the film pulls with across its edge.
    #[schemars(range(min = 0), extend("x-likely" = [1e-3, 1e6]))]
    pub preload: Option<Force>,
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
