//! Comparison of runs: their figures, the keys of their scenarios and their signals, each with those of the first run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use serde_json::{Value, json};

use super::figures::{is_key_figure, is_result};
use super::warning::VIRTUAL_REFERENCE;
use super::{COST, HEADER, VERDICT, Verdict, Warning};
use crate::script::{Row, object};
use crate::store::StoredRun;
use base::finding::Finding;
use base::group;
use base::number::duration;
use lab::signal::norm::relative_error;
use lab::signal::{Annotations, Series, column};
use scene::scenario;

/// Whether and when film ruptured, which is one row of a comparison.
const FILM: [&str; 3] = ["ruptured", "rupture_time_s", VERDICT];

/// Several runs, compared with the first of them.
#[derive(Clone, Debug)]
pub struct RunComparison {
    /// The runs; the lists that follow have one entry per run.
    pub runs: Vec<ComparedRun>,
    /// Figures that a run has, in the order of the summaries.
    pub figures: Vec<ComparedFigure>,
    /// Keys in which the scenarios differ.
    pub keys: Vec<ComparedKey>,
    /// Signals that several runs have, in the order of the first that has them.
    pub signals: Vec<ComparedSignal>,
    /// Failed runs, virtual recordings, signals of one run only.
    pub findings: Vec<Finding>,
}

/// One of the runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComparedRun {
    /// The shortest end of its path that no other run has.
    pub name: String,
    /// Its folder or file.
    pub place: PathBuf,
    /// Its title, where it has one.
    pub title: Option<String>,
}

/// One figure of all runs.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedFigure {
    /// As `summary.json` calls it.
    pub name: String,
    /// Number, string or Boolean; none where a run has none.
    pub values: Vec<Option<Value>>,
}

/// One key of all scenarios.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComparedKey {
    /// `layers.count`.
    pub path: String,
    /// As TOML; none where a scenario lacks it.
    pub values: Vec<Option<String>>,
}

/// One channel of all runs.
#[derive(Clone, Debug)]
pub struct ComparedSignal {
    /// As `signals.csv` calls it.
    pub column: String,
    /// None where a run has no such channel.
    pub series: Vec<Option<Series>>,
    /// ‖s − s₁‖/‖s₁‖ against the first run over their common time (paper, equations 14 and 15); none of the first run
    /// itself, and where there is nothing to compare.
    pub errors: Vec<Option<f64>>,
}

impl RunComparison {
    /// Compares `runs`; of the signals only those that `wanted` names, or all where it is empty.
    pub fn from_runs(runs: &[StoredRun], wanted: &[String]) -> RunComparison {
        let names = names(&runs.iter().map(|run| run.place.as_path()).collect::<Vec<_>>());
        let title = |run: &StoredRun| run.summary.get("title").and_then(Value::as_str).map(str::to_owned);
        let subject = |(run, name): (&StoredRun, &String)| ComparedRun {
            name: name.clone(),
            place: run.place.clone(),
            title: title(run),
        };
        let (signals, alone) = signals(runs, &names, wanted);
        RunComparison {
            runs: runs.iter().zip(&names).map(subject).collect(),
            figures: figures(runs),
            keys: keys(runs),
            findings: warnings(runs, &names)
                .chain(alone)
                .map(|w| Finding::new(&w))
                .chain(own_warnings(runs, &names))
                .collect(),
            signals,
        }
    }

    /// The names of the runs.
    pub fn title(&self) -> String {
        self.runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>().join(" | ")
    }

    /// The figures that differ, and the key figures, but for those of [`RunComparison::film`].
    pub fn key_figures(&self) -> impl Iterator<Item = &ComparedFigure> {
        self.figures.iter().filter(|figure| figure.is_key() && !FILM.contains(&figure.name.as_str()))
    }

    /// Of each run its verdict on the film, or when it ruptured; none where no run says so.
    pub fn film(&self) -> Option<Vec<String>> {
        let [ruptured, times, verdicts] = FILM.map(|name| self.figures.iter().find(|figure| figure.name == name));
        let time = |run: usize| times?.values[run].as_ref()?.as_f64();
        let verdict = |run: usize| verdicts?.values[run].as_ref()?.as_str();
        let of_run =
            |(run, ruptured): (usize, &Option<Value>)| match (ruptured.as_ref().and_then(Value::as_bool), time(run)) {
                (Some(true), Some(time)) => format!("ruptured at {}", duration(time)),
                (Some(true), None) => "ruptured".into(),
                (Some(false), _) => verdict(run).unwrap_or("held").into(),
                (None, _) => "-".into(),
            };
        Some(ruptured?.values.iter().enumerate().map(of_run).collect())
    }

    /// The figures by which runs are judged that a run and the first one have; a lowest point that is none counts in neither.
    pub fn judged(&self, run: usize) -> impl Iterator<Item = &ComparedFigure> {
        let is_judged = move |figure: &&ComparedFigure| {
            is_result(&figure.name) && ![0, run].iter().any(|run| figure.is_of_a_fall(*run, &self.figures))
        };
        self.figures.iter().filter(is_judged)
    }

    /// All other figures.
    pub fn other_figures(&self) -> impl Iterator<Item = &ComparedFigure> {
        self.figures.iter().filter(|figure| !figure.is_key())
    }

    /// The content of `summary.json` of the comparison.
    pub fn summary(&self) -> Row {
        let run = |run: &ComparedRun| json!({ "name": run.name, "path": run.place.display().to_string(), "title": run.title });
        let figure = |figure: &ComparedFigure| {
            let differences: Vec<_> = (0..self.runs.len()).map(|run| figure.difference(run)).collect();
            (figure.name.clone(), json!({ "values": figure.values, "differences": differences }))
        };
        let keys = self.keys.iter().map(|key| (key.path.clone(), json!(key.values)));
        let errors = self.signals.iter().map(|signal| (signal.column.clone(), json!(signal.errors)));
        object(json!({
            "droptower": env!("CARGO_PKG_VERSION"),
            "runs": self.runs.iter().map(run).collect::<Vec<_>>(),
            "keys": keys.collect::<Row>(),
            "figures": self.figures.iter().map(figure).collect::<Row>(),
            "errors": errors.collect::<Row>(),
            "notes": self.findings.iter().map(|finding| finding.message.as_str()).collect::<Vec<_>>(),
            "findings": self.findings,
        }))
    }
}

impl ComparedFigure {
    /// Relative difference of a run's number from that of the first run, `value / first - 1`. None for the first run,
    /// for what is not a number, and where the first number is zero.
    pub fn difference(&self, run: usize) -> Option<f64> {
        let number = |run: usize| self.values.get(run)?.as_ref()?.as_f64();
        let first = number(0).filter(|first| *first != 0.0)?;
        (run > 0).then(|| number(run).map(|value| value / first - 1.0))?
    }

    /// Whether it is the lowest point of an impactor that fell through film, or of one that still descended, in a run of `all` figures.
    fn is_of_a_fall(&self, run: usize, all: &[ComparedFigure]) -> bool {
        let Some(prefix) = self.name.strip_suffix("peak_displacement_m") else { return false };
        let of = |name: &str| all.iter().find(|figure| figure.name == name)?.values[run].as_ref();
        let goes_on = of("ruptured") == Some(&Value::Bool(true))
            || of(VERDICT).and_then(Value::as_str) == Some(Verdict::Descending.name());
        goes_on && of(&format!("{prefix}rebound_velocity_m_s")).is_none()
    }

    fn is_key(&self) -> bool {
        let differs = self.values.iter().any(|value| *value != self.values[0]);
        is_key_figure(&self.name) || differs && !COST.contains(&self.name.as_str())
    }
}

/// The shortest ends of the paths that differ.
fn names(places: &[&Path]) -> Vec<String> {
    let parts = |place: &Path| -> Vec<String> {
        let whole = place.canonicalize().unwrap_or_else(|_| place.into());
        let plain = whole.components().filter(|part| matches!(part, Component::Normal(_)));
        plain.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let parts: Vec<Vec<String>> = places.iter().map(|place| parts(place)).collect();
    let end = |run: &Vec<String>, length: usize| run[run.len().saturating_sub(length)..].join("/");
    let name = |run: &Vec<String>| {
        let is_one = |length: &usize| parts.iter().filter(|other| end(other, *length) == end(run, *length)).count() < 2;
        let length = (1..run.len()).find(is_one).unwrap_or(run.len());
        end(run, length)
    };
    parts.iter().map(name).collect()
}

fn figures(runs: &[StoredRun]) -> Vec<ComparedFigure> {
    let is_figure = |name: &String, value: &Value| {
        !HEADER.contains(&name.as_str()) && (value.is_number() || value.is_string() || value.is_boolean())
    };
    let mut all: Vec<ComparedFigure> = vec![];
    for (name, _) in runs.iter().flat_map(|run| &run.summary).filter(|(name, value)| is_figure(name, value)) {
        if all.iter().all(|known| known.name != *name) {
            let value = |run: &StoredRun| run.summary.get(name).filter(|value| is_figure(name, value)).cloned();
            all.push(ComparedFigure { name: name.clone(), values: runs.iter().map(value).collect() });
        }
    }
    all
}

fn keys(runs: &[StoredRun]) -> Vec<ComparedKey> {
    let scenarios: Vec<_> = runs.iter().map(|run| scenario::leaves(&run.scenario)).collect();
    // A recording has no scenario, so it does not count as different.
    let given: Vec<_> = scenarios.iter().filter(|scenario| !scenario.is_empty()).collect();
    let paths: BTreeSet<&String> = scenarios.iter().flat_map(|scenario| scenario.keys()).collect();
    let is_other = |path: &String, scenario: &BTreeMap<String, String>| {
        !scenario::is_same_value(scenario.get(path), given[0].get(path))
    };
    let differs = |path: &&String| given.iter().any(|scenario| is_other(path, scenario));
    let of = |path: &String| ComparedKey {
        path: path.clone(),
        values: scenarios.iter().map(|scenario| scenario.get(path).cloned()).collect(),
    };
    paths.into_iter().filter(|path| !HEADER.contains(&path.as_str())).filter(differs).map(of).collect()
}

/// The common signals, and warnings of the others.
fn signals(runs: &[StoredRun], names: &[String], wanted: &[String]) -> (Vec<ComparedSignal>, Vec<Warning>) {
    let columns = runs.iter().flat_map(|run| &run.signals.channels).map(|channel| &channel.name);
    let columns = columns.filter(|name| wanted.is_empty() || wanted.contains(name));
    let (mut common, mut alone) = (vec![], vec![vec![]; runs.len()]);
    for column in group::unique(columns) {
        let series: Vec<Option<Series>> = runs.iter().map(|run| run.signals.series(column)).collect();
        match having(&series)[..] {
            [run] => alone[run].push(column.clone()),
            _ => common.push(ComparedSignal { column: column.clone(), errors: errors(&series), series }),
        }
    }
    let alone = names.iter().zip(alone).filter(|(_, columns)| !columns.is_empty());
    let alone = alone.map(|(name, signals)| Warning::SignalsOfOneRun { run: name.clone(), signals });
    let none = common.is_empty().then_some(Warning::NoCommonSignal);
    (common, alone.chain(none).collect())
}

/// The runs that have a signal.
fn having(series: &[Option<Series>]) -> Vec<usize> {
    series.iter().enumerate().filter(|(_, series)| series.is_some()).map(|(run, _)| run).collect()
}

fn errors(series: &[Option<Series>]) -> Vec<Option<f64>> {
    let first = series.first().and_then(Option::as_ref);
    let error = |(run, own): (usize, &Option<Series>)| {
        let (first, own) = (first.filter(|_| run > 0)?, own.as_ref()?);
        relative_error(own, first, common_window(own, first)?).ok()
    };
    series.iter().enumerate().map(error).collect()
}

/// The interval of time (s) that both cover.
fn common_window(a: &Series, b: &Series) -> Option<[f64; 2]> {
    let (from, to) = (a.time().first()?.max(*b.time().first()?), a.time().last()?.min(*b.time().last()?));
    (from < to).then_some([from, to])
}

/// Runs that failed, virtual recordings, and runs whose errors are against one.
fn warnings<'a>(runs: &'a [StoredRun], names: &'a [String]) -> impl Iterator<Item = Warning> + 'a {
    runs.iter().zip(names).flat_map(|(run, name)| {
        let name = || name.clone();
        let failure = run.failure.as_ref().map(|cause| Warning::FailedRun { run: name(), cause: cause.clone() });
        let recording = run.is_virtual.then(|| Warning::VirtualRecording { run: name() });
        let errors = is_against_virtual(run).then(|| Warning::ErrorsAgainstVirtual { run: name() });
        let raw = is_raw(run).then(|| Warning::RawRecording { run: name() });
        failure.into_iter().chain(recording).chain(raw).chain(errors)
    })
}

/// The warnings of the runs, each code once with the runs that have it; those of virtual recordings are findings of their own.
fn own_warnings<'n>(runs: &[StoredRun], names: &'n [String]) -> Vec<Finding> {
    let of_run = |(run, name): (&StoredRun, &'n String)| {
        let findings = run.summary.get("findings").and_then(Value::as_array).into_iter().flatten();
        let read = findings.filter_map(|finding| serde_json::from_value::<Finding>(finding.clone()).ok());
        let own = read.filter(|finding| finding.is_warning() && finding.code != VIRTUAL_REFERENCE.name);
        own.map(|finding| (finding.code, (name.as_str(), finding.message))).collect::<Vec<_>>()
    };
    let with_codes = group::by_key(runs.iter().zip(names).flat_map(of_run));
    let named = |(code, of): (String, Vec<(&str, String)>)| {
        let names = group::unique(of.iter().map(|(name, _)| *name)).join(", ");
        Finding::of_script(&code, &format!("{names}: {}", of[0].1))
    };
    with_codes.into_iter().map(named).collect()
}

/// Whether it is the file of a recording none of whose channels has the name of a signal of a run.
fn is_raw(run: &StoredRun) -> bool {
    let is_file = run.summary.is_empty() && run.scenario.is_empty() && run.failure.is_none();
    is_file && !run.signals.channels.iter().any(|channel| column::find(&channel.name).is_some())
}

/// Whether a run was compared with a virtual recording.
fn is_against_virtual(run: &StoredRun) -> bool {
    let entries = |key: &str| run.summary.get(key).and_then(Value::as_array);
    if let Some(findings) = entries("findings") {
        return findings.iter().any(|finding| finding["code"] == VIRTUAL_REFERENCE.name);
    }
    // A summary of an earlier version has no findings, but the header comments of the recording, one of which is its
    // mark.
    let comments = entries("reference_notes").into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
    Annotations::new(comments.collect()).is_virtual()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::signal::{Channel, Recording};

    fn run(place: &str, summary: Value, scenario: &str, channels: &[(&str, [f64; 3])]) -> StoredRun {
        let channel = |(name, values): &(&str, [f64; 3])| Channel { name: (*name).into(), values: values.to_vec() };
        let signals = Recording { time: vec![0.0, 0.1, 0.2], channels: channels.iter().map(channel).collect() };
        let Value::Object(summary) = summary else { panic!("no figures") };
        StoredRun { place: place.into(), signals, summary, scenario: scenario.into(), ..StoredRun::default() }
    }

    fn messages(comparison: &RunComparison) -> Vec<String> {
        comparison.findings.iter().map(|finding| finding.message.clone()).collect()
    }

    #[test]
    fn a_name_is_the_shortest_end_that_differs() {
        for (places, expected) in [
            (vec!["/r/drop/1008", "/r/drop/1509"], vec!["1008", "1509"]),
            (vec!["/a/1008", "/b/1008", "/b/1509"], vec!["a/1008", "b/1008", "1509"]),
            (vec!["/r/a/x/1", "/s/a/x/1"], vec!["r/a/x/1", "s/a/x/1"]),
            (vec!["/x", "/a/x"], vec!["x", "a/x"]),
        ] {
            assert_eq!(names(&places.iter().map(Path::new).collect::<Vec<_>>()), expected);
        }
    }

    #[test]
    fn runs_are_compared_with_the_first() {
        let first = json!({ "title": "a", "peak_force_N": 200.0, "ruptured": false, "wall_s": 1.0, "warnings": ["w"] });
        let second = json!({ "title": "b", "peak_force_N": 150.0, "ruptured": true, "rupture_time_s": 0.0234, "wall_s": 2.0, "more": "text" });
        let comparison = RunComparison::from_runs(
            &[
                run(
                    "/r/a",
                    first,
                    "layers.count = 8\ntitle = \"a\"",
                    &[("force_N", [0.0, 3.0, 4.0]), ("depth_m", [1.0; 3])],
                ),
                run("/r/b", second, "layers.count = 9\ntitle = \"b\"\nmore = 1", &[("force_N", [0.0, 3.0, 9.0])]),
                run("/r/recording.csv", json!({}), "", &[("force_N", [0.0, 6.0, 8.0])]),
            ],
            &[],
        );
        let values = |figure: &ComparedFigure| (figure.name.clone(), figure.difference(1));
        let telling: Vec<_> = comparison.key_figures().map(values).collect();
        let named = |name: &str, difference| (name.to_owned(), difference);
        assert_eq!(telling, [named("peak_force_N", Some(-0.25)), named("more", None)]);
        assert_eq!(comparison.film().unwrap(), ["held", "ruptured at 23.4 ms", "-"]);
        assert_eq!(comparison.figures.len(), 5, "{:?}", comparison.figures);
        let keys: Vec<_> = comparison.keys.iter().map(|key| (key.path.as_str(), key.values.clone())).collect();
        let value = |text: &str| Some(text.to_owned());
        let (counts, more) = (vec![value("8"), value("9"), None], vec![None, value("1"), None]);
        assert_eq!(keys, [("layers.count", counts), ("more", more)]);
        let [signals] = &comparison.signals[..] else { panic!("{:?}", comparison.signals) };
        assert_eq!(signals.errors, [None, Some(1.0), Some(1.0)]);
        assert_eq!(messages(&comparison), ["only a has `depth_m`"]);
        let summary = comparison.summary();
        assert_eq!(summary["figures"]["peak_force_N"]["differences"][1], -0.25);
        assert_eq!(summary["errors"]["force_N"], json!([null, 1.0, 1.0]));
        assert_eq!(summary["keys"]["layers.count"], json!(["8", "9", null]));
    }

    /// Nor is the lowest point of a dart that fell through a change, and each warning of the runs is one finding.
    #[test]
    fn runs_are_compared_by_their_verdicts() {
        let warning = |code: &str| json!({ "code": code, "severity": "warning", "message": "m" });
        let note = json!({ "code": "note", "severity": "note", "message": "n" });
        let held = json!({
            "ruptured": false, "verdict": "too coarse to tell", "peak_displacement_m": -0.1, "rebound_velocity_m_s": 1.0,
            "peak_acceleration_m_s2": 90.0, "findings": [warning("coarse"), note],
        });
        let broke = json!({
            "ruptured": true, "verdict": "ruptured", "peak_displacement_m": -0.6, "rebound_velocity_m_s": null,
            "peak_acceleration_m_s2": 50.0, "findings": [warning("coarse"), warning("other"), warning("other")],
        });
        let comparison = RunComparison::from_runs(&[run("/r/a", held, "", &[]), run("/r/b", broke, "", &[])], &[]);
        assert_eq!(comparison.film().unwrap(), ["too coarse to tell", "ruptured"]);
        let judged: Vec<&str> = comparison.judged(1).map(|figure| figure.name.as_str()).collect();
        assert!(judged.contains(&"peak_acceleration_m_s2") && !judged.contains(&"peak_displacement_m"), "{judged:?}");
        let notes = messages(&comparison);
        assert!(notes.ends_with(&["a, b: m".into(), "b: m".into()]), "{notes:?}");
    }

    #[test]
    fn failed_runs_and_virtual_recordings_are_findings() {
        let failed = StoredRun { failure: Some("lost".into()), ..run("/r/a", json!({}), "", &[("force_N", [0.0; 3])]) };
        let computed = StoredRun { is_virtual: true, ..run("/r/b", json!({}), "", &[("strain", [0.0; 3])]) };
        let comparison = RunComparison::from_runs(&[failed, computed], &[]);
        let codes: Vec<&str> = comparison.findings.iter().map(|finding| finding.code.as_str()).collect();
        let one = "signals-of-one-run";
        assert_eq!(codes, ["failed-run", "virtual-recording", one, one, "no-common-signal"]);
        let notes = messages(&comparison);
        assert_eq!(notes[..2], ["a failed: lost", "b is a VIRTUAL recording: nothing was measured"]);
        let compared = json!({ "acceleration_error": 0.1, "reference_notes": ["VIRTUAL drop test: nothing fell"] });
        let notes_of = |summary| {
            messages(&RunComparison::from_runs(&[run("/r/a", summary, "", &[]), run("/r/b", json!({}), "", &[])], &[]))
        };
        assert_eq!(notes_of(compared)[0], "a: its errors are against a VIRTUAL recording: nothing was measured");
        let found = json!({ "findings": [{ "code": "virtual-reference" }], "reference_notes": [] });
        assert_eq!(notes_of(found)[0], "a: its errors are against a VIRTUAL recording: nothing was measured");
        assert!(!notes_of(json!({ "reference_notes": ["a test"] }))[0].contains("VIRTUAL"));
        assert_eq!(notes[2..], ["only a has `force_N`", "only b has `strain`", "the runs have no signal in common"]);
        let only =
            RunComparison::from_runs(&[run("/a", json!({}), "", &[]), run("/b", json!({}), "", &[])], &["none".into()]);
        assert!(only.signals.is_empty());
    }
}
