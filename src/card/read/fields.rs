//! Keywords of LS-DYNA with the fields of their cards and where these stand.

use super::{Fault, Mistake, Place};

/// A keyword and the cards below it.
#[derive(Clone, Debug)]
pub(super) struct Keyword<'a> {
    /// Upper case, without `*`, `_TITLE` and the mark of the format.
    pub(super) name: String,
    /// Its line.
    pub(super) line: usize,
    /// The title in a line of its own.
    pub(super) title: Option<&'a str>,
    pub(super) cards: Vec<Card<'a>>,
}

/// A line of fields.
#[derive(Clone, Debug)]
pub(super) struct Card<'a> {
    line: usize,
    fields: Vec<(usize, &'a str)>,
}

/// Columns of a field.
const SHORT: usize = 10;
const LONG: usize = 20;

/// Fields of a card.
const FIELDS: usize = 8;

/// The keywords of a file.
pub(super) fn keywords(text: &str) -> Result<Vec<Keyword<'_>>, Mistake> {
    let mut found: Vec<Keyword<'_>> = vec![];
    let (mut width, mut awaits_title, mut long_deck) = (SHORT, false, false);
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        let line = line.trim_end();
        let refuse = |column: usize, fault: Fault| Err(Mistake { place: Place { line: number, column }, fault });
        if line.starts_with('$') {
            continue;
        }
        if let Some(written) = line.strip_prefix('*') {
            let written = written.to_ascii_uppercase();
            let mut words = written.split_whitespace();
            let name = words.next().unwrap_or_default();
            if name.starts_with("INCLUDE") {
                return refuse(1, Fault::Include(format!("*{name}")));
            }
            long_deck |= name == "KEYWORD" && words.any(|word| word == "LONG=Y");
            let (name, own) = match name.strip_suffix('+') {
                Some(name) => (name, Some(LONG)),
                None => name.strip_suffix('-').map_or((name, None), |name| (name, Some(SHORT))),
            };
            width = own.unwrap_or(if long_deck { LONG } else { SHORT });
            let bare = name.strip_suffix("_TITLE");
            awaits_title = bare.is_some();
            if name == "END" {
                break;
            }
            found.push(Keyword { name: bare.unwrap_or(name).to_owned(), line: number, title: None, cards: vec![] });
            continue;
        }
        let Some(keyword) = found.last_mut() else { continue };
        if awaits_title {
            keyword.title = Some(line.trim());
            awaits_title = false;
            continue;
        }
        if let Some(column) = line.find('\t') {
            return refuse(line[..column].chars().count() + 1, Fault::Tab);
        }
        let is_point = matches!(keyword.name.as_str(), "DEFINE_CURVE" | "DEFINE_TABLE") && !keyword.cards.is_empty();
        let width = if is_point { LONG } else { width };
        keyword.cards.push(card(line, number, width)?);
    }
    Ok(found)
}

fn card(line: &str, number: usize, width: usize) -> Result<Card<'_>, Mistake> {
    // Free format: fields between commas.
    if line.contains(',') {
        let mut column = 1;
        let fields = line.split(',').map(|field| {
            let start = column + field.chars().take_while(|c| c.is_whitespace()).count();
            column += field.chars().count() + 1;
            (start, field.trim())
        });
        return Ok(Card { line: number, fields: fields.collect() });
    }
    let columns = line.chars().count();
    if columns > FIELDS * width {
        let fault = Fault::TooLong { found: columns, most: FIELDS * width, width };
        return Err(Mistake { place: Place { line: number, column: FIELDS * width + 1 }, fault });
    }
    let starts: Vec<usize> = line.char_indices().map(|(byte, _)| byte).step_by(width).chain([line.len()]).collect();
    let field = |(place, ends): (usize, &[usize])| {
        let written = &line[ends[0]..ends[1]];
        let before = written.chars().take_while(|c| c.is_whitespace()).count();
        (place * width + before + 1, written.trim())
    };
    let fields = starts.windows(2).enumerate().map(field);
    Ok(Card { line: number, fields: fields.collect() })
}

impl<'a> Keyword<'a> {
    /// Its card at `place`, from 0.
    pub(super) fn card(&self, place: usize) -> Result<&Card<'a>, Mistake> {
        self.cards.get(place).ok_or_else(|| {
            let fault = Fault::TooShort { keyword: format!("*{}", self.name), card: place + 1 };
            Mistake { place: Place { line: self.line, column: 1 }, fault }
        })
    }
}

impl Card<'_> {
    /// Its line.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// The text of the field at `place`, from 0; empty where there is none.
    pub(super) fn text(&self, place: usize) -> &str {
        self.fields.get(place).map_or("", |(_, text)| text)
    }

    /// A mistake at a field.
    pub(super) fn mistake(&self, place: usize, fault: Fault) -> Mistake {
        let column = self.fields.get(place).map_or(1, |(column, _)| *column);
        Mistake { place: Place { line: self.line, column }, fault }
    }

    /// The number of the field called `name` at `place`; zero where it is empty.
    pub(super) fn number(&self, place: usize, name: &'static str) -> Result<f64, Mistake> {
        let text = self.text(place);
        if text.is_empty() {
            return Ok(0.0);
        }
        if text.starts_with('&') {
            return Err(self.mistake(place, Fault::Parameter(text.to_owned())));
        }
        number(text).ok_or_else(|| self.mistake(place, Fault::NotANumber { name, text: text.to_owned() }))
    }

    /// As [`Card::number`], which must be above zero.
    pub(super) fn positive(&self, place: usize, name: &'static str) -> Result<f64, Mistake> {
        match self.number(place, name)? {
            0.0 => Err(self.mistake(place, Fault::Missing { name })),
            value if value > 0.0 => Ok(value),
            value => Err(self.mistake(place, Fault::Outside { name, value, expected: "more than 0" })),
        }
    }

    /// The number of a curve or material; `None` where it is zero or empty.
    pub(super) fn whole(&self, place: usize, name: &'static str) -> Result<Option<i64>, Mistake> {
        let value = self.number(place, name)?;
        let is_whole = value.fract() == 0.0 && value.abs() < 1e15;
        match is_whole {
            true => Ok(Some(value as i64).filter(|number| *number != 0)),
            false => Err(self.mistake(place, Fault::Outside { name, value, expected: "a whole number" })),
        }
    }
}

/// A number as Fortran reads it: `1.0E-3`, `1.0D-3` and `1.0-3`.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.replace(['d', 'D'], "E");
    let exponent = text.char_indices().skip(1).find(|(place, c)| {
        matches!(c, '+' | '-') && text[..*place].ends_with(|c: char| c.is_ascii_digit() || c == '.')
    });
    let text = match exponent {
        Some((place, _)) => format!("{}E{}", &text[..place], &text[place..]),
        None => text,
    };
    // Not `inf` and `nan`, which Rust reads.
    let is_number = text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | 'e' | 'E'));
    text.parse::<f64>().ok().filter(|value| is_number && value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_fortran_reads_them() {
        for (text, expected) in [
            ("1.0E-3", Some(1e-3)),
            ("1.0-3", Some(1e-3)),
            ("1.0+3", Some(1e3)),
            ("-2.5D-4", Some(-2.5e-4)),
            ("+.5", Some(0.5)),
            ("12", Some(12.0)),
            ("inf", None),
            ("nan", None),
            ("1e999", None),
            ("1.0e", None),
            ("film", None),
            ("-", None),
        ] {
            assert_eq!(number(text), expected, "{text}");
        }
    }

    #[test]
    fn fields_have_their_columns() {
        let text = "$ a comment\r\n*MAT_ELASTIC_TITLE\r\nmy film\r\n         1   9.15-10     200.0\r\n*define_curve+\n1, 0 ,2.0\n";
        let found = keywords(text).unwrap();
        assert_eq!((found[0].name.as_str(), found[0].title, found[0].line), ("MAT_ELASTIC", Some("my film"), 2));
        let card = found[0].card(0).unwrap();
        assert_eq!(
            (card.number(1, "ro"), card.number(2, "e"), card.number(3, "pr")),
            (Ok(9.15e-10), Ok(200.0), Ok(0.0))
        );
        let mistake = card.mistake(1, Fault::NoMaterial);
        assert_eq!(mistake.place, Place { line: 4, column: 14 });
        assert_eq!(found[1].card(0).unwrap().number(2, "sfa"), Ok(2.0));
        assert!(found[1].card(1).is_err());
    }

    #[test]
    fn what_moves_columns_is_a_mistake_at_its_place() {
        for (text, line, column) in [
            ("*MAT_ELASTIC\n         1\t1.0\n", 2, 11),
            (
                "*MAT_ELASTIC\n                                                                                 1\n",
                2,
                81,
            ),
            ("*KEYWORD\n*INCLUDE_PATH\nother.k\n", 2, 1),
        ] {
            let mistake = keywords(text).unwrap_err();
            assert_eq!(mistake.place, Place { line, column }, "{text}");
        }
    }
}
