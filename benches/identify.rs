//! Cost of an identification: `cargo bench --bench identify`.
//!
//! The recording of a drop test is the signals of its own run: the multipliers to be found are those of its scenario.
//! The first test is searched from a cold start, [1, 1, 1], the quasi-static curves; the others at the same time from
//! its result, or from a cold start where that film ruptures at once. The wall time is printed beside the CPU time of
//! all threads: it exceeds the CPU time over their number where other processes use the machine.

use std::error::Error;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Instant;

use droptower::diagnostic;
use droptower::functions;
use droptower::identify::{self, SearchHost};
use droptower::model;
use droptower::post::Plan;
use droptower::scenario::{Assignment, Document};
use droptower::scenario_functions;
use droptower::script::{Arguments, Limits, OutputCollector, Row, Script, ScriptOutput};
use droptower::signal::csv;
use droptower::simulate;
use rayon::prelude::*;
use rhai::{Map, Scope};

type Outcome<T> = Result<T, Box<dyn Error>>;

/// The tests without rupture.
const TESTS: [&str; 5] = ["1008", "1009", "1010", "1509", "1510"];

/// Columns of the printed table.
const HEAD: &str =
    "| test | iterations | evaluations | k1 | ke | ky | off by | error |\n|---|---|---|---|---|---|---|---|";

/// The search of `scripts/identify.rhai` for several tests.
const SCRIPT: &str = r#"
let options = #{
    tol_x: 1e-4, tol_f: 1e-4, max_iterations: 400, max_evaluations: 800, difference: 0.01,
    lower: [0.2, 0.2, 0.2], upper: [10, 10, 5],
};
let scaled = |test, k| test.with(#{ "specimen.material.fabric.scale": #{ k1: k[0], ke: k[1], ky: k[2] } });
let objective = |place| {
    let test = scenario(args[`test${place}`]).with(#{ "reference.signals": args[`recording${place}`] });
    |k| relative_residuals(scaled.call(test, k).simulate().acceleration, test.reference.acceleration, test.window)
};
let row = |best| #{ k1: best.x[0], ke: best.x[1], ky: best.x[2], f: best.f, iterations: best.iterations,
    evaluations: best.evaluations };
let starts = args.start.split(",").map(|k| parse_float(k));
let objectives = [];
for place in 0..args.count { objectives.push(objective.call(place)); }
let found = minimize_all(args.method, objectives.map(|_of_each| starts), options, objectives);
table("found", found.map(|best| row.call(best)));
for best in found { for warning in best.warnings { log(warning); } }
"#;

fn main() -> Outcome<()> {
    let folder = tempfile::tempdir()?;
    let recorded = TESTS.map(|test| record(test, folder.path())).into_iter().collect::<Outcome<Vec<_>>>()?;
    let (first, others) = recorded.split_at(1);
    for method in ["levenberg-marquardt", "nelder-mead"] {
        println!("## {method}, {} threads\n\n{HEAD}", rayon::current_num_threads());
        let (found, one) = identify(first, method, [1.0; 3])?;
        let (_, four) = identify(others, method, found)?;
        let five = averaged(&recorded)?;
        println!("\n| | wall, s | all threads, s |\n|---|---|---|");
        for (what, cost) in [("1008", &one), ("the other four", &four), ("five runs with one film", &five)] {
            println!("| {what} | {:.1} | {:.1} |", cost.wall, cost.busy);
        }
        let [wall, busy] = [one.wall + four.wall + five.wall, one.busy + four.busy + five.busy];
        println!("| together | {wall:.1} | {busy:.1} |\n");
    }
    Ok(())
}

/// A test with its recording.
struct Recorded {
    test: &'static str,
    recording: PathBuf,
    /// The multipliers to be found: those of the scenario (Table 8).
    expected: [f64; 3],
}

/// Wall time and CPU time, s.
struct Cost {
    wall: f64,
    busy: f64,
}

/// Calls `work` and measures its cost.
fn timed<T>(work: impl FnOnce() -> Outcome<T>) -> Outcome<(T, Cost)> {
    let (begin, before) = (Instant::now(), busy());
    let done = work()?;
    Ok((done, Cost { wall: begin.elapsed().as_secs_f64(), busy: busy() - before }))
}

/// CPU time of all threads of this process so far, s, from Linux in steps of 0.01 s; not a number elsewhere.
fn busy() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or_default();
    let tick = |place: usize| fields.split_whitespace().nth(place).and_then(|f| f.parse::<f64>().ok());
    tick(11).zip(tick(12)).map_or(f64::NAN, |(user, system)| (user + system) / 100.0)
}

fn scenario(test: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenarios/drop/{test}.toml"))
}

/// Runs a test and writes its signals as its recording.
fn record(test: &'static str, folder: &Path) -> Outcome<Recorded> {
    let document = Document::read(&scenario(test)).map_err(rendered)?;
    let resolved: toml::Table = document.resolved().parse()?;
    let scale = &resolved["specimen"]["material"]["fabric"]["scale"];
    let expected = ["k1", "ke", "ky"].map(|name| scale[name].as_float().unwrap_or(f64::NAN));
    let mut model = model::check(&document.with(&[change("output.frames=1")?])).map_err(rendered)?;
    (model.reference, model.post) = (None, None);
    let outcome = simulate::run(&model, &mut |_| {})?;
    let results = Plan::prepare(&model)?.measure(&model, &outcome)?;
    let recording = folder.join(format!("{test}.csv"));
    csv::write(&results.signals, &mut File::create(&recording)?)?;
    Ok(Recorded { test, recording, expected })
}

/// Searches the multipliers of all of `tests` from `start` and prints them. Returns those of the first, and the cost.
fn identify(tests: &[Recorded], method: &str, start: [f64; 3]) -> Outcome<([f64; 3], Cost)> {
    let mut args = Map::new();
    args.insert("method".into(), method.into());
    args.insert("start".into(), start.map(|k| k.to_string()).join(",").into());
    args.insert("count".into(), i64::try_from(tests.len())?.into());
    for (place, test) in tests.iter().enumerate() {
        args.insert(format!("test{place}").into(), scenario(test.test).display().to_string().into());
        args.insert(format!("recording{place}").into(), test.recording.display().to_string().into());
    }
    let (findings, cost) = timed(|| run(args))?;
    let rows = findings.tables.iter().find(|(name, _)| name == "found").map(|(_, rows)| rows);
    let found: Vec<[f64; 3]> =
        tests.iter().zip(rows.ok_or("the script has no table")?).map(|(test, row)| test.print(row)).collect();
    findings.log.iter().for_each(|line| println!("\n{line}"));
    Ok((*found.first().ok_or("no test was searched")?, cost))
}

/// Runs the script with `args`.
fn run(args: Map) -> Outcome<ScriptOutput> {
    let mut engine = functions::engine(Limits::STUDY);
    let collector = OutputCollector::new(Vec::new());
    functions::register_output(&mut engine, &collector);
    scenario_functions::register(&mut engine, &scenario_functions::Scenarios::default());
    identify::register(&mut engine, &SearchHost::new(|_| {}));
    Arguments::register(&mut engine);
    let mut scope = Scope::new();
    scope.push_constant("args", Arguments::new(args));
    let script = Script::compile(&engine, &scope, Path::new("benches/identify.rs"), SCRIPT);
    script.map_err(|faults| faults[0].clone())?.run(&engine, scope)?;
    Ok(collector.output())
}

/// All tests with the averaged film, as for Table 9.
fn averaged(tests: &[Recorded]) -> Outcome<Cost> {
    let film = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/materials/lldpe-averaged.toml");
    let changes = [change(&format!("specimen.material={}", film.display()))?];
    let model = |test: &Recorded| {
        let document = Document::read(&scenario(test.test)).map_err(rendered)?.with(&changes);
        Ok(model::check(&document).map_err(rendered)?)
    };
    let models = tests.iter().map(model).collect::<Outcome<Vec<_>>>()?;
    let runs = || models.par_iter().map(|model| simulate::run(model, &mut |_| {}).map(drop)).collect::<Result<(), _>>();
    Ok(timed(|| Ok(runs()?))?.1)
}

impl Recorded {
    fn print(&self, row: &Row) -> [f64; 3] {
        let number = |name: &str| row[name].as_f64().unwrap_or(f64::NAN);
        let k = ["k1", "ke", "ky"].map(number);
        let off = k.iter().zip(self.expected).map(|(k, expected)| (k / expected - 1.0).abs()).fold(0.0, f64::max);
        let [iterations, evaluations] = ["iterations", "evaluations"].map(|name| &row[name]);
        print!("| {} | {iterations} | {evaluations} | {:.3} | {:.3} | {:.3} ", self.test, k[0], k[1], k[2]);
        println!("| {:.2} % | {:.2e} |", 100.0 * off, number("f"));
        k
    }
}

fn change(text: &str) -> Outcome<Assignment> {
    Ok(Assignment::from_argument(text).map_err(rendered)?)
}

fn rendered(mistakes: Vec<diagnostic::Diagnostic>) -> String {
    diagnostic::render(&mistakes, false)
}
