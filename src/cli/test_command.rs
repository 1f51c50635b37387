//! `droptower test`: scenarios against what their runs must give.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use quick_xml::Writer;
use quick_xml::events::BytesText;
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use crate::failure::{both, evaluating, refuse, split};
use crate::folder::ResultPlace;
use crate::scenarios::{self, Checked};
use crate::{Failure, Shared, list, output, print_figures, tell};
use base::diagnostic::{Diagnostic, folder_of, shown_path};
use base::file;
use base::number::time_taken;
use lab::signal::{Recording, csv};
use scene::expectation::{Difference, Expectations, Given, Recorded, Verdict};
use scene::simulate::{self, RunError, RunOptions};
use study::post::{Results, failure_message};
use study::store::{self, Draft, Origin};

#[derive(Debug, Args)]
pub(crate) struct TestArgs {
    /// Folders to search for cases, folders of cases, or files called *.test.toml
    #[arg(value_name = "PATH", default_value = ".")]
    pub paths: Vec<PathBuf>,
    /// Record signals and figures of the runs anew, in place of comparing them
    #[arg(long)]
    pub bless: bool,
    /// Only cases whose path contains this text
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Also write the verdicts as JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Folder for the page with recorded and new signals
    #[arg(long, value_name = "DIR", default_value = "runs/test")]
    pub out: PathBuf,
    /// Replace results of tests of other paths or of something else in the same folder, and a file of something else by --junit
    #[arg(long)]
    pub force: bool,
}

pub(crate) fn run(args: &TestArgs, shared: &Shared) -> Result<(), Failure> {
    let begin = Instant::now();
    if let Some(file) = &args.junit {
        check(file, args.force)?;
    }
    let place = ResultPlace::new(args.out.clone(), Origin::of_tests(&args.paths), args.force)?;
    let cases = cases(&args.paths, args.filter.as_deref())?;
    let verdicts: Vec<Verdict> = cases.par_iter().map(|case| verdict(case, args, shared)).collect::<Result<_, _>>()?;
    let seconds = begin.elapsed().as_secs_f64();
    let summary = summary(args, &verdicts, seconds);
    let (_, files) = place.store(&summary, |_| Ok(()), report::test_page(&verdicts), Draft::publish)?;
    if let Some(junit) = &args.junit {
        output::write(junit, |file| write(file, &verdicts))?;
    }
    print_figures(shared, &summary, || [text(&verdicts, seconds), files].concat())?;
    match failed(&verdicts) {
        0 => Ok(()),
        _ if shared.json => Err(Failure::quiet()),
        failed => {
            let mistake = Diagnostic::new(format!("{failed} of {} tests failed", verdicts.len()));
            let page = shown_path(&args.out.join(store::run_files::REPORT));
            let hint = match args.bless {
                true => format!("the records are those of these runs; see {page} for what they are not to be"),
                false => format!("{page} shows new over recorded; if the new is right: droptower test --bless"),
            };
            Err(Failure::output(mistake.hint(hint)))
        }
    }
}

/// Runs a case, and tells at once where it fails.
fn verdict(case: &Case, args: &TestArgs, shared: &Shared) -> Result<Verdict, Failure> {
    let begin = Instant::now();
    let mut verdict = Verdict {
        name: case.name.clone(),
        expectations: case.expectations.clone(),
        differences: vec![],
        recorded: case.recorded.clone(),
        signals: None,
        seconds: 0.0,
        blessed: false,
    };
    match results(case) {
        Ok(results) => {
            let figures = results.summary(&case.checked.model);
            let given = Given { signals: &results.signals, figures: &figures };
            if args.bless {
                let recorded = case.expectations.recorded(&given);
                verdict.blessed = case.bless(&recorded)?;
                verdict.recorded = recorded;
            }
            verdict.differences = case.expectations.differences(&verdict.recorded, &given);
            verdict.signals = Some(results.signals);
        }
        Err(cause) => verdict.differences = vec![Difference::RunFailed { cause }],
    }
    verdict.seconds = begin.elapsed().as_secs_f64();
    if !shared.quiet && !shared.json {
        tell(&told(&verdict));
    }
    Ok(verdict)
}

/// The results of a run of the case, or why there are none.
fn results(case: &Case) -> Result<Results, String> {
    let Checked { model, plan, .. } = &case.checked;
    let options = RunOptions::default();
    let outcome = simulate::run_with(model, options, &mut |_| {}).map_err(|error| match error {
        RunError::Failure(failure) => failure_message(&failure, model),
        error => error.to_string(),
    })?;
    plan.evaluate(model, &outcome).map_err(|error| evaluating(&error).message)
}

/// The line that a case leaves when it ends.
fn told(verdict: &Verdict) -> String {
    let time = time_taken(verdict.seconds);
    match (verdict.has_passed(), verdict.blessed) {
        (true, true) => format!("recorded  {}  {time}", verdict.name),
        (true, false) => format!("ok        {}  {time}", verdict.name),
        (false, _) => format!("FAILED    {}  {time}", verdict.name),
    }
}

/// How many cases have failed.
fn failed(verdicts: &[Verdict]) -> usize {
    verdicts.iter().filter(|verdict| !verdict.has_passed()).count()
}

fn summary(args: &TestArgs, verdicts: &[Verdict], seconds: f64) -> Map<String, Value> {
    let failed = failed(verdicts);
    let entries: Vec<_> = verdicts.iter().map(Verdict::entry).collect();
    let figures = json!({
        "droptower": env!("CARGO_PKG_VERSION"),
        "passed": verdicts.len() - failed,
        "failed": failed,
        "seconds": seconds,
        "cases": entries,
        "paths": args.paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
        store::run_files::WORKING_FOLDER: store::path_from(&args.out, Path::new(".")),
    });
    match figures {
        Value::Object(figures) => figures,
        _ => Map::new(),
    }
}

fn text(verdicts: &[Verdict], seconds: f64) -> String {
    let mut lines = Vec::new();
    for verdict in verdicts.iter().filter(|verdict| !verdict.has_passed()) {
        lines.push(verdict.name.clone());
        lines.extend(verdict.differences.iter().map(|difference| format!("  {difference}")));
    }
    let failed = failed(verdicts);
    let passed = verdicts.len() - failed;
    lines.push(format!("{passed} passed, {failed} failed, {}", time_taken(seconds)));
    lines.join("\n") + "\n"
}

/// Files of a case in a folder of its own.
const SCENARIO: &str = "scenario.toml";
const EXPECTATIONS: &str = "expect.toml";
const SIGNALS: &str = "expected.csv";
const FIGURES: &str = "expected.json";

/// End of the name of a scenario that is a case beside others.
const ENDING: &str = ".test.toml";

/// A scenario and what its run must give, checked.
pub(crate) struct Case {
    /// Path of its folder or of its scenario.
    pub name: String,
    pub checked: Checked,
    pub expectations: Expectations,
    pub recorded: Recorded,
    files: Files,
}

/// The files of a case.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Files {
    name: PathBuf,
    scenario: PathBuf,
    expectations: PathBuf,
    signals: PathBuf,
    figures: PathBuf,
}

impl Files {
    /// The files of a case that is a folder.
    fn of_folder(folder: &Path) -> Files {
        let [scenario, expectations, signals, figures] =
            [SCENARIO, EXPECTATIONS, SIGNALS, FIGURES].map(|name| folder.join(name));
        Files { name: folder.into(), scenario, expectations, signals, figures }
    }

    /// The files of a case whose scenario is called `<stem>.test.toml`.
    fn of_scenario(scenario: &Path, stem: &str) -> Files {
        let beside = |ending: &str| scenario.with_file_name(format!("{stem}.{ending}"));
        let [expectations, signals, figures] = [EXPECTATIONS, SIGNALS, FIGURES].map(beside);
        Files { name: scenario.into(), scenario: scenario.into(), expectations, signals, figures }
    }
}

/// The cases below the paths whose names contain the filter, checked.
fn cases(paths: &[PathBuf], filter: Option<&str>) -> Result<Vec<Case>, Failure> {
    let (found, unread) = split(paths.iter().map(|path| below(path)));
    let found: BTreeSet<Files> = found.into_iter().flatten().collect();
    let is_wanted = |files: &Files| filter.is_none_or(|filter| shown_path(&files.name).contains(filter));
    let wanted: Vec<Files> = found.iter().filter(|files| is_wanted(files)).cloned().collect();
    let none = (wanted.is_empty() && unread.is_none()).then(|| none(paths, filter, found.len()).into());
    let (cases, faulty) = split(wanted.into_iter().map(Case::read));
    Failure::all([unread, none, faulty].into_iter().flatten()).map_or(Ok(cases), Err)
}

/// The mistake of arguments that name no case.
fn none(paths: &[PathBuf], filter: Option<&str>, all: usize) -> Diagnostic {
    let places: Vec<String> = paths.iter().map(|path| shown_path(path).to_string()).collect();
    let places = places.join(", ");
    match filter {
        Some(filter) if all > 0 => {
            Diagnostic::new(format!("none of the {all} tests in {places} has \"{filter}\" in its path"))
        }
        _ => Diagnostic::new(format!("no tests in {places}"))
            .hint("a test is a folder with scenario.toml and expect.toml: `droptower new test FOLDER` writes one"),
    }
}

/// The cases in a folder and those below it, or the one that a path names.
fn below(path: &Path) -> Result<Vec<Files>, Failure> {
    let as_case = |file: &Path| {
        let name = file.file_name()?.to_str()?;
        if name == EXPECTATIONS || name == SCENARIO {
            return Some(Files::of_folder(folder_of(file)));
        }
        name.strip_suffix(ENDING).map(|stem| Files::of_scenario(file, stem))
    };
    if path.is_file() {
        let hint = "a test is a folder with scenario.toml and expect.toml, or a file called *.test.toml";
        return as_case(path)
            .map(|files| vec![files])
            .ok_or_else(|| Diagnostic::new(format!("{} is no test", shown_path(path))).hint(hint).into());
    }
    if !path.is_dir() {
        return Err(Diagnostic::new(format!("there is no {}", shown_path(path))).into());
    }
    let (files, mistakes) = list::below(path, |name| name == EXPECTATIONS || name.ends_with(ENDING));
    refuse(mistakes).map(|()| files.iter().filter_map(|file| as_case(file)).collect())
}

impl Case {
    fn read(files: Files) -> Result<Case, Failure> {
        let checked = scenarios::check(&files.scenario, &[]);
        let scripts_report = checked.as_ref().map_or(true, |checked| checked.plan.script().is_some());
        let expectations = || {
            if !files.expectations.is_file() {
                let mistake = Diagnostic::new(format!("{} is missing", shown_path(&files.expectations)));
                return Err(mistake.hint("it says what the run must give: `droptower explain expect`").into());
            }
            scenarios::expectations(&files.expectations, scripts_report)
        };
        let (checked, expectations) = both(checked, expectations())?;
        let recorded = Recorded::read(&files.signals, &files.figures)?;
        Ok(Case { name: shown_path(&files.name).to_string(), checked, expectations, recorded, files })
    }

    /// Records what was given; whether that is another than before.
    fn bless(&self, recorded: &Recorded) -> Result<bool, Failure> {
        let text = |signals: &Recording| {
            let mut text = Vec::new();
            csv::write(signals, &mut text).map(|()| text)
        };
        let signals = renew(&self.files.signals, recorded.signals.as_ref().map(text))?;
        let figures = (!recorded.figures.is_empty()).then(|| serde_json::to_vec_pretty(&recorded.figures));
        let figures = renew(&self.files.figures, figures.map(|text| text.map_err(io::Error::other)))?;
        Ok(signals || figures)
    }
}

/// Writes what a file is to hold, or removes it where that is nothing; whether that is another than before.
fn renew(path: &Path, content: Option<io::Result<Vec<u8>>>) -> Result<bool, Failure> {
    let renewed = || -> io::Result<bool> {
        let before = fs::read(path).ok();
        match content.transpose()? {
            Some(content) if before.as_ref() != Some(&content) => file::replace(path, &content)?,
            None if before.is_some() => fs::remove_file(path)?,
            _ => return Ok(false),
        }
        Ok(true)
    };
    renewed().map_err(|error| output::failed(path, &error))
}

/// How a file begins that [`write`] wrote.
const START: &str = "<testsuite name=\"droptower\"";

/// Longest file of verdicts that is replaced, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Refuses a file that cannot be written, and one of something else, unless by `force`.
pub(crate) fn check(path: &Path, force: bool) -> Result<(), Failure> {
    let is_ours = file::read_text(path, MOST_BYTES).is_ok_and(|text| text.starts_with(START));
    output::check(path, "xml", None, Some(force || is_ours))
}

/// Writes one suite with a case for each verdict.
pub(crate) fn write(file: &mut dyn Write, verdicts: &[Verdict]) -> io::Result<()> {
    let failed = failed(verdicts);
    let seconds: f64 = verdicts.iter().map(|verdict| verdict.seconds).sum();
    let mut xml = Writer::new_with_indent(file, b' ', 2);
    let suite = xml.create_element("testsuite").with_attributes([
        ("name", "droptower"),
        ("tests", verdicts.len().to_string().as_str()),
        ("failures", failed.to_string().as_str()),
        ("time", format!("{seconds:.3}").as_str()),
    ]);
    let cases = |xml: &mut Xml<'_>| verdicts.iter().try_for_each(|verdict| case(xml, verdict));
    suite.write_inner_content(cases).map_err(io::Error::other)?;
    xml.into_inner().write_all(b"\n")
}

/// The document as it is written.
type Xml<'a> = Writer<&'a mut dyn Write>;

fn case(xml: &mut Xml<'_>, verdict: &Verdict) -> Result<(), quick_xml::Error> {
    let time = format!("{:.3}", verdict.seconds);
    let attributes = [("name", verdict.name.as_str()), ("classname", "droptower"), ("time", time.as_str())];
    let element = xml.create_element("testcase").with_attributes(attributes);
    if verdict.has_passed() {
        return element.write_empty().map(drop);
    }
    let lines: Vec<String> = verdict.differences.iter().map(Difference::to_string).collect();
    let first = lines.first().map_or("", String::as_str);
    let failure = |xml: &mut Xml<'_>| {
        let failure = xml.create_element("failure").with_attribute(("message", first));
        failure.write_text_content(BytesText::new(&lines.join("\n"))).map(drop)
    };
    element.write_inner_content(failure).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_are_cases_whose_text_is_escaped() {
        let verdict = |name: &str, differences: Vec<Difference>| Verdict {
            name: name.into(),
            expectations: Expectations::default(),
            differences,
            recorded: Recorded::default(),
            signals: None,
            seconds: 0.25,
            blessed: false,
        };
        let failed = vec![
            Difference::RunFailed { cause: "a < b & \"c\"".into() },
            Difference::NoFinding { finding: "coarse-contact".into() },
        ];
        let mut text = Vec::new();
        write(&mut text, &[verdict("a", vec![]), verdict("b \"<", failed)]).unwrap();
        let expected = r#"<testsuite name="droptower" tests="2" failures="1" time="0.500">
  <testcase name="a" classname="droptower" time="0.250"/>
  <testcase name="b &quot;&lt;" classname="droptower" time="0.250">
    <failure message="the run failed: a &lt; b &amp; &quot;c&quot;">the run failed: a &lt; b &amp; &quot;c&quot;
the finding coarse-contact did not come</failure>
  </testcase>
</testsuite>
"#;
        assert!(expected.starts_with(START));
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }
}
