//! Sick scenarios: each must end with the mistakes, the fault or the findings that its case names, and never with a panic,
//! a number that is not finite, or an energy balance that is lost in silence.
//!
//! `sick/*.toml` are the cases, `sick/base/*.toml` small scenarios that they change; other bases are shipped scenarios.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde::Deserialize;
use serde_json::Value as Json;

use crate::workbench::{await_of, command, imbalance, root};

/// Largest error of the energy balance without a finding.
const BALANCE: f64 = 0.01;

/// Columns of `signals.csv` that have gaps where there is no intact film (docs/results.md).
const WITH_GAPS: [&str; 2] = ["max_strain_md", "max_strain_td"];

/// A file of cases.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Cases {
    case: Vec<Case>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    name: String,
    /// A scenario of `sick/base`, or with a slash one of `scenarios`.
    base: String,
    /// The keys that it changes, as lines of the scenario.
    change: String,
    gives: Gives,
    /// Whether it repeats what another case proves, and is of a thorough run.
    #[serde(default)]
    thorough: bool,
}

/// How a case must end.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum Gives {
    /// The check refuses it: part of the message, and of the line that it is about.
    Mistake([String; 2]),
    /// The run fails: part of the cause.
    Fault(String),
    /// The run ends with these findings at least.
    Findings(Vec<String>),
    /// The run ends without a warning, but for values that are implausible.
    Healthy(bool),
    /// The run would take long and says so.
    Forecast(bool),
}

/// What a run left.
struct Ended {
    folder: PathBuf,
    /// Its exit status; none where it was ended, after its forecast.
    status: Option<i32>,
    error: String,
}

fn cases(file: &str) -> Vec<Case> {
    let path = root().join(format!("tests/it/sick/{file}.toml"));
    let text = fs::read_to_string(&path).expect("cases");
    toml::from_str::<Cases>(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display())).case
}

/// Runs `case` in `folder`.
fn run(case: &Case, folder: &Path) -> Result<Ended, String> {
    let base = if case.base.contains('/') { "scenarios" } else { "tests/it/sick/base" };
    let base = root().join(base).join(format!("{}.toml", case.base));
    let change = case.change.replace("MESHES", &root().join("tests/it/sick/mesh").display().to_string());
    let change = change.replace("MATERIALS", &root().join("scenarios/materials").display().to_string());
    fs::write(folder.join("sick.toml"), format!("extends = '{}'\n{change}", base.display())).expect("a scenario");
    let error = folder.join("stderr");
    let arguments = ["run", "sick.toml", "--out", "out", "--threads", "1", "--diagnostics", "json"];
    let mut child = command(folder, &arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&error).expect("a file"))
        .spawn()
        .expect("the binary starts");
    let errors = || fs::read_to_string(&error).unwrap_or_default();
    let has_forecast = || matches!(case.gives, Gives::Forecast(_)) && errors().contains("will take about");
    let status = if await_of(&mut child, has_forecast) {
        child.kill().and_then(|()| child.wait()).expect("a child");
        None
    } else {
        let status = child.wait().expect("a status");
        Some(status.code().ok_or_else(|| format!("ended by {status}"))?)
    };
    Ok(Ended { folder: folder.to_owned(), status, error: errors() })
}

/// What is wrong with how a case ended.
fn judge(gives: &Gives, ended: &Ended) -> Result<(), String> {
    let Ended { folder, status, error } = ended;
    if error.contains("panicked") {
        return Err(format!("panics: {error}"));
    }
    let expected = match gives {
        Gives::Mistake(_) => Some(2),
        Gives::Fault(_) => Some(3),
        Gives::Findings(_) | Gives::Healthy(_) => Some(0),
        Gives::Forecast(_) => None,
    };
    if *status != expected {
        return Err(format!("exit status {status:?}: {error}{}", codes(folder).join(", ")));
    }
    let has = |name: &str| folder.join(name).is_dir();
    if [has("out"), has("out.failed")] != [expected == Some(0), expected == Some(3)] {
        return Err("leaves another folder than its exit status says".to_owned());
    }
    match gives {
        Gives::Mistake([message, line]) => mistaken(folder, error, message, line),
        Gives::Fault(cause) => {
            let found = fs::read_to_string(folder.join("out.failed/failure.txt")).expect("a cause");
            let nan = ["NaN", "inf "].into_iter().find(|word| found.contains(word));
            match (found.contains(cause), nan) {
                (true, None) => Ok(()),
                (false, _) => Err(format!("fails otherwise: {found}")),
                (true, Some(word)) => Err(format!("tells the user of {word}: {found}")),
            }
        }
        Gives::Findings(_) | Gives::Healthy(_) => complete(&folder.join("out")).and_then(|()| found(gives, folder)),
        Gives::Forecast(_) => Ok(()),
    }
}

/// Checks that one of the mistakes has this part of its message and is about a line with this part.
fn mistaken(folder: &Path, error: &str, message: &str, part: &str) -> Result<(), String> {
    let is_meant = |record: &Json| {
        let text = |key: &str| record[key].as_str().unwrap_or_default();
        let number = record["line"].as_u64().unwrap_or_default() as usize;
        let source = fs::read_to_string(folder.join(text("source"))).unwrap_or_default();
        let line = source.lines().nth(number.wrapping_sub(1)).unwrap_or_default();
        text("message").contains(message) && line.contains(part)
    };
    let records = error.lines().filter_map(|line| serde_json::from_str::<Json>(line).ok());
    if records.into_iter().any(|record| is_meant(&record)) { Ok(()) } else { Err(format!("other mistakes: {error}")) }
}

/// The findings of a run, with their severity.
fn findings(folder: &Path) -> Vec<[String; 2]> {
    let summary = fs::read(folder.join("out/summary.json")).unwrap_or_default();
    let summary: Json = serde_json::from_slice(&summary).unwrap_or_default();
    let of = |finding: &Json, key: &str| finding[key].as_str().unwrap_or_default().to_owned();
    let findings = summary["findings"].as_array().cloned().unwrap_or_default();
    findings.iter().map(|finding| [of(finding, "severity"), of(finding, "code")]).collect()
}

fn codes(folder: &Path) -> Vec<String> {
    findings(folder).into_iter().map(|finding| finding.join(" ")).collect()
}

/// Checks the findings of a run that ended.
fn found(gives: &Gives, folder: &Path) -> Result<(), String> {
    let found = findings(folder);
    let is_right = match gives {
        Gives::Findings(codes) => codes.iter().all(|code| found.iter().any(|[_, found]| found == code)),
        _ => found.iter().all(|[severity, code]| severity == "note" || code == "implausible-value"),
    };
    if is_right { Ok(()) } else { Err(format!("other findings: {}", codes(folder).join(", "))) }
}

/// Columns of a table with gaps as NaN.
fn columns(path: &Path) -> Result<Vec<(String, Vec<f64>)>, String> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut lines = text.lines();
    let names = lines.next().unwrap_or_default().split(',');
    let mut columns: Vec<(String, Vec<f64>)> = names.map(|name| (name.to_owned(), vec![])).collect();
    for line in lines {
        for ((_, values), cell) in columns.iter_mut().zip(line.split(',')) {
            values.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    Ok(columns)
}

/// Checks that the numbers of a complete run are finite and that its energies balance, or that a finding says otherwise.
fn complete(out: &Path) -> Result<(), String> {
    let summary = fs::read(out.join("summary.json")).map_err(|error| error.to_string())?;
    let summary: Json = serde_json::from_slice(&summary).map_err(|error| error.to_string())?;
    for name in ["energy_balance_error", "steps", "time_step_s", "elements"] {
        if !summary[name].is_number() {
            return Err(format!("{name} is {}", summary[name]));
        }
    }
    let findings = summary["findings"].as_array().cloned().unwrap_or_default();
    if let Some(finding) = findings.iter().find(|finding| {
        let figures = finding.as_object().into_iter().flatten();
        figures.into_iter().any(|(_, value)| value.is_null()) || finding["message"].to_string().contains("NaN")
    }) {
        return Err(format!("a figure is not finite: {finding}"));
    }
    let (signals, energies) = (columns(&out.join("signals.csv"))?, columns(&out.join("energies.csv"))?);
    let gaps = signals.iter().filter(|(name, _)| !WITH_GAPS.contains(&name.as_str())).chain(&energies);
    if let Some((name, _)) = gaps.into_iter().find(|(_, values)| !values.iter().all(|value| value.is_finite())) {
        return Err(format!("{name} is not finite"));
    }
    let error = summary["energy_balance_error"].as_f64().unwrap_or(f64::NAN).max(imbalance(&energies));
    let is_told = findings.iter().any(|finding| finding["code"] == "energy-balance");
    if error < BALANCE || is_told { Ok(()) } else { Err(format!("the balance is off by {error} in silence")) }
}

/// Every case of a file ends as it says.
fn every_sick_scenario_ends_as_its_case_says(file: &str) {
    let mut wrong = vec![];
    let cases: Vec<Case> = cases(file).into_iter().filter(|case| thorough::thorough() || !case.thorough).collect();
    for case in &cases {
        let folder = tempfile::tempdir().expect("a folder");
        if let Err(why) = run(case, folder.path()).and_then(|ended| judge(&case.gives, &ended)) {
            wrong.push(format!("{}: {why}", case.name));
        }
    }
    assert!(wrong.is_empty(), "{} of {} cases:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

const FILES: [&str; 5] = ["bodies", "films", "laws", "loadings", "meshes"];

thorough::cases!(every_sick_scenario_ends_as_its_case_says {
    bodies: "bodies";
    films: "films";
    laws: "laws";
    loadings: "loadings";
    meshes: "meshes";
});

#[test]
fn cases_have_names_of_their_own() {
    assert_eq!(glob::glob("tests/it/sick/*.toml").expect("a good pattern").count(), FILES.len());
    let cases: Vec<Case> = FILES.into_iter().flat_map(cases).collect();
    let names: BTreeSet<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    assert!(cases.len() >= 60 && names.len() == cases.len(), "{} cases, {} names", cases.len(), names.len());
    assert!(!cases.iter().any(|case| matches!(case.gives, Gives::Healthy(false) | Gives::Forecast(false))));
}
