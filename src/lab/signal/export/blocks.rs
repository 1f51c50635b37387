//! Blocks of numbers below each other, each with the header above it or with that of the block before; the columns of a
//! block are divided among specimens.

use super::head::{self, Head};
use super::words::{Key, is_displacement, is_force, is_specimen, key};
use super::{Export, MOST_BYTES, MOST_TEXTS, Specimen, Stated, TextRow, cells, numbers};
use crate::error::{Error, refusal};
use crate::signal::column_name::{ColumnName, UnitCell, units_of_line};
use crate::signal::csv::{Mark, Separator};
use crate::signal::measurement::MOST_VALUES;

/// Rows of numbers under one header.
struct Block {
    header: Header,
    /// Rows above it that are not its header.
    above: Vec<TextRow>,
    rows: Vec<Vec<f64>>,
}

/// Reads rows one after the other.
#[derive(Default)]
pub struct Reader {
    blocks: Vec<Block>,
    /// Rows of texts since the last row of numbers.
    pending: Vec<TextRow>,
    /// Whether a blank row came since.
    gap: bool,
    /// Decimal mark of the numbers.
    mark: Mark,
    /// Lines that start with `#`.
    comments: Vec<String>,
    /// Numbers of all blocks, empty cells at the ends of rows too.
    held: usize,
    /// Rows of texts, and their bytes.
    texts: usize,
    bytes: usize,
}

impl Reader {
    /// The specimens of the blocks; one that is not named in them is called after the `sheet`, or numbered.
    pub fn finish(self, sheet: Option<&str>) -> Result<Export, Error> {
        let Reader { blocks, pending, mark, comments, .. } = self;
        let mut found: Vec<Specimen> = Vec::new();
        let mut heads = Vec::new();
        let single = blocks.len() == 1;
        for block in blocks {
            let first = found.len();
            let named = block_name(&block.above);
            for group in &block.header.groups {
                let number = found.len() + 1;
                let alone = block.header.groups.len() == 1;
                let of_sheet = sheet.filter(|_| single && alone).map(str::to_owned);
                let name = group.name.clone().or_else(|| named.clone().filter(|_| alone)).or(of_sheet);
                found.push(specimen(&block, group, name.unwrap_or_else(|| format!("specimen {number}"))));
            }
            heads.push(Head { rows: block.above, specimens: first..found.len(), groups: block.header.groups });
        }
        if let Some(last) = heads.last_mut() {
            last.rows.extend(pending);
        }
        head::state(&heads, &mut found, mark)?;
        for specimen in &mut found {
            specimen.trim();
            specimen.comments.clone_from(&comments);
        }
        found.retain(|specimen| specimen.values.first().is_some_and(|values| !values.is_empty()));
        Ok(Export { specimens: found })
    }

    /// Adds a line of a text.
    pub fn push(&mut self, number: usize, line: &str, separator: Separator) -> Result<(), Error> {
        if self.push_comment(line) { Ok(()) } else { self.push_cells(number, cells(separator, line)) }
    }

    /// Adds a line that is a comment, and whether it is one.
    pub fn push_comment(&mut self, line: &str) -> bool {
        let comment = line.trim_start().strip_prefix('#');
        self.comments.extend(comment.map(|comment| comment.trim().to_owned()));
        comment.is_some()
    }

    /// Adds a row.
    pub fn push_cells(&mut self, number: usize, mut cells: Vec<String>) -> Result<(), Error> {
        cells.truncate(cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1));
        if cells.is_empty() {
            self.gap = true;
            return Ok(());
        }
        let mut mark = self.mark;
        if let Some(numbers) = numbers(&cells, &mut mark) {
            self.mark = mark;
            return self.push_numbers(number, numbers);
        }
        self.texts += 1;
        self.bytes += cells.iter().map(|cell| size_of::<String>() + cell.len()).sum::<usize>();
        if self.texts > MOST_TEXTS || self.bytes > MOST_BYTES {
            return Err(refusal!("more than {MOST_TEXTS} rows that are not of numbers").at(number, 1));
        }
        self.pending.push((number, cells));
        Ok(())
    }

    fn push_numbers(&mut self, number: usize, numbers: Vec<f64>) -> Result<(), Error> {
        let last = self.pending.len().saturating_sub(HEADER_ROWS);
        let texts: Vec<&[String]> = self.pending[last..].iter().map(|(_, cells)| cells.as_slice()).collect();
        if let Some((header, taken)) = Header::read(&texts) {
            let above = self.pending.len() - taken;
            let above = self.pending.drain(..).take(above).collect();
            self.blocks.push(Block { header, above, rows: Vec::new() });
        } else if let Some(last) = self.blocks.last() {
            if self.starts_again(last, &numbers) {
                let header = unnamed(&last.header);
                let above = std::mem::take(&mut self.pending);
                self.blocks.push(Block { header, above, rows: Vec::new() });
            } else if let Some((row, cells)) = self.pending.first() {
                let wrong = cells.iter().find(|cell| cell.parse::<f64>().is_err() && !cell.is_empty());
                let found: String = wrong.map(|cell| cell.chars().take(40).collect()).unwrap_or_default();
                return Err(refusal!("expected a number, found `{found}`")
                    .with_hint("put a blank line and a name before the next specimen")
                    .at(*row, 1));
            }
        }
        self.gap = false;
        let expected = self.blocks.last().map(|block| block.header.columns.len());
        let found = numbers.len();
        if let Some(expected) = expected.filter(|expected| found > *expected) {
            return Err(refusal!("expected at most {expected} cells, found {found}").at(number, 1));
        }
        self.held += expected.unwrap_or(found);
        if self.held > MOST_VALUES {
            return Err(refusal!("more than {MOST_VALUES} cells").at(number, 1));
        }
        match self.blocks.last_mut() {
            Some(block) => block.rows.push(numbers),
            // Numbers in a head, such as those of a table of specimens.
            None if self.held <= MOST_IN_HEAD => {
                let texts = numbers.iter().map(|value| if value.is_nan() { String::new() } else { value.to_string() });
                self.pending.push((number, texts.collect()));
            }
            None => {}
        }
        Ok(())
    }

    /// Whether these numbers are those of another specimen under the header of the `last`: a name stands between, or a blank
    /// row and the displacement goes back to the beginning.
    fn starts_again(&self, last: &Block, numbers: &[f64]) -> bool {
        let name =
            |cell: &String| is_specimen(cell) || key(cell.split([':', '=']).next().unwrap_or_default()).is_some();
        if self.pending.iter().any(|(_, cells)| cells.iter().any(name)) {
            return true;
        }
        let travel = last.header.columns.iter().position(|column| is_displacement(&column.name));
        let value = |row: &[f64]| travel.and_then(|travel| row.get(travel).copied()).unwrap_or(f64::NAN);
        let [first, before] = [last.rows.first(), last.rows.last()].map(|row| row.map_or(f64::NAN, |row| value(row)));
        let now = value(numbers);
        self.pending.is_empty() && self.gap && (now - first).abs() < 0.5 * (before - first).abs()
    }
}

/// A header whose names of specimens were those of the block before.
fn unnamed(header: &Header) -> Header {
    let groups = header.groups.iter().map(|group| Group { name: None, ..group.clone() });
    Header { groups: groups.collect(), ..header.clone() }
}

/// The name of the specimen that the rows above a block state.
fn block_name(above: &[TextRow]) -> Option<String> {
    above.iter().rev().find_map(|(_, cells)| {
        let filled: Vec<&String> = cells.iter().filter(|cell| !cell.is_empty()).collect();
        match filled[..] {
            [one] => match one.split_once([':', '=']) {
                Some((word, name)) if key(word) == Some(Key::Name) => Some(name.trim().to_owned()),
                _ => is_specimen(one).then(|| one.trim_end_matches(':').to_owned()),
            },
            [word, name] if key(word) == Some(Key::Name) && !is_header(cells) => {
                let counts = name.bytes().all(|byte| byte.is_ascii_digit());
                Some(if counts { format!("{} {name}", word.trim_end_matches([':', ' '])) } else { name.clone() })
            }
            _ => None,
        }
    })
}

fn specimen(block: &Block, group: &Group, name: String) -> Specimen {
    let [start, end] = group.range;
    let value = |row: &Vec<f64>, place: usize| row.get(place).copied().unwrap_or(f64::NAN);
    Specimen {
        name,
        columns: block.header.columns[start..end].to_vec(),
        values: (start..end).map(|place| block.rows.iter().map(|row| value(row, place)).collect()).collect(),
        stated: Stated::default(),
        comments: vec![],
    }
}

/// Rows of a header: specimens, names and units.
const HEADER_ROWS: usize = 3;
/// Most numbers of a head.
const MOST_IN_HEAD: usize = 100_000;
/// Most columns among which specimens are looked for.
const MOST_COLUMNS: usize = 10_000;

/// The header of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    pub columns: Vec<ColumnName>,
    /// The specimens side by side.
    pub groups: Vec<Group>,
}

/// The columns of one specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// As the line above the names states it.
    pub name: Option<String>,
    /// Its first column, and the one behind its last.
    pub range: [usize; 2],
}

impl Header {
    /// Of the rows of texts above one of numbers, and how many of the last of them it takes; none where none of them holds
    /// names of force and displacement.
    pub fn read(texts: &[&[String]]) -> Option<(Header, usize)> {
        let units = texts.last().and_then(|cells| units(cells));
        let below = usize::from(units.is_some());
        let names = *texts.iter().rev().nth(below)?;
        if !is_header(names) {
            return None;
        }
        let mut columns: Vec<ColumnName> = names.iter().map(|name| ColumnName::read(name)).collect();
        for (column, unit) in columns.iter_mut().zip(units.into_iter().flatten()) {
            match unit {
                UnitCell::Known(unit) => column.unit = Some(unit),
                UnitCell::Unknown(symbol) if column.unit.is_none() => column.unknown_unit = Some(symbol),
                _ => {}
            }
        }
        let above = texts.iter().rev().nth(below + 1).and_then(|cells| groups(cells, columns.len()));
        let taken = 1 + below + usize::from(above.is_some());
        let groups = above.unwrap_or_else(|| repeated(&columns));
        Some((Header { columns, groups }, taken))
    }
}

/// Whether the cells name at least a force and a displacement.
pub fn is_header(cells: &[String]) -> bool {
    let any = |is: fn(&str) -> bool| cells.iter().any(|cell| is(&ColumnName::read(cell).name));
    any(is_force) && any(is_displacement)
}

/// The cells as units, also `Sec` and the like.
pub fn units(cells: &[String]) -> Option<Vec<UnitCell>> {
    let lowered = |cell: &String| match cell.as_str() {
        "Sec" | "SEC" | "sec." | "秒" => "s".to_owned(),
        other => other.to_owned(),
    };
    let cells: Vec<String> = cells.iter().map(lowered).collect();
    units_of_line(cells.iter().map(String::as_str))
}

/// The specimens that a line above the names states, where it states no more than a name for several columns each.
fn groups(cells: &[String], width: usize) -> Option<Vec<Group>> {
    let mut groups: Vec<Group> = Vec::new();
    for (place, cell) in cells.iter().enumerate().filter(|(_, cell)| !cell.is_empty()) {
        match groups.last() {
            // The name above each of its columns.
            Some(last) if last.name.as_ref() == Some(cell) => {}
            _ => groups.push(Group { name: Some(cell.clone()), range: [place, width] }),
        }
    }
    let starts: Vec<usize> = groups.iter().map(|group| group.range[0]).collect();
    for (group, end) in groups.iter_mut().zip(starts.iter().skip(1)) {
        group.range[1] = *end;
    }
    let wide = groups.iter().all(|group| group.range[1] >= group.range[0] + 2);
    let named = groups.len() > 1 || groups.iter().all(|group| group.name.as_deref().is_some_and(is_specimen));
    (!groups.is_empty() && wide && named && cells.len() <= width).then_some(groups)
}

/// The specimens of names that repeat, or the one of names that do not.
fn repeated(columns: &[ColumnName]) -> Vec<Group> {
    let count = columns.len();
    let repeats = |period: &usize| {
        count.is_multiple_of(*period)
            && (*period..count).all(|place| columns[place].name == columns[place - *period].name)
    };
    // Of more columns than machines write, finding a period takes long.
    let longest = if count <= MOST_COLUMNS { count / 2 } else { 0 };
    let period = (2..=longest).find(repeats).unwrap_or(count);
    (0..count / period.max(1))
        .map(|group| Group { name: None, range: [group * period, (group + 1) * period] })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of other names; to look at all rows for each row would take minutes.
    #[test]
    fn numbers_without_a_header_are_read_once() {
        let mut reader = Reader::default();
        for number in 0..200_000 {
            reader.push_cells(number, vec!["1".into(), "2".into()]).unwrap();
        }
        assert!(reader.pending.len() <= MOST_IN_HEAD);
        reader.push_cells(200_000, vec!["Force [N]".into(), "Displacement [mm]".into()]).unwrap();
        reader.push_cells(200_001, vec!["1".into(), "2".into()]).unwrap();
        assert_eq!(reader.finish(None).unwrap().specimens.len(), 1);
    }
}
