//! The page of a script over scenarios.

use serde_json::{Map, Value};

use super::html::{self, escape};
use super::{Figure, rounded};
use crate::script::{Findings, Row};

/// What the page of a study is made of.
#[derive(Clone, Copy)]
pub struct StudyPage<'a> {
    /// The script's name.
    pub name: &'a str,
    /// Script, scenario, changes and arguments, as `summary.json` has them.
    pub call: &'a Map<String, Value>,
    pub findings: &'a Findings,
    /// The script's text.
    pub script: &'a str,
}

/// `report.html` of a study.
pub fn study_page(study: &StudyPage) -> String {
    let figures = study.findings.measures.iter().filter_map(|(name, value)| Figure::of(name, value));
    let figures: Vec<Vec<String>> = figures.map(|figure| figure.cells().into()).collect();
    let body = [
        format!("<h1>{}</h1>\n", escape(study.name)),
        html::section("Figures", &html::table("figures", &[], &figures)),
        tables(study.findings),
        html::section("Log", &html::list(&study.findings.log)),
        html::section("What was run", &html::table("rows", &[], &call(study.call))),
        html::section("Script", &html::verbatim(study.script)),
        format!("<footer>droptower {}</footer>\n", env!("CARGO_PKG_VERSION")),
    ];
    html::page(study.name, &body.concat())
}

fn call(call: &Map<String, Value>) -> Vec<Vec<String>> {
    let written = |value: &Value| match value {
        Value::Array(items) => items.iter().map(cell).collect::<Vec<_>>().join("  "),
        Value::Object(args) => {
            let args = args.iter().map(|(name, value)| format!("{name}={}", cell(value)));
            args.collect::<Vec<_>>().join("  ")
        }
        other => cell(other),
    };
    let rows = call.iter().map(|(name, value)| vec![name.clone(), written(value)]);
    rows.filter(|row| !row[1].is_empty()).collect()
}

/// A section for every table that a script left.
pub(super) fn tables(findings: &Findings) -> String {
    let tables = findings.tables.iter();
    tables.map(|(name, rows)| html::section(&name.replace('_', " "), &table(rows))).collect()
}

/// The columns of a table: every name that a row has, in the order of first appearance.
pub fn columns(rows: &[Row]) -> Vec<String> {
    let mut columns: Vec<String> = Vec::new();
    for name in rows.iter().flat_map(Row::keys) {
        if !columns.contains(name) {
            columns.push(name.clone());
        }
    }
    columns
}

fn table(rows: &[Row]) -> String {
    let columns = columns(rows);
    let cells = |row: &Row| columns.iter().map(|name| row.get(name).map_or_else(String::new, cell)).collect();
    html::table("rows", &columns, &rows.iter().map(cells).collect::<Vec<_>>())
}

/// A value of a table as people read it; numbers rounded, nothing where there is none.
pub fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => rounded(number.as_f64().unwrap_or(f64::NAN)),
        other => other.to_string(),
    }
}
