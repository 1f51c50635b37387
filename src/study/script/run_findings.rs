//! How often the runs of a study had findings.

use std::collections::{BTreeMap, BTreeSet};

/// Numbers of runs, and of those with a finding of each code.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunFindings {
    /// Number of runs with an outcome.
    pub runs: usize,
    /// Of these, how many had findings, by code.
    pub codes: BTreeMap<String, usize>,
}

impl RunFindings {
    /// Counts a run with findings of these codes.
    pub fn count<'c>(&mut self, codes: impl IntoIterator<Item = &'c str>) {
        self.runs += 1;
        for code in codes.into_iter().collect::<BTreeSet<&str>>() {
            *self.codes.entry(code.to_owned()).or_default() += 1;
        }
    }

    /// Counts the runs of another part of the study.
    pub fn add(&mut self, other: &RunFindings) {
        self.runs += other.runs;
        for (code, count) in &other.codes {
            *self.codes.entry(code.clone()).or_default() += count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_counts_once_for_a_code() {
        let mut found = RunFindings::default();
        found.count(["a", "b", "a"]);
        found.count([]);
        found.add(&found.clone());
        assert_eq!((found.runs, found.codes["a"], found.codes["b"]), (4, 2, 2));
    }
}
