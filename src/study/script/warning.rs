//! Warnings about the output of a script.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::RunFindings;
use base::diagnostic::shown_path;
use base::findings;
use lab::signal::VIRTUAL_RECORDING;

/// Most virtual recordings that the message names one by one.
const MOST_NAMED: usize = 6;

findings! {
    /// A warning about the output of a script, besides those that the script reports itself.
    #[derive(Clone, Debug, PartialEq, Eq)]
    pub enum Warning {
        /// Recordings that it read, or that its scenarios are compared with, are virtual.
        VirtualRecordings {
            recordings: Vec<PathBuf>, "their paths, at least one" => "recordings" = shown(recordings);
        } = code &VIRTUAL_RECORDING;
            message "VIRTUAL recordings, nothing was measured: {}{}",
                shown(recordings.iter().take(MOST_NAMED)).join(", "),
                match recordings.len().saturating_sub(MOST_NAMED) {
                    0 => String::new(),
                    more => format!(" and {more} more"),
                };
        /// Runs of the study have warnings.
        RunWarnings {
            runs: usize, "number of runs" => "runs";
            codes: Vec<(String, usize)>, "codes of their warnings, each with the number of runs that have it"
                => "codes" = codes.iter().cloned().collect::<BTreeMap<String, usize>>();
        } = "warnings-of-runs", Warning;
            meaning "runs of a study have warnings of their own, which put its figures in doubt as they do those of a single run";
            remedy "`droptower explain` with each code says what it means and what to do; run one of the scenarios alone to see its \
                warning";
            message "{}: {}",
                match runs {
                    1 => "the run has warnings".to_owned(),
                    _ if codes.iter().any(|(_, count)| count == runs) => format!("all {runs} runs have warnings"),
                    _ => format!("of {runs} runs some have warnings"),
                },
                codes.iter().map(|(code, count)| format!("{code} ({count})")).collect::<Vec<_>>().join(", ");
        EndedEarly { cause: String, "the mistake" => "cause" } = "ended-early", Warning;
            meaning "a script or a study ended with a mistake after it had results: its tables and its page have what was found until then";
            remedy "mend the mistake and start it again: its runs are kept";
            message "ended before its end: {cause}";
        SearchesNotShown { shown: usize, "how many have plots" => "shown" } = "searches-not-shown", Note;
            meaning "a script makes more searches, or more correlations of estimated parameters, than report and \
                recording show";
            remedy "none is needed for the results of the script; divide it where each of its searches should have \
                plots";
            message "the report shows the first {shown} searches of a script; later ones have no plots";
    }
}

fn shown<'p>(paths: impl IntoIterator<Item = &'p PathBuf>) -> Vec<String> {
    paths.into_iter().map(|path| shown_path(path)).collect()
}

impl Warning {
    /// The warning of runs of which some have findings whose codes are warnings; none where no run has.
    pub fn of_runs(found: &RunFindings, is_warning: impl Fn(&str) -> bool) -> Option<Warning> {
        let codes = found.codes.iter().filter(|(code, _)| is_warning(code));
        let codes: Vec<(String, usize)> = codes.map(|(code, count)| (code.clone(), *count)).collect();
        (!codes.is_empty()).then_some(Warning::RunWarnings { runs: found.runs, codes })
    }

    /// The warning of these virtual recordings; none where there are none.
    pub fn virtual_recordings(recordings: Vec<PathBuf>) -> Option<Warning> {
        (!recordings.is_empty()).then_some(Warning::VirtualRecordings { recordings })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::finding::Report;

    #[test]
    fn all_runs_are_not_some() {
        let of = |count| Warning::RunWarnings { runs: 88, codes: vec![("coarse-contact".into(), count)] }.to_string();
        assert_eq!(of(88), "all 88 runs have warnings: coarse-contact (88)");
        assert_eq!(of(8), "of 88 runs some have warnings: coarse-contact (8)");
    }

    #[test]
    fn many_recordings_are_counted() {
        let paths: Vec<PathBuf> = (0..8).map(|i| PathBuf::from(format!("{i}.csv"))).collect();
        let warning = Warning::virtual_recordings(paths).unwrap();
        assert!(warning.to_string().ends_with(": 0.csv, 1.csv, 2.csv, 3.csv, 4.csv, 5.csv and 2 more"), "{warning}");
        assert_eq!(warning.figures()["recordings"].as_array().map(Vec::len), Some(8));
        assert_eq!(Warning::virtual_recordings(vec![]), None);
    }
}
