//! `figure.toml`: a curve in a picture of a published figure.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Amount;

/// A curve in a picture. Pixels count from the upper left corner, across and down; the first goes from 0 to 1, so that the middle of
/// the pixel that an image viewer calls 87 is at 87.5.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct Figure {
    /// A file of the same kind whose keys hold where this one has none: several curves of a figure share its axes.
    #[schemars(extend("x-path" = true))]
    pub extends: Option<PathBuf>,
    /// The picture: PNG or JPEG. Where the figure comes from belongs into a comment.
    #[schemars(extend("x-path" = true))]
    pub picture: PathBuf,
    /// The axis across.
    pub x: FigureAxis,
    /// The axis up.
    pub y: FigureAxis,
    /// The curve.
    pub curve: FigureCurve,
}

/// An axis by two of its points. The picture may be turned or sheared.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FigureAxis {
    /// Column of the table, whose name ends with its unit: "`time_s`", "`acceleration_m_s2`".
    pub column: String,
    /// Two points of the axis, best far apart.
    #[schemars(length(min = 2, max = 2))]
    pub points: Vec<AxisPoint>,
    /// Scale of the axis.
    #[serde(default)]
    pub scale: AxisScale,
}

/// A point of an axis.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct AxisPoint {
    /// Where it is in the picture, pixels across and down: the numbers that an image viewer shows, and half a pixel more for its middle.
    #[schemars(inner(range(min = 0, max = 100_000)))]
    pub pixel: [f64; 2],
    /// Value there, with its unit: "50 ms".
    pub value: Amount,
}

/// Scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum AxisScale {
    /// Equal lengths are equal differences.
    #[default]
    Linear,
    /// Equal lengths are equal ratios.
    Log,
}

/// How the curve is drawn, and where.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
pub struct FigureCurve {
    /// Colour of the curve: "#1f77b4".
    pub colour: String,
    /// Colour behind it.
    #[serde(default = "white")]
    pub background: String,
    /// How far a pixel's colour may be from those between curve and background, as a share of their distance.
    #[serde(default = "quarter")]
    #[schemars(range(min = 0.01, max = 1))]
    pub tolerance: f64,
    /// Where the curve is looked for: left, top, right, bottom in pixels. Left out, what the points of the axes span.
    #[schemars(inner(range(min = 0, max = 100_000)))]
    pub area: Option<[f64; 4]>,
    /// Parts of it that are left out, such as a legend: left, top, right, bottom in pixels.
    #[serde(default)]
    pub without: Vec<[f64; 4]>,
    /// By how much the pixels of the axes' points may be wrong, all alike or not.
    #[serde(default = "half")]
    #[schemars(range(min = 0, max = 100))]
    pub pixel_error: f64,
}

fn white() -> String {
    "#ffffff".into()
}

fn quarter() -> f64 {
    0.25
}

fn half() -> f64 {
    0.5
}
