//! The rows of an export, of a text or of a sheet.

use std::io::BufRead;

use super::fault::{Fault, Mistake};
use crate::signal::channel_fault::MOST_VALUES;
use crate::signal::csv::{Mark, Separator};
use crate::signal::text::{Lines, TextError};

/// A row of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Counted from one.
    pub number: usize,
    /// What it holds.
    pub content: Content,
}

/// What a row holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Nothing.
    Blank,
    /// Numbers alone, `NaN` for an empty cell.
    Numbers(Vec<f64>),
    /// Anything else.
    Texts(Vec<String>),
}

/// A row of texts in a head, with its number.
pub type TextRow = (usize, Vec<String>);

/// Rows and how their numbers are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// All of them, blank ones too.
    pub rows: Vec<Row>,
    /// Decimal mark of the numbers.
    pub mark: Mark,
    /// Lines that start with `#`.
    pub comments: Vec<String>,
}

/// Most rows of anything but numbers, and most bytes of them.
const MOST_TEXTS: usize = 10_000;
const MOST_BYTES: usize = 1 << 26;
/// Lines in which the separator is looked for.
const SEPARATOR_WITHIN: usize = 1000;

/// The rows of a text; none where no line is one of numbers.
pub fn of_text(lines: &mut Lines<impl BufRead>) -> Result<Option<Rows>, Mistake> {
    let (mut first, mut separator, mut held) = (Vec::new(), None, 0);
    while let Some(line) = lines.line::<TextError>().map_err(Mistake::from_text)? {
        if line.text.trim_start().starts_with('#') {
            held += line.text.len();
            if held > MOST_BYTES {
                break;
            }
            first.push((line.number, line.text.into_owned()));
            continue;
        }
        separator = Separator::ALL.into_iter().find(|separator| is_numbers(&cells(*separator, &line.text)));
        held += line.text.len();
        first.push((line.number, line.text.into_owned()));
        if separator.is_some() || first.len() > SEPARATOR_WITHIN || held > MOST_BYTES {
            break;
        }
    }
    let Some(separator) = separator else { return Ok(None) };
    // A quoted cell may have a decimal comma between commas.
    let mut rows = Rows::default();
    let mut count = Count::default();
    for (number, text) in first {
        rows.push_line(number, &text, separator, &mut count)?;
    }
    while let Some(line) = lines.line::<TextError>().map_err(Mistake::from_text)? {
        rows.push_line(line.number, &line.text, separator, &mut count)?;
    }
    Ok(Some(rows))
}

/// Texts and numbers that are held.
#[derive(Default)]
pub struct Count {
    texts: usize,
    bytes: usize,
    numbers: usize,
}

impl Rows {
    fn push_line(&mut self, number: usize, line: &str, separator: Separator, count: &mut Count) -> Result<(), Mistake> {
        match line.trim_start().strip_prefix('#') {
            Some(comment) => {
                self.comments.push(comment.trim().to_owned());
                Ok(())
            }
            None => self.push(number, cells(separator, line), count),
        }
    }

    /// Adds a row of these cells.
    pub fn push(&mut self, number: usize, cells: Vec<String>, count: &mut Count) -> Result<(), Mistake> {
        let filled = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
        let cells = &cells[..filled];
        let mut mark = self.mark;
        let content = match numbers(cells, &mut mark) {
            _ if cells.is_empty() => Content::Blank,
            Some(numbers) => {
                self.mark = mark;
                count.numbers += numbers.len();
                Content::Numbers(numbers)
            }
            None => {
                count.texts += 1;
                count.bytes += cells.iter().map(|cell| size_of::<String>() + cell.len()).sum::<usize>();
                Content::Texts(cells.to_vec())
            }
        };
        let at = |fault| Mistake { row: number, column: None, fault };
        if count.numbers > MOST_VALUES {
            return Err(at(Fault::TooLarge));
        }
        if count.texts > MOST_TEXTS || count.bytes > MOST_BYTES {
            return Err(at(Fault::ManyTexts { most: MOST_TEXTS }));
        }
        self.rows.push(Row { number, content });
        Ok(())
    }
}

fn cells(separator: Separator, line: &str) -> Vec<String> {
    separator.cells(line).map(|cell| cell.text.into_owned()).collect()
}

fn is_numbers(cells: &[String]) -> bool {
    numbers(cells, &mut Mark::Unknown).is_some_and(|found| found.iter().filter(|value| !value.is_nan()).count() > 1)
}

/// The cells as numbers, at least one of them; none where some cell is anything else.
fn numbers(cells: &[String], mark: &mut Mark) -> Option<Vec<f64>> {
    let number = |cell: &String| if cell.is_empty() { Some(f64::NAN) } else { mark.number(cell, "").ok() };
    cells.iter().map(number).collect()
}
