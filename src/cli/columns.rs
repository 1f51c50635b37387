//! `droptower explain COLUMN` and `droptower explain columns`: what a column of `signals.csv` or `energies.csv` is, and of
//! which runs.

use serde::Serialize;

use super::{Failure, Shared, print, print_json};
use lab::signal::column::{self, COLUMNS, Column};
use scene::simulate::{EnergyTerm, energy_columns};
use study::store::run_files::{ENERGIES, SIGNALS};

/// The word in place of a key that lists all columns.
pub(super) const WORD: &str = "columns";

/// A column as it is explained.
#[derive(Serialize)]
struct Explanation<'a> {
    column: &'a str,
    /// The file that it is in.
    file: &'static str,
    /// The beginning of its name, where it is that of one of several impactors.
    impactor: Option<&'a str>,
    sentence: String,
    unit: &'static str,
    when: &'static str,
    script: String,
}

/// A column that is known.
pub(super) enum Known {
    /// Of `signals.csv`.
    Signal(&'static Column),
    /// Of `energies.csv`.
    Energy(EnergyTerm),
}

/// The column `name`, which may begin with the name of an impactor, and that beginning; only what a column of a run may be
/// called.
pub(super) fn find(name: &str) -> Option<(&str, Known)> {
    if let Some(term) = energy_columns().find(|term| term.name == name) {
        return Some(("", Known::Energy(term)));
    }
    let (prefix, column) = column::find(name)?;
    (prefix.is_empty() || column.is_of_each_impactor).then_some((prefix, Known::Signal(column)))
}

/// All names of columns.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    COLUMNS.iter().map(|column| column.name).chain(energy_columns().map(|term| term.name))
}

/// Prints what the column `name` is, found with the beginning `prefix`.
pub(super) fn run(name: &str, (prefix, column): (&str, Known), shared: &Shared) -> Result<(), Failure> {
    show(
        &[match column {
            Known::Signal(column) => of_signal(name, prefix, column),
            Known::Energy(term) => of_energy(term),
        }],
        shared,
    )
}

/// Prints what every column is.
pub(super) fn all(shared: &Shared) -> Result<(), Failure> {
    let signals = COLUMNS.iter().map(|column| of_signal(column.name, "", column));
    show(&signals.chain(energy_columns().map(of_energy)).collect::<Vec<_>>(), shared)
}

fn of_signal<'a>(name: &'a str, prefix: &'a str, column: &Column) -> Explanation<'a> {
    Explanation {
        column: name,
        file: SIGNALS,
        impactor: prefix.strip_suffix('_'),
        sentence: sentence(column.sentence),
        unit: column.unit,
        when: column.when,
        script: format!("run.{prefix}{}", column.short),
    }
}

fn of_energy(term: EnergyTerm) -> Explanation<'static> {
    Explanation {
        column: term.name,
        file: ENERGIES,
        impactor: None,
        sentence: sentence(term.sentence),
        unit: "J",
        when: "of every run",
        script: format!("run.energies.{}", term.name),
    }
}

fn sentence(lines: &[&str]) -> String {
    lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ")
}

fn show(explanations: &[Explanation], shared: &Shared) -> Result<(), Failure> {
    if shared.json {
        return print_json(&explanations);
    }
    print(&explanations.iter().map(text).collect::<Vec<_>>().join("\n\n"))
}

fn text(explanation: &Explanation) -> String {
    let Explanation { column, file, sentence, unit, when, script, .. } = explanation;
    let unit = if unit.is_empty() { "a ratio or a number".to_owned() } else { format!("in {unit}") };
    let whose = explanation.impactor.map_or_else(String::new, |name| format!("\n    of the impactor \"{name}\""));
    format!("{column}\n    {sentence}{whose}\n    column of {file}; {unit}; {when}\n    in scripts `{script}`")
}
