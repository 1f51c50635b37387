//! The layout of a table: separator, names, units and time, detected from the lines before its numbers and the first
//! row.

use std::collections::{HashSet, VecDeque};
use std::io::BufRead;

use super::cell::{Cell, Mark, Separator, at_cell};
use crate::error::{Error, Kind, refusal};
use crate::signal::column_name::{ColumnName, UnitCell, units_of_line};
use crate::signal::text::{Line, Lines};
use crate::signal::{Annotations, ReadOptions, Warning, measurement};
use base::diagnostic::listed;

/// Most lines before the first number.
const LONGEST_HEAD: usize = 200;

/// A table whose rows are still to be read.
pub struct Layout {
    pub separator: Separator,
    pub columns: Vec<ColumnName>,
    /// Where the names stand; none where the file has no header or the caller gave them.
    pub header: Option<Line<'static>>,
    /// Rows that were read to detect the layout.
    pub rows: VecDeque<Line<'static>>,
}

impl Layout {
    /// Reads `lines` up to the first row of numbers; with the comments before it.
    pub fn read(lines: &mut Lines<impl BufRead>, options: &ReadOptions) -> Result<(Layout, Annotations), Error> {
        let Head { mut lines, first, mut comments } = Head::read(lines)?;
        let separator = separator(&first.text, options);
        let mut rows = VecDeque::from([first]);
        let has_names = lines.len() > 1 || !options.names.is_empty();
        if let Some(row) = lines.pop_if(|line| has_names && is_row(line, separator)) {
            rows.push_front(row);
        }
        if !options.names.is_empty() {
            comments.extend(lines.iter().map(|line| quoted(line, "not used, since names are given")));
            let columns = options.names.iter().map(|name| ColumnName::read(name)).collect();
            let layout = Layout { separator, columns, header: None, rows }.checked()?;
            return Ok((layout, Annotations::new(comments)));
        }
        let units = take_units(&mut lines, separator);
        let header = lines.pop();
        comments.extend(lines.iter().map(|line| quoted(line, "before the header")));
        let mut annotations = Annotations::new(comments);
        let columns = match &header {
            Some(header) => trimmed(separator.cells(&header.text)).map(|cell| ColumnName::read(&cell.text)).collect(),
            None => numbered(separator, &rows[0], &mut annotations),
        };
        let mut layout = Layout { separator, columns, header, rows };
        if let Some((line, units)) = units {
            layout.add_units(&line, units)?;
        }
        Ok((layout.checked()?, annotations))
    }

    /// The place of the column that holds the time.
    pub fn time(&self, options: &ReadOptions) -> Result<usize, Error> {
        if let Some(name) = &options.time {
            let names = self.columns.iter().map(|column| (column.name.as_str(), column.label.as_str()));
            return measurement::find(name, names).map_err(|error| self.at_header(error));
        }
        if self.header.is_none() && options.names.is_empty() {
            return Ok(0);
        }
        let places: Vec<usize> = (0..self.columns.len()).filter(|place| self.columns[*place].is_time()).collect();
        let refused = |what: &str| {
            let error = refusal!("{what} of time among {}", self.names());
            self.at_header(error.with_hint("name the column of time: --time NAME"))
        };
        match places[..] {
            [place] => Ok(place),
            [] => Err(refused("no column").with_kind(Kind::NoTime)),
            _ => Err(refused("several columns")),
        }
    }

    /// The names as they are written.
    fn names(&self) -> String {
        listed(self.columns.iter().map(|column| &column.label))
    }

    /// A mistake in the header.
    pub fn at_header(&self, error: Error) -> Error {
        error.at(self.header.as_ref().map_or(0, |line| line.number), 1)
    }

    /// A mistake in the header of a column.
    pub fn at_column(&self, place: usize, error: Error) -> Error {
        match &self.header {
            Some(line) => at_cell(line, self.separator, place, error),
            None => error,
        }
    }

    /// Adds the units of a line below the names.
    fn add_units(&mut self, line: &Line, units: Vec<UnitCell>) -> Result<(), Error> {
        for (place, unit) in units.into_iter().enumerate() {
            let column = &mut self.columns[place];
            match (unit, &column.unit) {
                (UnitCell::Known(row), Some(header)) if *header != row => {
                    let error = refusal!(
                        "mixed units: the header states `{}` of `{}`, the line of units `{}`",
                        header.symbol(),
                        column.name,
                        row.symbol()
                    );
                    return Err(at_cell(line, self.separator, place, error));
                }
                (UnitCell::Known(row), None) => column.unit = Some(row),
                (UnitCell::Unknown(symbol), None) => column.unknown_unit = Some(symbol),
                _ => {}
            }
        }
        Ok(())
    }

    /// The layout, once its names are those of the first row's columns.
    fn checked(self) -> Result<Layout, Error> {
        let cells = trimmed_to(self.separator.cells(&self.rows[0].text), self.columns.len()).count();
        if cells != self.columns.len() {
            let place = self.header.as_ref().unwrap_or(&self.rows[0]);
            let (names, columns) = (counted(self.columns.len(), "name"), counted(cells, "column"));
            return Err(refusal!("{names} ({}) over {columns}", self.names())
                .with_hint("give the names of the columns: --columns time,a,b")
                .at(place.number, 1));
        }
        let mut labels = HashSet::new();
        for (place, column) in self.columns.iter().enumerate() {
            if column.label.is_empty() {
                return Err(self.at_column(place, refusal!("column {} has no name", place + 1)));
            }
            if !labels.insert(column.label.as_str()) {
                let error = refusal!("two columns are called `{}`", column.label)
                    .with_hint("rename one; several specimens side by side are read by `droptower reduce coupon`")
                    .with_kind(Kind::EqualNames);
                return Err(self.at_column(place, error));
            }
        }
        Ok(self)
    }
}

/// The lines before the first row.
struct Head {
    lines: Vec<Line<'static>>,
    first: Line<'static>,
    comments: Vec<String>,
}

impl Head {
    fn read(source: &mut Lines<impl BufRead>) -> Result<Head, Error> {
        let (mut lines, mut comments) = (Vec::new(), Vec::new());
        while let Some(line) = source.line()? {
            if let Some(comment) = line.text.trim_start().strip_prefix('#') {
                comments.push(comment.trim().to_owned());
            } else if starts_with_number(&line.text) {
                return Ok(Head { lines, first: line.into_owned(), comments });
            } else if !line.text.trim().is_empty() {
                lines.push(line.into_owned());
            }
            if lines.len() + comments.len() > LONGEST_HEAD {
                let error = refusal!("no samples: none of the first {LONGEST_HEAD} lines starts with a number");
                return Err(error.with_kind(Kind::NoRows).at(1, 1));
            }
        }
        let error = match lines.last() {
            Some(last) => refusal!("no samples: no line below the header starts with a number").at(last.number, 1),
            None => refusal!("no samples: the file is empty"),
        };
        Err(error.with_kind(Kind::NoRows))
    }
}

/// Whether the first cell that is not empty starts a row: whatever separates the cells, it is a number.
fn starts_with_number(line: &str) -> bool {
    let filler = |letter: char| letter.is_whitespace() || ";,\"".contains(letter);
    let first = line.trim_start_matches(filler).split(filler).next().unwrap_or_default();
    first.parse::<f64>().is_ok()
}

/// The separator with which all cells of a row are numbers, or else the first that stands in it.
fn separator(row: &str, options: &ReadOptions) -> Separator {
    let reads = |separator: &Separator| {
        let mut mark = Mark::between(*separator);
        let mut cells = trimmed(separator.cells(row));
        cells.all(|cell| measurement::is_gap(&cell.text, options.gaps) || mark.number(&cell.text, "").is_ok())
    };
    let splits = |separator: &Separator| trimmed(separator.cells(row)).nth(1).is_some();
    let mut candidates = Separator::ALL.into_iter().filter(splits);
    let whole = candidates.clone().find(reads);
    whole.or_else(|| candidates.next()).unwrap_or(Separator::Comma)
}

/// Whether the last line before the numbers is a row with a mistake in its first cell.
fn is_row(line: &Line, separator: Separator) -> bool {
    let mut mark = Mark::between(separator);
    let cells: Vec<Cell> = trimmed(separator.cells(&line.text)).collect();
    let numbers = cells.iter().filter(|cell| !cell.text.is_empty() && mark.number(&cell.text, "").is_ok()).count();
    numbers > 0 && 2 * numbers >= cells.len() && units_of_line(cells.iter().map(|cell| &cell.text)).is_none()
}

/// Takes the last line if it holds the units of the one above it.
fn take_units(lines: &mut Vec<Line<'static>>, separator: Separator) -> Option<(Line<'static>, Vec<UnitCell>)> {
    let [.., header, last] = &lines[..] else {
        return None;
    };
    let count = trimmed(separator.cells(&header.text)).count();
    let units = units_of_line(trimmed_to(separator.cells(&last.text), count).map(|cell| cell.text))?;
    if units.len() != count {
        return None;
    }
    lines.pop().map(|line| (line, units))
}

/// Names for the columns of a file that has none.
fn numbered(separator: Separator, row: &Line, annotations: &mut Annotations) -> Vec<ColumnName> {
    let columns = trimmed(separator.cells(&row.text)).count();
    let columns: Vec<String> = (1..=columns).map(|place| format!("column {place}")).collect();
    let name = |name: &String| ColumnName { label: name.clone(), name: name.clone(), unit: None, unknown_unit: None };
    let names = columns.iter().map(name).collect();
    annotations.warnings.push(Warning::NoHeader { columns });
    names
}

/// A line that is no header, as a comment.
fn quoted(line: &Line, what: &str) -> String {
    format!("line {} ({what}): {}", line.number, line.text.trim())
}

/// The cells without an empty one at the end: a separator that ends a line separates nothing.
fn trimmed<'a>(cells: impl Iterator<Item = Cell<'a>> + Clone) -> impl Iterator<Item = Cell<'a>> + Clone {
    let all = cells.clone().count();
    let ends_empty = cells.clone().last().is_some_and(|cell| cell.text.is_empty());
    cells.take(all - usize::from(ends_empty))
}

/// The cells without an empty one behind the expected `count`.
pub fn trimmed_to<'a>(
    cells: impl Iterator<Item = Cell<'a>> + Clone,
    count: usize,
) -> impl Iterator<Item = Cell<'a>> + Clone {
    let all = cells.clone().count();
    let surplus = all == count + 1 && cells.clone().last().is_some_and(|cell| cell.text.is_empty());
    cells.take(all - usize::from(surplus))
}

/// `1 name`, `2 names`.
fn counted(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}
