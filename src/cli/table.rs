//! Tables on the terminal: the figures and tables of a script.

use crate::report::{Figure, cell, columns};
use crate::script::{Row, ScriptOutput};

/// Most rows of a table that are printed; its file has all of them.
const MOST_ROWS: usize = 40;

/// Figures and tables; every line ends with a line break.
pub(super) fn script_output(output: &ScriptOutput) -> String {
    let figures = output.measures.iter().filter_map(|(name, value)| Figure::of(name, value));
    let figures = figures.map(|figure| format!("  {}\n", figure.cells().join(" ").trim_end()));
    let tables = output.tables.iter().map(|(name, rows)| format!("  {name}\n{}", table(rows)));
    figures.chain(tables).collect()
}

/// The rows under the names of their columns, aligned to the right.
fn table(rows: &[Row]) -> String {
    let columns = columns(rows);
    let shown = rows.iter().take(MOST_ROWS);
    let cells = shown.map(|row| columns.iter().map(|name| row.get(name).map_or_else(String::new, cell)).collect());
    let lines: Vec<Vec<String>> = std::iter::once(columns.clone()).chain(cells).collect();
    let rest = rows.len().saturating_sub(MOST_ROWS);
    let rest = if rest > 0 { format!("    and {rest} more\n") } else { String::new() };
    aligned(&lines, 0) + rest.as_str()
}

/// Lines of equally many cells in columns, the first `words` columns aligned to the left, the others to the right.
pub(super) fn aligned(lines: &[Vec<String>], words: usize) -> String {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |line: &Vec<String>| {
        let cell = |(column, (cell, width)): (usize, (&String, &usize))| {
            if column < words { format!("  {cell:<width$}") } else { format!("  {cell:>width$}") }
        };
        let cells: String = line.iter().zip(&widths).enumerate().map(cell).collect();
        format!("  {}\n", cells.trim_end())
    };
    lines.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn cells_are_aligned_under_the_names_of_their_columns() {
        let row = |layers: i64, travel: f64| match json!({ "layers": layers, "travel": travel }) {
            serde_json::Value::Object(row) => row,
            _ => Row::new(),
        };
        assert_eq!(
            table(&[row(8, -169.4413), row(10, -15.0)]),
            "    layers  travel\n         8  -169.4\n        10  -15.00\n"
        );
        let many = table(&vec![row(1, 1.0); 45]);
        assert!(many.ends_with("and 5 more\n") && many.lines().count() == 42);
    }
}
