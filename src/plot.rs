//! Diagrams as values: axes, curves, and what is marked on them. Has never heard of pages, recordings or scripts.

/// Curves over a common axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub curves: Vec<Curve>,
    /// Stretch of the x axis to be marked, and what it is.
    pub window: Option<Window>,
}

/// What an axis shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Quantity and unit, e.g. `time (ms)`.
    pub words: String,
    pub scale: Scale,
}

/// How values are laid along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    #[default]
    Linear,
    /// By decades; values that are not positive have no place.
    Logarithmic,
}

/// Points in their order; one that is not finite interrupts the curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What a legend calls it.
    pub name: String,
    /// x and y, in the units of the axes.
    pub points: Vec<[f64; 2]>,
    pub look: Look,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    #[default]
    Line,
    /// What others are held against, such as a measured curve.
    Dashed,
    /// Points without a line.
    Points,
}

/// A stretch of the x axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    pub words: String,
    /// From and to, in the unit of the axis.
    pub range: [f64; 2],
}

impl Axis {
    /// A linear axis.
    pub fn linear(words: impl Into<String>) -> Axis {
        Axis { words: words.into(), scale: Scale::Linear }
    }
}

impl Plot {
    /// A plot over linear axes without marks.
    pub fn new(title: impl Into<String>, [x, y]: [&str; 2], curves: Vec<Curve>) -> Plot {
        Plot { title: title.into(), x: Axis::linear(x), y: Axis::linear(y), curves, window: None }
    }
}

impl Curve {
    /// A line through `points`.
    pub fn line(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Curve {
        Curve { name: name.into(), points: points.into_iter().collect(), look: Look::Line }
    }

    /// The same, dashed.
    pub fn dashed(self) -> Curve {
        Curve { look: Look::Dashed, ..self }
    }
}
