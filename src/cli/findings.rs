//! Findings on the terminal.

use std::fmt::Write;

use base::finding::{Finding, Severity};
use study::codes;
use study::script::{RunFindings, Warning};

/// The finding of a study whose runs have warnings; that recordings are virtual is a finding of its own.
pub(super) fn of_runs(found: &RunFindings) -> Option<Finding> {
    let is_warning = |code: &str| {
        let severity = codes::find(code).map_or(Severity::Warning, |code| code.severity);
        severity == Severity::Warning && !code.starts_with("virtual-")
    };
    Warning::of_runs(found, is_warning).map(|warning| Finding::new(&warning))
}

/// One line a finding, with its severity and code, each after `indent` and ending with a line break.
pub(super) fn lines<'f>(indent: &str, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    findings.into_iter().fold(String::new(), |mut text, finding| {
        let _ = writeln!(text, "{indent}{finding}");
        text
    })
}

/// The findings of a run: a line each, and one line of those that its film's data leave open in every test.
pub(super) fn lines_of_run<'f>(indent: &str, findings: impl IntoIterator<Item = &'f Finding>) -> String {
    let (open, own): (Vec<&Finding>, Vec<&Finding>) =
        findings.into_iter().partition(|finding| codes::left_open(&finding.code).is_some());
    let mut text = lines(indent, own);
    let words: Vec<&str> = open.iter().filter_map(|finding| codes::left_open(&finding.code)).collect();
    let names: Vec<&str> = open.iter().map(|finding| finding.code.as_str()).collect();
    if !open.is_empty() {
        let _ = writeln!(text, "{indent}what this film's data leave open [{}]: {}", names.join(", "), words.join(", "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::Warning;

    #[test]
    fn what_a_films_data_leave_open_is_one_line() {
        let names = ["uncoupled-biaxial", "strain-rate-outside", "break-strain-of-coupons"];
        assert!(names.iter().all(|name| codes::find(name).is_some() && codes::left_open(name).is_some()));
        let open = names.map(|name| Finding::of_script(name, "65 % of the film"));
        let text = lines_of_run("  ", open.iter().chain([&Finding::new(&Warning::NoTimeColumn)]));
        let line = "  what this film's data leave open [uncoupled-biaxial, strain-rate-outside, break-strain-of-coupons]: coupling of MD and \
                    TD, strain rates, break strain\n";
        assert!(text.lines().count() == 2 && text.ends_with(line), "{text}");
    }
}
