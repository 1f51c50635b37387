//! The page of a sweep: how its figures scatter, what matters for them, the worst runs, and tables of all.

mod answer;
mod columns;
mod effects;
mod runs;

use serde_json::{Map, Value};

use super::html::{self, escape};
use super::table::{self, Cell, folded};
use super::{drawn, figure};
use columns::Columns;
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

/// `report.html` of a sweep.
pub fn sweep_page(page: &SweepPage) -> String {
    let SweepPage { sweep, results, summary, command, .. } = *page;
    let title = format!("{}: {} runs", sweep.model().title, results.table.rows());
    let columns = Columns::of_page(page);
    let facts = summary.iter().filter(|(_, value)| value.is_number());
    let body = [
        format!("<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape(&title), escape(&answer::sentence(page, &columns))),
        answer::picture(page, &columns),
        html::findings(Vec::new(), &results.findings),
        html::section("What matters", &effects::tornadoes(page, &columns)),
        html::section("Trends", &drawn::small(&effects::scatters(page, &columns))),
        html::section("Worst runs", &runs::worst(page, &columns)),
        html::section("Failed runs", &runs::failures(results)),
        html::section("What varies", &inputs(sweep, &columns)),
        html::section("Figures", &folded("median, range and deviation of every figure", &runs::statistics(results))),
        html::section("Runs", &folded(&format!("{} runs", results.table.rows()), &runs::all(page, &columns))),
        html::section("Run it again", &[html::verbatim(command), figure::table(facts)].concat()),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(&title, &body.concat())
}

/// The keys that vary and the values that they have.
fn inputs(sweep: &Sweep, columns: &Columns) -> String {
    let row = |(factor, column): (&scene::model::Factor, &columns::Shown)| {
        vec![Cell::text(&column.words).titled(&column.key), Cell::text(factor.shown_values())]
    };
    let rows: Vec<Vec<Cell>> = sweep.variation().factors.iter().zip(&columns.inputs).map(row).collect();
    let method = format!("<p class=\"note\">{}</p>\n", escape(&sweep.variation().description()));
    [table::table(&["input", "values"].map(Cell::text), &rows), method].concat()
}
