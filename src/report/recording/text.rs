//! Texts of a recording, in Markdown.

use viz::Document;

use crate::{cell, columns};

pub(super) use crate::figure::escaped;
use study::script::{File, Row, ScriptOutput};

/// Most files that are shown, lines of each, and characters of each line.
const MOST_FILES: usize = 20;
const MOST_LINES: usize = 10;
const MOST_LETTERS: usize = 160;

/// A text of its own.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) title: String,
    pub(super) markdown: String,
}

impl Text {
    /// A file verbatim, such as a scenario or a script.
    pub(super) fn verbatim(title: &str, content: &str) -> Text {
        // A fence is longer than any run of backticks within.
        let longest = content.split(|c| c != '`').map(str::len).max().unwrap_or(0);
        let fence = "`".repeat(longest.max(2) + 1);
        Text { title: title.to_owned(), markdown: format!("{fence}\n{}\n{fence}\n", content.trim_end()) }
    }

    /// The tables of a script; `None` without any.
    pub(super) fn tables(output: &ScriptOutput) -> Option<Text> {
        let tables: Vec<String> = output.tables.iter().map(|(name, rows)| table(name, rows)).collect();
        (!tables.is_empty()).then(|| Text { title: "Tables".to_owned(), markdown: tables.join("\n") })
    }

    /// The beginnings of the files of a script; `None` without any.
    pub(super) fn files(output: &ScriptOutput) -> Option<Text> {
        let files: Vec<String> = output.files.iter().take(MOST_FILES).map(file).collect();
        let more = match output.files.iter().count().saturating_sub(MOST_FILES) {
            0 => String::new(),
            more => format!("\nand {more} more in the folder\n"),
        };
        (!files.is_empty()).then(|| Text { title: "Files".to_owned(), markdown: files.join("\n") + more.as_str() })
    }

    pub(super) fn document(&self) -> Document {
        let letters = self.title.chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' });
        Document {
            path: format!("texts/{}", letters.collect::<String>()),
            title: self.title.clone(),
            text: self.markdown.clone(),
        }
    }
}

/// Name, length and first lines of a file.
fn file(File { name, content }: &File) -> String {
    let lines: Vec<String> =
        content.lines().take(MOST_LINES).map(|line| line.chars().take(MOST_LETTERS).collect()).collect();
    let shown = Text::verbatim(name, &lines.join("\n")).markdown;
    format!("## {}\n\n{} lines, {} bytes\n\n{shown}", escaped(name), content.lines().count(), content.len())
}

/// Rows under the names of all their columns, under a heading.
pub(super) fn table(name: &str, rows: &[Row]) -> String {
    let columns = columns(rows);
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let heads = line(columns.iter().map(|name| escaped(name)).collect());
    let rule = format!("|{}\n", "---|".repeat(columns.len()));
    let cells = |row: &Row| columns.iter().map(|name| row.get(name).map_or_else(String::new, cell)).collect::<Vec<_>>();
    let rows = rows.iter().map(|row| line(cells(row).iter().map(|cell| escaped(cell)).collect()));
    format!("## {}\n\n{heads}{rule}{}", escaped(&name.replace('_', " ")), rows.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fence_is_longer_than_those_within() {
        let text = Text::verbatim("Script", "let a = `b`;\n// ````\n");
        assert_eq!(text.markdown, "`````\nlet a = `b`;\n// ````\n`````\n");
    }

    #[test]
    fn the_first_lines_of_a_long_file_are_shown() {
        let content: String = (0..50).map(|i| format!("{i},1\n")).collect();
        let text = file(&File { name: "tests_a.csv".into(), content });
        assert!(text.starts_with("## tests\\_a.csv\n\n50 lines, 240 bytes\n\n```\n0,1\n1,1\n"), "{text}");
        assert!(text.ends_with("\n9,1\n```\n"), "{text}");
        assert!(Text::files(&ScriptOutput::default()).is_none());
    }

    #[test]
    fn cells_are_escaped() {
        let row = |cell: &str| serde_json::json!({ "k1": 2.75, "note": cell }).as_object().cloned().unwrap();
        let expected = "## best of all\n\n| k1 | note |\n|---|---|\n| 2.750 | a \\| b \\<i\\> |\n";
        assert_eq!(table("best_of_all", &[row("a | b <i>")]), expected);
    }
}
