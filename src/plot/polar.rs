//! Polar diagrams: a radius over the angle, as an SVG.

use std::fmt::Write;

use super::picture::{COLOURS, ticks};
use super::{Curve, Look, Plot, Style};
use base::markup::escape;
use base::number::significant;

/// Rings of a diagram, at most.
const RINGS: usize = 5;

/// Degrees from one spoke to the next.
const SPOKES: usize = 30;

/// Significant digits of the values that a point shows under the pointer.
const DIGITS: usize = 4;

/// Share of the largest radius that is left free beyond it.
const MARGIN: f64 = 0.04;

/// How a diagram is set, in its own units.
struct Setting {
    /// Of the field with the angles around it.
    size: [f64; 2],
    letters: f64,
    line: f64,
    has_title: bool,
    /// Whether it has a ground of its own, as on paper.
    has_paper: bool,
    /// CSS colours.
    ink: String,
    soft: String,
    grid: String,
    curve: fn(usize) -> String,
}

/// The parts of the diagram, in units of the drawing.
struct Field {
    centre: [f64; 2],
    radius: f64,
    /// The value at the outermost ring.
    most: f64,
}

/// Height of a line of text over that of letters.
const ROW: f64 = 1.5;

/// The colours of a picture on white.
fn fixed(size: [f64; 2], letters: f64, line: f64, has_title: bool) -> Setting {
    Setting {
        size,
        letters,
        line,
        has_title,
        has_paper: true,
        ink: "#1c2126".into(),
        soft: "#56616b".into(),
        grid: "#dbdfe3".into(),
        curve: |place| {
            let colour = COLOURS[place % COLOURS.len()];
            format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2)
        },
    }
}

/// The plot as a picture for a file.
pub(super) fn svg(plot: &Plot) -> String {
    let setting = fixed([380.0, 390.0], 12.0, 2.0, true);
    drawn(plot, &setting, |[width, height]| format!("width=\"{width}\" height=\"{height}\""), Some("sans-serif"))
}

/// The plot in the size and font of paper, its legend within the height.
pub(super) fn svg_in(plot: &Plot, style: &Style) -> String {
    let mut setting = fixed([style.width, style.height], style.letters, style.line, style.has_title);
    setting.size[1] -= legend_height(plot, &setting);
    let size = [style.width, style.height].map(Style::millimetres);
    drawn(plot, &setting, |_| format!("width=\"{}\" height=\"{}\"", size[0], size[1]), Some(&style.family))
}

/// The plot for a page that has its heading and its colours: `--ink`, `--soft`, `--line` and `--c0` to `--c7`; as wide as
/// there is room.
pub fn polar_figure(plot: &Plot) -> String {
    let setting = Setting {
        size: [360.0, 340.0],
        letters: 12.0,
        line: 2.0,
        has_title: false,
        has_paper: false,
        ink: "var(--ink)".into(),
        soft: "var(--soft)".into(),
        grid: "var(--line)".into(),
        curve: |place| format!("var(--c{})", place % COLOURS.len()),
    };
    drawn(plot, &setting, |_| "class=\"polar\" aria-hidden=\"true\"".into(), None)
}

/// The point of an angle (degrees) and a radius in the plane, x along the angle zero.
pub(super) fn in_plane([angle, radius]: [f64; 2]) -> [f64; 2] {
    let angle = angle.to_radians();
    [radius * angle.cos(), radius * angle.sin()]
}

fn drawn(plot: &Plot, setting: &Setting, attributes: impl Fn([f64; 2]) -> String, family: Option<&str>) -> String {
    let [width, height] = [setting.size[0], setting.size[1] + legend_height(plot, setting)];
    let family = family.map(|family| format!(" font-family=\"{}\"", escape(family))).unwrap_or_default();
    let mut text = format!(
        "<svg {} viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\"{family} font-size=\"{}\">\n",
        attributes([width, height]),
        setting.letters
    );
    if setting.has_paper {
        let _ = writeln!(text, "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>");
    }
    if setting.has_title {
        let place = [0.5 * width, ROW * setting.letters];
        text += &words(&plot.title, place, "middle", &setting.ink, " font-weight=\"bold\"");
    }
    let field = field(plot, setting);
    text += &grid(plot, setting, &field);
    for (place, curve) in plot.curves.iter().enumerate() {
        text += &curve_of(plot, curve, &(setting.curve)(place), setting, &field);
    }
    text += &legend(plot, setting);
    text + "</svg>\n"
}

fn field(plot: &Plot, setting: &Setting) -> Field {
    let [width, height] = setting.size;
    let row = ROW * setting.letters;
    // Above the field its title and the label of the radius; around it a row for the angles.
    let top = if setting.has_title { 2.4 * row } else { 1.2 * row };
    let radius = (0.5 * width - 2.2 * row).min(0.5 * (height - top) - 1.2 * row).max(setting.letters);
    let radii = plot.curves.iter().flat_map(|curve| &curve.points).filter(|point| plot.has_place(point));
    let most = radii.map(|point| point[1]).fold(0.0, f64::max);
    let most = if most > 0.0 { most * (1.0 + MARGIN) } else { 1.0 };
    Field { centre: [0.5 * width, top + 1.1 * row + radius], radius, most }
}

impl Field {
    fn place(&self, [angle, radius]: [f64; 2]) -> [f64; 2] {
        let [x, y] = in_plane([angle, radius / self.most * self.radius]);
        [self.centre[0] + x, self.centre[1] - y]
    }
}

/// Rings with their values, spokes with their angles, and the label of the radius.
fn grid(plot: &Plot, setting: &Setting, field: &Field) -> String {
    let mut text = String::new();
    let [x, y] = field.centre;
    let rings = ticks([0.0, field.most], RINGS).into_iter().filter(|ring| *ring > 0.0);
    let rings: Vec<f64> = rings.collect();
    let style = format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"", setting.grid, 0.5 * setting.line);
    for ring in rings.iter().chain([&field.most]) {
        let radius = ring / field.most * field.radius;
        let _ = writeln!(text, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" {style}/>");
    }
    for angle in (0..360).step_by(SPOKES).map(|angle| angle as f64) {
        let [to_x, to_y] = field.place([angle, field.most]);
        let _ = writeln!(text, "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{to_x:.2}\" y2=\"{to_y:.2}\" {style}/>");
        let away = field.most * (1.0 + 0.9 * setting.letters / field.radius);
        let [label_x, label_y] = field.place([angle, away]);
        let anchor = match in_plane([angle, 1.0])[0] {
            side if side > 0.1 => "start",
            side if side < -0.1 => "end",
            _ => "middle",
        };
        let place = [label_x, label_y + 0.35 * setting.letters];
        text += &words(&format!("{angle}°"), place, anchor, &setting.soft, "");
    }
    // Between two spokes, where fewest curves are labelled over.
    for ring in &rings {
        let [label_x, label_y] = field.place([75.0, *ring]);
        let place = [label_x, label_y - 0.15 * setting.letters];
        text += &words(&significant(*ring, DIGITS), place, "middle", &setting.soft, "");
    }
    let label = format!("{} over {}", plot.y.label, plot.x.label);
    let top = field.centre[1] - field.radius - 2.0 * setting.letters * ROW * 0.75;
    text += &words(&label, [0.5 * setting.size[0], top], "middle", &setting.ink, "");
    text
}

/// A curve: the runs between points that have no place.
fn curve_of(plot: &Plot, curve: &Curve, colour: &str, setting: &Setting, field: &Field) -> String {
    let mut text = String::new();
    let runs = curve.points.split(|point| !plot.has_place(point)).filter(|run| !run.is_empty());
    for run in runs {
        if curve.look == Look::Points {
            for point in run {
                let [x, y] = field.place(*point);
                let _ = writeln!(
                    text,
                    "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{}\" fill=\"{colour}\"><title>{}: {} at {}°</title></circle>",
                    1.6 * setting.line,
                    escape(&curve.name),
                    significant(point[1], DIGITS),
                    significant(point[0], DIGITS),
                );
            }
            continue;
        }
        let points = run.iter().map(|point| {
            let [x, y] = field.place(*point);
            format!("{x:.2},{y:.2}")
        });
        let points = points.collect::<Vec<_>>().join(" ");
        let style = line_style(curve.look, colour, setting);
        let _ = writeln!(text, "<polyline points=\"{points}\" {style}/>");
    }
    text
}

fn line_style(look: Look, colour: &str, setting: &Setting) -> String {
    let dash = match look {
        Look::Dashed => format!(" stroke-dasharray=\"{} {}\"", 3.0 * setting.line, 2.0 * setting.line),
        Look::Line | Look::Points => String::new(),
    };
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{}\"{dash}", setting.line)
}

/// The names of the curves below the field, one below the other in as many columns as there is room for.
fn legend(plot: &Plot, setting: &Setting) -> String {
    let mut text = String::new();
    if !has_legend(plot) {
        return text;
    }
    let columns = columns(plot, setting);
    let row = ROW * setting.letters;
    for (place, curve) in plot.curves.iter().enumerate() {
        let colour = (setting.curve)(place);
        let x = setting.letters + (place % columns) as f64 * (setting.size[0] - setting.letters) / columns as f64;
        let y = setting.size[1] + (place / columns) as f64 * row + 0.5 * row;
        let end = x + 2.0 * setting.letters;
        match curve.look {
            Look::Points => {
                let radius = 1.6 * setting.line;
                let middle = 0.5 * (x + end);
                let _ = writeln!(text, "<circle cx=\"{middle:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{colour}\"/>");
            }
            look => {
                let style = line_style(look, &colour, setting);
                let _ = writeln!(text, "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{end:.2}\" y2=\"{y:.2}\" {style}/>");
            }
        }
        let at = [end + 0.5 * setting.letters, y + 0.35 * setting.letters];
        text += &words(&curve.name, at, "start", &setting.ink, "");
    }
    text
}

fn columns(plot: &Plot, setting: &Setting) -> usize {
    let longest = plot.curves.iter().map(|curve| curve.name.chars().count()).max().unwrap_or(0);
    // The mark, the gap and letters that are narrower than 0.57 of their height on average.
    let width = setting.letters * (3.5 + 0.57 * longest as f64);
    ((setting.size[0] / width) as usize).clamp(1, 4)
}

/// Whether the curves are named: a single one has the name of the plot.
fn has_legend(plot: &Plot) -> bool {
    plot.curves.len() > 1
}

fn legend_height(plot: &Plot, setting: &Setting) -> f64 {
    if !has_legend(plot) {
        return 0.0;
    }
    plot.curves.len().div_ceil(columns(plot, setting)) as f64 * ROW * setting.letters
}

fn words(text: &str, [x, y]: [f64; 2], anchor: &str, colour: &str, more: &str) -> String {
    let text = escape(text);
    format!("<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" fill=\"{colour}\"{more}>{text}</text>\n")
}

/// Points of a full circle, for a curve that is the same at opposite angles: `points` over half a turn, and again behind it.
pub fn around(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let behind = points.iter().map(|[angle, radius]| [angle + 180.0, *radius]);
    points.iter().copied().chain(behind).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Frame, braille, svg as any_svg};

    fn plot() -> Plot {
        let circle = (0..=36).map(|step| [f64::from(step) * 10.0, 50.0]);
        let measured =
            Curve { look: Look::Points, ..Curve::line("a < b", [[0.0, 50.0], [90.0, 25.0], [10.0, f64::NAN]]) };
        let mut plot =
            Plot::new("A & B", ["angle from MD", "modulus (MPa)"], vec![Curve::line("law", circle), measured]);
        plot.frame = Frame::Polar;
        plot
    }

    /// An ellipse four times as long as high covers four times as many columns of dots as rows of them.
    #[test]
    fn a_terminal_has_one_scale_for_both_axes() {
        let of = |angle: f64| {
            [angle, (angle.to_radians().cos().powi(2) / 16.0 + angle.to_radians().sin().powi(2)).sqrt().recip()]
        };
        let ellipse = (0..=360).map(|angle| of(f64::from(angle)));
        let mut plot = Plot::new("a", ["angle", "modulus"], vec![Curve::line("law", ellipse)]);
        plot.frame = Frame::Polar;
        let text = braille(&plot, [40, 20]);
        let rows = text.lines().filter(|line| line.chars().any(|c| (0x2801..0x2900).contains(&(c as u32)))).count();
        assert!((4..=6).contains(&rows), "a quarter of 20 rows:\n{text}");
    }

    #[test]
    fn points_lie_at_their_angle_and_radius() {
        let field = Field { centre: [100.0, 100.0], radius: 50.0, most: 10.0 };
        for ([angle, radius], expected) in
            [([0.0, 10.0], [150.0, 100.0]), ([90.0, 5.0], [100.0, 75.0]), ([180.0, 2.0], [90.0, 100.0])]
        {
            let found = field.place([angle, radius]);
            assert!((0..2).all(|axis| (found[axis] - expected[axis]).abs() < 1e-9), "{found:?}");
        }
    }

    #[test]
    fn every_output_of_a_plot_knows_the_polar_frame() {
        let text = any_svg(&plot());
        for words in
            ["A &amp; B", "a &lt; b: 25 at 90°", "modulus (MPa) over angle from MD", "330°", "<polyline", "#1F77B4"]
        {
            assert!(text.contains(words), "{words} in {text}");
        }
        assert!(!text.contains("NaN") && text.matches("<title>").count() == 2, "{text}");
        let style = Style {
            width: Style::points(0.06),
            height: Style::points(0.08),
            letters: 8.0,
            family: "serif".into(),
            line: 1.0,
            has_title: false,
        };
        let paper = crate::svg_in(&plot(), &style);
        assert!(paper.contains("width=\"60mm\" height=\"80mm\"") && !paper.contains("A &amp; B"), "{paper}");
        assert!(polar_figure(&plot()).contains("var(--c1)"));
        // In a terminal as wide as it is high: a character has two dots across and four down.
        let lines: Vec<String> = braille(&plot(), [40, 20]).lines().map(str::to_owned).collect();
        let dots = |line: &String| line.chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count();
        assert!(dots(&lines[1]) > 3 && dots(&lines[20]) > 3 && dots(&lines[10]) >= 2, "{lines:#?}");
    }

    #[test]
    fn a_diagram_without_points_has_a_grid_alone() {
        let mut empty = plot();
        empty.curves.iter_mut().for_each(|curve| curve.points = vec![[0.0, f64::NAN]]);
        let text = any_svg(&empty);
        assert!(text.contains("<circle") && !text.contains("<polyline") && !text.contains("NaN"), "{text}");
    }

    #[test]
    fn half_a_turn_becomes_a_whole_one() {
        assert_eq!(around(&[[0.0, 1.0], [90.0, 2.0]]), [[0.0, 1.0], [90.0, 2.0], [180.0, 1.0], [270.0, 2.0]]);
    }
}
