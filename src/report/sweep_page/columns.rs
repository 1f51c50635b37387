//! The columns of a sweep as its page shows them: what they are in words, and the unit in which they are read.

use std::collections::HashMap;

use super::SweepPage;
use base::table::{Column, Values};
use base::units::Dimension;
use base::written::Reading;
use scene::model::Factor;
use scene::scenario::grammar;
use study::sweep::Table;

/// Most figures that are shown with plots.
const MOST_FIGURES: usize = 4;

/// A column as it is shown.
pub(super) struct Shown<'a> {
    /// Its values.
    pub column: &'a Column,
    /// What it is.
    pub words: String,
    /// Its key or name in full, shown on hover.
    pub key: String,
    /// How its values are read.
    pub reading: Reading,
}

/// Inputs, and the figures that are shown first.
pub(super) struct Columns<'a> {
    /// In the order of the keys that vary.
    pub inputs: Vec<Shown<'a>>,
    /// The one by which runs are ranked comes first.
    pub figures: Vec<Shown<'a>>,
}

impl<'a> Columns<'a> {
    pub(super) fn of_page(page: &SweepPage<'a>) -> Columns<'a> {
        let table = &page.results.table;
        let figures = page.results.shown_figures(page.figure, MOST_FIGURES);
        Columns {
            inputs: inputs(table, &page.sweep.variation().factors),
            figures: figures.into_iter().filter_map(|name| table.column(name)).map(Shown::of_figure).collect(),
        }
    }
}

fn inputs<'a>(table: &'a Table, factors: &[Factor]) -> Vec<Shown<'a>> {
    let titles: Vec<String> =
        factors.iter().map(|factor| grammar::title(&factor.path).unwrap_or_else(|| factor.path.clone())).collect();
    let mut counts: HashMap<&String, usize> = HashMap::new();
    titles.iter().for_each(|title| *counts.entry(title).or_default() += 1);
    let shown = |((column, factor), title): ((&'a Column, &Factor), &String)| {
        // Of two keys with one title, as the frictions of two impactors, the paths tell which is which.
        let words = if counts[title] > 1 { factor.path.clone() } else { title.clone() };
        let reading =
            Reading::of_unit(factor.dimension.map_or("1", |dimension: Dimension| dimension.unit), size(column));
        Shown { column, words, key: factor.path.clone(), reading }
    };
    table.inputs().iter().zip(factors).zip(&titles).map(shown).collect()
}

/// The largest size of the numbers of a column.
fn size(column: &Column) -> f64 {
    match &column.values {
        Values::Numbers(values) => values.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs())),
        _ => 0.0,
    }
}

impl<'a> Shown<'a> {
    /// A figure, by its name.
    pub(super) fn of_figure(column: &'a Column) -> Shown<'a> {
        let (words, reading) = Reading::of_name(&column.name, size(column));
        Shown { column, words, key: column.name.clone(), reading }
    }

    /// Words and unit, as the head of a column or of an axis.
    pub(super) fn heading(&self) -> String {
        self.reading.heading(&self.words)
    }

    /// The number of each row, SI; none of a word or a gap.
    pub(super) fn numbers(&self) -> Vec<Option<f64>> {
        match &self.column.values {
            Values::Texts(texts) => vec![None; texts.len()],
            values => values.numbers(),
        }
    }

    /// The value in a row with its unit; empty of a gap.
    pub(super) fn text(&self, row: usize) -> String {
        match &self.column.values {
            Values::Texts(texts) => texts.get(row).cloned().flatten().unwrap_or_default(),
            values => {
                values.numbers().get(row).copied().flatten().map_or_else(String::new, |value| self.reading.text(value))
            }
        }
    }
}

/// `words` within a sentence: a capital that begins a word is none there.
pub(super) fn lower(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next();
    // Abbreviations keep theirs.
    let is_word = letters.clone().next().is_some_and(char::is_lowercase);
    match first {
        Some(first) if is_word => first.to_lowercase().chain(letters).collect(),
        _ => words.to_owned(),
    }
}
