//! Curves over an axis of their own, drawn as lines in a plane: the viewer's time series know timelines only.
//!
//! The plane is a box of [`WIDTH`] by one with y down, as the viewer has it.

mod draw;
mod ticks;

pub(crate) use draw::log;
pub(crate) use ticks::Scale;

/// Width of the box that curves are drawn in over its height.
pub(crate) const WIDTH: f64 = 1.6;

/// Visible part of the plane, across and down: the box with its labels and legend.
pub(crate) const BOUNDS: [[f64; 2]; 2] = [[-0.2, WIDTH + 0.6], [-0.12, 1.2]];

/// A diagram of curves.
#[derive(Clone, Debug)]
pub struct Diagram {
    /// Entity path, e.g. `diagrams/force`; no part of it is the path of another diagram.
    pub path: String,
    /// Title above it.
    pub title: String,
    /// Across and up.
    pub axes: [Axis; 2],
    /// In the order of the legend.
    pub curves: Vec<Curve>,
    /// The marked stretch of the axis across, if there is one.
    pub window: Option<Window>,
}

/// A stretch of the axis across to be marked.
#[derive(Clone, Debug)]
pub struct Window {
    /// Its label.
    pub label: String,
    /// Its ends, in the unit of the axis.
    pub ends: [f64; 2],
}

/// An axis of a diagram.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Logarithmic; values that are not positive are not drawn.
    pub logarithmic: bool,
}

/// Points in their order; one that is not finite interrupts the curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Label in the legend.
    pub name: String,
    /// Across and up, in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub look: Look,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A continuous line.
    Line,
    /// A reference.
    Dashed,
    /// Points without a line.
    Points,
}
