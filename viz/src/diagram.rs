//! Curves over an axis of their own, drawn as lines in a plane: the viewer's time series know timelines only.
//!
//! The plane is a box of [`WIDTH`] by one with y down, as the viewer has it.

use re_sdk::{RecordingStream, RecordingStreamResult};
use re_sdk_types::AsComponents;
use re_sdk_types::archetypes::{Boxes2D, LineStrips2D, Points2D};
use re_sdk_types::components::Radius;

use crate::quantity::{GREY, NUMBERS, Stroke};
use plot::{Along, Curve, Look, Plot, Window};

/// Width of the box that curves are drawn in over its height.
pub(crate) const WIDTH: f64 = 1.6;

/// Visible part of the plane, across and down: the box with its labels and legend.
pub(crate) const BOUNDS: [[f64; 2]; 2] = [[-0.2, WIDTH + 0.6], [-0.12, 1.2]];

/// Entity of the diagram of this index.
pub(crate) fn entity(index: usize) -> String {
    format!("plots/{index}")
}

/// Lengths of a dash and of the gap after it, in heights of the box.
const DASH: [f64; 2] = [0.03, 0.02];

/// Length of a tick, and distances of labels from the box, in heights of it. The viewer centres a label below its
/// point.
const TICK: f64 = 0.015;
const BELOW: [f64; 2] = [0.02, 0.10];
const LEFT: f64 = 0.07;
const LABEL: f64 = 0.03;

/// Distance of the legend from the box, and of its lines from each other.
const LEGEND: [f64; 2] = [0.3, 0.08];

/// A point of the viewer's plane: across, down.
type Point = [f32; 2];

/// Logs border, ticks, legend and all curves of the diagram of this index.
pub(crate) fn log(stream: &RecordingStream, index: usize, plot: &Plot) -> RecordingStreamResult<()> {
    let page = Page::from_plot(plot);
    let entity = |part: &str| format!("{}/{part}", entity(index));
    stream.log_static(entity("frame"), &page.border())?;
    stream.log_static(entity("labels"), &page.labels())?;
    stream.log_static(entity("legend"), &legend(plot))?;
    if let Some(window) = &plot.window {
        let [from, to] = page.ends(window);
        stream.log_static(entity("window"), &outline([from, to]))?;
        let label = (place(0.5 * (from + to), 0.99), window.label.clone());
        stream.log_static(entity("window/words"), &texts([label].into_iter(), [GREY]))?;
    }
    for (index, curve) in plot.curves.iter().enumerate() {
        stream.log_static(entity(&format!("curves/{index}")), page.drawn(curve, stroke(curve, index)).as_ref())?;
    }
    Ok(())
}

/// A plot and the values along its axes.
struct Page<'a> {
    plot: &'a Plot,
    x: Along,
    y: Along,
}

impl Page<'_> {
    fn from_plot(plot: &Plot) -> Page<'_> {
        Page { plot, x: Along::from_plot(plot, 0, NUMBERS), y: Along::from_plot(plot, 1, NUMBERS) }
    }

    fn point_at(&self, point: &[f64; 2]) -> Option<Point> {
        self.plot.has_place(point).then(|| place(self.x.share(point[0]), self.y.share(point[1])))
    }

    /// The box and its ticks.
    fn border(&self) -> LineStrips2D {
        let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]].map(|[x, y]| place(x, y)).to_vec();
        let below = self.x.ticks().into_iter().map(|(x, _)| vec![place(x, 0.0), place(x, -TICK)]);
        let left = self.y.ticks().into_iter().map(|(y, _)| vec![place(0.0, y), place(-TICK / WIDTH, y)]);
        let strips: Vec<_> = std::iter::once(outline).chain(below).chain(left).collect();
        LineStrips2D::new(strips).with_colors([GREY]).with_radii([Radius::new_ui_points(0.5)])
    }

    /// Numbers at the ticks and the labels of both axes.
    fn labels(&self) -> Points2D {
        let Plot { x, y, .. } = self.plot;
        let below = self.x.ticks().into_iter().map(|(x, words)| (place(x, -BELOW[0]), words));
        let left = self.y.ticks().into_iter().map(|(y, words)| (place(-LEFT / WIDTH, y + LABEL), words));
        let across = (place(0.5, -BELOW[1]), x.label.clone());
        let up = (place(0.0, 1.0 + 4.0 * LABEL), y.label.clone());
        texts(below.chain(left).chain([across, up]), [GREY])
    }

    /// Shares of the axis across at which a window begins and ends.
    fn ends(&self, window: &Window) -> [f64; 2] {
        // A logarithmic axis has no place for zero.
        let share = |end| Some(self.x.share(end)).filter(|share| !share.is_nan());
        window.range.map(|end| share(end).unwrap_or(0.0).clamp(0.0, 1.0))
    }

    fn drawn(&self, curve: &Curve, stroke: Stroke) -> Box<dyn AsComponents> {
        let radius = Radius::new_ui_points(0.5 * stroke.width);
        if curve.look == Look::Points {
            let points = curve.points.iter().filter_map(|point| self.point_at(point));
            let radius = Radius::new_ui_points(1.5 * stroke.width);
            return Box::new(Points2D::new(points).with_colors([stroke.colour]).with_radii([radius]));
        }
        let whole = strips(curve.points.iter().map(|point| self.point_at(point)));
        let strips = match curve.look {
            Look::Dashed => whole.iter().flat_map(|strip| dashes(strip)).collect(),
            _ => whole,
        };
        Box::new(LineStrips2D::new(strips).with_colors([stroke.colour]).with_radii([radius]))
    }
}

/// The outline of an interval of the axis across, at full height.
fn outline([from, to]: [f64; 2]) -> Boxes2D {
    let half_width = (0.5 * (to - from) * WIDTH) as f32;
    Boxes2D::from_centers_and_half_sizes([place(0.5 * (from + to), 0.5)], [[half_width, 0.5]])
        .with_colors([GREY])
        .with_radii([Radius::new_ui_points(0.5)])
}

/// The point of the viewer's plane at shares of both axes.
fn place(x: f64, y: f64) -> Point {
    [(x * WIDTH) as f32, (1.0 - y) as f32]
}

fn stroke(curve: &Curve, index: usize) -> Stroke {
    match curve.look {
        Look::Dashed => Stroke { width: Stroke::nth(0).width, ..Stroke::target() },
        _ => Stroke::nth(index),
    }
}

/// The names of the curves in their colours, in a column right of the box.
fn legend(plot: &Plot) -> Points2D {
    let entry = |(index, curve): (usize, &Curve)| {
        (place(1.0 + LEGEND[0] / WIDTH, 1.0 - LEGEND[1] * index as f64), curve.name.clone())
    };
    let curves = || plot.curves.iter().enumerate();
    let colours: Vec<[u8; 3]> = curves().map(|(index, curve)| stroke(curve, index).colour).collect();
    texts(curves().map(entry), colours)
}

/// Labels at invisible points.
fn texts(labels: impl Iterator<Item = (Point, String)>, colours: impl IntoIterator<Item = [u8; 3]>) -> Points2D {
    let (points, words): (Vec<Point>, Vec<String>) = labels.unzip();
    Points2D::new(points)
        .with_labels(words)
        .with_show_labels(true)
        .with_colors(colours)
        .with_radii([Radius::new_ui_points(0.0)])
}

/// Runs of points without a gap.
fn strips(points: impl Iterator<Item = Option<Point>>) -> Vec<Vec<Point>> {
    let mut strips = vec![vec![]];
    for point in points {
        match (point, strips.last_mut()) {
            (Some(point), Some(strip)) => strip.push(point),
            _ => strips.push(vec![]),
        }
    }
    strips.retain(|strip| strip.len() > 1);
    strips
}

/// A line cut into dashes of equal length along it.
fn dashes(strip: &[Point]) -> Vec<Vec<Point>> {
    let mut dashes: Vec<Vec<Point>> = vec![strip.first().copied().into_iter().collect()];
    let (mut drawn, mut left) = (true, DASH[0]);
    for pair in strip.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(|point| point.map(f64::from));
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut covered = 0.0;
        while length - covered > left {
            covered += left;
            let at = [0, 1].map(|k| (from[k] + covered / length * (to[k] - from[k])) as f32);
            match (drawn, dashes.last_mut()) {
                (true, Some(dash)) => dash.push(at),
                _ => dashes.push(vec![at]),
            }
            drawn = !drawn;
            left = DASH[usize::from(!drawn)];
        }
        left -= length - covered;
        if let Some(dash) = dashes.last_mut().filter(|_| drawn) {
            dash.push(pair[1]);
        }
    }
    dashes.retain(|dash| dash.len() > 1);
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_are_of_equal_length_around_corners() {
        let length = |dash: &[Point]| {
            let legs = dash.windows(2).map(|p| f64::from((p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])));
            legs.sum::<f64>()
        };
        let corner = dashes(&[[0.0, 0.0], [0.115, 0.0], [0.115, 0.125]]);
        assert_eq!(corner.len(), 5);
        for dash in &corner {
            assert!((length(dash) - DASH[0]).abs() < 1e-6, "{dash:?}");
        }
        assert_eq!(corner[2].len(), 3, "the third dash has a corner");
    }

    #[test]
    fn a_gap_in_the_points_is_a_gap_in_the_line() {
        let points =
            [Some([0.0, 0.0]), Some([1.0, 0.0]), None, Some([2.0, 0.0]), None, Some([3.0, 0.0]), Some([4.0, 0.0])];
        let strips = strips(points.into_iter());
        assert_eq!(strips, [vec![[0.0, 0.0], [1.0, 0.0]], vec![[3.0, 0.0], [4.0, 0.0]]]);
    }
}
