//! Warnings about the output of a script.

use std::fmt;
use std::path::PathBuf;

use serde_json::{Map, Value};

use crate::diagnostic::shown_path;
use crate::finding::{Code, Report, codes};

/// Most virtual recordings that the message names one by one.
const MOST_NAMED: usize = 6;

codes! {
    VIRTUAL_RECORDINGS = "virtual-recordings", Warning,
        "recordings that a script read, or that its scenarios are compared with, were computed, not measured",
        "agreement with them is not a validation";
}

/// What puts the output of a script in doubt, besides what the script reports itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Warning {
    /// Recordings behind it are virtual.
    VirtualRecordings {
        /// Their paths, at least one.
        recordings: Vec<PathBuf>,
    },
}

impl Warning {
    /// The warning of these virtual recordings; none where there are none.
    pub fn virtual_recordings(recordings: Vec<PathBuf>) -> Option<Warning> {
        (!recordings.is_empty()).then_some(Warning::VirtualRecordings { recordings })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Warning::VirtualRecordings { recordings } = self;
        let named: Vec<String> = recordings.iter().take(MOST_NAMED).map(|path| shown_path(path)).collect();
        write!(f, "VIRTUAL recordings, nothing was measured: {}", named.join(", "))?;
        match recordings.len().saturating_sub(MOST_NAMED) {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::VirtualRecordings { .. } => &VIRTUAL_RECORDINGS,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let Warning::VirtualRecordings { recordings } = self;
        let paths: Vec<String> = recordings.iter().map(|path| shown_path(path)).collect();
        Map::from_iter([("recordings".into(), paths.into())])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_recordings_are_counted() {
        let paths: Vec<PathBuf> = (0..8).map(|i| PathBuf::from(format!("{i}.csv"))).collect();
        let warning = Warning::virtual_recordings(paths).unwrap();
        assert!(warning.to_string().ends_with(": 0.csv, 1.csv, 2.csv, 3.csv, 4.csv, 5.csv and 2 more"), "{warning}");
        assert_eq!(warning.figures()["recordings"].as_array().map(Vec::len), Some(8));
        assert_eq!(Warning::virtual_recordings(vec![]), None);
    }
}
