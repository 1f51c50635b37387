//! Findings and tables on the terminal.

use std::fmt::Write;

use serde_json::Value;

use base::finding::{Finding, Severity};
use base::number::significant;
use base::written::Reading;
use report::{Figure, cell, columns};
use study::codes;
use study::post;
use study::script::{Row, RunFindings, ScriptOutput, Warning};

/// The findings of a study whose runs have warnings: one of all of them, and one of each thing that the film's data leave open,
/// unless the study's `own` findings say so. That recordings are virtual is a finding of its own.
pub(crate) fn findings_of_runs(found: &RunFindings, own: &[Finding]) -> Vec<Finding> {
    let is_warning = |code: &str| {
        let severity = codes::find(code).map_or(Severity::Warning, |code| code.severity);
        severity == Severity::Warning && !code.starts_with("virtual-") && post::left_open(code).is_none()
    };
    let warning = Warning::of_runs(found, is_warning).map(|warning| Finding::new(&warning));
    let left_open = |(code, count): (&String, &usize)| {
        let known = codes::find(code).filter(|_| post::left_open(code).is_some())?;
        let message = format!("{count} of {} runs: {}", found.runs, known.meaning);
        let is_new = own.iter().all(|finding| finding.code != *code);
        is_new.then(|| Finding { severity: known.severity, ..Finding::of_script(code, &message) })
    };
    warning.into_iter().chain(found.codes.iter().filter_map(left_open)).collect()
}

/// One line a finding, with its severity and code, each after `indent` and ending with a line break.
pub(crate) fn findings<'f>(indent: &str, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    findings.into_iter().fold(String::new(), |mut text, finding| {
        let _ = writeln!(text, "{indent}{finding}");
        text
    })
}

/// The findings of a run: a line each, and one line of those that its film's data leave open in every test.
pub(crate) fn findings_of_run<'f>(indent: &str, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    let (open, own): (Vec<&Finding>, Vec<&Finding>) =
        findings.into_iter().partition(|finding| post::left_open(&finding.code).is_some());
    let mut text = self::findings(indent, own);
    let words: Vec<&str> = open.iter().filter_map(|finding| post::left_open(&finding.code)).collect();
    let names: Vec<&str> = open.iter().map(|finding| finding.code.as_str()).collect();
    if !open.is_empty() {
        let _ = writeln!(text, "{indent}what this film's data leave open [{}]: {}", names.join(", "), words.join(", "));
    }
    text
}

/// Most rows of a table that are printed; its file has all of them.
const MOST_ROWS: usize = 40;

/// The rows of a longer table that are printed from its beginning; the others are from its end.
const FIRST_ROWS: usize = 10;

/// Significant digits of a figure of a script.
const DIGITS: usize = 4;

/// The sentences of an answer, a line each, which ends with a line break.
pub(crate) fn sentences(answer: &str) -> String {
    let mut text = String::from("  ");
    for (place, part) in answer.split(". ").enumerate() {
        // A point within a sentence is followed by a small letter or a digit.
        let before = if part.starts_with(char::is_uppercase) { ".\n  " } else { ". " };
        text += if place == 0 { "" } else { before };
        text += part;
    }
    text + "\n"
}

/// The answer, figures and tables; every line ends with a line break.
pub(crate) fn script_output(output: &ScriptOutput) -> String {
    let answer = report::study_answer(output).map(|answer| sentences(&answer));
    let figures = output.measures.iter().filter_map(|(name, value)| {
        let of_number = |number: f64| {
            let (words, reading) = Reading::of_name(name, number);
            format!("{words} {}", reading.with_unit(&significant(reading.value(number), DIGITS)))
        };
        let other = || Some(Figure::from_value(name, value)?.cells().join(" ").trim_end().to_owned());
        value.as_f64().map(of_number).or_else(other)
    });
    let figures = figures.map(|figure| format!("  {figure}\n"));
    let tables = output.tables.iter().map(|(name, rows)| format!("  {name}\n{}", rows_of(rows)));
    answer.into_iter().chain(figures).chain(tables).collect()
}

/// The rows under the names of their columns; those before the first numbers are words, aligned to the left.
fn rows_of(rows: &[Row]) -> String {
    let columns = columns(rows);
    let left_out = rows.len().saturating_sub(MOST_ROWS);
    let (head, tail) = if left_out > 0 { (FIRST_ROWS, FIRST_ROWS + left_out) } else { (rows.len(), rows.len()) };
    let cells = |row: &Row| columns.iter().map(|name| row.get(name).map_or_else(String::new, cell)).collect();
    let shown = rows[..head].iter().chain(&rows[tail..]).map(cells);
    let is_words = |name: &&String| rows.iter().all(|row| row.get(*name).is_some_and(Value::is_string));
    let text = table(columns.iter().take_while(is_words).count(), &columns, shown);
    if left_out == 0 {
        return text;
    }
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let (before, after) = lines.split_at(1 + head);
    format!("{}    {left_out} rows not shown\n{}", before.concat(), after.concat())
}

/// Rows under a header, the first `words` columns aligned to the left, the others to the right.
pub(crate) fn table<H: AsRef<str>>(
    words: usize,
    header: impl IntoIterator<Item = H>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let header = header.into_iter().map(|name| name.as_ref().to_owned()).collect();
    aligned(&std::iter::once(header).chain(rows).collect::<Vec<Vec<String>>>(), words)
}

/// Lines of equally many cells in columns, the first `words` columns aligned to the left, the others to the right; indented.
pub(crate) fn aligned(lines: &[Vec<String>], words: usize) -> String {
    in_columns(lines, words).map(|line| format!("  {line}\n")).collect()
}

/// Lines as [`aligned`] gives them, without line breaks and less indented.
pub(crate) fn in_columns(lines: &[Vec<String>], words: usize) -> impl Iterator<Item = String> {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    lines.iter().map(move |line| {
        let cell = |(column, (cell, width)): (usize, (&String, &usize))| {
            if column < words { format!("  {cell:<width$}") } else { format!("  {cell:>width$}") }
        };
        let cells: String = line.iter().zip(&widths).enumerate().map(cell).collect();
        cells.trim_end().to_owned()
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use lab::signal::Warning;

    use super::*;

    #[test]
    fn what_a_films_data_leave_open_is_one_line() {
        let names = ["uncoupled-biaxial", "strain-rate-outside", "break-strain-of-coupons"];
        assert!(names.iter().all(|name| codes::find(name).is_some() && post::left_open(name).is_some()));
        let open = names.map(|name| Finding::of_script(name, "65 % of the film"));
        let text = findings_of_run("  ", open.iter().chain([&Finding::new(&Warning::NoTimeColumn)]));
        let line = "  what this film's data leave open [uncoupled-biaxial, strain-rate-outside, break-strain-of-coupons]: coupling of MD and \
                TD, strain rates, break strain\n";
        assert!(text.lines().count() == 2 && text.ends_with(line), "{text}");
    }

    #[test]
    fn sentences_are_lines() {
        let lines = "  It held, approx. 3 g.\n  It came to 92 %.\n";
        assert_eq!(sentences("It held, approx. 3 g. It came to 92 %."), lines);
    }

    #[test]
    fn cells_are_aligned_under_the_names_of_their_columns() {
        let row = |layers: i64, travel: f64| match json!({ "layers": layers, "travel": travel }) {
            serde_json::Value::Object(row) => row,
            _ => Row::new(),
        };
        let lines = "    layers  travel\n         8  -169.4\n        10  -15.00\n";
        assert_eq!(rows_of(&[row(8, -169.4413), row(10, -15.0)]), lines);
        let rows: Vec<Row> = (1..=45).map(|layers| row(layers, 1.0)).collect();
        let many = rows_of(&rows);
        let lines: Vec<&str> = many.lines().map(str::trim_start).collect();
        assert_eq!(lines[10..13], ["10   1.000", "5 rows not shown", "16   1.000"]);
        assert_eq!((lines.len(), lines[41]), (42, "45   1.000"));
    }
}
