//! The page of a comparison of runs.

use std::path::Path;

use serde_json::Value;

use crate::drawn::{self, Line, RangeLook, ranges};
use crate::html::{self, Cell, folded};
use crate::panes::CHARACTERISTICS;
use crate::{Figure, cell, figure};
use base::diagnostic::shown_path;
use base::number::significant;
use base::written::{DIGITS, Reading, capital, digits};
use lab::signal::{Series, column};
use plot::{Curve, Plot, TIME, thinned_together};
use scene::expectation::Outside;
use scene::scenario::grammar;
use study::post::comparison::{ComparedFigure, ComparedKey, ComparedRun, ComparedSignal};
use study::post::{self, LEAST_SHARE, RunComparison};

/// Most points of all curves, so that the page can be sent by mail.
const MOST_POINTS: usize = 100_000;

/// Relative difference from which it is said as a multiple.
const MOST_SHARE: f64 = 9.0;

/// `report.html` of a comparison; with bounds, how far runs are outside of them.
pub fn compare_page(comparison: &RunComparison, outside: Option<&[Outside]>) -> String {
    let title = comparison.title();
    let head = |first: &str| {
        let names = comparison.runs.iter().map(|run| Cell::text(&run.name));
        std::iter::once(Cell::text(first)).chain(names).collect::<Vec<_>>()
    };
    let [over_time, against] = plots(comparison);
    let film = film(comparison).map(|row| row.into_iter().map(Cell::text).collect());
    let rows: Vec<Vec<Cell>> = film.into_iter().chain(shown_figures(comparison.key_figures())).collect();
    let key_figures = html::sorted_table(&head("figure"), &rows);
    let others = html::sorted_table(&head("figure"), &shown_figures(comparison.other_figures()));
    let parts = [
        html::findings(Vec::new(), &comparison.findings),
        html::section("Bounds", &outside.map(bounds).unwrap_or_default()),
        bars(comparison),
        html::section("Scenarios", &html::sorted_table(&head("key"), &shown_keys(comparison))),
        html::section("Signals", &drawn::small(against.iter().chain(&over_time))),
        html::section("Figures", &folded("those that differ, and the key figures", &key_figures)),
        html::section(
            "Errors of signals",
            &folded("of each run", &distances(&shown_errors(comparison, &head("signal")))),
        ),
        html::section("Further figures", &folded("those that are equal, and the cost", &others)),
        html::section("Runs", &html::table(&["run", "title", "path"], &runs(comparison))),
    ];
    html::finished(&title, &sentence(comparison), &parts)
}

fn bounds(outside: &[Outside]) -> String {
    let rows = outside.iter().flat_map(|Outside { run, differences }| {
        let within = differences.is_empty().then(|| vec![run.clone(), "within the bounds".into()]);
        within.into_iter().chain(differences.iter().map(|difference| vec![run.clone(), difference.to_string()]))
    });
    html::table(&["run", "verdict"], &rows.collect::<Vec<_>>())
}

fn runs(comparison: &RunComparison) -> Vec<Vec<String>> {
    let row = |run: &ComparedRun| vec![run.name.clone(), run.title.clone().unwrap_or_default(), shown_path(&run.place)];
    comparison.runs.iter().map(row).collect()
}

/// Whether the film of each run held, or when it ruptured.
pub fn film(comparison: &RunComparison) -> Option<Vec<String>> {
    comparison.film().map(|runs| std::iter::once("film".to_owned()).chain(runs).collect())
}

/// Name with unit, then a value a run with its difference.
pub fn figures<'a>(figures: impl Iterator<Item = &'a ComparedFigure>) -> Vec<Vec<String>> {
    figures.map(|figure| std::iter::once(quantity(&figure.name)).chain(values(figure)).collect()).collect()
}

fn values(figure: &ComparedFigure) -> impl Iterator<Item = String> + '_ {
    let value = |value: &Value| Figure::from_value(&figure.name, value).map_or_else(String::new, |figure| figure.value);
    figure.values.iter().enumerate().map(move |(run, of_run)| {
        let of_run = of_run.as_ref().map_or_else(|| "-".into(), value);
        match figure.difference(run) {
            // An error is a share already.
            Some(difference) if difference != 0.0 && !figure.name.ends_with("_error") => {
                format!("{of_run} ({})", signed_percent(difference))
            }
            _ => of_run,
        }
    })
}

/// A key, then a value a scenario; paths are seen from here.
pub fn keys(comparison: &RunComparison) -> Vec<Vec<String>> {
    let shown = |text: &str| if Path::new(text).is_absolute() { shown_path(Path::new(text)) } else { text.to_owned() };
    let value =
        |value: &Option<String>| value.as_deref().map_or_else(|| "-".into(), |text| shown(text.trim_matches('"')));
    comparison
        .keys
        .iter()
        .map(|key| std::iter::once(key.path.clone()).chain(key.values.iter().map(value)).collect())
        .collect()
}

/// A signal, then the error of each run against the first.
pub fn errors(comparison: &RunComparison) -> Vec<Vec<String>> {
    // What a table rounds off is no difference.
    let shown = |error: f64| if error < 1e-12 { "0 %".into() } else { format!("{} %", significant(100.0 * error, 3)) };
    let value = |value: &Option<f64>| value.map_or_else(|| "-".into(), shown);
    let row = |signals: &ComparedSignal| {
        std::iter::once(quantity(&signals.column)).chain(signals.errors.iter().map(value)).collect()
    };
    comparison.signals.iter().map(row).collect()
}

fn distances(table: &str) -> String {
    let note =
        "RMS of the difference from the signal of the first run over the RMS of that signal, over their common time";
    if table.is_empty() { String::new() } else { [&html::note(note), table].concat() }
}

/// `peak force (N)`.
fn quantity(name: &str) -> String {
    let (words, unit) = figure::named(name);
    unit.heading(&words)
}

/// A relative difference in percent; of a value that is many times the first one how many, and of one with the other sign that.
fn signed_percent(share: f64) -> String {
    if share < -1.0 {
        return "other sign".into();
    }
    if share >= MOST_SHARE {
        return format!("{} times", significant(1.0 + share, 3));
    }
    if (100.0 * share).abs() < LEAST_SHARE {
        return format!("below {LEAST_SHARE} %");
    }
    let text = digits(100.0 * share);
    format!("{}{text} %", if share > 0.0 { "+" } else { "" })
}

/// Every common signal over time, a curve a run; and pairs of them over each other.
fn plots(comparison: &RunComparison) -> [Vec<Plot>; 2] {
    let over_time = comparison.signals.iter().map(|signals| {
        let (words, reading) = shown(&signals.column);
        let points = |series: &Series| series.samples().map(|[t, v]| [t * 1e3, reading.value(v)]).collect::<Vec<_>>();
        let curves = curves(comparison, |run| signals.series[run].as_ref().map(points));
        Plot::new(capital(&words), [TIME, &reading.heading(&words)], curves)
    });
    let against = CHARACTERISTICS.iter().filter_map(|(_, pair)| {
        let [x, y] = pair.map(|column| comparison.signals.iter().find(|signals| signals.column == column.name));
        Some(against_each_other(comparison, x?, y?))
    });
    thinned_together([over_time.collect(), against.collect()], MOST_POINTS)
}

fn against_each_other(comparison: &RunComparison, x: &ComparedSignal, y: &ComparedSignal) -> Plot {
    let [(of_x, across), (of_y, up)] = [x, y].map(|signals| shown(&signals.column));
    let points = |run: usize| {
        let (x, y) = (x.series[run].as_ref()?, y.series[run].as_ref()?);
        Some(x.values().iter().zip(y.values()).map(|(x, y)| [across.value(*x), up.value(*y)]).collect())
    };
    let title = capital(&format!("{of_y} over {of_x}"));
    Plot::new(title, [&across.heading(&of_x), &up.heading(&of_y)], curves(comparison, points))
}

fn curves(comparison: &RunComparison, points: impl Fn(usize) -> Option<Vec<[f64; 2]>>) -> Vec<Curve> {
    let curve = |(run, subject): (usize, &ComparedRun)| Some(Curve::line(&subject.name, points(run)?));
    comparison.runs.iter().enumerate().filter_map(curve).collect()
}

/// The words of a column and how it is shown: in the unit of the table of columns, or in the one in the name of a column that
/// is not in the table.
fn shown(name: &str) -> (String, Reading) {
    let (words, named) = figure::named(name);
    match column::find(name) {
        Some((_, known)) => (words, Reading { unit: known.axis_unit.into(), factor: known.factor }),
        None => (words, named),
    }
}

/// Most differences that the sentence names, and that are drawn of a run.
const MOST_NAMED: usize = 3;
const MOST_DRAWN: usize = 8;

/// Most digits of values that differ, which [`LEAST_DIFFERENCE`] needs.
const MOST_DIGITS: usize = 5;

/// Least difference that is one, as a share: smaller ones are shown as zero.
const LEAST_DIFFERENCE: f64 = 5e-4;

/// The difference of a figure of a run from that of the first.
struct Difference<'a> {
    figure: &'a ComparedFigure,
    share: f64,
}

impl Difference<'_> {
    fn words(&self) -> String {
        post::reading(&self.figure.name, 0.0).0
    }

    /// The values of the first run and of this one with their unit.
    fn values(&self, run: usize) -> String {
        let value = |run: usize| self.figure.values[run].as_ref().and_then(Value::as_f64).unwrap_or(f64::NAN);
        let (first, own) = (value(0), value(run));
        let reading = post::reading(&self.figure.name, first.abs().max(own.abs())).1;
        let mut texts = [own, first].map(|value| reading.digits(value));
        for count in DIGITS + 1..=MOST_DIGITS {
            // As many digits as tell them apart.
            if texts[0] != texts[1] {
                break;
            }
            texts = [own, first].map(|value| significant(reading.value(value), count).replace('-', "\u{2212}"));
        }
        let [own, first] = texts.map(|text| reading.with_unit(&text));
        format!("{own} instead of {first}")
    }
}

/// The figures by which runs are judged that differ in a run, the largest difference first.
fn judged(comparison: &RunComparison, run: usize) -> Vec<Difference<'_>> {
    let of = |figure| Some(Difference { figure, share: ComparedFigure::difference(figure, run)? });
    let mut all: Vec<Difference> = comparison.judged(run).filter_map(of).collect();
    all.retain(|difference| difference.share.abs() >= LEAST_DIFFERENCE);
    all.sort_by(|a, b| b.share.abs().total_cmp(&a.share.abs()));
    all
}

/// What differs most, and in how many keys the scenarios differ.
pub fn sentence(comparison: &RunComparison) -> String {
    let first = comparison.runs.first().map_or("", |run| &run.name);
    let of_run = |run: usize| {
        let name = &comparison.runs[run].name;
        let differences = judged(comparison, run);
        let named = differences.iter().take(MOST_NAMED);
        let named: Vec<String> = named.map(|one| format!("{} {}", one.words(), signed_percent(one.share))).collect();
        let is_compared = || comparison.judged(run).any(|figure| figure.difference(run).is_some());
        match named.is_empty() {
            true if !is_compared() => format!("{name} and {first} have no key figure in common."),
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
    ruptures(comparison).into_iter().chain(runs).chain(rest).chain(keys).collect::<Vec<_>>().join(" ")
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
pub(crate) fn bars(comparison: &RunComparison) -> String {
    let of_run = |run: usize| {
        let line = |one: &Difference| Line {
            words: one.words(),
            title: one.figure.name.clone(),
            value: Some(one.share),
            text: format!("{} ({})", signed_percent(one.share), one.values(run)),
            ..Line::default()
        };
        let lines: Vec<Line> = judged(comparison, run).iter().take(MOST_DRAWN).map(line).collect();
        ranges(&format!("{} against {}", comparison.runs[run].name, comparison.runs[0].name), RangeLook::Bars, &lines)
    };
    let blocks: String = (1..comparison.runs.len()).map(of_run).collect();
    html::section("Differences", &blocks)
}

/// A figure with its values in the unit in which they are read, each with its difference.
pub(crate) fn shown_figures<'a>(figures: impl Iterator<Item = &'a ComparedFigure>) -> Vec<Vec<Cell>> {
    let row = |figure: &ComparedFigure| {
        let number = |value: &Option<Value>| value.as_ref().and_then(Value::as_f64);
        let size = figure.values.iter().filter_map(number).map(f64::abs).fold(0.0, f64::max);
        let (words, reading) = post::reading(&figure.name, size);
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
fn shown_keys(comparison: &RunComparison) -> Vec<Vec<Cell>> {
    let titles: Vec<String> = comparison.keys.iter().map(|key| key_words(&key.path)).collect();
    let row = |(key, cells): (&ComparedKey, Vec<String>)| {
        let title = key_words(&key.path);
        // Of keys with one title, as the curves of MD and TD, each has the end of its path.
        let is_shared = titles.iter().filter(|other| **other == title).count() > 1;
        let end = key.path.rmatch_indices('.').nth(1).map_or(key.path.as_str(), |(at, _)| &key.path[at + 1..]);
        let title = Cell::text(if is_shared { end } else { &title }).titled(&key.path);
        std::iter::once(title).chain(cells.into_iter().skip(1).map(Cell::text)).collect()
    };
    comparison.keys.iter().zip(keys(comparison)).map(row).collect()
}

/// A key in words; that of another file as it is written.
fn key_words(path: &str) -> String {
    grammar::title(path).unwrap_or_else(|| path.to_owned())
}

/// The errors of the signals as shares in percent, which sort.
fn shown_errors(comparison: &RunComparison, head: &[Cell]) -> String {
    let value = |error: &Option<f64>| {
        error.map_or_else(|| Cell::text("-"), |error| Cell::number(error, format!("{} %", digits(100.0 * error))))
    };
    let row = |signals: &ComparedSignal| {
        let name = Cell::text(figure::named(&signals.column).0).titled(&signals.column);
        std::iter::once(name).chain(signals.errors.iter().map(value)).collect()
    };
    html::sorted_table(head, &comparison.signals.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use lab::signal::{Channel, Recording};
    use study::store::StoredRun;

    use super::*;

    #[test]
    fn the_page_of_many_long_runs_stays_small() {
        let time: Vec<f64> = (0..6_000).map(|i| f64::from(i) * 5e-5).collect();
        let run = |number: usize| {
            let channel = |name: &str| {
                let values = time.iter().map(|t| (t * 40.0 + number as f64).sin()).collect();
                Channel { name: name.into(), values }
            };
            let names =
                ["displacement_m", "force_N", "velocity_m_s", "acceleration_m_s2", "kinetic_energy_J", "depth_m"];
            let signals = Recording { time: time.clone(), channels: names.map(channel).into() };
            StoredRun { place: format!("/r/{number}").into(), signals, ..StoredRun::default() }
        };
        let comparison = RunComparison::from_runs(&(0..16).map(run).collect::<Vec<_>>(), &[]);
        let [over_time, against] = plots(&comparison);
        assert_eq!((over_time.len(), against.len()), (6, 2));
        let page = compare_page(&comparison, None);
        assert!(page.len() < 3_000_000, "{}", page.len());
    }
}
