//! What an identification costs: `cargo bench --bench identify`.
//!
//! The signals of a drop test's own run are its recording: the multipliers that are to be found are those of its scenario. A
//! cold start is [1, 1, 1], the quasi-static curves. Wall times are of one search each.

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

/// The tests that held.
const TESTS: [&str; 5] = ["1008", "1009", "1010", "1509", "1510"];

/// Columns of the printed table.
const HEAD: &str = "| test | method | s | iterations | evaluations | k1 | ke | ky | off by | E_a |\n|---|---|---|---|---|---|---|---|---|---|";

const QUICK: (&str, &str) = ("method", "levenberg-marquardt");

fn main() -> Outcome<()> {
    let folder = tempfile::tempdir()?;
    let recorded = TESTS.map(|test| record(test, folder.path()));
    let [first, others @ ..] = recorded;
    let first = first?;
    println!("## Drop test 1008 from a cold start, {} threads\n\n{HEAD}", rayon::current_num_threads());
    first.identify(&[])?;
    first.identify(&[QUICK])?;
    println!("\n## All five, the first from a cold start and the others from what it found where that holds\n\n{HEAD}");
    let (mut total, found) = first.identify(&[QUICK])?;
    let start = found.map(|k| k.to_string()).join(",");
    for other in others {
        let other = other?;
        // Where the first one's film is too weak, the search has no value to begin with.
        let warm = other.identify(&[QUICK, ("start", &start)]).or_else(|refused| {
            println!("| {} | {refused}; from a cold start: |", other.test);
            other.identify(&[QUICK])
        });
        total += warm?.0;
    }
    println!("\nTogether {total:.0} s.");
    Ok(())
}

/// A test with its recording.
struct Recorded {
    test: &'static str,
    recording: PathBuf,
    /// The multipliers that are to be found: those of the scenario (Table 8).
    expected: [f64; 3],
}

fn scenario(test: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/drop/{test}.toml"))
}

/// Runs a test and keeps its signals as its recording.
fn record(test: &'static str, folder: &Path) -> Outcome<Recorded> {
    let document = Document::read(&scenario(test)).map_err(told)?;
    let resolved: toml::Table = document.resolved().parse()?;
    let scale = &resolved["specimen"]["material"]["fabric"]["scale"];
    let expected = ["k1", "ke", "ky"].map(|name| scale[name].as_float().unwrap_or(f64::NAN));
    let mut model = model::check(&document.with(&[change("output.frames=1")?])).map_err(told)?;
    (model.reference, model.post) = (None, None);
    let outcome = simulate::run(&model, &mut |_| {})?;
    let results = Plan::prepare(&model)?.measure(&model, &outcome)?;
    let recording = folder.join(format!("{test}.csv"));
    csv::write(&results.signals, &mut File::create(&recording)?)?;
    Ok(Recorded { test, recording, expected })
}

impl Recorded {
    /// Searches as `scripts/identify.rhai` does and prints what is found; the seconds that it took, and the multipliers.
    fn identify(&self, given: &[(&str, &str)]) -> Outcome<(f64, [f64; 3])> {
        let reference = change(&format!("reference.signals={}", self.recording.display()))?;
        let mut engine = script::engine(Limits::STUDY);
        let ledger = Ledger::new(Vec::new(), |_| {});
        ledger.register(&mut engine);
        post::register_studies(&mut engine, vec![reference]);
        identify::register(&mut engine, &Laboratory::new(None, |_| {}));
        Arguments::register(&mut engine);
        let mut args: Map = given.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect();
        // What is timed is the search, and the seven trials of its confidence.
        args.insert("profiles".into(), "no".into());
        args.insert("scenario".into(), scenario(self.test).display().to_string().into());
        let mut scope = Scope::new();
        scope.push_constant("args", Arguments::new(args));
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/identify.rhai");
        let script = Script::compile(&engine, &scope, &path, &fs::read_to_string(&path)?);
        let begin = Instant::now();
        script.map_err(|faults| faults[0].clone())?.run(&engine, scope)?;
        let seconds = begin.elapsed().as_secs_f64();
        let findings = ledger.findings();
        let row = findings.tables.iter().find(|(name, _)| name == "coefficients").map(|(_, rows)| &rows[0]);
        Ok((seconds, self.print(given, seconds, row.ok_or("the script left no coefficients")?)))
    }

    fn print(&self, given: &[(&str, &str)], seconds: f64, row: &Row) -> [f64; 3] {
        let number = |name: &str| row[name].as_f64().unwrap_or(f64::NAN);
        let method = given.iter().find(|(name, _)| *name == "method").map_or("nelder-mead", |(_, method)| method);
        let k = ["k1", "ke", "ky"].map(number);
        let off = k.iter().zip(self.expected).map(|(k, expected)| (k / expected - 1.0).abs()).fold(0.0, f64::max);
        println!(
            "| {} | {method} | {seconds:.1} | {} | {} | {:.3} | {:.3} | {:.3} | {:.2} % | {:.2e} |",
            self.test,
            row["iterations"],
            row["evaluations"],
            k[0],
            k[1],
            k[2],
            100.0 * off,
            number("error")
        );
        k
    }
}

fn change(text: &str) -> Outcome<Assignment> {
    Ok(Assignment::from_argument(text).map_err(told)?)
}

fn told(mistakes: Vec<diagnostic::Diagnostic>) -> String {
    diagnostic::render(&mistakes, false)
}
