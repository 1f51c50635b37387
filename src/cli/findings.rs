//! Findings on the terminal.

use std::fmt::Write;

use base::finding::Finding;

/// One line a finding, with its severity and code, each after `indent` and ending with a line break.
pub(super) fn lines<'f>(indent: &str, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    findings.into_iter().fold(String::new(), |mut text, finding| {
        let _ = writeln!(text, "{indent}{finding}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::finding::Report;
    use lab::signal::Warning;

    #[test]
    fn each_line_has_severity_and_code_of_its_finding() {
        let reports = [Warning::NoTimeColumn, Warning::NoPositiveLevel];
        let text = lines("  ", &reports.clone().map(|report| Finding::new(&report)));
        let codes = reports.map(|report| report.code().name);
        let start =
            format!("  note[{}]: there is no column of time\n  warning[{}]: no positive level", codes[0], codes[1]);
        assert!(text.starts_with(&start), "{text}");
    }
}
