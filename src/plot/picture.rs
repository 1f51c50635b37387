//! A plot as a picture: an SVG that any page shows without a script.

use std::error::Error;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::{
    Cartesian2d, ChartBuilder, ChartContext, Circle, Color, DrawingArea, FontDesc, FontStyle, IntoDrawingArea,
    IntoFont, PathElement, RGBColor, Rectangle, SVGBackend, ShapeStyle, TRANSPARENT, Text, TextStyle, WHITE,
};

use super::style::Style;
use super::{Curve, Look, Plot, Scale};
use base::number::{ends, significant};

/// Units of the drawing for a pixel of a page: the crate places points at whole units.
const UNITS: i32 = 10;

/// Size of a picture of a page without its legend.
const SIZE: [i32; 2] = [560 * UNITS, 340 * UNITS];

/// Units of the drawing for a point of paper.
const UNITS_OF_POINT: f64 = 100.0;

/// Length of a dash and of the gap after it, in twelfths of the height of letters.
const DASH: [i32; 2] = [6, 4];

/// Most ticks of an axis.
const TICKS: usize = 10;

/// Digits of a tick, where they tell it from its neighbours.
const TICK_DIGITS: usize = 6;

/// Least length of an axis, as a share of the largest size on it.
const LEAST_SPAN: f64 = 1e-12;

/// Size of a font of the crate over that of its letters.
const FONT: f64 = 1.24;

const INK: RGBColor = RGBColor(0x1c, 0x21, 0x26);
const FRAME: RGBColor = RGBColor(0x56, 0x61, 0x6b);
const GRID: RGBColor = RGBColor(0xdb, 0xdf, 0xe3);
const WINDOW: RGBColor = RGBColor(0xee, 0xf2, 0xe4);

/// Colours of curves in their order, those of the pages on white.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0x1f, 0x77, 0xb4),
    RGBColor(0xd9, 0x48, 0x0f),
    RGBColor(0x2b, 0x8a, 0x3e),
    RGBColor(0x9c, 0x36, 0xb5),
    RGBColor(0xc2, 0x25, 0x5c),
    RGBColor(0x0b, 0x72, 0x85),
    RGBColor(0x8a, 0x6d, 0x1a),
    RGBColor(0x5f, 0x3d, 0xc4),
];

/// The area that is drawn on.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The field of the curves.
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Along, Along>>;

/// Where the parts of a picture are, in units of the drawing; all but its size are in proportion to its letters.
struct Layout<'a> {
    /// Of the picture without its legend.
    size: [i32; 2],
    /// Height of letters.
    letters: i32,
    family: &'a str,
    /// Width of a curve.
    line: u32,
    has_title: bool,
}

impl Layout<'_> {
    /// So many twelfths of the height of letters.
    fn scale(&self, twelfths: i32) -> i32 {
        self.letters * twelfths / 12
    }

    /// Height of the title.
    fn top(&self) -> i32 {
        self.scale(if self.has_title { 34 } else { 10 })
    }

    /// Width of the label and the numbers of the y axis, with what is beside them.
    fn left(&self) -> i32 {
        self.scale(62)
    }

    /// Height of the label and the numbers of the x axis.
    fn bottom(&self) -> i32 {
        self.scale(46)
    }

    /// Beside the field of the curves, on the right: half of the last number of the x axis.
    fn right(&self) -> i32 {
        self.scale(24)
    }

    /// Height of a line of the legend.
    fn row(&self) -> i32 {
        self.scale(18)
    }

    /// Width of axes and of the grid.
    fn hairline(&self) -> u32 {
        self.scale(1) as u32
    }

    /// Radius of a point.
    fn radius(&self) -> i32 {
        self.scale(3)
    }

    fn dash(&self) -> [i32; 2] {
        DASH.map(|length| self.scale(length))
    }

    /// Most ticks of both axes, so that numbers stay apart.
    fn ticks(&self) -> [usize; 2] {
        let [width, height] = [self.size[0] - self.left() - self.right(), self.size[1] - self.top() - self.bottom()];
        let most = |length: i32, apart: i32| (length / self.scale(apart).max(1)).clamp(2, TICKS as i32) as usize;
        [most(width, 36), most(height, 18)]
    }

    fn font(&self) -> FontDesc<'_> {
        (self.family, f64::from(self.letters) * FONT).into_font()
    }

    fn text(&self) -> TextStyle<'_> {
        self.font().color(&INK)
    }
}

/// The plot as SVG: axes with ticks, curves, the marked window, and a legend of more than one curve below; points without a place on
/// the axes interrupt a curve. Coordinates have a tenth of a pixel.
pub fn svg(plot: &Plot) -> String {
    let letters = 12 * UNITS;
    let layout = Layout { size: SIZE, letters, family: "sans-serif", line: 2 * UNITS as u32, has_title: true };
    let legend = legend(plot, &layout);
    let height = SIZE[1] + height_of(&legend, &layout);
    let drawn = drawn(plot, &layout, &legend, [SIZE[0], height]);
    sized(drawn, [SIZE[0], height], [SIZE[0], height].map(|side| (side / UNITS).to_string()))
}

/// The plot as SVG in the size and font of paper, its legend within the height. Coordinates have a hundredth of a point.
pub fn svg_in(plot: &Plot, style: &Style) -> String {
    let units = |length: f64| (length * UNITS_OF_POINT).round() as i32;
    let size = [style.width, style.height].map(units);
    let Style { family, has_title, .. } = style;
    let mut layout =
        Layout { size, letters: units(style.letters), family, line: units(style.line) as u32, has_title: *has_title };
    let legend = legend(plot, &layout);
    layout.size[1] -= height_of(&legend, &layout);
    let drawn = drawn(plot, &layout, &legend, size);
    sized(drawn, size, [style.width, style.height].map(Style::millimetres))
}

/// The drawing of this size in units, with its width and height on paper or a screen instead.
fn sized(drawing: String, [width, height]: [i32; 2], [wide, high]: [String; 2]) -> String {
    let units = format!("width=\"{width}\" height=\"{height}\"");
    drawing.replacen(&units, &format!("width=\"{wide}\" height=\"{high}\""), 1)
}

fn drawn(plot: &Plot, layout: &Layout<'_>, legend: &[Entry<'_>], size: [i32; 2]) -> String {
    let mut text = String::new();
    draw(plot, layout, legend, &mut text, size).expect("a text takes whatever is drawn");
    text
}

fn draw(
    plot: &Plot,
    layout: &Layout<'_>,
    legend: &[Entry<'_>],
    text: &mut String,
    [width, height]: [i32; 2],
) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::with_string(text, (width as u32, height as u32)).into_drawing_area();
    area.fill(&WHITE)?;
    let (above, below) = area.split_vertically(layout.size[1]);
    draw_field(plot, layout, &above)?;
    for entry in legend {
        draw_entry(entry, layout, &below)?;
    }
    Ok(area.present()?)
}

/// The field of the curves with its axes and the title.
fn draw_field(plot: &Plot, layout: &Layout<'_>, area: &Area<'_>) -> Result<(), Box<dyn Error>> {
    if layout.has_title {
        let title = layout.font().style(FontStyle::Bold).resize(f64::from(layout.scale(14)) * FONT);
        area.draw(&Text::new(plot.title.as_str(), (layout.left(), layout.scale(10)), title.color(&INK)))?;
    }
    let (beside, [across, up]) = (layout.scale(5), layout.ticks());
    let mut chart = ChartBuilder::on(area)
        .margin_top(layout.top())
        .margin_right(layout.right())
        .x_label_area_size(layout.bottom())
        .margin_left(beside)
        .y_label_area_size(layout.left() - beside)
        .build_cartesian_2d(Along::from_plot(plot, 0, across), Along::from_plot(plot, 1, up))?;
    let [x, y] = [chart.x_range(), chart.y_range()];
    if let Some(window) = &plot.window {
        let [from, to] = window.range.map(|at| at.clamp(x.start, x.end));
        chart.draw_series([Rectangle::new([(from, y.start), (to, y.end)], WINDOW.filled())])?;
    }
    chart
        .configure_mesh()
        .bold_line_style(ShapeStyle::from(GRID).stroke_width(layout.hairline()))
        .axis_style(ShapeStyle::from(FRAME).stroke_width(layout.hairline()))
        .x_labels(across)
        .y_labels(up)
        .light_line_style(TRANSPARENT)
        .set_all_tick_mark_size(layout.scale(4))
        .label_style(layout.text())
        .axis_desc_style(layout.text())
        .x_desc(plot.x.label.as_str())
        .y_desc(plot.y.label.as_str())
        .draw()?;
    let [dash, gap] = layout.dash();
    for (curve, colour) in plot.curves.iter().zip(COLOURS.into_iter().cycle()) {
        let line = ShapeStyle::from(colour).stroke_width(layout.line);
        for points in runs(plot, curve) {
            let points = points.iter().map(|[x, y]| (*x, *y));
            match curve.look {
                Look::Line => chart.draw_series([PathElement::new(points.collect::<Vec<_>>(), line)])?,
                Look::Dashed => chart.draw_series([DashedPathElement::new(points, dash, gap, line)])?,
                Look::Points => {
                    chart.draw_series(points.map(|at| Circle::new(at, layout.radius(), colour.filled())))?
                }
            };
        }
    }
    draw_marks(plot, layout, area, &mut chart)
}

/// A line at each mark with its label beside it, in the first row where there is room.
fn draw_marks(
    plot: &Plot,
    layout: &Layout<'_>,
    area: &Area<'_>,
    chart: &mut Chart<'_, '_>,
) -> Result<(), Box<dyn Error>> {
    let [x, y] = [chart.x_range(), chart.y_range()];
    let [dash, gap] = layout.dash().map(|length| length / 2);
    let line = ShapeStyle::from(FRAME).stroke_width(layout.hairline());
    let (left, top) = chart.backend_coord(&(x.start, y.end));
    let (right, _) = chart.backend_coord(&(x.end, y.end));
    let mut rows: Vec<i32> = vec![];
    for mark in plot.marks.iter().filter(|mark| (x.start..=x.end).contains(&mark.at)) {
        let ends = [(mark.at, y.start), (mark.at, y.end)];
        chart.draw_series([DashedPathElement::new(ends, dash, gap, line)])?;
        let width = width_of(&mark.label, layout);
        let place = (chart.backend_coord(&(mark.at, y.end)).0 + layout.scale(4)).min(right - width).max(left);
        let row = rows.iter().position(|end| place > *end).unwrap_or(rows.len());
        rows.resize(rows.len().max(row + 1), 0);
        rows[row] = place + width + layout.scale(6);
        let text = Text::new(mark.label.as_str(), (place, top + layout.scale(3 + 14 * row as i32)), layout.text());
        area.draw(&text)?;
    }
    Ok(())
}

/// The values along an axis.
pub struct Along {
    /// Of its ends.
    range: [f64; 2],
    scale: Scale,
    /// Most of its ticks.
    most: usize,
    /// Digits that tell neighbours among them apart.
    digits: usize,
}

impl Along {
    fn new(range: [f64; 2], scale: Scale, most: usize) -> Along {
        let mut along = Along { range, scale, most, digits: TICK_DIGITS };
        let values = along.key_points(most);
        let digits = TICK_DIGITS..=f64::DIGITS as usize;
        let tells = |digits: &usize| {
            values.windows(2).all(|pair| significant(pair[0], *digits) != significant(pair[1], *digits))
        };
        along.digits = digits.clone().find(tells).unwrap_or(*digits.end());
        along
    }

    /// Those of x (0) or y (1), with at most so many ticks.
    pub fn from_plot(plot: &Plot, index: usize, most: usize) -> Along {
        let scale = [plot.x.scale, plot.y.scale][index];
        let points = plot.curves.iter().flat_map(|curve| &curve.points).filter(|point| plot.has_place(point));
        let ends = ends(points.map(|point| point[index]));
        Along::new(widened(ends.unwrap_or([1.0, 2.0]), scale), scale, most)
    }

    /// Those of a linear axis from `low` to `high` with at most so many ticks; it is wider where these ends are the same.
    pub fn between(low: f64, high: f64, most: usize) -> Along {
        let (ends, scale) = ([low, high], Scale::Linear);
        let range = if high - low > LEAST_SPAN * low.abs().max(high.abs()) { ends } else { widened(ends, scale) };
        Along::new(range, scale, most)
    }

    /// Where a value lies: zero at the lower end, one at the upper.
    pub fn share(&self, value: f64) -> f64 {
        let [low, high] = self.range.map(|end| self.scale.along(end));
        (self.scale.along(value) - low) / (high - low)
    }

    /// Where round values lie, and how they are written.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        self.key_points(self.most).iter().map(|value| (self.share(*value), self.format_ext(value))).collect()
    }
}

impl Ranged for Along {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let [low, high] = self.range.map(|end| self.scale.along(end));
        from + (f64::from(to - from) * (self.scale.along(*value) - low) / (high - low)).round() as i32
    }

    /// Round values; of a logarithmic axis decades, and where there are few of them their double and fivefold.
    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let [low, high] = self.range;
        if self.scale == Scale::Linear {
            return RangedCoordf64::from(low..high).key_points(hint);
        }
        let factors: &[f64] = if high < 100.0 * low { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let values = decades.flat_map(|decade| factors.iter().map(move |factor| factor * 10.0_f64.powi(decade)));
        values.filter(|value| (low..=high).contains(value)).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Along {
    fn format_ext(&self, value: &f64) -> String {
        significant(*value, self.digits)
    }
}

/// A range that is not a point, and of a linear axis from zero where zero is near.
fn widened([low, high]: [f64; 2], scale: Scale) -> [f64; 2] {
    match scale {
        Scale::Logarithmic if low < high => [low, high],
        Scale::Logarithmic => [0.5 * low, 2.0 * high],
        Scale::Linear => {
            // Rounded values within a range must differ, or there is no end of them.
            let size = low.abs().max(high.abs());
            let span = if high - low > LEAST_SPAN * size { high - low } else { size.max(1.0) };
            let (near, far) = (low >= 0.0 && low < 0.3 * high, 0.04 * span);
            [if near { 0.0 } else { low - far }, high + far]
        }
    }
}

/// The points of a curve between those that have no place on the axes.
fn runs<'a>(plot: &Plot, curve: &'a Curve) -> impl Iterator<Item = &'a [[f64; 2]]> {
    curve.points.split(|point| !plot.has_place(point)).filter(|run| !run.is_empty())
}

/// The name of a curve below the field.
struct Entry<'a> {
    curve: &'a Curve,
    colour: RGBColor,
    /// Left and top.
    place: [i32; 2],
}

/// The entries of all curves, where there are several.
fn legend<'a>(plot: &'a Plot, layout: &Layout<'_>) -> Vec<Entry<'a>> {
    if plot.curves.len() < 2 {
        return vec![];
    }
    let [mut x, mut y] = [layout.left(), layout.scale(6)];
    let mut entries = vec![];
    for (curve, colour) in plot.curves.iter().zip(COLOURS.into_iter().cycle()) {
        // The mark of the curve comes before its name.
        let width = layout.scale(40) + width_of(&curve.name, layout);
        if x > layout.left() && x + width > layout.size[0] {
            (x, y) = (layout.left(), y + layout.row());
        }
        entries.push(Entry { curve, colour, place: [x, y] });
        x += width;
    }
    entries
}

/// Width of a text.
fn width_of(text: &str, layout: &Layout<'_>) -> i32 {
    // Characters of a sans-serif font are narrower than 0.57 of their height on average.
    (text.chars().count() as f64 * 0.57 * f64::from(layout.letters)) as i32
}

fn height_of(legend: &[Entry<'_>], layout: &Layout<'_>) -> i32 {
    legend.last().map_or(0, |entry| entry.place[1] + layout.row())
}

fn draw_entry(
    Entry { curve, colour, place: [x, y] }: &Entry<'_>,
    layout: &Layout<'_>,
    area: &Area<'_>,
) -> Result<(), Box<dyn Error>> {
    let (line, middle) = (ShapeStyle::from(colour).stroke_width(layout.line), y + layout.row() / 2);
    let ends = [(*x, middle), (x + layout.scale(20), middle)];
    let [dash, gap] = layout.dash();
    match curve.look {
        Look::Line => area.draw(&PathElement::new(ends, line))?,
        Look::Dashed => area.draw(&DashedPathElement::new(ends, dash, gap, line))?,
        Look::Points => area.draw(&Circle::new((x + layout.scale(10), middle), layout.radius(), colour.filled()))?,
    }
    let place = (x + layout.scale(26), middle - layout.letters / 2);
    Ok(area.draw(&Text::new(curve.name.as_str(), place, layout.text()))?)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn neighbours_far_from_nothing_have_words_of_their_own() {
        for [low, high] in [[1.0, 1.00001], [1.23e12, 1.23e12 + 4e6], [-2e-9, 3e-9], [101_325.0, 101_325.5]] {
            let ticks = Along::between(low, high, 7).ticks();
            let different: BTreeSet<&String> = ticks.iter().map(|(_, words)| words).collect();
            assert!(ticks.len() > 3 && different.len() == ticks.len(), "{ticks:?}");
        }
        let pressed = Curve::line("c", [[0.0, 101_325.0], [1.0, 101_325.5]]);
        let text = svg(&Plot::new("t", ["time (s)", "pressure (Pa)"], vec![pressed]));
        let numbers: Vec<&str> = text.split('\n').map(str::trim).filter(|line| line.starts_with("101325")).collect();
        assert!(numbers.len() > 3 && numbers.windows(2).all(|pair| pair[0] != pair[1]), "{text}");
    }

    #[test]
    fn ticks_are_round_and_within_the_range() {
        for (scale, range, expected) in [
            (Scale::Linear, [0.0, 1.04], "0 0.2 0.4 0.6 0.8 1"),
            (Scale::Linear, [-30.0, 270.0], "0 50 100 150 200 250"),
            (Scale::Logarithmic, [0.02, 300.0], "0.1 1 10 100"),
            (Scale::Logarithmic, [1.0, 30.0], "1 2 5 10 20"),
        ] {
            let along = Along::new(range, scale, TICKS);
            let found: Vec<String> = along.key_points(TICKS).iter().map(|tick| along.format_ext(tick)).collect();
            assert_eq!(found.join(" "), expected);
        }
    }

    #[test]
    fn any_numbers_are_drawn() {
        for values in [
            [-9e307, 9e307],
            [-1e300, 1e300],
            [8e-31, 1.0],
            [5e-324, 0.0],
            [0.0, 1e-300],
            [1.0, 1.0 + f64::EPSILON],
            [1e16, 1e16 + 2.0],
            [f64::INFINITY, f64::MIN],
        ] {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                let points = [[0.0, values[0]], [1.0, values[1]], [values[0], values[1]]];
                let mut plot = Plot::new("t", ["x", "y"], vec![Curve::line("c", points)]);
                (plot.x.scale, plot.y.scale) = (scale, scale);
                let text = svg(&plot);
                assert!(text.len() < 20_000 && !text.contains("NaN") && !text.contains("inf"), "{values:?}: {text}");
                assert!(crate::braille(&plot, [40, 10]).len() < 10_000);
            }
        }
    }

    /// Coordinates of the points of all polylines of this colour.
    fn polylines(text: &str, colour: &str) -> Vec<Vec<[f64; 2]>> {
        let of_colour = text.lines().filter(|line| line.contains("<polyline") && line.contains(colour));
        let points = |line: &str| {
            let (_, rest) = line.split_once("points=\"")?;
            let pairs = rest.split('"').next()?.split_whitespace().filter_map(|pair| pair.split_once(','));
            Some(pairs.map(|(x, y)| [x, y].map(|value| value.parse().expect("a number"))).collect())
        };
        of_colour.filter_map(points).collect()
    }

    #[test]
    fn points_lie_where_the_axes_say_and_gaps_interrupt() {
        let points = [[0.0, 0.0], [1.0, 2.0], [2.0, f64::NAN], [4.0, 1.0], [4.0, 2.0]];
        let curves = vec![Curve::line("a < b", points), Curve::line("b", [[0.0, 2.0], [4.0, 2.0]]).dashed()];
        let plot = Plot::new("A & B", ["time (s)", "force (N)"], curves);
        assert_eq!([0, 1].map(|axis| Along::from_plot(&plot, axis, TICKS).range), [[0.0, 4.16], [0.0, 2.08]]);
        let text = svg(&plot);
        let [left, top, right, bottom] =
            [62 * UNITS, 34 * UNITS, SIZE[0] - 24 * UNITS, SIZE[1] - 46 * UNITS].map(f64::from);
        let place = |[x, y]: [f64; 2]| [left + (right - left) * x / 4.16, bottom - (bottom - top) * y / 2.08];
        let found = polylines(&text, "#1F77B4");
        let expected = [vec![points[0], points[1]], vec![points[3], points[4]]];
        for (found, expected) in found.iter().zip(&expected) {
            for (found, expected) in found.iter().zip(expected.iter().map(|point| place(*point))) {
                assert!([0, 1].iter().all(|k| (found[*k] - expected[*k]).abs() <= 10.0), "{found:?} {expected:?}");
            }
        }
        // The second line is the mark of the legend.
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 2], "{text}");
        assert!(polylines(&text, "#D9480F").len() > 30, "{text}");
        for words in ["A &amp; B", "a &lt; b", "time (s)", "force (N)", "width=\"560\" height=\"364\""] {
            assert!(text.contains(words), "{words} in {text}");
        }
        assert_eq!(text.matches("</svg>").count(), 1);
    }

    #[test]
    fn marks_are_lines_with_labels_that_do_not_overlap() {
        let mut plot = Plot::new("t", ["x", "y"], vec![Curve::line("c", [[0.0, 0.0], [100.0, 1.0]])]);
        plot.marks = [("contact", 50.0), ("lowest <point>", 51.0), ("beyond", 200.0)]
            .map(|(label, at)| super::super::Mark { label: label.into(), at })
            .into();
        let text = svg(&plot);
        assert!(text.contains("lowest &lt;point&gt;") && !text.contains("beyond"), "{text}");
        let height = |label: &str| {
            let (before, _) = text.split_once(label).expect("a label");
            let (_, after) = before.rsplit_once(" y=\"").expect("its place");
            after.split('"').next().and_then(|number| number.parse::<f64>().ok()).expect("a number")
        };
        assert!((height("lowest") - height("contact")).abs() > 100.0, "{text}");
    }

    #[test]
    fn a_picture_for_paper_has_its_size_and_letters() {
        let curves = ["simulated", "measured"].map(|name| Curve::line(name, [[0.0, 0.0], [120.0, 140.0]])).to_vec();
        let plot = Plot::new("left out", ["time (ms)", "acceleration (m/s²)"], curves);
        let style = Style {
            width: Style::points(0.09),
            height: Style::points(0.06),
            letters: 8.0,
            family: "Times New Roman".into(),
            line: 1.0,
            has_title: false,
        };
        let text = svg_in(&plot, &style);
        assert!(text.starts_with("<svg width=\"90mm\" height=\"60mm\" viewBox=\"0 0 25512 17008\""), "{text}");
        assert!(text.contains("font-family=\"Times New Roman\"") && !text.contains("left out"), "{text}");
        // Units are hundredths of a point.
        let sizes: BTreeSet<&str> =
            text.split("font-size=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(sizes.into_iter().collect::<Vec<_>>(), ["800"], "{text}");
        assert!(text.contains("stroke=\"#1F77B4\" stroke-width=\"100\""), "{text}");
        let numbers = text.matches("text-anchor=\"middle\"").count();
        assert!((5..=9).contains(&numbers), "{numbers} numbers along 90 mm");
        let lowest = polylines(&text, "#1F77B4").concat().into_iter().map(|[_, y]| y).fold(0.0, f64::max);
        assert!(lowest < 17_008.0, "the legend is within the height: {lowest}");
    }

    #[test]
    fn a_logarithmic_axis_has_no_place_for_zero() {
        let mut plot = Plot::new("t", ["x", "y"], vec![Curve::line("c", [[0.0, 1.0], [1.0, 2.0], [100.0, 3.0]])]);
        plot.x.scale = Scale::Logarithmic;
        assert_eq!(Along::from_plot(&plot, 0, TICKS).range, [1.0, 100.0]);
        assert_eq!(Along::from_plot(&plot, 0, TICKS).map(&10.0, (0, 200)), 100);
        let text = svg(&plot);
        assert!(polylines(&text, "#1F77B4").iter().all(|line| line.len() == 2), "{text}");
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
