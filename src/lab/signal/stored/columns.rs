//! Arrays as channels: a vector is one, a matrix one a column.

use super::{Entry, Fault};

/// Channels and the arrays that they are columns of.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    /// The channels.
    pub entries: Vec<Entry>,
    /// Array and column of each.
    pub places: Vec<(usize, usize)>,
}

/// Most columns of an array that become channels.
const MOST_COLUMNS: u64 = 10_000;

impl Columns {
    /// Adds an array of so many rows and columns, or the reason why its values cannot be read.
    pub fn push(
        &mut self,
        [group, name]: [&str; 2],
        unit: Option<&str>,
        array: usize,
        shape: Result<[u64; 2], String>,
    ) -> Result<(), Fault> {
        let (rows, columns, unread) = match shape {
            Ok([_, columns]) if columns > MOST_COLUMNS => (0, 1, Some(format!("it has {columns} columns"))),
            Ok([rows, columns]) => (rows, columns, None),
            Err(why) => (0, 1, Some(why)),
        };
        for column in 0..columns {
            let own = if columns > 1 { format!("{name}(:,{})", column + 1) } else { name.to_owned() };
            let mut entry = Entry::new(group, &own, unit)?;
            entry.samples = rows;
            entry.unread.clone_from(&unread);
            self.entries.push(entry);
            self.places.push((array, column as usize));
        }
        Ok(())
    }
}
