//! What is wanted of a file.

use crate::units::Unit;

/// What is wanted of a file, and what the caller knows about it.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// Which channels; the others are not held in memory.
    pub channels: Selection,
    /// The column that holds the time of a table; the one that is called so where none is given.
    pub time: Option<String>,
    /// Units of channels whose file does not give one, by name; what contradicts the file is refused.
    pub units: Vec<(String, Unit)>,
    /// The unit of every channel but the time that the file gives none for; what contradicts the file is refused.
    pub unit: Option<Unit>,
    /// Names of a table's columns in place of its own, time included; written like a header, `accel [g]`.
    pub names: Vec<String>,
}

/// Which channels of a file are wanted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// All that there are.
    #[default]
    All,
    /// These; a missing one is an error.
    Named(Vec<String>),
    /// The one that there is; several are an error.
    Only,
}

impl Wanted {
    /// The one channel called `name`, or the only one.
    pub fn one(name: Option<&str>) -> Wanted {
        let channels = name.map_or(Selection::Only, |name| Selection::Named(vec![name.into()]));
        Wanted { channels, ..Wanted::default() }
    }
}
