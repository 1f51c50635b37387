//! The page of tests: what became of each case, and new signals over recorded ones where they differ.

use super::drawn;
use super::html;
use base::group;
use base::number::time_taken;
use lab::signal::{Series, column};
use plot::{Curve, Plot, TIME};
use scene::expectation::Verdict;

/// `report.html` of tests.
pub fn test_page(verdicts: &[Verdict]) -> String {
    let failed: Vec<&Verdict> = verdicts.iter().filter(|verdict| !verdict.has_passed()).collect();
    let title = match failed.len() {
        0 => format!("{} tests passed", verdicts.len()),
        count => format!("{count} of {} tests failed", verdicts.len()),
    };
    let parts = [
        failed.iter().map(|verdict| html::section(&verdict.name, &differences(verdict))).collect(),
        html::section("All tests", &all(verdicts)),
    ];
    html::finished(&title, "", &parts)
}

fn differences(verdict: &Verdict) -> String {
    let lines: Vec<String> = verdict.differences.iter().map(ToString::to_string).collect();
    [html::list(&lines), drawn::figures(&plots(verdict))].concat()
}

/// New over old of each signal that differs, with its corridor.
fn plots(verdict: &Verdict) -> Vec<Plot> {
    let names = group::unique(verdict.differences.iter().filter_map(|difference| difference.signal()));
    names.into_iter().filter_map(|name| plot(verdict, name)).collect()
}

fn plot(verdict: &Verdict, name: &str) -> Option<Plot> {
    let (axis, factor) = column::find(name).map_or((name, 1.0), |(_, column)| (column.axis, column.factor));
    let curve = |label: &str, recording: Option<&lab::signal::Recording>| {
        let series = recording?.series(name)?;
        Some(Curve::line(label, series.samples().map(|[time, value]| [1e3 * time, factor * value])))
    };
    let new = curve("new", verdict.signals.as_ref());
    let old = curve("recorded", verdict.recorded.signals.as_ref()).map(Curve::dashed);
    let bound = |(label, series): (&str, &Series)| {
        Curve::line(label, series.samples().map(|[time, value]| [1e3 * time, factor * value])).dashed()
    };
    let corridor = verdict.expectations.signal(name).and_then(|bounds| bounds.corridor.as_ref());
    let corridor = corridor.into_iter().flat_map(|corridor| ["lower", "upper"].into_iter().zip(corridor)).map(bound);
    let curves: Vec<Curve> = [new, old].into_iter().flatten().chain(corridor).collect();
    (!curves.is_empty()).then(|| Plot::new(name, [TIME, axis], curves))
}

fn all(verdicts: &[Verdict]) -> String {
    let row = |verdict: &Verdict| {
        let became = match (verdict.has_passed(), verdict.blessed) {
            (true, true) => "recorded anew",
            (true, false) => "passed",
            (false, _) => "failed",
        };
        vec![verdict.name.clone(), became.into(), time_taken(verdict.seconds)]
    };
    html::table_of_numbers(2, &["test", "verdict", "time"], &verdicts.iter().map(row).collect::<Vec<_>>())
}
