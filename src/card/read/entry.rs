//! Keywords of LS-DYNA and blocks of OpenRadioss: their lines, and the fields of these by name and place.

use std::cell::RefCell;

use super::{Mistake, Place, Warning};
use crate::layout::{Column, Format, Layout, columns};
use crate::target::System;

/// A keyword or a block.
pub(super) struct Entry<'a> {
    /// With which its line begins.
    mark: char,
    /// Upper case: the name of a keyword without `_TITLE` and the mark of its format, or the words between strokes.
    pub(super) words: Vec<String>,
    /// Its line.
    pub(super) line: usize,
    /// In a line of its own.
    pub(super) title: Option<&'a str>,
    pub(super) rows: Vec<Row<'a>>,
}

/// A line of fields.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    line: usize,
    text: &'a str,
    format: Format,
    system: System,
}

/// A field.
#[derive(Clone, Copy)]
pub(super) struct Cell<'a> {
    column: Column<'static>,
    place: Place,
    system: System,
    /// Empty where there is none.
    pub(super) text: &'a str,
}

/// Columns of a field of LS-DYNA.
const SHORT: usize = 10;
const LONG: usize = 20;

/// Fields of a line of LS-DYNA, and columns of one of OpenRadioss.
const FIELDS: usize = 8;
const COLUMNS: usize = 100;

/// A limit that is never reached, which stands for none.
const NEVER: f64 = 1e20;

/// The keywords of a file of LS-DYNA.
pub(super) fn keywords(text: &str, system: System) -> Result<Vec<Entry<'_>>, Mistake> {
    let mut found: Vec<Entry<'_>> = vec![];
    let (mut width, mut awaits_title, mut long_deck) = (SHORT, false, false);
    for (number, line) in (1..).zip(text.lines().map(str::trim_end)).filter(|(_, line)| !line.starts_with('$')) {
        if let Some(written) = line.strip_prefix('*') {
            let written = written.to_ascii_uppercase();
            let mut words = written.split_whitespace();
            let name = words.next().unwrap_or_default();
            if name.starts_with("INCLUDE") {
                return Err(refused(number, 1, included(&format!("*{name}"))));
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
            let words = vec![bare.unwrap_or(name).to_owned()];
            found.push(Entry { mark: '*', words, line: number, title: None, rows: vec![] });
            continue;
        }
        let Some(keyword) = found.last_mut() else { continue };
        if std::mem::take(&mut awaits_title) {
            keyword.title = Some(line.trim());
            continue;
        }
        let is_point =
            matches!(keyword.name(), "DEFINE_CURVE" | "DEFINE_TABLE" | "DEFINE_TABLE_2D") && !keyword.rows.is_empty();
        let width = if is_point { LONG } else { width };
        // In free format fields are between commas.
        let most = if line.contains(',') { usize::MAX } else { FIELDS * width };
        let row = Row { line: number, text: line, format: Format::Equal(width), system };
        keyword.rows.push(row.checked(most, width)?);
    }
    Ok(found)
}

/// The blocks of a file of OpenRadioss.
pub(super) fn blocks(text: &str, system: System) -> Result<Vec<Entry<'_>>, Mistake> {
    let mut found: Vec<Entry<'_>> = vec![];
    for (number, line) in (1..).zip(text.lines().map(str::trim_end)) {
        if line.starts_with("#include") {
            return Err(refused(number, 1, included("#include")));
        }
        if line.starts_with(['#', '$']) {
            continue;
        }
        if let Some(words) = line.strip_prefix('/') {
            let words: Vec<String> = words.split('/').map(|word| word.trim().to_ascii_uppercase()).collect();
            if words[0] == "END" {
                break;
            }
            found.push(Entry { mark: '/', words, line: number, title: None, rows: vec![] });
            continue;
        }
        let Some(block) = found.last_mut() else { continue };
        if block.title.is_none() {
            block.title = Some(line.trim());
            continue;
        }
        let row = Row { line: number, text: line, format: Format::Mixed, system };
        block.rows.push(row.checked(COLUMNS, 10)?);
    }
    Ok(found)
}

fn refused(line: usize, column: usize, message: String) -> Mistake {
    Mistake { place: Place { line, column }, message }
}

/// Another file is part of the card.
fn included(by: &str) -> String {
    format!("{by} would read another file: put its lines here")
}

impl<'a> Entry<'a> {
    /// Its first word.
    pub(super) fn name(&self) -> &str {
        &self.words[0]
    }

    /// Its word at `place`; empty where there is none.
    pub(super) fn word(&self, place: usize) -> &str {
        self.words.get(place).map_or("", String::as_str)
    }

    /// Its name as the format has it.
    pub(super) fn shown(&self) -> String {
        format!("{}{}", self.mark, self.words.join("/"))
    }

    /// Its line of fields at `place`, from 0.
    pub(super) fn row(&self, place: usize) -> Result<Row<'a>, Mistake> {
        self.rows
            .get(place)
            .copied()
            .ok_or_else(|| refused(self.line, 1, format!("{} ends before its card {}", self.shown(), place + 1)))
    }
}

impl<'a> Row<'a> {
    /// The row, which has no tab and at most `most` columns.
    fn checked(self, most: usize, width: usize) -> Result<Row<'a>, Mistake> {
        if let Some(tab) = self.text.find('\t') {
            let tabbed = "a tab: in columns it stands for a number of blanks that readers disagree on";
            return Err(refused(self.line, self.text[..tab].chars().count() + 1, tabbed.into()));
        }
        let found = self.text.chars().count();
        if found > most {
            let long =
                format!("the line has {found} columns, a card at most {most}: are its fields {width} columns wide?");
            return Err(refused(self.line, most + 1, long));
        }
        Ok(self)
    }

    /// Whether it has no field.
    pub(super) fn is_blank(&self) -> bool {
        self.text.is_empty()
    }

    /// The fields called `names`.
    pub(super) fn cells(self, names: &'static str) -> impl Iterator<Item = Cell<'a>> {
        let is_free = self.format != Format::Mixed && self.text.contains(',');
        columns(names, self.format).enumerate().map(move |(place, column)| {
            let (from, written) = if is_free {
                let before: usize = self.text.split(',').take(place).map(|field| field.chars().count() + 1).sum();
                self.text.split(',').nth(place).map_or((0, ""), |field| (before, field))
            } else {
                let byte = |place: usize| self.text.char_indices().nth(place).map_or(self.text.len(), |(byte, _)| byte);
                (column.from, &self.text[byte(column.from)..byte(column.from + column.width)])
            };
            let blanks = written.chars().take_while(|c| c.is_whitespace()).count();
            let place = Place { line: self.line, column: from + blanks % column.width + 1 };
            Cell { column, place, system: self.system, text: written.trim() }
        })
    }

    /// The field called `name` among `names`.
    pub(super) fn cell(self, names: &'static str, name: &str) -> Cell<'a> {
        self.cells(names).find(|cell| cell.name().eq_ignore_ascii_case(name)).expect("a name of the layout")
    }
}

impl Cell<'_> {
    pub(super) fn name(&self) -> &'static str {
        self.column.name
    }

    pub(super) fn mistake(&self, message: String) -> Mistake {
        Mistake { place: self.place, message }
    }

    /// A value (in the units of the card) that a film cannot have.
    pub(super) fn outside(&self, value: f64, expected: &'static str) -> Mistake {
        self.mistake(format!("{} is {value}, expected {expected}", self.name()))
    }

    pub(super) fn missing(&self) -> Mistake {
        self.mistake(format!("{} is missing", self.name()))
    }

    /// Its number in the units of the card; zero where it is empty.
    pub(super) fn written(&self) -> Result<f64, Mistake> {
        match self.text {
            "" => Ok(0.0),
            text if text.starts_with('&') => Err(self.mistake(format!("`{text}` is a parameter: write its value"))),
            text => number(text).ok_or_else(|| self.mistake(format!("{} is not a number: `{text}`", self.name()))),
        }
    }

    /// Its number (SI); zero where it is empty.
    pub(super) fn number(&self) -> Result<f64, Mistake> {
        Ok(self.column.in_si(self.written()?, self.system))
    }

    /// Its number (SI), or `default` where that is zero.
    pub(super) fn or(&self, default: f64) -> Result<f64, Mistake> {
        self.number().map(|value| if value == 0.0 { default } else { value })
    }

    /// Its number (SI), which must be above zero.
    pub(super) fn positive(&self) -> Result<f64, Mistake> {
        match self.written()? {
            0.0 => Err(self.missing()),
            value if value > 0.0 => self.number(),
            value => Err(self.outside(value, "more than 0")),
        }
    }

    /// Poisson's ratio.
    pub(super) fn poisson(&self) -> Result<f64, Mistake> {
        let value = self.number()?;
        if (0.0..0.5).contains(&value) { Ok(value) } else { Err(self.outside(value, "0 to less than 0.5")) }
    }

    /// The number of a curve or material; `None` where it is zero or empty.
    pub(super) fn whole(&self) -> Result<Option<i64>, Mistake> {
        let value = self.number()?;
        match value.fract() == 0.0 && value.abs() < 1e15 {
            true => Ok(Some(value as i64).filter(|number| *number != 0)),
            false => Err(self.outside(value, "a whole number")),
        }
    }

    /// The warning that its value is not read.
    pub(super) fn ignored(&self, value: impl ToString) -> Warning {
        Warning::Field { line: self.place.line, name: self.name().to_owned(), value: value.to_string() }
    }

    /// Whether it has a value that is neither zero nor a limit that is never reached.
    fn says_something(&self) -> bool {
        !self.text.is_empty() && number(self.text).is_none_or(|value| value != 0.0 && value < NEVER)
    }
}

/// A material by the names of its fields.
pub(super) struct Fields<'e, 'a> {
    entry: &'e Entry<'a>,
    layout: Layout,
    /// Names that were asked for.
    read: RefCell<Vec<&'static str>>,
}

impl<'e, 'a> Fields<'e, 'a> {
    pub(super) fn of(entry: &'e Entry<'a>, layout: Layout) -> Fields<'e, 'a> {
        Fields { entry, layout, read: RefCell::default() }
    }

    /// The field of a name of the layout.
    pub(super) fn cell(&self, name: &'static str) -> Result<Cell<'a>, Mistake> {
        self.read.borrow_mut().push(name);
        let has = |names: &&str| columns(names, Format::Mixed).any(|column| column.name.eq_ignore_ascii_case(name));
        let place = self.layout.iter().position(has).expect("a name of the layout");
        Ok(self.entry.row(place)?.cell(self.layout[place], name))
    }

    pub(super) fn number(&self, name: &'static str) -> Result<f64, Mistake> {
        self.cell(name)?.number()
    }

    pub(super) fn positive(&self, name: &'static str) -> Result<f64, Mistake> {
        self.cell(name)?.positive()
    }

    /// All fields of a line of the layout.
    pub(super) fn cells(&self, place: usize) -> Result<Vec<Cell<'a>>, Mistake> {
        let cells: Vec<Cell<'a>> = self.entry.row(place)?.cells(self.layout[place]).collect();
        self.read.borrow_mut().extend(cells.iter().map(Cell::name));
        Ok(cells)
    }

    /// The row at `place` below those of the layout.
    pub(super) fn below(&self, place: usize) -> Result<Row<'a>, Mistake> {
        self.entry.row(self.layout.len() + place)
    }

    /// All rows below those of the layout.
    pub(super) fn rest(&self) -> impl Iterator<Item = &'e Row<'a>> {
        self.entry.rows.iter().skip(self.layout.len())
    }

    /// Warnings of values that were not asked for and might say something of a film.
    pub(super) fn unread(&self) -> Vec<Warning> {
        let rows = self.layout.iter().zip(&self.entry.rows);
        rows.flat_map(|(names, row)| self.of_row(names, row)).collect()
    }

    /// As [`Fields::unread`], of one row with the names of its fields.
    pub(super) fn of_row(&self, names: &'static str, row: &Row<'a>) -> Vec<Warning> {
        let read = self.read.borrow();
        let is_of_film = |name: &str| name != "-" && !name.starts_with(|c: char| c.is_ascii_lowercase());
        let cells = row.cells(names).filter(|cell| is_of_film(cell.name()) && !read.contains(&cell.name()));
        cells.filter(Cell::says_something).map(|cell| cell.ignored(cell.text)).collect()
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
        let found = keywords(text, System::KgMS).unwrap();
        assert_eq!((found[0].name(), found[0].title, found[0].line), ("MAT_ELASTIC", Some("my film"), 2));
        let fields = Fields::of(&found[0], &["mid RO E PR"]);
        let [density, young, poisson] = ["RO", "E", "PR"].map(|name| fields.number(name));
        assert_eq!((density, young, poisson), (Ok(9.15e-10), Ok(200.0), Ok(0.0)));
        assert_eq!(fields.cell("RO").unwrap().place, Place { line: 4, column: 14 });
        let free = Fields::of(&found[1], &["LCID sidr SFA", "X Y"]);
        assert_eq!(free.number("SFA"), Ok(2.0));
        assert!(free.number("X").is_err());
    }

    #[test]
    fn what_moves_columns_is_a_mistake_at_its_place() {
        let long = format!("*MAT_ELASTIC\n{:>81}\n", 1);
        for (text, line, column) in
            [("*MAT_ELASTIC\n         1\t1.0\n", 2, 11), (&long, 2, 81), ("*KEYWORD\n*INCLUDE_PATH\nother.k\n", 2, 1)]
        {
            let mistake = keywords(text, System::KgMS).err().unwrap();
            assert_eq!(mistake.place, Place { line, column }, "{text}");
        }
    }
}
