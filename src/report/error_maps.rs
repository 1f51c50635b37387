//! The comparison with a displacement field on the page of a run: how it was aligned, the errors over time and their maps.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::html::{escape, table_of_numbers};
use super::{RunPage, drawn};
use base::number::{duration, significant};
use plot::viridis::{stops, viridis};
use plot::{Curve, Plot, TIME};
use study::field_comparison::{FieldComparison, StateErrors};

/// Digits of figures.
const DIGITS: usize = 3;
/// Most maps of a page.
const MOST_MAPS: usize = 6;
/// Units along the longer side of a map.
const SIDE: f64 = 1000.0;
/// Cells along the longer side into which points are gathered.
const CELLS: f64 = 64.0;
/// Colours of a map.
const SHADES: usize = 24;

/// The section; empty without a field.
pub(super) fn section(run: &RunPage) -> String {
    let Some(field) = &run.results.field else { return String::new() };
    let lines = [measured(run, field), aligned(field), gaps(field)];
    let lines: String =
        lines.into_iter().filter(|line| !line.is_empty()).map(|line| format!("<p>{}</p>\n", escape(&line))).collect();
    let plot = Plot::new(
        "Errors over time",
        [TIME, "error (mm)"],
        vec![
            Curve::line("root mean square", over_time(field, |state| state.norms.rms().unwrap_or(f64::NAN))),
            Curve::line("largest", over_time(field, |state| state.norms.largest().unwrap_or(f64::NAN))).dashed(),
        ],
    );
    let plots = if field.states.len() > 1 { drawn::figures(&[plot]) } else { String::new() };
    format!("{lines}{}{plots}{}", maps(field), rows(field))
}

fn millimetres(length: f64) -> String {
    format!("{} mm", significant(length * 1e3, DIGITS))
}

/// What was measured, and how far the run is from it.
fn measured(run: &RunPage, field: &FieldComparison) -> String {
    let program = run
        .results
        .comparison
        .as_ref()
        .and_then(|known| known.field.as_ref())
        .map(|known| format!("The columns {} are those of {}. ", known.columns.join(", "), known.program));
    let ([points, compared], norms) = (field.counts(), field.norms());
    let of_measured = norms
        .relative()
        .map(|share| format!(", {} % of the measured displacements", significant(share * 100.0, DIGITS)));
    format!(
        "{}{compared} of {points} measured points of {} files lie on face {} and are compared with its nearest point. The error is \
         {} (root mean square){}; the largest is {}.",
        program.unwrap_or_default(),
        field.states.len(),
        field.face + 1,
        norms.rms().map_or("-".into(), millimetres),
        of_measured.unwrap_or_default(),
        norms.largest().map_or("-".into(), millimetres),
    )
}

/// The motion from the axes of the field.
fn aligned(field: &FieldComparison) -> String {
    let motion = &field.alignment.motion;
    let [x, y, z] = [0, 1, 2].map(|axis| significant(motion.translation[axis] * 1e3, 5));
    let [a, b, c] = motion.rotation_vector().map(|part| significant(part.to_degrees(), 5));
    let moved = format!("turned by ({a}, {b}, {c}) degrees (axis times angle), then moved by ({x}, {y}, {z}) mm");
    match field.alignment.found {
        Some(found) => format!(
            "The field was {moved}: found by places and displacements together. The residuals have a standard deviation of {}; a place at \
             the edge of the field is known to {} in the direction in which it is known least, if errors of points do not depend on each \
             other.",
            millimetres(found.deviation),
            millimetres(found.least_known)
        ),
        None if motion.rotation.angle() == 0.0 && motion.translation.norm() == 0.0 => {
            "The axes of the field are those of the run.".into()
        }
        None => format!("The field was {moved}, by its markers."),
    }
}

/// What is not compared.
fn gaps(field: &FieldComparison) -> String {
    match (field.outside, field.not_reached.len()) {
        (0, 0) => String::new(),
        (outside, not_reached) => {
            format!(
                "Files that are not compared: {outside} outside of the window, {not_reached} that the run did not reach."
            )
        }
    }
}

fn over_time(field: &FieldComparison, value: impl Fn(&StateErrors) -> f64) -> Vec<[f64; 2]> {
    field.states.iter().map(|state| [state.time * 1e3, value(state) * 1e3]).collect()
}

fn rows(field: &FieldComparison) -> String {
    let header = ["time (ms)", "points", "not matched", "root mean square (mm)", "largest (mm)"];
    let row = |state: &StateErrors| {
        vec![
            significant(state.time * 1e3, 6),
            state.norms.points.to_string(),
            state.missing.to_string(),
            state.norms.rms().map_or(String::new(), |rms| significant(rms * 1e3, DIGITS)),
            state.norms.largest().map_or(String::new(), |largest| significant(largest * 1e3, DIGITS)),
        ]
    };
    let rows = table_of_numbers(0, &header, &field.states.iter().map(row).collect::<Vec<_>>());
    format!("<details>\n<summary>Errors at each time</summary>\n{rows}</details>\n")
}

/// Maps of some states, seen along z, in common colours.
fn maps(field: &FieldComparison) -> String {
    let Some(frame) = Frame::new(field) else { return String::new() };
    let count = field.states.len().min(MOST_MAPS);
    let chosen = (1..=count).map(|number| &field.states[number * field.states.len() / count - 1]);
    let gathered: Vec<(&StateErrors, Vec<Cell>)> = chosen.map(|state| (state, frame.cells(field, state))).collect();
    let largest = gathered.iter().flat_map(|(_, cells)| cells).map(|cell| cell.error).fold(0.0, f64::max);
    if largest <= 0.0 {
        return String::new();
    }
    let figures = gathered.iter().map(|(state, cells)| figure(&frame, state, cells, largest));
    let figures = drawn::small_figures(figures);
    let stops = stops().map(|(_, colour)| colour).collect::<Vec<_>>().join(", ");
    format!(
        "<h3>Error of the displacement, seen along z</h3>\n{figures}<p class=\"note\">0 <span class=\"colours\" \
         style=\"background:linear-gradient(to right, {stops})\"></span> {}; a mark is the root mean square of the points at its \
         place</p>\n",
        escape(&millimetres(largest))
    )
}

/// Where points are drawn.
struct Frame {
    low: [f64; 2],
    /// Units of the drawing for a metre.
    scale: f64,
    size: [f64; 2],
    /// Side of a mark, units.
    mark: f64,
}

/// A mark: its place in units of the drawing, and the error there, m.
struct Cell {
    place: [f64; 2],
    error: f64,
}

impl Frame {
    fn new(field: &FieldComparison) -> Option<Frame> {
        let on_film =
            || field.places.iter().zip(&field.on_film).filter(|(_, on_film)| **on_film).map(|(place, _)| place);
        let bound = |axis: usize, pick: fn(f64, f64) -> f64| on_film().map(|place| place[axis]).reduce(pick);
        let low = [bound(0, f64::min)?, bound(1, f64::min)?];
        let high = [bound(0, f64::max)?, bound(1, f64::max)?];
        let extent = [high[0] - low[0], high[1] - low[1]];
        let longer = extent[0].max(extent[1]);
        if !(longer > 0.0 && longer.is_finite()) {
            return None;
        }
        let scale = SIDE / longer;
        let size = extent.map(|length| (length * scale).max(SIDE / CELLS));
        let apart = (size[0] * size[1] / on_film().count() as f64).sqrt();
        Some(Frame { low, scale, size, mark: apart.max(SIDE / CELLS) })
    }

    /// The points of a state, those of a cell together.
    fn cells(&self, field: &FieldComparison, state: &StateErrors) -> Vec<Cell> {
        let mut cells: BTreeMap<[i64; 2], (f64, [f64; 2], f64)> = BTreeMap::new();
        for point in state.points.iter().filter(|point| field.on_film[point.place as usize]) {
            let place = field.places[point.place as usize];
            let [x, y] = [0, 1].map(|axis| (place[axis] - self.low[axis]) * self.scale);
            let cell = [x, y].map(|along| (along / (SIDE / CELLS)) as i64);
            let (count, sum, squares) = cells.entry(cell).or_default();
            *count += 1.0;
            sum[0] += x;
            sum[1] += self.size[1] - y;
            *squares += point.size().powi(2);
        }
        let cell = |(count, sum, squares): (f64, [f64; 2], f64)| Cell {
            place: sum.map(|along| along / count),
            error: (squares / count).sqrt(),
        };
        cells.into_values().map(cell).collect()
    }
}

/// The colour of a share of the range, `#rrggbb`.
fn colour(share: f64) -> String {
    let [r, g, b] = viridis(share as f32).map(|part| part.round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn figure(frame: &Frame, state: &StateErrors, cells: &[Cell], largest: f64) -> String {
    let mut paths: BTreeMap<usize, String> = BTreeMap::new();
    let side = frame.mark.ceil();
    for Cell { place: [x, y], error } in cells {
        let shade = (error / largest * (SHADES - 1) as f64).round() as usize;
        let path = paths.entry(shade).or_default();
        let _ = write!(path, "M{} {}h{side}v{side}h-{side}z", x.round(), y.round());
    }
    let drawn: String = paths
        .iter()
        .map(|(shade, path)| format!("<path fill=\"{}\" d=\"{path}\"/>", colour(*shade as f64 / (SHADES - 1) as f64)))
        .collect();
    let time = duration(state.time);
    let words = format!(
        "Errors at {time}: root mean square {}, largest {}",
        state.norms.rms().map_or("-".into(), millimetres),
        state.norms.largest().map_or("-".into(), millimetres)
    );
    let [width, height] = frame.size.map(|length| length + side);
    format!(
        "<figure class=\"map\">\n<h4>{}</h4>\n<svg role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {width:.0} {height:.0}\">{drawn}</svg>\n\
         </figure>\n",
        escape(&time),
        escape(&words)
    )
}
