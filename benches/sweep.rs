//! What a sweep of many short runs costs beside its runs: `cargo bench --bench sweep`, or with another number of runs
//! `cargo bench --bench sweep -- 1000`.
//!
//! The runs are of a drop test on a coarse film, 30 ms long, whose mass and friction vary.

use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use droptower::diagnostic;
use droptower::evaluate::Evaluations;
use droptower::scenario::{Assignment, Document};
use droptower::store::EvaluationStore;
use droptower::sweep::{Done, Event, Stop, Sweep, SweepResults, Work};

/// Runs of the sweep.
const RUNS: usize = 10_000;

/// Share of the runs after which the sweep is stopped, to be taken up again.
const STOPPED: f64 = 0.7;

fn main() {
    let asked = std::env::args().skip(1).find_map(|argument| argument.parse().ok());
    let runs = asked.unwrap_or(RUNS);
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = sweep(runs);
    println!("## A sweep of {runs} runs of 50 elements over 30 ms, {} threads\n", rayon::current_num_threads());
    let first = timed(&sweep, folder.path(), Some((STOPPED * runs as f64) as usize));
    let second = timed(&sweep, folder.path(), None);
    let begin = Instant::now();
    let evaluations = Evaluations::new(folder.path());
    let results = SweepResults::from_evaluations(&sweep, &second.done, &evaluations).expect("results");
    let csv = droptower::table::to_csv(&results.table.columns).expect("a table");
    let gathered = begin.elapsed().as_secs_f64();
    println!("| | stopped | taken up |\n|---|---|---|");
    let row = |name: &str, of: &dyn Fn(&Timed) -> String| println!("| {name} | {} | {} |", of(&first), of(&second));
    row("runs computed", &|timed| timed.done.computed.to_string());
    row("runs taken from records", &|timed| timed.done.cache_hits.to_string());
    row("wall time, s", &|timed| format!("{:.1}", timed.wall));
    row("engine time over wall time × threads", &|timed| format!("{:.3}", timed.efficiency()));
    row("until the first run is computed, s", &|timed| format!("{:.2}", timed.taken_up));
    row("resident memory after 100 runs, MB", &|timed| format!("{:.1}", timed.memory[0]));
    row("resident memory at the end, MB", &|timed| format!("{:.1}", timed.memory[1]));
    let stored = EvaluationStore::list(folder.path()).expect("records");
    let bytes: u64 = stored.iter().map(|build| build.bytes).sum();
    let (record, row) = (bytes as f64 / runs as f64, csv.len() / runs);
    println!("\n{record:.0} bytes of records a run; table of {row} bytes a run, gathered in {gathered:.2} s");
}

struct Timed {
    done: Done,
    wall: f64,
    /// Time until a run was computed, s.
    taken_up: f64,
    /// Resident memory after 100 computed runs and at the end, MB.
    memory: [f64; 2],
}

impl Timed {
    fn efficiency(&self) -> f64 {
        self.done.engine_s / (self.wall - self.taken_up) / rayon::current_num_threads() as f64
    }
}

/// The sweep with records in `folder`, stopped after so many runs.
fn timed(sweep: &Sweep, folder: &Path, stop_after: Option<usize>) -> Timed {
    let evaluations = Evaluations::new(folder);
    let stop = Stop::default();
    let work = Work { sweep, evaluations: &evaluations, waits: true, stop: &stop, gather: false };
    let (computed, early, taken_up) = (AtomicUsize::new(0), Mutex::new(0.0), Mutex::new(None));
    let begin = Instant::now();
    let observer = |event: Event<'_>| {
        let Event::Computed(_, evaluation) = event else { return };
        let count = computed.fetch_add(1, Ordering::Relaxed) + 1;
        let since = begin.elapsed().as_secs_f64() - evaluation.wall_s;
        taken_up.lock().expect("a lock").get_or_insert(since);
        if count == 100 {
            *early.lock().expect("a lock") = resident();
        }
        if stop_after.is_some_and(|most| count >= most) {
            stop.given_up.cancel();
        }
    };
    let done = work.run(&observer).expect("a sweep");
    let wall = begin.elapsed().as_secs_f64();
    let taken_up = taken_up.lock().expect("a lock").unwrap_or(wall);
    let early = *early.lock().expect("a lock");
    Timed { done, wall, taken_up, memory: [early, resident()] }
}

/// Resident memory of this process, MB; not known on every platform.
fn resident() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.unwrap_or(f64::NAN) / 1024.0
}

fn sweep(runs: usize) -> Sweep {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/drop/1008.toml");
    let changes = [
        "specimen.mesh.size=80 mm",
        "specimen.symmetry=none",
        "loading.impact.duration=30 ms",
        "variation={ \"impactor.mass\" = { uniform = [10.0, 12.0] }, \"impactor.friction\" = { uniform = [0.1, 0.5] } }",
    ];
    let set = changes.map(|change| sound(Assignment::from_argument(change)));
    let left_out = ["reference", "post"].map(|key| Assignment::unset(key, "bench"));
    let changes: Vec<Assignment> = left_out.into_iter().chain(set).collect();
    let document = sound(Document::read(&path)).with(&changes);
    Sweep::prepare(&document, Some(runs)).expect("a sweep")
}

fn sound<T>(read: Result<T, Vec<diagnostic::Diagnostic>>) -> T {
    read.unwrap_or_else(|mistakes| panic!("{}", diagnostic::render(&mistakes, false)))
}
