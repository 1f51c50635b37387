//! `droptower explain COLUMN` and `droptower explain columns`: what a column of `signals.csv` is, and of which runs.

use serde::Serialize;

use super::{Failure, Shared, print, print_json};
use crate::signal::column::{self, COLUMNS, Column};

/// The word in place of a key that lists all columns.
pub(super) const WORD: &str = "columns";

/// A column as it is explained.
#[derive(Serialize)]
struct Explanation<'a> {
    column: &'a str,
    /// The beginning of its name, where it is that of one of several impactors.
    impactor: Option<&'a str>,
    sentence: String,
    unit: &'static str,
    when: &'static str,
    script: String,
}

/// The column `name`, which may begin with the name of an impactor, and that beginning; only what a column of a run may be
/// called.
pub(super) fn find(name: &str) -> Option<(&str, &'static Column)> {
    column::of(name).filter(|(prefix, column)| prefix.is_empty() || column.is_of_each_impactor())
}

/// All names of columns.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    COLUMNS.iter().map(|column| column.name)
}

/// Prints what the column `name` is, found with the beginning `prefix`.
pub(super) fn run(name: &str, (prefix, column): (&str, &Column), shared: &Shared) -> Result<(), Failure> {
    show(&[explanation(name, prefix, column)], shared)
}

/// Prints what every column is.
pub(super) fn all(shared: &Shared) -> Result<(), Failure> {
    show(&COLUMNS.iter().map(|column| explanation(column.name, "", column)).collect::<Vec<_>>(), shared)
}

fn explanation<'a>(name: &'a str, prefix: &'a str, column: &Column) -> Explanation<'a> {
    let lines: Vec<&str> = column.sentence.iter().map(|line| line.trim()).collect();
    Explanation {
        column: name,
        impactor: prefix.strip_suffix('_'),
        sentence: lines.join(" "),
        unit: column.unit,
        when: column.when,
        script: format!("run.{prefix}{}", column.short),
    }
}

fn show(explanations: &[Explanation], shared: &Shared) -> Result<(), Failure> {
    if shared.json {
        return print_json(&explanations);
    }
    print(&explanations.iter().map(text).collect::<Vec<_>>().join("\n\n"))
}

fn text(explanation: &Explanation) -> String {
    let Explanation { column, sentence, unit, when, script, .. } = explanation;
    let unit = if unit.is_empty() { "a ratio or a number".to_owned() } else { format!("in {unit}") };
    let whose = explanation.impactor.map_or_else(String::new, |name| format!("\n    of the impactor \"{name}\""));
    format!("{column}\n    {sentence}{whose}\n    column of signals.csv; {unit}; {when}\n    in scripts `{script}`")
}
