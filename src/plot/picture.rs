//! A plot as a picture: an SVG that any page shows without a script.

use std::fmt::Write;

use super::{Axis, Curve, Look, Plot, Scale};
use crate::number::significant;

/// Size of a picture, px, without its legend.
const SIZE: [f64; 2] = [560.0, 340.0];

/// Between the edges and the field of the curves, px: left, top, right, bottom.
const MARGINS: [f64; 4] = [62.0, 34.0, 16.0, 46.0];

/// Height of a line of the legend, px.
const LINE: f64 = 18.0;

/// Between the label of the x axis and the legend, px.
const GAP: f64 = 10.0;

/// Width of a character of the legend, px: an upper bound for its letters.
const CHARACTER: f64 = 6.8;

/// Ticks of a linear axis, about.
const TICKS: f64 = 6.0;

/// Digits of a tick.
const TICK_DIGITS: usize = 6;

/// Colours of curves in their order, those of the pages on white.
const COLOURS: [&str; 8] = ["#1f77b4", "#d9480f", "#2b8a3e", "#9c36b5", "#c2255c", "#0b7285", "#8a6d1a", "#5f3dc4"];

/// The plot as SVG: axes with ticks, curves, the marked window, and a legend of more than one curve below. Coordinates
/// have a tenth of a pixel; points without a place on the axes interrupt a curve.
pub fn svg(plot: &Plot) -> String {
    let legend = legend(plot);
    let height = SIZE[1] + LINE * legend.rows as f64 + if legend.rows > 0 { GAP } else { 0.0 };
    let field = Field::of(plot);
    let [left, top, right, bottom] = field.edges();
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {height}\" width=\"{}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\" fill=\"#1c2126\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         <text x=\"{left}\" y=\"20\" font-size=\"14\" font-weight=\"bold\">{}</text>\n",
        SIZE[0],
        SIZE[0],
        escape(&plot.title)
    );
    let mut draw = |line: String| {
        out.push_str(&line);
        out.push('\n');
    };
    if let Some(window) = &plot.window {
        let [from, to] = window.range.map(|x| field.place(0, x).clamp(left, right));
        draw(format!(
            "<rect x=\"{from:.1}\" y=\"{top}\" width=\"{:.1}\" height=\"{}\" fill=\"#eef2e4\"/>",
            to - from,
            bottom - top
        ));
    }
    for tick in ticks(&plot.x, field.ranges[0]) {
        let x = field.place(0, tick);
        draw(format!("<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"#dbdfe3\"/>"));
        draw(format!("<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>", bottom + 16.0, number(tick)));
    }
    for tick in ticks(&plot.y, field.ranges[1]) {
        let y = field.place(1, tick);
        draw(format!("<path d=\"M{left} {y:.1}H{right}\" stroke=\"#dbdfe3\"/>"));
        draw(format!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>", left - 6.0, y + 4.0, number(tick)));
    }
    draw(format!("<path d=\"M{left} {top}V{bottom}H{right}\" fill=\"none\" stroke=\"#56616b\"/>"));
    let (middle, height) = (0.5 * (left + right), 0.5 * (top + bottom));
    draw(format!(
        "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
        bottom + 36.0,
        escape(&plot.x.label)
    ));
    draw(format!(
        "<text x=\"14\" y=\"{height}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {height})\">{}</text>",
        escape(&plot.y.label)
    ));
    for (curve, colour) in plot.curves.iter().zip(COLOURS.iter().cycle()) {
        draw(drawn(curve, colour, plot, &field));
    }
    out.push_str(&legend.text);
    out.push_str("</svg>\n");
    out
}

/// Where values lie in a picture.
struct Field {
    /// Least and largest value of x and of y.
    ranges: [[f64; 2]; 2],
    scales: [Scale; 2],
}

impl Field {
    fn of(plot: &Plot) -> Field {
        let points = || plot.curves.iter().flat_map(|curve| &curve.points).filter(|point| plot.has_place(point));
        let range = |axis: usize, scale: Scale| {
            let ends = points().map(|point| point[axis]).fold(None, |ends: Option<[f64; 2]>, value| {
                let [low, high] = ends.unwrap_or([value; 2]);
                Some([low.min(value), high.max(value)])
            });
            widened(ends.unwrap_or([1.0, 2.0]), scale)
        };
        let scales = [plot.x.scale, plot.y.scale];
        Field { ranges: [range(0, scales[0]), range(1, scales[1])], scales }
    }

    /// Left, top, right and bottom, px.
    fn edges(&self) -> [f64; 4] {
        [MARGINS[0], MARGINS[1], SIZE[0] - MARGINS[2], SIZE[1] - MARGINS[3]]
    }

    /// The place of a value along an axis, px.
    fn place(&self, axis: usize, value: f64) -> f64 {
        let along = |value: f64| if self.scales[axis] == Scale::Linear { value } else { value.log10() };
        let [low, high] = self.ranges[axis].map(along);
        let share = (along(value) - low) / (high - low);
        let [left, top, right, bottom] = self.edges();
        if axis == 0 { left + share * (right - left) } else { bottom - share * (bottom - top) }
    }
}

/// A range that is not a point, and of a linear axis from zero where zero is near.
fn widened([low, high]: [f64; 2], scale: Scale) -> [f64; 2] {
    match scale {
        Scale::Logarithmic if low < high => [low, high],
        Scale::Logarithmic => [0.5 * low, 2.0 * high],
        Scale::Linear => {
            let span = if high > low { high - low } else { low.abs().max(1.0) };
            let (near, far) = (low >= 0.0 && low < 0.3 * high, 0.04 * span);
            [if near { 0.0 } else { low - far }, high + far]
        }
    }
}

/// Round values of an axis within its range.
fn ticks(axis: &Axis, [low, high]: [f64; 2]) -> Vec<f64> {
    if axis.scale == Scale::Logarithmic {
        let decades = low.log10().ceil() as i32..=high.log10().floor() as i32;
        return decades.map(|decade| 10.0_f64.powi(decade)).collect();
    }
    let raw = (high - low) / TICKS;
    let decade = 10.0_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * decade).find(|step| *step >= raw);
    let step = step.unwrap_or(10.0 * decade);
    ((low / step).ceil() as i64..=(high / step).floor() as i64).map(|place| place as f64 * step).collect()
}

fn number(value: f64) -> String {
    significant(value, TICK_DIGITS)
}

/// A line, broken where a point has no place, or a mark at each point.
fn drawn(curve: &Curve, colour: &str, plot: &Plot, field: &Field) -> String {
    let place = |[x, y]: &[f64; 2]| [field.place(0, *x), field.place(1, *y)];
    if curve.look == Look::Points {
        let points = curve.points.iter().filter(|point| plot.has_place(point)).map(place);
        return points
            .map(|[x, y]| format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{colour}\"/>"))
            .collect();
    }
    let mut path = String::new();
    let mut joined = false;
    for point in &curve.points {
        let is_shown = plot.has_place(point);
        if is_shown {
            let [x, y] = place(point);
            // Writing to a text cannot fail.
            let _ = write!(path, "{}{x:.1} {y:.1}", if joined { "L" } else { "M" });
        }
        joined = is_shown;
    }
    format!("<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{}/>", dashes(curve.look))
}

fn dashes(look: Look) -> &'static str {
    if look == Look::Dashed { " stroke-dasharray=\"6 4\"" } else { "" }
}

/// Names of the curves below the field.
struct Legend {
    rows: usize,
    text: String,
}

fn legend(plot: &Plot) -> Legend {
    let mut legend = Legend { rows: 0, text: String::new() };
    if plot.curves.len() < 2 {
        return legend;
    }
    let (mut x, mut y) = (MARGINS[0], SIZE[1] + GAP + 4.0);
    for (curve, colour) in plot.curves.iter().zip(COLOURS.iter().cycle()) {
        let width = 40.0 + CHARACTER * curve.name.chars().count() as f64;
        if x > MARGINS[0] && x + width > SIZE[0] {
            (x, y, legend.rows) = (MARGINS[0], y + LINE, legend.rows + 1);
        }
        let mark = match curve.look {
            Look::Points => format!("<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{colour}\"/>", x + 10.0, y - 4.0),
            look => {
                let path = format!("M{x:.1} {:.1}h20", y - 4.0);
                format!("<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"2\"{}/>", dashes(look))
            }
        };
        let _ = writeln!(legend.text, "{mark}<text x=\"{:.1}\" y=\"{y:.1}\">{}</text>", x + 26.0, escape(&curve.name));
        x += width;
    }
    legend.rows += 1;
    legend
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        let linear = Axis::linear("x");
        assert_eq!(ticks(&linear, [0.0, 1.04]), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(&linear, [-30.0, 270.0]), [0.0, 50.0, 100.0, 150.0, 200.0, 250.0]);
        let decades = Axis { label: "x".into(), scale: Scale::Logarithmic };
        assert_eq!(ticks(&decades, [0.02, 300.0]), [0.1, 1.0, 10.0, 100.0]);
        assert_eq!(number(0.6000000000000001), "0.6");
    }

    #[test]
    fn points_lie_where_the_axes_say_and_gaps_interrupt() {
        let points = [[0.0, 0.0], [1.0, 2.0], [2.0, f64::NAN], [4.0, 1.0]];
        let curves = vec![Curve::line("a < b", points), Curve::line("b", [[0.0, 2.0]]).dashed()];
        let plot = Plot::new("A & B", ["x", "y"], curves);
        let field = Field::of(&plot);
        assert_eq!(field.ranges, [[0.0, 4.16], [0.0, 2.08]]);
        let [left, top, right, bottom] = field.edges();
        let (x, y) = (left + (right - left) / 4.16, bottom - (bottom - top) * 2.0 / 2.08);
        let text = svg(&plot);
        assert!(text.contains(&format!("d=\"M{left:.1} {bottom:.1}L{x:.1} {y:.1}M")), "{text}");
        assert!(text.contains("A &amp; B") && text.contains("a &lt; b") && text.contains("stroke-dasharray"), "{text}");
        assert_eq!(text.matches("</svg>").count(), 1);
    }

    #[test]
    fn a_logarithmic_axis_has_no_place_for_zero() {
        let mut plot = Plot::new("t", ["x", "y"], vec![Curve::line("c", [[0.0, 1.0], [1.0, 2.0], [100.0, 3.0]])]);
        plot.x.scale = Scale::Logarithmic;
        let field = Field::of(&plot);
        assert_eq!(field.ranges[0], [1.0, 100.0]);
        assert!((field.place(0, 10.0) - 0.5 * (field.place(0, 1.0) + field.place(0, 100.0))).abs() < 1e-9);
        assert!(!svg(&plot).contains("NaN") && !svg(&plot).contains("inf"));
    }
}
