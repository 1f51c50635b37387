//! Findings on the terminal.

use std::fmt::Write;

use crate::finding::Finding;

/// One line a finding, with its severity, each after `indent` and ending with a line break.
pub(super) fn lines<'f>(indent: &str, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    findings.into_iter().fold(String::new(), |mut text, finding| {
        let _ = writeln!(text, "{indent}{}: {finding}", finding.severity);
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Warning;

    #[test]
    fn each_line_has_the_severity_of_its_finding() {
        let reports = [Warning::NoTimeColumn, Warning::NoPositiveLevel];
        let text = lines("  ", &reports.map(|report| Finding::new(&report)));
        assert!(text.starts_with("  note: there is no column of time\n  warning: no positive level"), "{text}");
    }
}
