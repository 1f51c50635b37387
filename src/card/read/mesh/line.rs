//! A line of a mesh: its fields with their columns.

use crate::read::fields::number;
use crate::read::{Fault, Mistake, Place};

/// A line of fields.
#[derive(Clone, Debug)]
pub(super) struct Fields<'a> {
    line: usize,
    /// Column, from 1, and text of each.
    fields: Vec<(usize, &'a str)>,
}

impl<'a> Fields<'a> {
    /// Fields of these widths in columns, or between commas where there are any.
    ///
    /// # Errors
    /// A tab, which moves columns.
    pub(super) fn in_columns(text: &'a str, line: usize, widths: &[usize]) -> Result<Fields<'a>, Mistake> {
        if text.contains(',') {
            return Ok(Fields::separated(text, line));
        }
        if let Some(tab) = text.find('\t') {
            let place = Place { line, column: text[..tab].chars().count() + 1 };
            return Err(Mistake { place, fault: Fault::Tab });
        }
        let mut fields = vec![];
        let (mut rest, mut column) = (text, 1);
        for width in widths {
            let end = rest.char_indices().nth(*width).map_or(rest.len(), |(byte, _)| byte);
            let (field, behind) = rest.split_at(end);
            let before = field.chars().take_while(|c| c.is_whitespace()).count();
            fields.push((column + before, field.trim()));
            (rest, column) = (behind, column + width);
        }
        Ok(Fields { line, fields })
    }

    /// Fields between commas.
    pub(super) fn separated(text: &'a str, line: usize) -> Fields<'a> {
        let mut column = 1;
        let fields = text.split(',').map(|field| {
            let start = column + field.chars().take_while(|c| c.is_whitespace()).count();
            column += field.chars().count() + 1;
            (start, field.trim())
        });
        Fields { line, fields: fields.collect() }
    }

    /// Its line.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// Whether there is nothing at `place`.
    pub(super) fn is_blank(&self, place: usize) -> bool {
        self.text(place).is_empty()
    }

    /// The text at `place`, empty where there is none.
    pub(super) fn text(&self, place: usize) -> &'a str {
        self.fields.get(place).map_or("", |(_, text)| *text)
    }

    /// A mistake at a field.
    pub(super) fn mistake(&self, place: usize, fault: Fault) -> Mistake {
        let column = self.fields.get(place).map_or(1, |(column, _)| *column);
        Mistake { place: Place { line: self.line, column }, fault }
    }

    /// The number at `place`; zero where there is none.
    pub(super) fn real(&self, place: usize, name: &'static str) -> Result<f64, Mistake> {
        let text = self.text(place);
        if text.is_empty() {
            return Ok(0.0);
        }
        if text.starts_with(['&', '<']) {
            return Err(self.mistake(place, Fault::Parameter(text.to_owned())));
        }
        number(text).ok_or_else(|| self.mistake(place, Fault::NotANumber { name, text: text.to_owned() }))
    }

    /// The whole number at `place`, which must be there.
    pub(super) fn whole(&self, place: usize, name: &'static str) -> Result<i64, Mistake> {
        if self.is_blank(place) {
            return Err(self.mistake(place, Fault::Missing { name }));
        }
        let value = self.real(place, name)?;
        let is_number = value.fract() == 0.0 && (0.0..1e15).contains(&value);
        let fault = Fault::Outside { name, value, expected: "a whole number, not negative" };
        if is_number { Ok(value as i64) } else { Err(self.mistake(place, fault)) }
    }
}
