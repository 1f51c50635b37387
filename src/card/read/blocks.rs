//! Blocks of OpenRadioss: a line that begins with `/`, a title, and lines of fields in columns of ten.

use super::fields::number;
use super::{Fault, Mistake, Place};

/// A block.
pub(super) struct Block<'a> {
    /// The words between the strokes of its first line, upper case.
    pub(super) words: Vec<String>,
    /// Its line.
    pub(super) line: usize,
    /// The line below it.
    pub(super) title: &'a str,
    /// Lines of fields, blank ones among them.
    pub(super) lines: Vec<Line<'a>>,
}

/// A line of fields.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    number: usize,
    text: &'a str,
}

/// A field of a line: from its column, counted from 0, and so many columns wide.
#[derive(Clone, Copy)]
pub(super) struct Field {
    pub(super) name: &'static str,
    from: usize,
    width: usize,
}

/// A real number in 20 columns from `tens` times ten.
pub(super) const fn real(name: &'static str, tens: usize) -> Field {
    Field { name, from: 10 * tens, width: 20 }
}

/// A whole number in 10 columns from `tens` times ten.
pub(super) const fn whole(name: &'static str, tens: usize) -> Field {
    Field { name, from: 10 * tens, width: 10 }
}

/// The blocks of a file.
pub(super) fn blocks(text: &str) -> Result<Vec<Block<'_>>, Mistake> {
    let mut found: Vec<Block<'_>> = vec![];
    let mut awaits_title = false;
    for (index, line) in text.lines().enumerate() {
        let (number, line) = (index + 1, line.trim_end());
        let refuse = |column: usize, fault: Fault| Err(Mistake { place: Place { line: number, column }, fault });
        if line.starts_with('#') && !line.starts_with("#include") || line.starts_with('$') {
            continue;
        }
        if line.starts_with("#include") {
            return refuse(1, Fault::Include("#include".into()));
        }
        if let Some(words) = line.strip_prefix('/') {
            let words: Vec<String> = words.split('/').map(|word| word.trim().to_ascii_uppercase()).collect();
            if words[0] == "END" {
                break;
            }
            found.push(Block { words, line: number, title: "", lines: vec![] });
            awaits_title = true;
            continue;
        }
        let Some(block) = found.last_mut() else { continue };
        if awaits_title {
            block.title = line.trim();
            awaits_title = false;
            continue;
        }
        if let Some(column) = line.find('\t') {
            return refuse(line[..column].chars().count() + 1, Fault::Tab);
        }
        const COLUMNS: usize = 100;
        let columns = line.chars().count();
        if columns > COLUMNS {
            return refuse(COLUMNS + 1, Fault::TooLong { found: columns, most: COLUMNS, width: 10 });
        }
        block.lines.push(Line { number, text: line });
    }
    Ok(found)
}

impl<'a> Block<'a> {
    /// Its line at `place`, from 0.
    pub(super) fn line(&self, place: usize) -> Result<Line<'a>, Mistake> {
        self.lines.get(place).copied().ok_or_else(|| {
            let fault = Fault::TooShort { keyword: format!("/{}", self.words.join("/")), card: place + 1 };
            Mistake { place: Place { line: self.line, column: 1 }, fault }
        })
    }
}

impl Line<'_> {
    /// Its number in the file.
    pub(super) fn number(&self) -> usize {
        self.number
    }

    /// Whether it has no field.
    pub(super) fn is_blank(&self) -> bool {
        self.text.is_empty()
    }

    /// The text of a field; empty where there is none.
    pub(super) fn text(&self, field: Field) -> &str {
        let place = |column: usize| self.text.char_indices().nth(column).map_or(self.text.len(), |(byte, _)| byte);
        self.text[place(field.from)..place(field.from + field.width)].trim()
    }

    /// A mistake at a field.
    pub(super) fn mistake(&self, field: Field, fault: Fault) -> Mistake {
        let written = self.text.chars().skip(field.from).take(field.width);
        let before = written.take_while(|c| c.is_whitespace()).count() % field.width;
        Mistake { place: Place { line: self.number, column: field.from + before + 1 }, fault }
    }

    /// The number of a field; zero where it is empty.
    pub(super) fn value(&self, field: Field) -> Result<f64, Mistake> {
        let text = self.text(field);
        if text.is_empty() {
            return Ok(0.0);
        }
        let fault = || Fault::NotANumber { name: field.name, text: text.to_owned() };
        number(text).ok_or_else(|| self.mistake(field, fault()))
    }

    /// As [`Line::value`], which must be above zero.
    pub(super) fn positive(&self, field: Field) -> Result<f64, Mistake> {
        match self.value(field)? {
            0.0 => Err(self.mistake(field, Fault::Missing { name: field.name })),
            value if value > 0.0 => Ok(value),
            value => Err(self.mistake(field, Fault::Outside { name: field.name, value, expected: "more than 0" })),
        }
    }

    /// The number of a function; `None` where it is zero or empty.
    pub(super) fn function(&self, field: Field) -> Result<Option<i64>, Mistake> {
        let value = self.value(field)?;
        match value.fract() == 0.0 && value.abs() < 1e15 {
            true => Ok(Some(value as i64).filter(|number| *number != 0)),
            false => Err(self.mistake(field, Fault::Outside { name: field.name, value, expected: "a whole number" })),
        }
    }
}
