//! The differences between runs, as they are said, drawn and set in tables.

use serde_json::Value;

use super::super::ranges::{Line, Look, ranges};
use super::super::table::{self, Cell};
use super::super::{cell, figure, html};
use super::{keys, signed_percent};
use base::written::{Reading, digits};
use scene::scenario::grammar;
use study::post::comparison::{ComparedFigure, ComparedKey, ComparedSignal};
use study::post::{RunComparison, is_result};

/// Most differences that the sentence names, and that are drawn of a run.
const MOST_NAMED: usize = 3;
const MOST_DRAWN: usize = 8;

/// Least difference that is one, as a share: smaller ones are shown as zero.
const LEAST_DIFFERENCE: f64 = 5e-4;

/// The difference of a figure of a run from that of the first.
struct Difference<'a> {
    figure: &'a ComparedFigure,
    share: f64,
}

impl Difference<'_> {
    fn words(&self) -> String {
        Reading::of_name(&self.figure.name, 0.0).0
    }

    /// The values of the first run and of this one with their unit.
    fn values(&self, run: usize) -> String {
        let value = |run: usize| self.figure.values[run].as_ref().and_then(Value::as_f64).unwrap_or(f64::NAN);
        let (first, own) = (value(0), value(run));
        let reading = Reading::of_name(&self.figure.name, first.abs().max(own.abs())).1;
        format!("{} instead of {}", reading.text(own), reading.text(first))
    }
}

/// The figures by which runs are judged that differ in a run, the largest difference first.
fn judged(comparison: &RunComparison, run: usize) -> Vec<Difference<'_>> {
    let is_judged = |figure: &&ComparedFigure| is_result(&figure.name);
    let of = |figure| Some(Difference { figure, share: ComparedFigure::difference(figure, run)? });
    let mut all: Vec<Difference> = comparison.figures.iter().filter(is_judged).filter_map(of).collect();
    all.retain(|difference| difference.share.abs() >= LEAST_DIFFERENCE);
    all.sort_by(|a, b| b.share.abs().total_cmp(&a.share.abs()));
    all
}

/// What differs most, and in how many keys the scenarios differ.
pub(super) fn sentence(comparison: &RunComparison) -> String {
    let first = comparison.runs.first().map_or("", |run| &run.name);
    let of_run = |run: usize| {
        let name = &comparison.runs[run].name;
        let differences = judged(comparison, run);
        let named = differences.iter().take(MOST_NAMED);
        let named: Vec<String> = named.map(|one| format!("{} {}", one.words(), signed_percent(one.share))).collect();
        match named.is_empty() {
            true => format!("{name} has the key figures of {first}."),
            false => format!("{name} against {first}: {}.", named.join(", ")),
        }
    };
    let count = comparison.runs.len();
    let runs = (1..count.min(1 + MOST_NAMED)).map(of_run);
    let rest = (count > 1 + MOST_NAMED).then(|| format!("And {} more runs.", count - 1 - MOST_NAMED));
    let keys = match comparison.keys.len() {
        0 => None,
        1 => Some(format!("Their scenarios differ in one key: {}.", key_words(&comparison.keys[0].path))),
        several => Some(format!("Their scenarios differ in {several} keys.")),
    };
    let outcome = ruptures(comparison);
    runs.chain(rest).chain(outcome).chain(keys).collect::<Vec<_>>().join(" ")
}

/// The runs whose film ruptured, where it held in others.
fn ruptures(comparison: &RunComparison) -> Option<String> {
    let ruptured = comparison.figures.iter().find(|figure| figure.name == "ruptured")?;
    let is = |run: &usize| ruptured.values[*run] == Some(Value::Bool(true));
    let broken: Vec<&str> =
        (0..comparison.runs.len()).filter(is).map(|run| comparison.runs[run].name.as_str()).collect();
    let all = ruptured.values.iter().flatten().count();
    (!broken.is_empty() && broken.len() < all).then(|| format!("The film ruptures in {} alone.", broken.join(", ")))
}

/// The differences as bars, the largest first, a block a run.
pub(super) fn bars(comparison: &RunComparison) -> String {
    let of_run = |run: usize| {
        let line = |one: &Difference| Line {
            words: one.words(),
            title: one.figure.name.clone(),
            value: Some(one.share),
            text: format!("{} ({})", signed_percent(one.share), one.values(run)),
            ..Line::default()
        };
        let lines: Vec<Line> = judged(comparison, run).iter().take(MOST_DRAWN).map(line).collect();
        ranges(&format!("{} against {}", comparison.runs[run].name, comparison.runs[0].name), Look::Bars, &lines)
    };
    let blocks: String = (1..comparison.runs.len()).map(of_run).collect();
    html::section("Differences", &blocks)
}

/// A figure with its values in the unit in which they are read, each with its difference.
pub(super) fn shown_figures<'a>(figures: impl Iterator<Item = &'a ComparedFigure>) -> Vec<Vec<Cell>> {
    let row = |figure: &ComparedFigure| {
        let number = |value: &Option<Value>| value.as_ref().and_then(Value::as_f64);
        let size = figure.values.iter().filter_map(number).map(f64::abs).fold(0.0, f64::max);
        let (words, reading) = Reading::of_name(&figure.name, size);
        let cell = |(run, value): (usize, &Option<Value>)| match (number(value), value) {
            (Some(number), _) => {
                let is_error = figure.name.ends_with("_error");
                let difference = figure.difference(run).filter(|share| share.abs() >= LEAST_DIFFERENCE && !is_error);
                let beside = difference.map_or_else(String::new, |share| format!(" ({})", signed_percent(share)));
                Cell::number(number, format!("{}{beside}", reading.text(number)))
            }
            (None, Some(value)) => Cell::text(cell(value)),
            (None, None) => Cell::text("-"),
        };
        let values = figure.values.iter().enumerate().map(cell);
        std::iter::once(Cell::text(words).titled(&figure.name)).chain(values).collect()
    };
    figures.map(row).collect()
}

/// A key by its title, then a value a scenario.
pub(super) fn shown_keys(comparison: &RunComparison) -> Vec<Vec<Cell>> {
    let row = |(key, cells): (&ComparedKey, Vec<String>)| {
        let title = Cell::text(key_words(&key.path)).titled(&key.path);
        std::iter::once(title).chain(cells.into_iter().skip(1).map(Cell::text)).collect()
    };
    comparison.keys.iter().zip(keys(comparison)).map(row).collect()
}

/// A key in words; that of another file as it is written.
fn key_words(path: &str) -> String {
    grammar::title(path).unwrap_or_else(|| path.to_owned())
}

/// The errors of the signals as shares in percent, which sort.
pub(super) fn shown_errors(comparison: &RunComparison, head: &[Cell]) -> String {
    let value = |error: &Option<f64>| {
        error.map_or_else(|| Cell::text("-"), |error| Cell::number(error, format!("{} %", digits(100.0 * error))))
    };
    let row = |signals: &ComparedSignal| {
        let name = Cell::text(figure::named(&signals.column).0).titled(&signals.column);
        std::iter::once(name).chain(signals.errors.iter().map(value)).collect()
    };
    table::table(head, &comparison.signals.iter().map(row).collect::<Vec<_>>())
}
