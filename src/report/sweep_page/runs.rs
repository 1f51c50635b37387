//! The runs of a sweep: the worst, those that failed, and tables of all.

use super::super::html::{self, escape};
use super::super::table::{self, Cell};
use super::SweepPage;
use super::columns::{Columns, Shown, lower};
use base::shell::quoted;
use base::written::Reading;
use study::sweep::{Sweep, SweepResults};

/// Most runs of a table on the page; the file has all of them.
const MOST_ROWS: usize = 200;

/// How many of the worst runs are shown.
const WORST: usize = 3;

/// The worst runs, each with the command that repeats it.
pub(super) fn worst(page: &SweepPage, columns: &Columns) -> String {
    let SweepPage { sweep, results, single, .. } = *page;
    let item = |place: usize| {
        let row = (0..results.table.rows()).find(|row| results.table.number(*row) == place + 1)?;
        let outcome = match results.table.failure(row) {
            Some(cause) => format!("failed: {cause}"),
            None => columns.figures.iter().map(|figure| said(figure, row)).collect::<Vec<_>>().join(", "),
        };
        let inputs = columns.inputs.iter().map(|input| lower(&said(input, row))).collect::<Vec<_>>().join(", ");
        let command = html::verbatim(&format!("{single} {}", changes(sweep, place)));
        Some(format!(
            "<li><p><b>run {}</b>: {}; with {}</p>\n{command}</li>\n",
            place + 1,
            escape(&outcome),
            escape(&inputs)
        ))
    };
    let items: String = results.worst(page.figure, WORST).into_iter().filter_map(item).collect();
    if items.is_empty() {
        return items;
    }
    let note = format!(
        "Worst by {}, the largest first; --keep worst:{WORST} in the command of the sweep writes their folders too.",
        page.figure
    );
    format!("<ol class=\"worst\">\n{items}</ol>\n<p class=\"note\">{}</p>\n", escape(&note))
}

/// The words of a column and its value in a row.
fn said(column: &Shown, row: usize) -> String {
    format!("{} {}", column.words, column.text(row))
}

/// The runs without a result.
pub(super) fn failures(results: &SweepResults) -> String {
    let rows = (0..results.table.rows()).filter_map(|row| {
        let cause = results.table.failure(row)?;
        let number = results.table.number(row);
        Some(vec![Cell::number(number as f64, number.to_string()), Cell::text(cause)])
    });
    table::table(&["run", "cause"].map(Cell::text), &rows.take(MOST_ROWS).collect::<Vec<_>>())
}

/// Median, range and deviation of every figure, each in its unit.
pub(super) fn statistics(results: &SweepResults) -> String {
    let row = |(name, of): &(String, study::sweep::Quantiles)| {
        let (words, reading) = Reading::of_name(name, of.p50.abs().max(of.p95.abs()).max(of.p05.abs()));
        let cell = |value: f64| Cell::number(value, reading.text(value));
        let deviation = of.deviation.map_or_else(Cell::default, cell);
        vec![Cell::text(words).titled(name), cell(of.p50), cell(of.p05), cell(of.p95), cell(of.mean), deviation]
    };
    let head = ["figure", "median", "5 % are below", "95 % are below", "mean", "standard deviation"].map(Cell::text);
    table::table(&head, &results.statistics.iter().map(row).collect::<Vec<_>>())
}

/// The first runs with inputs, the figures that are shown first, and the changes of the scenario that repeat each.
pub(super) fn all(page: &SweepPage, columns: &Columns) -> String {
    let SweepPage { sweep, results, .. } = *page;
    let shown = || columns.inputs.iter().chain(&columns.figures);
    let names = shown().map(|column| Cell::text(column.heading()).titled(&column.key));
    let head: Vec<Cell> = std::iter::once(Cell::text("run")).chain(names).chain([Cell::text("repeated by")]).collect();
    let numbers: Vec<Vec<Option<f64>>> = shown().map(Shown::numbers).collect();
    let row = |row: usize| {
        let number = results.table.number(row);
        let cells = shown().zip(&numbers).map(|(column, numbers)| match numbers[row] {
            Some(value) => Cell::reading(Some(value), &column.reading),
            None => Cell::text(column.text(row)),
        });
        let changes = html::verbatim(&changes(sweep, number - 1));
        let command = Cell::html(format!("<details><summary>changes</summary>{changes}</details>"));
        std::iter::once(Cell::number(number as f64, number.to_string())).chain(cells).chain([command]).collect()
    };
    let count = results.table.rows();
    let rest = match count > MOST_ROWS {
        true => format!("<p class=\"note\">{MOST_ROWS} of {count}; table.csv has all, with every figure.</p>\n"),
        false => "<p class=\"note\">table.csv has every figure.</p>\n".into(),
    };
    let rows: Vec<Vec<Cell>> = (0..count.min(MOST_ROWS)).map(row).collect();
    [table::table(&head, &rows), rest].concat()
}

/// The changes of the scenario that give the run at `place`, as options.
fn changes(sweep: &Sweep, place: usize) -> String {
    let options = sweep.changes(place).into_iter().map(|change| format!("--set {}", quoted(&change)));
    options.collect::<Vec<_>>().join(" ")
}
