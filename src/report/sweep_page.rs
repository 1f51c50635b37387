//! The page of a sweep.

use serde_json::{Map, Value};

use super::figure::{DIGITS, heading};
use super::html::{self, escape};
use super::{drawn, figure};
use base::number;
use base::shell::quoted;
use base::table::{Column, Values};
use plot::{Curve, Look, Plot};
use study::sweep::{Sweep, SweepResults};

/// The content of the page of a sweep.
#[derive(Clone, Copy)]
pub struct SweepPage<'a> {
    /// The sweep.
    pub sweep: &'a Sweep,
    /// Its results.
    pub results: &'a SweepResults,
    /// The content of `summary.json`.
    pub summary: &'a Map<String, Value>,
    /// The command that repeats it.
    pub command: &'a str,
    /// The command that runs the scenario as it is written.
    pub single: &'a str,
    /// The figure that is shown first.
    pub figure: &'a str,
}

/// Most figures that are plotted over the inputs.
const MOST_FIGURES: usize = 6;

/// Most runs of a table on the page; the file has all of them.
const MOST_ROWS: usize = 200;

/// Most points of a plot.
const MOST_POINTS: usize = 2000;

/// `report.html` of a sweep.
pub fn sweep_page(page: &SweepPage) -> String {
    let SweepPage { sweep, results, summary, command, .. } = *page;
    let title = format!("{}: {} runs", sweep.model().title, results.table.rows());
    let facts = ["runs", "failed", "reused", "rupture_probability"];
    let facts = summary.iter().filter(|(name, _)| facts.contains(&name.as_str()));
    let body = [
        format!("<h1>{}</h1>\n", escape(&title)),
        html::findings(Vec::new(), &results.findings),
        html::section("What varies", &inputs(sweep)),
        html::section("Figures", &[figure::table(facts), rupture(results)].concat()),
        html::section("Quantiles", &quantiles(page)),
        html::section("Main effects", &effects(results)),
        html::section("Figures over inputs", &drawn::figures(&plots(page))),
        html::section("Failed runs", &failures(results)),
        html::section("Runs", &runs(page)),
        html::section("A run by itself", &again(page)),
        html::section("Run it again", &html::verbatim(command)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(&title, &body.concat())
}

/// The keys that vary and the values that they have.
fn inputs(sweep: &Sweep) -> String {
    let rows = sweep.variation().factors.iter().map(|factor| vec![factor.column(), factor.values.to_string()]);
    let head = ["key", "values"].map(String::from);
    let method = format!("<p>{}</p>\n", escape(&sweep.variation().description()));
    [method, html::table("rows", &head, &rows.collect::<Vec<_>>())].concat()
}

fn rupture(results: &SweepResults) -> String {
    let Some((probability, [low, high])) = results.rupture else { return String::new() };
    let [probability, low, high] = [probability, low, high].map(|share| number::figure(100.0 * share, 3));
    format!(
        "<p>The film ruptures in {probability} % of the runs; the interval of 95 % of the probability is {low} to {high} \
         % (Wilson).</p>\n"
    )
}

/// The figures that vary, that of the page first.
fn varying<'a>(page: &SweepPage<'a>) -> Vec<&'a str> {
    let mut names: Vec<&str> = page.results.effects.iter().map(|effects| effects.figure.as_str()).collect();
    names.sort_by_key(|name| *name != page.figure);
    names
}

fn quantiles(page: &SweepPage) -> String {
    let varying = varying(page);
    let of = |name: &&str| page.results.statistics.iter().find(|(own, _)| own == name);
    let rows = varying.iter().filter_map(of).map(|(name, of)| {
        let figures = [Some(of.mean), of.deviation, Some(of.p05), Some(of.p50), Some(of.p95)];
        let cells = figures.map(|value| value.map_or_else(String::new, |value| number::figure(value, DIGITS)));
        [heading(name)].into_iter().chain(cells).collect()
    });
    let head = ["figure", "mean", "deviation", "5 %", "median", "95 %"].map(String::from);
    table(&head, rows.collect())
}

fn table(head: &[String], rows: Vec<Vec<String>>) -> String {
    if rows.is_empty() { String::new() } else { html::table("rows", head, &rows) }
}

/// The share of the variance of each figure that each input has alone.
fn effects(results: &SweepResults) -> String {
    let Some(first) = results.effects.first() else { return String::new() };
    let head = std::iter::once("figure".to_owned()).chain(first.effects.iter().map(|effect| effect.input.clone()));
    let percent = |share: f64| number::figure(100.0 * share, 2);
    let row = |effects: &study::sweep::Effects| {
        let cell = |effect: &study::sweep::Effect| match effect.interval {
            Some([low, high]) => format!("{} ({} to {})", percent(effect.share), percent(low), percent(high)),
            None => percent(effect.share),
        };
        std::iter::once(heading(&effects.figure)).chain(effects.effects.iter().map(cell)).collect()
    };
    let rows = results.effects.iter().map(row).collect();
    let words = "<p>Share of the variance that an input has alone, %, with its interval of 95 %; what the shares of a row \
                 lack of 100 % is due to inputs that act together.</p>\n";
    [words, &table(&head.collect::<Vec<_>>(), rows)].concat()
}

/// Figures over inputs.
fn plots(page: &SweepPage) -> Vec<Plot> {
    let results = page.results;
    let names: Vec<&str> = varying(page).into_iter().take(MOST_FIGURES).collect();
    let columns = names.iter().filter_map(|name| results.table.column(name));
    columns.flat_map(|figure| results.table.inputs().iter().filter_map(|input| scatter(input, figure))).collect()
}

/// A figure over an input that is a number.
fn scatter(input: &Column, figure: &Column) -> Option<Plot> {
    let Values::Numbers(places) = &input.values else { return None };
    let values = figure.values.numbers();
    let points: Vec<[f64; 2]> = places.iter().zip(&values).filter_map(|(x, y)| Some([(*x)?, (*y)?])).collect();
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let points = points.into_iter().step_by(every).collect();
    let curve = Curve { name: "runs".into(), points, look: Look::Points };
    let [x, y] = [&input.name, &figure.name].map(|name| heading(name));
    Some(Plot::new(format!("{y} over {x}"), [&x, &y], vec![curve]))
}

fn failures(results: &SweepResults) -> String {
    let rows = (0..results.table.rows()).filter_map(|row| {
        let cause = results.table.failure(row)?;
        Some(vec![results.table.number(row).to_string(), cause.to_owned()])
    });
    table(&["run", "cause"].map(String::from), rows.take(MOST_ROWS).collect())
}

/// The first runs with inputs, the figures that vary, and the changes of the scenario that repeat each.
fn runs(page: &SweepPage) -> String {
    let SweepPage { sweep, results, .. } = *page;
    let shown = |column: &&Column| results.effects.iter().any(|effects| effects.figure == column.name);
    let figures: Vec<&Column> = results.table.figures().iter().filter(shown).collect();
    let columns = || results.table.inputs().iter().chain(figures.iter().copied());
    let names = columns().map(|column| heading(&column.name));
    let head: Vec<String> = std::iter::once("run".to_owned()).chain(names).chain(["repeated by".to_owned()]).collect();
    let cell = |column: &Column, row: usize| match &column.values {
        Values::Texts(texts) => texts[row].clone().unwrap_or_default(),
        values => values.numbers()[row].map_or_else(String::new, |value| number::figure(value, DIGITS)),
    };
    let row = |row: usize| {
        let number = results.table.number(row);
        let cells = columns().map(|column| cell(column, row));
        std::iter::once(number.to_string()).chain(cells).chain([changes(sweep, number - 1)]).collect()
    };
    let count = results.table.rows();
    let rest =
        if count > MOST_ROWS { format!("<p>{MOST_ROWS} of {count}; table.csv has all.</p>\n") } else { String::new() };
    [table(&head, (0..count.min(MOST_ROWS)).map(row).collect()), rest].concat()
}

/// How one of the runs is repeated alone.
fn again(page: &SweepPage) -> String {
    let SweepPage { sweep, results, single, .. } = *page;
    let worst = results.worst(page.figure, 1);
    let Some(place) = worst.first().copied() else { return String::new() };
    let number = place + 1;
    let words = format!(
        "<p>This command repeats run {number}, the worst by {}; with the changes in the last column of the table above it \
         repeats any other. <code>--keep {number}</code> in the command of the sweep writes its folder too.</p>\n",
        escape(page.figure),
    );
    [words, html::verbatim(&format!("{single} {}", changes(sweep, place)))].concat()
}

/// The changes of the scenario that give the run at `place`, as options.
fn changes(sweep: &Sweep, place: usize) -> String {
    let options = sweep.changes(place).into_iter().map(|change| format!("--set {}", quoted(&change)));
    options.collect::<Vec<_>>().join(" ")
}
