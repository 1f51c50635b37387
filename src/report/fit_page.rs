//! The page of a fit: its figures, measured and fitted curves, residuals, and what it reports.

use super::drawn;
use super::html;
use base::finding::Finding;
use plot::{Correlation, Plot};

/// The content of the page of a fit.
#[derive(Clone, Debug)]
pub struct FitPage<'a> {
    /// Heading.
    pub title: &'a str,
    /// How well the law fits, in a sentence.
    pub answer: String,
    /// Heading, names of the columns and rows of each table.
    pub tables: Vec<FitTable>,
    /// Measured and fitted curves, and residuals.
    pub plots: Vec<Plot>,
    /// Of the coefficients, where there is one.
    pub correlation: Option<Correlation>,
    /// The findings of the fit.
    pub findings: &'a [Finding],
    /// The material file, where one is written.
    pub material: Option<&'a str>,
}

/// A table of a fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FitTable {
    /// Heading.
    pub title: &'static str,
    /// How many columns at the left are text; the others are numbers.
    pub texts: usize,
    /// Names of the columns.
    pub columns: &'static [&'static str],
    /// Cells.
    pub rows: Vec<Vec<String>>,
}

/// The page of a fit.
pub fn fit_page(fit: &FitPage<'_>) -> String {
    let table =
        |table: &FitTable| html::section(table.title, &html::table_of_numbers(table.texts, table.columns, &table.rows));
    let matrix = fit.correlation.as_ref().map(|one| html::matrix(&one.title, &one.names, &one.rows));
    let parts = [
        html::findings(Vec::new(), fit.findings),
        fit.tables.iter().map(table).collect(),
        html::section("Curves", &drawn::figures(&fit.plots)),
        html::section("Correlations", &matrix.unwrap_or_default()),
        html::section("Material", &fit.material.map(html::verbatim).unwrap_or_default()),
    ];
    html::finished(fit.title, &fit.answer, &parts)
}
