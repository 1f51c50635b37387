//! Tables that a reader sorts and filters: cells with the number they stand for, heads with the whole key on hover.

use super::html::escape;
use base::written::Reading;

/// Most columns of a table that stays upright; a wider one with fewer rows than columns is turned.
const MOST_COLUMNS: usize = 12;

/// A cell, or the head of a column.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Cell {
    /// HTML.
    content: String,
    /// By which rows are sorted.
    number: Option<f64>,
    /// Shown on hover.
    title: Option<String>,
}

impl Cell {
    /// A text.
    pub(super) fn text(text: impl AsRef<str>) -> Cell {
        Cell { content: escape(text.as_ref()), ..Cell::default() }
    }

    /// HTML.
    pub(super) fn html(content: String) -> Cell {
        Cell { content, ..Cell::default() }
    }

    /// A number as it is written.
    pub(super) fn number(value: f64, written: impl AsRef<str>) -> Cell {
        Cell { number: Some(value), ..Cell::text(written) }
    }

    /// A value in the unit of its column.
    pub(super) fn reading(value: Option<f64>, reading: &Reading) -> Cell {
        value.map_or_else(Cell::default, |value| Cell::number(value, reading.digits(value)))
    }

    /// The cell with what is shown on hover, where that is another text.
    pub(super) fn titled(self, title: &str) -> Cell {
        let title = (escape(title) != self.content).then(|| title.to_owned());
        Cell { title, ..self }
    }

    fn attributes(&self) -> String {
        let title = self.title.as_ref().map(|title| format!(" title=\"{}\"", escape(title)));
        // Digits that decide the order: those of the table are too few.
        let number = self.number.filter(|number| number.is_finite()).map(|number| format!(" data-sort=\"{number:e}\""));
        [title, number].into_iter().flatten().collect()
    }
}

/// A table whose columns sort its rows; a wide one of few rows is turned, so that its heads stand at the left.
pub(super) fn table(head: &[Cell], rows: &[Vec<Cell>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    if head.len() > MOST_COLUMNS && rows.len() < head.len() {
        return turned(head, rows);
    }
    let is_number = |at: usize| {
        let mut cells = rows.iter().filter_map(|row| row.get(at)).filter(|cell| !cell.content.is_empty()).peekable();
        cells.peek().is_some() && cells.all(|cell| cell.number.is_some())
    };
    let numbers: Vec<bool> = (0..head.len()).map(is_number).collect();
    let class = |at: usize| if numbers.get(at) == Some(&true) { " class=\"number\"" } else { "" };
    let line = |cells: &[Cell], tag: &str, scope: &str| -> String {
        let cell = |(at, cell): (usize, &Cell)| {
            format!("<{tag}{scope}{}{}>{}</{tag}>", class(at), cell.attributes(), cell.content)
        };
        format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
    };
    let body: String = rows.iter().map(|row| line(row, "td", "")).collect();
    let head = line(head, "th", " scope=\"col\"");
    format!(
        "<div class=\"scroll\"><table class=\"sorted\">\n<thead>{head}</thead>\n<tbody>\n{body}</tbody>\n</table></div>\n"
    )
}

/// The table with a row a column.
fn turned(head: &[Cell], rows: &[Vec<Cell>]) -> String {
    let line = |(at, head): (usize, &Cell)| {
        let cell = |row: &Vec<Cell>| {
            let cell = row.get(at).cloned().unwrap_or_default();
            let class = if cell.number.is_some() { " class=\"number\"" } else { "" };
            format!("<td{class}{}>{}</td>", cell.attributes(), cell.content)
        };
        let cells: String = rows.iter().map(cell).collect();
        format!("<tr><th scope=\"row\"{}>{}</th>{cells}</tr>\n", head.attributes(), head.content)
    };
    let lines: String = head.iter().enumerate().map(line).collect();
    format!("<div class=\"scroll\"><table class=\"turned\">\n{lines}</table></div>\n")
}

/// `content` (HTML), folded below a line (text) that opens it; empty without content.
pub(super) fn folded(line: &str, content: &str) -> String {
    if content.is_empty() {
        return String::new();
    }
    format!("<details><summary>{}</summary>\n{content}</details>\n", escape(line))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_sorted_by_numbers_and_keys_are_shown_on_hover() {
        let head = [Cell::text("run"), Cell::text("thickness (µm)").titled("specimen.<thickness>")];
        let rows = [vec![Cell::text("<1>"), Cell::number(12e-6, "12")], vec![Cell::text("2"), Cell::default()]];
        let html = table(&head, &rows);
        let column = "<th scope=\"col\" class=\"number\" title=\"specimen.&lt;thickness&gt;\">thickness (µm)</th>";
        assert!(html.contains(column) && html.contains("<td class=\"number\" data-sort=\"1.2e-5\">12</td>"), "{html}");
        assert!(html.contains("<td>&lt;1&gt;</td>") && html.contains("<td class=\"number\"></td>"), "{html}");
        assert_eq!(table(&head, &[]), "");
    }

    #[test]
    fn a_wide_table_of_few_rows_is_turned() {
        let head: Vec<Cell> = (0..13).map(|at| Cell::text(format!("c{at}"))).collect();
        let row: Vec<Cell> = (0..13).map(|at| Cell::number(f64::from(at), at.to_string())).collect();
        let html = table(&head, &[row]);
        assert!(
            html.contains("<tr><th scope=\"row\">c12</th><td class=\"number\" data-sort=\"1.2e1\">12</td></tr>"),
            "{html}"
        );
    }
}
