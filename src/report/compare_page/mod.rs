//! The page of a comparison of runs.

mod differences;

use serde_json::Value;

use super::html::{self, escape};
use super::panes::CHARACTERISTICS;
use super::table::{self, Cell, folded};
use super::{Figure, drawn, figure};
use base::diagnostic::shown_path;
use base::number::significant;
use base::written::capital;
use lab::signal::{Series, column};
use plot::{self as diagrams, Curve, Plot, TIME};
use scene::expectation::Outside;
use study::post::RunComparison;
use study::post::comparison::{ComparedFigure, ComparedRun, ComparedSignal};

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
    let (over_time, against) = plots(comparison);
    let key_figures = table::table(&head("figure"), &differences::shown_figures(comparison.key_figures()));
    let others = table::table(&head("figure"), &differences::shown_figures(comparison.other_figures()));
    let body = [
        format!("<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape(&title), escape(&differences::sentence(comparison))),
        differences::bars(comparison),
        html::section("Bounds", &outside.map(bounds).unwrap_or_default()),
        html::findings(Vec::new(), &comparison.findings),
        html::section("Scenarios", &table::table(&head("key"), &differences::shown_keys(comparison))),
        html::section("Signals", &drawn::small(against.iter().chain(&over_time))),
        html::section("Figures", &folded("those that differ, and the key figures", &key_figures)),
        html::section(
            "Errors of signals",
            &folded("of each run", &distances(&differences::shown_errors(comparison, &head("signal")))),
        ),
        html::section("Further figures", &folded("those that are equal, and the cost", &others)),
        html::section("Runs", &html::table(&header_of_runs(), &runs(comparison))),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(&title, &body.concat())
}

fn bounds(outside: &[Outside]) -> String {
    let rows = outside.iter().flat_map(|Outside { run, differences }| {
        let within = differences.is_empty().then(|| vec![run.clone(), "within the bounds".into()]);
        within.into_iter().chain(differences.iter().map(|difference| vec![run.clone(), difference.to_string()]))
    });
    html::table(&["run", "verdict"].map(String::from), &rows.collect::<Vec<_>>())
}

fn header_of_runs() -> Vec<String> {
    ["run", "title", "path"].map(String::from).into()
}

fn runs(comparison: &RunComparison) -> Vec<Vec<String>> {
    let row = |run: &ComparedRun| vec![run.name.clone(), run.title.clone().unwrap_or_default(), shown_path(&run.place)];
    comparison.runs.iter().map(row).collect()
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

/// A key, then a value a scenario.
pub fn keys(comparison: &RunComparison) -> Vec<Vec<String>> {
    let value =
        |value: &Option<String>| value.as_deref().map_or_else(|| "-".into(), |text| text.trim_matches('"').to_owned());
    comparison
        .keys
        .iter()
        .map(|key| std::iter::once(key.path.clone()).chain(key.values.iter().map(value)).collect())
        .collect()
}

/// A signal, then the error of each run against the first.
pub fn errors(comparison: &RunComparison) -> Vec<Vec<String>> {
    let value =
        |value: &Option<f64>| value.map_or_else(|| "-".into(), |error| format!("{} %", significant(100.0 * error, 3)));
    let row = |signals: &ComparedSignal| {
        std::iter::once(quantity(&signals.column)).chain(signals.errors.iter().map(value)).collect()
    };
    comparison.signals.iter().map(row).collect()
}

fn distances(table: &str) -> String {
    let note =
        "RMS of the difference from the signal of the first run over the RMS of that signal, over their common time";
    if table.is_empty() { String::new() } else { format!("<p class=\"note\">{note}</p>\n{table}") }
}

/// `peak force (N)`.
fn quantity(name: &str) -> String {
    match figure::named(name) {
        (words, unit) if unit.is_empty() => words,
        (words, unit) => format!("{words} ({unit})"),
    }
}

/// A relative difference in percent; of a value that is many times the first one how many, and of one with the other sign that.
fn signed_percent(share: f64) -> String {
    if share < -1.0 {
        return "other sign".into();
    }
    if share >= MOST_SHARE {
        return format!("{} times", significant(1.0 + share, 3));
    }
    let text = significant(100.0 * share, 3);
    format!("{}{text} %", if share > 0.0 { "+" } else { "" })
}

/// Every common signal over time, a curve a run; and pairs of them over each other.
fn plots(comparison: &RunComparison) -> (Vec<Plot>, Vec<Plot>) {
    let over_time = comparison.signals.iter().map(|signals| {
        let shown = Shown::from_name(&signals.column);
        let points = |series: &Series| series.samples().map(|[t, v]| [t * 1e3, v * shown.factor]).collect::<Vec<_>>();
        let curves = curves(comparison, |run| signals.series[run].as_ref().map(points));
        Plot::new(capital(&shown.words), [TIME, &shown.axis()], curves)
    });
    let against = CHARACTERISTICS.iter().filter_map(|(_, pair)| {
        let [x, y] = pair.map(|column| comparison.signals.iter().find(|signals| signals.column == column.name));
        Some(against_each_other(comparison, x?, y?))
    });
    let (mut over_time, against): (Vec<Plot>, Vec<Plot>) = (over_time.collect(), against.collect());
    let count = over_time.len();
    over_time.extend(against);
    let mut over_time = diagrams::thinned(over_time, MOST_POINTS);
    let against = over_time.split_off(count);
    (over_time, against)
}

fn against_each_other(comparison: &RunComparison, x: &ComparedSignal, y: &ComparedSignal) -> Plot {
    let [across, up] = [x, y].map(|signals| Shown::from_name(&signals.column));
    let points = |run: usize| {
        let (x, y) = (x.series[run].as_ref()?, y.series[run].as_ref()?);
        Some(x.values().iter().zip(y.values()).map(|(x, y)| [x * across.factor, y * up.factor]).collect())
    };
    let title = capital(&format!("{} over {}", up.words, across.words));
    Plot::new(title, [&across.axis(), &up.axis()], curves(comparison, points))
}

fn curves(comparison: &RunComparison, points: impl Fn(usize) -> Option<Vec<[f64; 2]>>) -> Vec<Curve> {
    let curve = |(run, subject): (usize, &ComparedRun)| Some(Curve::line(&subject.name, points(run)?));
    comparison.runs.iter().enumerate().filter_map(curve).collect()
}

/// How a column is shown: its words and the unit of its axis.
struct Shown {
    words: String,
    unit: String,
    /// From SI to the unit.
    factor: f64,
}

impl Shown {
    /// The unit is that of the table of columns, or the one in the name of a column that is not in the table.
    fn from_name(name: &str) -> Shown {
        let (words, unit) = figure::named(name);
        match column::find(name) {
            Some((_, known)) => Shown { words, unit: known.axis_unit.into(), factor: known.factor },
            None => Shown { words, unit, factor: 1.0 },
        }
    }

    fn axis(&self) -> String {
        if self.unit.is_empty() { self.words.clone() } else { format!("{} ({})", self.words, self.unit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::{Channel, Recording};
    use study::store::StoredRun;

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
        let (over_time, against) = plots(&comparison);
        assert_eq!((over_time.len(), against.len()), (6, 2));
        let page = compare_page(&comparison, None);
        assert!(page.len() < 3_000_000, "{}", page.len());
    }
}
