//! The curve as values, each with its error.

use super::trace::trace;
use super::{Figure, Trace, TraceError, Warning};

/// Points to either side that a point is compared with, for the scatter of the trace.
const NEIGHBOURS: usize = 3;

/// A normal deviation over the median distance from the middle.
const NORMAL_FROM_MEDIAN: f64 = 1.4826;

/// Share of its length over which the curve may be missing.
const MISSING: f64 = 0.03;

/// Share of what has its colour that may be elsewhere.
const ELSEWHERE: f64 = 0.25;

/// Share of the x axis that it must cover.
const COVERED: f64 = 0.5;

/// A curve that was read out of a picture.
#[derive(Clone, Debug)]
pub struct Digitized {
    /// Values across and up, SI, in rising order across.
    pub points: Vec<[f64; 2]>,
    /// Half the width of the interval in which a value up lies with 95 %, one a point.
    pub errors: Vec<f64>,
    /// The curve in pixels.
    pub trace: Trace,
    /// Scatter of the trace, pixels.
    pub scatter: f64,
    /// Doubts about the curve.
    pub warnings: Vec<Warning>,
}

/// Reads the curve of a figure out of its picture.
///
/// # Errors
/// Nothing has its colour, or too much.
pub fn digitize(figure: &Figure) -> Result<Digitized, TraceError> {
    let is_left_out = |at: [f64; 2]| figure.without.iter().any(|area| holds(*area, at));
    let pixel = |column: usize, row: usize| {
        let middle = [column as f64 + 0.5, row as f64 + 0.5];
        (!is_left_out(middle)).then(|| figure.colour(column, row))
    };
    let [left, top, right, bottom] = figure.area;
    let found = trace([left..right, top..bottom], &figure.ink, pixel)?;
    let scatter = scatter(&found.points).max(figure.least_scatter);
    let mut points: Vec<([f64; 2], f64)> = Vec::with_capacity(found.points.len());
    for (place, pixel) in found.points.iter().enumerate() {
        points.push((figure.axes.values(*pixel), error(figure, &found, place, scatter)));
    }
    points.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
    let (points, errors) = points.into_iter().unzip();
    let warnings = warnings(figure, &found);
    Ok(Digitized { points, errors, trace: found, scatter, warnings })
}

fn holds([left, top, right, bottom]: [f64; 4], [x, y]: [f64; 2]) -> bool {
    (left..=right).contains(&x) && (top..=bottom).contains(&y)
}

/// The scatter of the trace about itself: half the second difference of a smooth curve is small.
fn scatter(points: &[[f64; 2]]) -> f64 {
    let mut distances: Vec<f64> = points
        .windows(3)
        .filter(|three| three[2][0] - three[0][0] == 2.0)
        .map(|three| (three[1][1] - three[0][1].midpoint(three[2][1])).abs())
        .collect();
    distances.sort_unstable_by(f64::total_cmp);
    // Of independent points with deviation s, this difference has the deviation s √1.5.
    let median = distances.get(distances.len() / 2).copied().unwrap_or(0.0);
    NORMAL_FROM_MEDIAN * median / 1.5_f64.sqrt()
}

/// Half the width of the interval of a value up: from the scatter of the trace, and from the points of the axes, whose error
/// grows beyond them; an error across counts by the slope of the curve. Both points of an axis, and both axes, may be off alike, as where
/// the corner of a pixel was taken for its middle: such errors add up. Where another curve hides a part of the line, its
/// middle is uncertain by half of what is hidden, and where it turns within its width, by a part of that.
fn error(figure: &Figure, trace: &Trace, place: usize, scatter: f64) -> f64 {
    let points = &trace.points;
    let hidden = 0.5 * (trace.thickness - trace.covered[place]).max(0.0);
    let near = &points[place.saturating_sub(NEIGHBOURS)..(place + NEIGHBOURS + 1).min(points.len())];
    let [first, last] = [near[0], near[near.len() - 1]];
    let [from, to] = [first, last].map(|pixel| figure.axes.values(pixel));
    let steep = if to[0] == from[0] { 0.0 } else { (to[1] - from[1]) / (to[0] - from[0]) };
    let pixel = points[place];
    let slopes = figure.axes.slopes(pixel);
    let places = figure.axes.places(pixel);
    let of_axis = |index: usize| figure.pixel_error * ((1.0 - places[index]).abs() + places[index].abs());
    let length = |index: usize| slopes[index][0].hypot(slopes[index][1]);
    let of_points = of_axis(0) * length(0) * steep.abs() + of_axis(1) * length(1);
    // Two deviations of a normal scatter are 95 %.
    let of_both = of_points.hypot(2.0 * scatter * slopes[1][1]);
    of_both + (hidden + trace.doubts[place]) * slopes[1][1].abs()
}

fn warnings(figure: &Figure, found: &Trace) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let (Some(first), Some(last)) = (found.points.first(), found.points.last()) else {
        return warnings;
    };
    let length = (last[0] - first[0]).max(1.0);
    let missing: f64 = found.gaps.iter().map(|[from, to]| to - from - 1.0).sum();
    let longest = found.gaps.iter().max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    if let Some([from, to]) = longest.filter(|_| missing / length > MISSING) {
        let at = |column: f64| {
            let point = found.points.iter().find(|point| point[0] == column);
            point.map_or(f64::NAN, |point| figure.axes.values(*point)[0])
        };
        warnings.push(Warning::Interrupted { share: missing / length, from: at(*from), to: at(*to) });
    }
    if found.elsewhere > ELSEWHERE {
        warnings.push(Warning::Elsewhere { share: found.elsewhere });
    }
    let share = (length + 1.0) / (figure.area[2] - figure.area[0]).max(1) as f64;
    if share < COVERED {
        warnings.push(Warning::Short { share });
    }
    warnings
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use image::{Rgb, RgbImage};

    use super::*;
    use crate::digitize::axes::Axis;
    use crate::digitize::{Axes, Fidelity, Ink};
    use crate::scenario::AxisScale;

    /// Lines of 3 pixels up and down by `slope`, read with the corners of the axes' pixels for their middles, and with their middles.
    #[test]
    fn half_a_pixel_of_the_axes_is_within_the_error() {
        for slope in [-4.0, -1.0, 0.0, 1.0, 4.0] {
            let middle = |across: f64| 100.0 - slope * (across - 100.0);
            let half = 1.5 * f64::hypot(1.0, slope);
            let share = |column: u32, row: u32| {
                let [top, bottom] = [-1.0, 1.0].map(|side| middle(f64::from(column) + 0.5) + side * half);
                (bottom.min(f64::from(row) + 1.0) - top.max(f64::from(row))).clamp(0.0, 1.0)
            };
            let picture =
                RgbImage::from_fn(200, 200, |column, row| Rgb([(255.0 * (1.0 - share(column, row))) as u8; 3]));
            for off in [0.0, 0.5] {
                // Values are pixels, up from the lower edge.
                let axis = |pixels, column: &str| {
                    let (column, values) = (column.to_owned(), [0.5, 199.5]);
                    Axis { column, pixels, values, scale: AxisScale::Linear }
                };
                let [low, high] = [0.5 - off, 199.5 - off];
                let axes =
                    Axes::new([axis([[low, high], [high, high]], "x"), axis([[low, high], [low, low]], "y")]).unwrap();
                let ink = Ink::new([0; 3], [255; 3], 0.25, Fidelity::EXACT).unwrap();
                let figure = Figure {
                    path: PathBuf::new(),
                    picture: picture.clone(),
                    axes,
                    ink,
                    area: [5, 5, 195, 195],
                    without: vec![],
                    pixel_error: 0.5,
                    least_scatter: 0.1,
                };
                let found = digitize(&figure).unwrap();
                let inner = found.points.iter().zip(&found.errors).filter(|([x, _], _)| (85.0..115.0).contains(x));
                let (mut count, mut most) = (0, 0.0_f64);
                for ([x, y], error) in inner {
                    let wrong = (y - (200.0 - middle(*x))).abs();
                    assert!(wrong <= *error, "slope {slope}, off by {off}: {wrong} of {error} at {x}");
                    assert!(*error < 0.5 * (1.0 + slope.abs()) + 0.5, "slope {slope}: {error}");
                    (count, most) = (count + 1, most.max(wrong));
                }
                // Half a pixel across, which the slope turns into one up, and half a pixel up.
                assert!(
                    count >= 29 && (most - off * (1.0 + slope).abs()).abs() < 0.15,
                    "slope {slope}: {count} {most}"
                );
            }
        }
    }
}
