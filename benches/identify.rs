//! What an identification costs: `cargo bench --bench identify`.
//!
//! Every drop test is searched for from [1, 1, 1], the quasi-static curves, with the signals of its own run as the recording:
//! the multipliers that are to be found are those of its scenario. Wall times are of one search each.

use std::error::Error;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Instant;

use droptower::diagnostic;
use droptower::identify::{self, Laboratory};
use droptower::model;
use droptower::post::{self, Plan};
use droptower::scenario::{Assignment, Document};
use droptower::script::{self, Arguments, Ledger, Limits, Row, Script};
use droptower::signal::csv;
use droptower::simulate;
use rhai::{Map, Scope};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// The tests that held, and their multipliers (Table 8).
const TESTS: [(&str, [f64; 3]); 5] = [
    ("1008", [2.75, 3.41, 1.00]),
    ("1009", [2.89, 3.47, 0.91]),
    ("1010", [2.99, 3.55, 0.88]),
    ("1509", [3.14, 1.69, 1.16]),
    ("1510", [3.07, 2.29, 1.04]),
];

/// Columns of the printed table.
const HEAD: &str = "| test | method | s | iterations | evaluations | k1 | ke | ky | off by | E_a |\n|---|---|---|---|---|---|---|---|---|---|";

fn main() -> Outcome<()> {
    let folder = tempfile::tempdir()?;
    for (test, _) in TESTS {
        record(test, folder.path())?;
    }
    println!("## Drop test 1008 from a cold start, {} threads\n\n{HEAD}", rayon::current_num_threads());
    let quick = [("method", "levenberg-marquardt")];
    for given in [&[][..], &[("lead", "13.34")], &quick, &[("method", "levenberg-marquardt"), ("lead", "13.34")]] {
        identified(TESTS[0], given, folder.path())?;
    }
    println!("\n## All five tests\n\n{HEAD}");
    let seconds = TESTS.map(|test| identified(test, &quick, folder.path()));
    let total: f64 = seconds.into_iter().collect::<Outcome<Vec<f64>>>()?.iter().sum();
    println!("\nTogether {total:.0} s.");
    Ok(())
}

fn scenario(test: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/drop/{test}.toml"))
}

fn recording(test: &str, folder: &Path) -> PathBuf {
    folder.join(format!("{test}.csv"))
}

/// Runs a test and keeps its signals as its recording.
fn record(test: &str, folder: &Path) -> Outcome<()> {
    let document = Document::read(&scenario(test)).map_err(told)?;
    let mut model = model::check(&document.with(&[change("output.frames=1")?])).map_err(told)?;
    (model.reference, model.post) = (None, None);
    let outcome = simulate::run(&model, &mut |_| {})?;
    let results = Plan::prepare(&model)?.measure(&model, &outcome)?;
    Ok(csv::write(&results.signals, &mut File::create(recording(test, folder))?)?)
}

/// Searches as `scripts/identify.rhai` does and prints what is found; seconds that it took.
fn identified((test, expected): (&str, [f64; 3]), given: &[(&str, &str)], folder: &Path) -> Outcome<f64> {
    let reference = change(&format!("reference.signals={}", recording(test, folder).display()))?;
    let mut engine = script::engine(Limits::STUDY);
    let ledger = Ledger::new(Vec::new(), |_| {});
    ledger.register(&mut engine);
    post::register_studies(&mut engine, vec![reference]);
    identify::register(&mut engine, &Laboratory::new(None, |_| {}));
    Arguments::register(&mut engine);
    let mut args: Map = given.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect();
    args.insert("scenario".into(), scenario(test).display().to_string().into());
    let mut scope = Scope::new();
    scope.push_constant("args", Arguments::new(args));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/identify.rhai");
    let text = fs::read_to_string(&path)?;
    let script = Script::compile(&engine, &scope, &path, &text).map_err(|faults| faults[0].clone())?;
    let begin = Instant::now();
    script.run(&engine, scope)?;
    let seconds = begin.elapsed().as_secs_f64();
    let findings = ledger.findings();
    let row = findings.tables.iter().find(|(name, _)| name == "coefficients").map(|(_, rows)| &rows[0]);
    print(test, given, seconds, row.ok_or("the script left no coefficients")?, expected);
    Ok(seconds)
}

fn print(test: &str, given: &[(&str, &str)], seconds: f64, row: &Row, expected: [f64; 3]) {
    let number = |name: &str| row[name].as_f64().unwrap_or(f64::NAN);
    let method: Vec<String> = given.iter().map(|(name, value)| format!("{name}={value}")).collect();
    let k = ["k1", "ke", "ky"].map(number);
    let off = k.iter().zip(expected).map(|(k, expected)| (k / expected - 1.0).abs()).fold(0.0, f64::max);
    println!(
        "| {test} | {} | {seconds:.1} | {} | {} | {:.3} | {:.3} | {:.3} | {:.2} % | {:.2e} |",
        method.join(" "),
        row["iterations"],
        row["evaluations"],
        k[0],
        k[1],
        k[2],
        100.0 * off,
        number("error")
    );
}

fn change(text: &str) -> Outcome<Assignment> {
    Ok(Assignment::from_argument(text).map_err(told)?)
}

fn told(mistakes: Vec<diagnostic::Diagnostic>) -> String {
    diagnostic::render(&mistakes, false)
}
