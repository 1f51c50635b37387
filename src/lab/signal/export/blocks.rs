//! Blocks of numbers below each other, each with the header above it or with that of the block before.

use super::columns::{Group, Header, is_header};
use super::fault::{Fault, Mistake};
use super::head::{self, Head};
use super::rows::{Content, Row, Rows, TextRow};
use super::stated::{Specimen, Stated};
use super::words::{Key, is_displacement, is_specimen, key};
use crate::signal::channel_fault::MOST_VALUES;

/// Rows of numbers under one header.
struct Block {
    header: Header,
    row: usize,
    /// Rows above it that are not its header.
    above: Vec<TextRow>,
    rows: Vec<(usize, Vec<f64>)>,
}

/// The specimens in rows.
pub fn specimens(rows: &Rows, sheet: Option<&str>) -> Result<Vec<Specimen>, Mistake> {
    let mut reader = Reader::default();
    for row in &rows.rows {
        reader.push(row)?;
    }
    let Reader { blocks, pending, .. } = reader;
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
            found.push(specimen(&block, group, name.unwrap_or_else(|| format!("specimen {number}")), sheet));
        }
        heads.push(Head { rows: block.above, specimens: first..found.len(), groups: block.header.groups.clone() });
    }
    if let Some(last) = heads.last_mut() {
        last.rows.extend(pending);
    }
    head::state(&heads, &mut found, rows.mark)?;
    found.iter_mut().for_each(Specimen::trim);
    found.retain(|specimen| specimen.values.first().is_some_and(|values| !values.is_empty()));
    Ok(found)
}

#[derive(Default)]
struct Reader {
    blocks: Vec<Block>,
    /// Rows of texts since the last row of numbers.
    pending: Vec<TextRow>,
    /// Whether a blank row came since.
    gap: bool,
    /// Cells of all blocks, empty ones at the ends of rows too.
    held: usize,
}

impl Reader {
    fn push(&mut self, row: &Row) -> Result<(), Mistake> {
        match &row.content {
            Content::Blank => self.gap = true,
            Content::Texts(cells) => self.pending.push((row.number, cells.clone())),
            Content::Numbers(numbers) => self.push_numbers(row.number, numbers)?,
        }
        Ok(())
    }

    fn push_numbers(&mut self, number: usize, numbers: &[f64]) -> Result<(), Mistake> {
        let texts: Vec<&[String]> = self.pending.iter().map(|(_, cells)| cells.as_slice()).collect();
        if let Some((header, taken)) = Header::read(&texts) {
            let above = self.pending.len() - taken;
            let row = self.pending[above].0;
            let above = self.pending.drain(..).take(above).collect();
            self.blocks.push(Block { header, row, above, rows: Vec::new() });
        } else if let Some(last) = self.blocks.last() {
            if self.starts_again(last, numbers) {
                let (header, row) = (unnamed(&last.header), last.row);
                let above = std::mem::take(&mut self.pending);
                self.blocks.push(Block { header, row, above, rows: Vec::new() });
            } else if let Some((row, cells)) = self.pending.first() {
                let place = cells.iter().position(|cell| cell.parse::<f64>().is_err() && !cell.is_empty());
                let found = place.map(|place| cells[place].chars().take(40).collect()).unwrap_or_default();
                let column = place.map(|place| place + 1);
                return Err(Mistake { row: *row, column, fault: Fault::NotANumber { found } });
            }
        }
        self.gap = false;
        let Some(block) = self.blocks.last_mut() else {
            // Numbers in a head, such as those of a table of specimens.
            let texts = numbers.iter().map(|value| if value.is_nan() { String::new() } else { value.to_string() });
            self.pending.push((number, texts.collect()));
            return Ok(());
        };
        let (expected, found) = (block.header.columns.len(), numbers.len());
        if found > expected {
            let fault = Fault::RowLength { expected, found };
            return Err(Mistake { row: number, column: Some(expected + 1), fault });
        }
        self.held += expected;
        if self.held > MOST_VALUES {
            return Err(Mistake { row: number, column: None, fault: Fault::TooLarge });
        }
        block.rows.push((number, numbers.to_vec()));
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
        let [first, before] =
            [last.rows.first(), last.rows.last()].map(|row| row.map_or(f64::NAN, |row| value(&row.1)));
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

fn specimen(block: &Block, group: &Group, name: String, sheet: Option<&str>) -> Specimen {
    let [start, end] = group.range;
    let value = |row: &(usize, Vec<f64>), place: usize| row.1.get(place).copied().unwrap_or(f64::NAN);
    Specimen {
        name,
        place: (sheet.map(str::to_owned), block.row),
        columns: block.header.columns[start..end].to_vec(),
        values: (start..end).map(|place| block.rows.iter().map(|row| value(row, place)).collect()).collect(),
        stated: Stated::default(),
    }
}
