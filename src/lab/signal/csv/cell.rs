//! The cells of a line, and the numbers in them.

use std::borrow::Cow;

use crate::error::{Error, refusal};
use crate::signal::measurement::{not_a_number, not_finite};
use crate::signal::text::Line;
use base::units::Unit;

/// Separator of the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    Semicolon,
    Tab,
    Comma,
    /// Any number of blanks, also before the first cell.
    Blanks,
}

/// One cell of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell<'a> {
    /// Without the blanks and the quotes around it; doubled quotes within quotes are one.
    pub text: Cow<'a, str>,
    /// Bytes of the line before it.
    pub offset: usize,
}

impl Separator {
    /// All of them; what is tried first is the least likely to stand within a cell.
    pub const ALL: [Separator; 4] = [Separator::Semicolon, Separator::Tab, Separator::Comma, Separator::Blanks];

    /// The cells of `line`.
    pub fn cells(self, line: &str) -> Cells<'_> {
        Cells { separator: self, line, at: Some(0) }
    }

    fn matches(self, letter: char) -> bool {
        match self {
            Separator::Semicolon => letter == ';',
            Separator::Tab => letter == '\t',
            Separator::Comma => letter == ',',
            Separator::Blanks => letter == ' ' || letter == '\t',
        }
    }
}

/// The cells of a line from the first to the last.
#[derive(Clone)]
pub struct Cells<'a> {
    separator: Separator,
    line: &'a str,
    /// Where the next cell starts; none after the last.
    at: Option<usize>,
}

impl<'a> Iterator for Cells<'a> {
    type Item = Cell<'a>;

    fn next(&mut self) -> Option<Cell<'a>> {
        let start = self.at?;
        let rest = &self.line[start..];
        let trimmed = rest.trim_start_matches(|letter: char| letter.is_whitespace() && !self.is_tab(letter));
        let offset = start + rest.len() - trimmed.len();
        if self.separator == Separator::Blanks && trimmed.is_empty() {
            self.at = None;
            return None;
        }
        let quoted = trimmed.strip_prefix('"').and_then(closing).map_or(0, |close| close + 2);
        let end = trimmed[quoted..].find(|letter| self.separator.matches(letter)).map(|end| quoted + end);
        self.at = end.map(|end| offset + end + 1);
        let text = trimmed[..end.unwrap_or(trimmed.len())].trim();
        Some(Cell { text: unquoted(text), offset })
    }
}

impl Cells<'_> {
    /// Whether the letter separates cells although it is a blank.
    fn is_tab(&self, letter: char) -> bool {
        self.separator == Separator::Tab && letter == '\t'
    }
}

/// Where the quote stands that closes a cell: it is not doubled.
fn closing(inner: &str) -> Option<usize> {
    let quotes = inner.match_indices('"').map(|(place, _)| place);
    let mut doubled = None;
    for place in quotes {
        if doubled == Some(place) {
            doubled = None;
        } else if inner[place + 1..].starts_with('"') {
            doubled = Some(place + 1);
        } else {
            return Some(place);
        }
    }
    None
}

fn unquoted(text: &str) -> Cow<'_, str> {
    match text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).map(str::trim) {
        Some(inner) if inner.contains("\"\"") => Cow::Owned(inner.replace("\"\"", "\"")),
        Some(inner) => Cow::Borrowed(inner),
        None => Cow::Borrowed(text),
    }
}

/// How the numbers of a file are written; decided by the first number that is unambiguous.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    #[default]
    Unknown,
    Point,
    Comma,
}

impl Mark {
    /// Before any number was read: a comma that separates cells is no decimal mark.
    pub fn between(separator: Separator) -> Mark {
        if separator == Separator::Comma { Mark::Point } else { Mark::Unknown }
    }

    /// The number in `text`, which is not empty; `name` is the column's, for the error.
    pub fn number(&mut self, text: &str, name: &str) -> Result<f64, Error> {
        let found = || text.chars().take(40).collect::<String>();
        let mixed = || refusal!("decimal point and decimal comma in one file: `{}` for `{name}`", found());
        let written = self.with_point(text).ok_or_else(mixed)?;
        match written.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(not_finite(name).with_hint("leave the cell empty where nothing was measured")),
            Err(_) if carries_unit(text) => {
                let found = found();
                let error =
                    refusal!("expected a number for `{name}`, found `{found}`, which carries a unit of its own");
                Err(error.with_hint("units belong into the header: `accel [g]`"))
            }
            Err(_) => Err(not_a_number(name, &found())),
        }
    }

    /// The number with a decimal point; none where it has the other mark than the numbers before it.
    fn with_point<'a>(&mut self, text: &'a str) -> Option<Cow<'a, str>> {
        let mark = match (text.contains('.'), text.contains(',')) {
            (false, false) | (true, true) => return Some(Cow::Borrowed(text)),
            (true, false) => Mark::Point,
            (false, true) => Mark::Comma,
        };
        if *self == Mark::Unknown {
            *self = mark;
        }
        let written = if mark == Mark::Comma { Cow::Owned(text.replacen(',', ".", 1)) } else { Cow::Borrowed(text) };
        (*self == mark || written.parse::<f64>().is_err()).then_some(written)
    }
}

/// Whether the cell is a number with a unit behind it.
fn carries_unit(text: &str) -> bool {
    let unit = text.trim_start_matches(|letter: char| letter.is_ascii_digit() || "+-.,".contains(letter));
    unit.len() < text.len() && Unit::parse(unit).is_ok()
}

/// A mistake in the cell at `place` of a line.
pub(super) fn at_cell(line: &Line, separator: Separator, place: usize, error: Error) -> Error {
    let offset = separator.cells(&line.text).nth(place).map_or(0, |cell| cell.offset);
    error.at(line.number, line.text[..offset].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_their_offset_in_the_line() {
        for (separator, line, expected) in [
            (Separator::Comma, "0, 1 ,,2", &[("0", 0), ("1", 3), ("", 6), ("2", 7)][..]),
            (Separator::Semicolon, "0,5;\"a;b\";", &[("0,5", 0), ("a;b", 4), ("", 10)]),
            (Separator::Tab, "0\t\t 1", &[("0", 0), ("", 2), ("1", 4)]),
            (Separator::Blanks, "   0.5  1\t2 ", &[("0.5", 3), ("1", 8), ("2", 10)]),
            (Separator::Comma, "\"a", &[("\"a", 0)]),
            (Separator::Semicolon, "\"a \"\"b; c\"\"\";2", &[("a \"b; c\"", 0), ("2", 13)]),
            (Separator::Comma, "\"\",\"\"\"\",1", &[("", 0), ("\"", 3), ("1", 8)]),
            (Separator::Comma, "", &[("", 0)]),
            (Separator::Blanks, " ", &[]),
        ] {
            let found: Vec<Cell> = separator.cells(line).collect();
            let found: Vec<(&str, usize)> = found.iter().map(|cell| (cell.text.as_ref(), cell.offset)).collect();
            assert_eq!(found, expected, "{line:?}");
        }
    }

    #[test]
    fn a_file_has_one_decimal_mark() {
        let mut mark = Mark::Unknown;
        assert_eq!(mark.number("7", "a").unwrap(), 7.0);
        assert_eq!(mark.number("-1,5e3", "a").unwrap(), -1500.0);
        for (mut mark, text, expected) in [
            (mark, "1.5", "decimal point and decimal comma in one file: `1.5` for `a`"),
            (Mark::Point, "1,5", "decimal point and decimal comma in one file: `1,5` for `a`"),
            (Mark::Unknown, "1.234,5", "expected a number for `a`, found `1.234,5`"),
        ] {
            assert_eq!(mark.number(text, "a").unwrap_err().to_string(), expected);
        }
    }
}
