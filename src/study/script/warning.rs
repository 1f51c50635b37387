//! Warnings about the output of a script.

use std::fmt;
use std::path::PathBuf;

use serde_json::{Map, Value};

use base::codes;
use base::diagnostic::shown_path;
use base::finding::{Code, Report};
use lab::signal::VIRTUAL_RECORDING;

/// Most virtual recordings that the message names one by one.
const MOST_NAMED: usize = 6;

codes! {
    SEARCHES_NOT_SHOWN = "searches-not-shown", Note,
        "a script makes more searches, or more correlations of estimated parameters, than report and recording show",
        "none is needed for the results of the script; divide it where each of its searches should have plots";
}

/// What is reported of the output of a script, besides what the script reports itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Warning {
    /// Recordings that it read, or that its scenarios are compared with, are virtual.
    VirtualRecordings {
        /// Their paths, at least one.
        recordings: Vec<PathBuf>,
    },
    /// There are too many searches or correlations to store the plots of one more.
    SearchesNotShown {
        /// How many have plots.
        shown: usize,
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
        match self {
            Warning::VirtualRecordings { recordings } => {
                let named: Vec<String> = recordings.iter().take(MOST_NAMED).map(|path| shown_path(path)).collect();
                write!(f, "VIRTUAL recordings, nothing was measured: {}", named.join(", "))?;
                match recordings.len().saturating_sub(MOST_NAMED) {
                    0 => Ok(()),
                    more => write!(f, " and {more} more"),
                }
            }
            Warning::SearchesNotShown { shown } => {
                write!(f, "report and recording show the first {shown} searches of a script; later ones have no plots")
            }
        }
    }
}

impl Report for Warning {
    fn code(&self) -> &'static Code {
        match self {
            Warning::VirtualRecordings { .. } => &VIRTUAL_RECORDING,
            Warning::SearchesNotShown { .. } => &SEARCHES_NOT_SHOWN,
        }
    }

    fn figures(&self) -> Map<String, Value> {
        let (name, value) = match self {
            Warning::VirtualRecordings { recordings } => {
                let paths: Vec<String> = recordings.iter().map(|path| shown_path(path)).collect();
                ("recordings", paths.into())
            }
            Warning::SearchesNotShown { shown } => ("shown", (*shown).into()),
        };
        Map::from_iter([(name.into(), value)])
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
