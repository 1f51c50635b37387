//! The columns of a block: names with units, divided among specimens.

use super::words::{is_displacement, is_force, is_specimen};
use crate::signal::column_name::{ColumnName, UnitCell, units_of_line};

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
