//! Diagrams as text: curves of dots in the characters of braille.

use super::{Axis, Plot, Scale};
use base::number;

/// Dots of a character, across and down.
const ACROSS: usize = 2;
const DOWN: usize = 4;

/// The bit of each dot of a character, row by row.
const DOTS: [[u32; ACROSS]; DOWN] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// The character without dots.
const BLANK: u32 = 0x2800;

/// Significant digits of the ends of the axes.
const DIGITS: usize = 4;

/// The plot in `size` characters across and down, without the texts beside and below; all curves look alike. A mark is a
/// dotted line with its label below the axis. Empty where no curve has a point.
pub fn braille(plot: &Plot, size: [usize; 2]) -> String {
    let place = |p: &[f64; 2]| plot.has_place(p).then(|| [plot.x.scale.along(p[0]), plot.y.scale.along(p[1])]);
    let placed: Vec<Vec<Option<[f64; 2]>>> =
        plot.curves.iter().map(|curve| curve.points.iter().map(place).collect()).collect();
    let range = |axis: usize| number::ends(placed.iter().flatten().flatten().map(|point| point[axis]));
    let (Some(x), Some(y)) = (range(0), range(1)) else { return String::new() };
    let mut canvas = Canvas::new(size);
    let dots = [(size[0] * ACROSS - 1) as f64, (size[1] * DOWN - 1) as f64];
    let dot = |[a, b]: [f64; 2]| [share(a, x) * dots[0], (1.0 - share(b, y)) * dots[1]];
    for points in &placed {
        for (place, point) in points.iter().enumerate() {
            let Some(point) = point.map(dot) else { continue };
            let before = place.checked_sub(1).and_then(|before| points[before]).map_or(point, dot);
            canvas.line(before, point);
        }
    }
    let columns = marked(plot, x, size[0]);
    for (column, _) in &columns {
        canvas.upright(*column);
    }
    framed(plot, &canvas, &columns, [x, y])
}

/// The columns of characters of the marks within the ends of the x axis, from left to right, with their labels.
fn marked(plot: &Plot, [from, to]: [f64; 2], width: usize) -> Vec<(usize, &str)> {
    let inside = plot.marks.iter().map(|mark| (plot.x.scale.along(mark.at), mark.label.as_str()));
    let inside = inside.filter(|(at, _)| (from..=to).contains(at));
    let dots = (width * ACROSS - 1) as f64;
    let mut columns: Vec<(usize, &str)> =
        inside.map(|(at, label)| ((share(at, [from, to]) * dots).round() as usize / ACROSS, label)).collect();
    columns.sort_by_key(|(column, _)| *column);
    columns
}

/// The labels below their columns, in as few lines as they need.
fn labelled(columns: &[(usize, &str)], width: usize) -> Vec<String> {
    let mut lines: Vec<String> = vec![];
    for (column, label) in columns {
        let length = label.chars().count();
        let start = (*column).min(width.saturating_sub(length));
        let end = |line: &String| line.chars().count();
        let free = lines.iter().position(|line| line.is_empty() || end(line) < start);
        let line = free.unwrap_or_else(|| {
            lines.push(String::new());
            lines.len() - 1
        });
        let gap = start - end(&lines[line]);
        lines[line] += &format!("{}{label}", " ".repeat(gap));
    }
    lines
}

/// The value at a place of an axis.
fn off(axis: &Axis, value: f64) -> f64 {
    if axis.scale == Scale::Logarithmic { 10_f64.powf(value) } else { value }
}

/// Where a value lies between the ends of a range; in its middle where these are the same.
fn share(value: f64, [from, to]: [f64; 2]) -> f64 {
    if to > from { (value - from) / (to - from) } else { 0.5 }
}

struct Canvas {
    width: usize,
    cells: Vec<u32>,
}

impl Canvas {
    fn new([width, height]: [usize; 2]) -> Canvas {
        Canvas { width, cells: vec![0; width * height] }
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2]) {
        let steps = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()).ceil().max(1.0);
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            self.dot([0, 1].map(|axis| (from[axis] + share * (to[axis] - from[axis])).round() as usize));
        }
    }

    /// A dotted line through a column of characters.
    fn upright(&mut self, column: usize) {
        let height = self.cells.len() / self.width * DOWN;
        for y in (0..height).step_by(2) {
            self.dot([column * ACROSS, y]);
        }
    }

    fn dot(&mut self, [x, y]: [usize; 2]) {
        self.cells[y / DOWN * self.width + x / ACROSS] |= DOTS[y % DOWN][x % ACROSS];
    }

    fn lines(&self) -> impl Iterator<Item = String> {
        let character = |cell: &u32| char::from_u32(BLANK + cell).unwrap_or(' ');
        self.cells.chunks(self.width).map(move |line| line.iter().map(character).collect())
    }
}

/// The canvas within its axes.
fn framed(plot: &Plot, canvas: &Canvas, columns: &[(usize, &str)], [x, y]: [[f64; 2]; 2]) -> String {
    let text = |axis: &Axis, value: f64| number::figure(off(axis, value), DIGITS);
    let [bottom, top] = y.map(|value| text(&plot.y, value));
    let [left, right] = x.map(|value| text(&plot.x, value));
    let margin = bottom.chars().count().max(top.chars().count());
    let mut lines = vec![format!("{} {}", " ".repeat(margin), plot.y.label)];
    let last = canvas.cells.len() / canvas.width - 1;
    for (place, line) in canvas.lines().enumerate() {
        let label = if place == 0 {
            &top
        } else if place == last {
            &bottom
        } else {
            ""
        };
        lines.push(format!("{label:>margin$} │{line}"));
    }
    let is_marked = |column: usize| columns.iter().any(|(marked, _)| *marked == column);
    let axis: String = (0..canvas.width).map(|column| if is_marked(column) { '┬' } else { '─' }).collect();
    lines.push(format!("{} └{axis}", " ".repeat(margin)));
    lines.extend(labelled(columns, canvas.width).iter().map(|line| format!("{}  {line}", " ".repeat(margin))));
    let label = &plot.x.label;
    let gap = canvas.width.saturating_sub(left.chars().count() + right.chars().count());
    lines.push(format!("{}  {left}{label:^gap$}{right}", " ".repeat(margin)));
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Curve, Plot};

    #[test]
    fn a_line_runs_from_corner_to_corner() {
        let plot = Plot::new("a", ["x (s)", "y (N)"], vec![Curve::line("c", [[0.0, -1.0], [2.0, 3.0]])]);
        let text = braille(&plot, [12, 3]);
        let expected = "       y (N)\n 3.000 │⠀⠀⠀⠀⠀⠀⠀⠀⣀⠤⠒⠉\n       │⠀⠀⠀⠀⣀⠤⠒⠉⠀⠀⠀⠀\n-1.000 │⣀⠤⠒⠉⠀⠀⠀⠀⠀⠀⠀⠀\n       └────────────\n        0x (s) 2.000\n";
        assert_eq!(text, expected, "{text}");
    }

    #[test]
    fn marks_have_their_labels_below_the_axis_each_at_its_place() {
        let mark = |label: &str, at: f64| crate::Mark { label: label.into(), at };
        let mut plot = Plot::new("a", ["x", "y"], vec![Curve::line("c", [[0.0, 0.0], [10.0, 0.0]])]);
        plot.marks = vec![mark("late", 9.5), mark("first", 0.0), mark("next", 2.0), mark("beyond", 11.0)];
        let text = braille(&plot, [21, 1]);
        let below: Vec<&str> = text.lines().skip(2).map(|line| line.trim_start_matches("0 ")).collect();
        let expected =
            ["  └┬───┬──────────────┬─", "   first            late", "       next", "   0       x       10.00"];
        assert_eq!(below, expected, "{text}");
    }

    #[test]
    fn gaps_and_values_without_a_place_are_left_out() {
        let mut plot = Plot::new("a", ["x", "y"], vec![Curve::line("c", [[0.0, 1.0], [1.0, f64::NAN], [2.0, 1.0]])]);
        let text = braille(&plot, [11, 1]);
        let row = text.lines().nth(1).unwrap();
        assert_eq!(row.chars().filter(|c| *c as u32 > BLANK).count(), 2, "{text}");
        plot.y.scale = Scale::Logarithmic;
        plot.curves[0].points = vec![[0.0, -1.0]];
        assert_eq!(braille(&plot, [11, 1]), "");
    }
}
