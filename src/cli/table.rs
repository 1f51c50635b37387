//! Tables on the terminal: the figures and tables of a script.

use report::{Figure, cell, columns};
use study::script::{Row, ScriptOutput};

/// Most rows of a table that are printed; its file has all of them.
const MOST_ROWS: usize = 40;

/// The rows of a longer table that are printed from its beginning; the others are from its end.
const FIRST_ROWS: usize = 10;

/// The answer, figures and tables; every line ends with a line break.
pub(super) fn script_output(output: &ScriptOutput) -> String {
    let answer = output.answer.iter().map(|answer| format!("  {answer}\n"));
    let figures = output.measures.iter().filter_map(|(name, value)| Figure::from_value(name, value));
    let figures = figures.map(|figure| format!("  {}\n", figure.cells().join(" ").trim_end()));
    let tables = output.tables.iter().map(|(name, rows)| format!("  {name}\n{}", self::rows(rows)));
    answer.chain(figures).chain(tables).collect()
}

/// The rows under the names of their columns, aligned to the right.
pub(super) fn rows(rows: &[Row]) -> String {
    let columns = columns(rows);
    let left_out = rows.len().saturating_sub(MOST_ROWS);
    let (head, tail) = if left_out > 0 { (FIRST_ROWS, FIRST_ROWS + left_out) } else { (rows.len(), rows.len()) };
    let cells = |row: &Row| columns.iter().map(|name| row.get(name).map_or_else(String::new, cell)).collect();
    let shown = rows[..head].iter().chain(&rows[tail..]).map(cells);
    let text = aligned(&std::iter::once(columns.clone()).chain(shown).collect::<Vec<Vec<String>>>(), 0);
    if left_out == 0 {
        return text;
    }
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let (before, after) = lines.split_at(1 + head);
    format!("{}    {left_out} rows not shown\n{}", before.concat(), after.concat())
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
            super::rows(&[row(8, -169.4413), row(10, -15.0)]),
            "    layers  travel\n         8  -169.4\n        10  -15.00\n"
        );
        let rows: Vec<Row> = (1..=45).map(|layers| row(layers, 1.0)).collect();
        let many = super::rows(&rows);
        let lines: Vec<&str> = many.lines().map(str::trim_start).collect();
        assert_eq!(
            (lines.len(), lines[10], lines[11], lines[12]),
            (42, "10   1.000", "5 rows not shown", "16   1.000")
        );
        assert_eq!(lines[41], "45   1.000");
    }
}
