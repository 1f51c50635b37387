//! How a file is read.

use base::units::Unit;

/// Which channels of a file are read, and what the caller states about them.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// The channels to read; the others are not held in memory.
    pub channels: ChannelSelection,
    /// The column of a table that holds the time; where none is given, the one with such a name.
    pub time: Option<String>,
    /// Units by channel name where the file states none; a unit that contradicts the file is an error.
    pub units: Vec<(String, Unit)>,
    /// The unit of every channel except the time where the file states none; one that contradicts the file is an error.
    pub unit: Option<Unit>,
    /// Column names of a table, which replace those of its header, time included; with units as in a header,
    /// `accel [g]`.
    pub names: Vec<String>,
    /// Words in the cells of a table that mean that nothing was measured, in lower case; an empty cell always does.
    pub gaps: &'static [&'static str],
}

/// Which channels of a file are read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ChannelSelection {
    /// All of them.
    #[default]
    All,
    /// The channels with these names; a missing one is an error.
    Named(Vec<String>),
    /// The only one of the file; several are an error.
    Only,
}

impl ReadOptions {
    /// Whether the text of a cell means that nothing was measured.
    pub(super) fn is_gap(&self, text: &str) -> bool {
        text.is_empty() || self.gaps.iter().any(|gap| text.eq_ignore_ascii_case(gap))
    }

    /// The one channel called `name`, or the only one.
    pub fn one(name: Option<&str>) -> ReadOptions {
        let channels = name.map_or(ChannelSelection::Only, |name| ChannelSelection::Named(vec![name.into()]));
        ReadOptions { channels, ..ReadOptions::default() }
    }
}
