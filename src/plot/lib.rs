//! Diagrams as values: axes, curves, and what is marked on them; their pictures.
#![warn(missing_docs)]

mod braille;
mod picture;
mod style;
pub mod viridis;

pub use braille::braille;
pub use picture::{Along, svg, svg_in};
pub use style::Style;

use serde::{Deserialize, Serialize};

/// Label of an axis of time.
pub const TIME: &str = "time (ms)";

/// Curves over a common axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Heading of the plot.
    pub title: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// In the order of the legend.
    pub curves: Vec<Curve>,
    /// Interval of the x axis that is marked.
    pub window: Option<Window>,
    /// Places on the x axis that are marked, in their order; those beyond the curves are not drawn.
    pub marks: Vec<Mark>,
}

/// Quantity and scale of an axis.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// Quantity and unit, e.g. `time (ms)`.
    #[serde(rename = "words")]
    pub label: String,
    /// Linear or logarithmic.
    #[serde(rename = "log")]
    pub scale: Scale,
}

/// How values are laid along an axis; it is serialized as whether it is logarithmic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "bool", into = "bool")]
pub enum Scale {
    /// In proportion.
    #[default]
    Linear,
    /// By decades; values that are not positive have no place.
    Logarithmic,
}

impl Scale {
    /// A value on it: its logarithm on a logarithmic one.
    fn along(self, value: f64) -> f64 {
        if self == Scale::Logarithmic { value.log10() } else { value }
    }
}

impl From<bool> for Scale {
    fn from(is_logarithmic: bool) -> Scale {
        if is_logarithmic { Scale::Logarithmic } else { Scale::Linear }
    }
}

impl From<Scale> for bool {
    fn from(scale: Scale) -> bool {
        scale == Scale::Logarithmic
    }
}

/// Points in their order; one that is not finite interrupts the curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// x and y, in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// Solid, dashed, or points alone.
    pub look: Look,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Look {
    /// A solid line through the points.
    #[default]
    Line,
    /// A dashed line, for a curve that others are compared with, such as a measured one.
    Dashed,
    /// Points without a line.
    Points,
}

/// An interval of the x axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Label of the interval.
    #[serde(rename = "words")]
    pub label: String,
    /// From and to, in the unit of the axis.
    pub range: [f64; 2],
}

/// A place on the x axis, such as the time of an event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// The event.
    #[serde(rename = "words")]
    pub label: String,
    /// In the unit of the axis.
    pub at: f64,
}

/// Correlation matrix of parameters: square and symmetric.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlation {
    /// Heading of the matrix.
    pub title: String,
    /// Of rows and columns.
    pub names: Vec<String>,
    /// Rows of numbers from −1 to 1.
    pub rows: Vec<Vec<f64>>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>) -> Axis {
        Axis { label: label.into(), scale: Scale::Linear }
    }

    /// Whether the axis has a place for `value`: beyond [`SIZES`] the length of an axis would overflow.
    fn has_place(&self, value: f64) -> bool {
        let size = value.abs();
        let is_zero = size == 0.0 && self.scale == Scale::Linear;
        is_zero || ((SIZES[0]..=SIZES[1]).contains(&size) && (self.scale == Scale::Linear || value > 0.0))
    }
}

/// Sizes of the values, other than zero, that axes have a place for.
const SIZES: [f64; 2] = [1e-300, 1e300];

impl Plot {
    /// A plot over linear axes without marks.
    pub fn new(title: impl Into<String>, [x, y]: [&str; 2], curves: Vec<Curve>) -> Plot {
        let (x, y) = (Axis::linear(x), Axis::linear(y));
        Plot { title: title.into(), x, y, curves, window: None, marks: vec![] }
    }

    /// Whether a point can be drawn on the axes.
    pub fn has_place(&self, [x, y]: &[f64; 2]) -> bool {
        self.x.has_place(*x) && self.y.has_place(*y)
    }
}

impl Curve {
    /// A line through `points`.
    pub fn line(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Curve {
        Curve { name: name.into(), points: points.into_iter().collect(), look: Look::Line }
    }

    /// The curve, dashed.
    pub fn dashed(self) -> Curve {
        Curve { look: Look::Dashed, ..self }
    }

    /// The curve through the [outline] of its points.
    pub fn thinned(&self, most: usize) -> Curve {
        Curve { name: self.name.clone(), points: outline(&self.points, most), look: self.look }
    }
}

/// At most `most` points, 5 at least: the ends, and of every stretch between them the lowest, the highest and the first
/// gap.
pub fn outline(points: &[[f64; 2]], most: usize) -> Vec<[f64; 2]> {
    match points {
        [first, between @ .., last] if points.len() > most => {
            let stretch = between.len().div_ceil((most.saturating_sub(2) / 3).max(1));
            let between = between.chunks(stretch).flat_map(extremes);
            [*first].into_iter().chain(between).chain([*last]).collect()
        }
        _ => points.to_vec(),
    }
}

/// The plots with at most `most` points together, but 3 a curve at least: long curves are thinned, all to the same
/// number of points.
pub fn thinned(plots: Vec<Plot>, most: usize) -> Vec<Plot> {
    let [plots] = thinned_together([plots], most);
    plots
}

/// As [`thinned`], of all groups of plots together.
pub fn thinned_together<const N: usize>(groups: [Vec<Plot>; N], most: usize) -> [Vec<Plot>; N] {
    let curves = groups.iter().flatten().flat_map(|plot| &plot.curves);
    let share = share(curves.map(|curve| curve.points.len()).collect(), most);
    let thin = |plot: Plot| Plot { curves: plot.curves.iter().map(|curve| curve.thinned(share)).collect(), ..plot };
    groups.map(|plots| plots.into_iter().map(thin).collect())
}

/// Share of each so that all together have `most`: those that have less leave the rest to the others.
fn share(mut lengths: Vec<usize>, most: usize) -> usize {
    lengths.sort_unstable();
    let (mut left, count) = (most, lengths.len());
    for (place, length) in lengths.into_iter().enumerate() {
        let share = left / (count - place);
        if length > share {
            return share;
        }
        left -= length;
    }
    usize::MAX
}

/// The lowest and the highest point, and one that interrupts the curve where there is such a one.
fn extremes(stretch: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let finite = || (0..stretch.len()).filter(|place| stretch[*place].iter().all(|value| value.is_finite()));
    let by_height = |a: &usize, b: &usize| stretch[*a][1].total_cmp(&stretch[*b][1]);
    let gap = stretch.iter().position(|point| !point.iter().all(|value| value.is_finite()));
    let mut places: Vec<usize> =
        [finite().min_by(by_height), finite().max_by(by_height), gap].into_iter().flatten().collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|place| stretch[place]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plots_share_their_points() {
        let plot = |count: usize| {
            let points = (0..count).map(|i| [i as f64, (i as f64).sin()]);
            Plot::new("a", ["x", "y"], vec![Curve::line("c", points)])
        };
        let counts = |lengths: &[usize], most| {
            let plots = thinned(lengths.iter().map(|length| plot(*length)).collect(), most);
            plots.iter().map(|plot| plot.curves[0].points.len()).collect::<Vec<_>>()
        };
        assert_eq!(counts(&[10, 2000], 2010), [10, 2000]);
        let shared = counts(&[10, 2000, 3000], 1010);
        assert!(shared[0] == 10 && shared[1..].iter().all(|count| (300..=500).contains(count)), "{shared:?}");
    }

    #[test]
    fn thinning_keeps_extremes_their_order_and_gaps() {
        // A loop: x goes forth and back.
        let angle = |i: usize| i as f64 * 1e-3 * std::f64::consts::TAU;
        let mut points: Vec<[f64; 2]> = (0..1000).map(|i| [angle(i).cos(), angle(i).sin()]).collect();
        points[321][1] = 7.0;
        points[654][1] = -7.0;
        points[800][1] = f64::NAN;
        let thin = Curve::line("loop", points.clone()).thinned(100);
        assert!(thin.points.len() <= 100 && thin.points.contains(&points[321]) && thin.points.contains(&points[654]));
        assert_eq!(thin.points.iter().filter(|point| point[1].is_nan()).count(), 1);
        assert_eq!([thin.points[0], thin.points[thin.points.len() - 1]], [points[0], points[999]]);
        let mut rest = points.iter();
        let is_next = |point: &[f64; 2]| rest.any(|other| other[0] == point[0]);
        assert!(thin.points.iter().all(is_next));
    }
}
