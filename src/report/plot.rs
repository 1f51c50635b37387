//! Line plots and histograms as SVG that suits light and dark pages.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use thiserror::Error;

use super::figure::significant;
use super::html::escape;
use crate::post::Histogram;

/// Readable on white and on black.
const COLOURS: [RGBColor; 14] = [
    RGBColor(0x2f, 0x80, 0xc8),
    RGBColor(0xd9, 0x77, 0x06),
    RGBColor(0x2f, 0x9e, 0x62),
    RGBColor(0x99, 0x66, 0xcc),
    RGBColor(0xd1, 0x49, 0x5b),
    RGBColor(0x1b, 0x9a, 0xaa),
    RGBColor(0xb0, 0x85, 0x2c),
    RGBColor(0xc0, 0x5a, 0x9e),
    RGBColor(0x6b, 0x9a, 0x1f),
    RGBColor(0x5a, 0x5f, 0xd6),
    RGBColor(0x8f, 0x5a, 0x3a),
    RGBColor(0xe0, 0x7a, 0x6a),
    RGBColor(0x5f, 0x7f, 0x95),
    RGBColor(0x00, 0x8f, 0x7a),
];
const GREY: RGBColor = RGBColor(0x80, 0x88, 0x90);
/// Small, so that the labels stay readable where the page scales it down to a phone.
const SIZE: (u32, u32) = (480, 300);

/// Most points of one curve; longer ones are drawn by the extremes of their stretches.
const MOST_POINTS: usize = 2000;

/// The SVG could not be drawn.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("cannot draw `{title}`: {cause}")]
pub struct PlotError {
    title: String,
    cause: String,
}

/// One curve: its name in the legend and its points; a point that is not finite interrupts it.
pub struct Curve {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

/// A plot of curves over a common x axis.
pub struct Plot {
    pub title: String,
    pub x: String,
    pub y: String,
    pub curves: Vec<Curve>,
}

impl Plot {
    /// The plot as an HTML figure; empty where no curve has a point.
    pub fn draw(&self) -> Result<String, PlotError> {
        let Some((x, y)) = self.ranges() else {
            return Ok(String::new());
        };
        let mut svg = String::new();
        self.draw_on(SVGBackend::with_string(&mut svg, SIZE).into_drawing_area(), x, y)
            .map_err(|cause| PlotError { title: self.title.clone(), cause: cause.to_string() })?;
        let names = self.curves.iter().map(|curve| curve.name.as_str());
        Ok(figure(&self.title, names, &svg))
    }

    fn draw_on(&self, area: Area, x: Range<f64>, y: Range<f64>) -> Result<(), Fault> {
        let mut chart = axes(
            &area,
            Axis { words: &self.x, range: x, label: tick },
            Axis { words: &self.y, range: y, label: tick },
        )?;
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            for piece in curve.points.split(|point| !finite(point)) {
                chart.draw_series(LineSeries::new(thinned(piece), colour.stroke_width(2)))?;
            }
        }
        area.present()?;
        Ok(())
    }

    fn ranges(&self) -> Option<(Range<f64>, Range<f64>)> {
        let points = || self.curves.iter().flat_map(|curve| &curve.points).filter(|point| finite(point));
        Some((range(points().map(|p| p.0), 0.0)?, range(points().map(|p| p.1), 0.05)?))
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Fault = Box<dyn std::error::Error>;

/// One axis: what it shows, from where to where, and how a place on it is written.
struct Axis<'a> {
    words: &'a str,
    range: Range<f64>,
    label: fn(f64) -> String,
}

/// A chart with its axes and grid.
fn axes<'a, 'b>(area: &'a Area<'b>, x: Axis, y: Axis) -> Result<Chart<'a, 'b>, Fault> {
    // What sums of steps leave of a zero is no label.
    let near_zero = |range: &Range<f64>| 1e-9 * (range.end - range.start);
    let (least_x, least_y) = (near_zero(&x.range), near_zero(&y.range));
    let clean = |place: f64, least: f64| if place.abs() < least { 0.0 } else { place };
    let mut chart = ChartBuilder::on(area)
        .margin(6)
        .margin_right(24)
        .x_label_area_size(44)
        .y_label_area_size(62)
        .build_cartesian_2d(x.range, y.range)?;
    chart
        .configure_mesh()
        .x_labels(7)
        .y_labels(7)
        .x_desc(x.words)
        .y_desc(y.words)
        .axis_style(GREY)
        .bold_line_style(GREY.mix(0.25))
        .light_line_style(TRANSPARENT)
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 14))
        .x_label_formatter(&|place| (x.label)(clean(*place, least_x)))
        .y_label_formatter(&|place| (y.label)(clean(*place, least_y)))
        .draw()?;
    Ok(chart)
}

fn finite(point: &(f64, f64)) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// From the smallest to the largest value with a `margin` (share) on both sides, never empty.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> Option<Range<f64>> {
    let ends = values.fold(None, |ends: Option<(f64, f64)>, value| {
        let (low, high) = ends.unwrap_or((value, value));
        Some((low.min(value), high.max(value)))
    });
    let (low, high) = ends?;
    let span = high - low;
    let pad = if span > 0.0 { margin * span } else { 0.5 * low.abs().max(1e-9) };
    Some(low - pad..high + pad)
}

fn tick(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e5).contains(&value.abs()) {
        return format!("{value:.1e}").replace(".0e", "e");
    }
    significant(value, 5)
}

/// At most about [`MOST_POINTS`] of the points: the lowest and the highest of every stretch.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let stretch = points.len().div_ceil(MOST_POINTS / 2);
    let extremes = |stretch: &[(f64, f64)]| {
        let by_height = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let mut ends = [stretch.iter().min_by(by_height), stretch.iter().max_by(by_height)].map(|p| p.copied());
        ends.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        ends.into_iter().flatten().collect::<Vec<_>>()
    };
    points.chunks(stretch).flat_map(extremes).collect()
}

fn figure<'a>(title: &str, names: impl Iterator<Item = &'a str>, svg: &str) -> String {
    let entry = |(name, colour): (&str, &RGBColor)| {
        let RGBColor(r, g, b) = colour;
        format!("<li><span style=\"background:rgb({r},{g},{b})\"></span>{}</li>", escape(name))
    };
    let legend: String = names.zip(COLOURS.iter().cycle()).map(entry).collect();
    format!("<figure>\n<h3>{}</h3>\n<ul class=\"legend\">{legend}</ul>\n{svg}\n</figure>\n", escape(title))
}

/// The histogram of strain rates over a logarithmic axis, the measured range shaded; empty where nothing strained.
pub fn rates(title: &str, histogram: &Histogram) -> Result<String, PlotError> {
    let edges: Vec<f64> = histogram.edges_1_s.iter().map(|edge| edge.log10()).collect();
    let highest = histogram.shares.iter().copied().fold(0.0, f64::max);
    let Some(decades) = decades(histogram, &edges) else {
        return Ok(String::new());
    };
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    let ranges = (decades, 0.0..1.1 * highest);
    let drawn = draw_rates(area, histogram, &edges, ranges);
    drawn.map_err(|cause| PlotError { title: title.into(), cause: cause.to_string() })?;
    let names = ["share of the straining"].into_iter().chain(histogram.measured_1_s.map(|_| "range of the curves"));
    Ok(figure(title, names, &svg))
}

/// Share of the straining from which a bin is worth its place on the axis.
const WORTH_SHOWING: f64 = 1e-3;

/// Whole decades around the measured range and every bin that is high enough to be seen; nothing where there is none.
fn decades(histogram: &Histogram, edges: &[f64]) -> Option<Range<f64>> {
    let bins = edges.windows(2).zip(&histogram.shares).filter(|(_, share)| **share > WORTH_SHOWING);
    let strained = range(bins.flat_map(|(bin, _)| bin.iter().copied()), 0.0)?;
    let [low, high] = histogram.measured_1_s.map_or([strained.start, strained.end], |rates| rates.map(f64::log10));
    Some(strained.start.min(low).floor()..strained.end.max(high).ceil())
}

fn draw_rates(area: Area, histogram: &Histogram, edges: &[f64], (x, y): (Range<f64>, Range<f64>)) -> Result<(), Fault> {
    let (left, right, top) = (x.start, x.end, y.end);
    let x = Axis { words: "strain rate (1/s)", range: x, label: |exponent| tick(10f64.powf(exponent)) };
    let mut chart = axes(&area, x, Axis { words: "share", range: y, label: tick })?;
    if let Some(measured) = histogram.measured_1_s {
        let [low, high] = measured.map(|rate| rate.log10().clamp(left, right));
        chart.draw_series([Rectangle::new([(low, 0.0), (high, top)], COLOURS[1].mix(0.18).filled())])?;
    }
    let bars = edges.windows(2).zip(&histogram.shares);
    let bars = bars.map(|(edge, share)| Rectangle::new([(edge[0], 0.0), (edge[1], *share)], COLOURS[0].filled()));
    chart.draw_series(bars)?;
    area.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<(f64, f64)>) -> Plot {
        let curve = Curve { name: "<film>".into(), points };
        Plot { title: "A & B".into(), x: "time (ms)".into(), y: "travel (mm)".into(), curves: vec![curve] }
    }

    #[test]
    fn a_plot_holds_its_curve_and_its_escaped_names() {
        let html = plot(vec![(0.0, 1.0), (1.0, 2.0), (f64::NAN, 0.0), (2.0, 1.0), (3.0, 4.0)]).draw().unwrap();
        assert_eq!(html.matches("#2F80C8").count(), 2, "a gap interrupts the curve");
        assert!(html.contains("&lt;film&gt;") && html.contains("A &amp; B") && html.contains("travel (mm)"));
        assert!(!html.contains("NaN"));
    }

    #[test]
    fn neighbouring_ticks_differ() {
        assert_eq!([0.0015, 0.002, 0.0025, 1e-4, 1.5e5].map(tick), ["0.0015", "0.002", "0.0025", "1e-4", "1.5e5"]);
    }

    #[test]
    fn a_tick_at_zero_reads_zero() {
        let html = plot(vec![(0.0, -0.3), (1.0, 0.3)]).draw().unwrap();
        assert!(html.contains("0.1") && !html.contains("e-1"), "{html}");
    }

    #[test]
    fn nothing_to_plot_gives_nothing_and_a_constant_still_has_a_range() {
        assert_eq!(plot(vec![]).draw().unwrap(), "");
        assert!(plot(vec![(0.0, 5.0), (1.0, 5.0)]).draw().unwrap().contains("<svg"));
        assert!(plot(vec![(0.0, 0.0)]).draw().unwrap().contains("<svg"));
    }

    #[test]
    fn long_curves_keep_their_extremes() {
        let mut points: Vec<(f64, f64)> = (0..50_000).map(|i| (f64::from(i), 0.0)).collect();
        points[31_415].1 = 7.0;
        points[27_182].1 = -3.0;
        let thin = thinned(&points);
        assert!(thin.len() <= MOST_POINTS + 2);
        assert!(thin.contains(&(31_415.0, 7.0)) && thin.contains(&(27_182.0, -3.0)));
        assert!(thin.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    #[test]
    fn rates_show_the_measured_range() {
        let histogram = Histogram {
            edges_1_s: vec![0.1, 1.0, 10.0, 100.0],
            shares: vec![0.2, 0.5, 0.3],
            measured_1_s: Some([0.04, 40.0]),
            outside: 0.3,
        };
        let html = rates("Strain rates", &histogram).unwrap();
        assert!(html.contains("<svg") && html.contains("range of the curves"));
        let nothing = Histogram { shares: vec![0.0; 3], ..histogram };
        assert_eq!(rates("Strain rates", &nothing).unwrap(), "");
    }
}
