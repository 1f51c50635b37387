//! Large and long runs: interrupted and resumed, forecast, within memory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::{Duration, SystemTime};

use serde_json::Value as Json;
use thorough::thorough;

use droptower::model::{Model, Motion};
use droptower::post::OF_THE_MACHINE;
use droptower::signal::Recording;
use droptower::simulate::{self, Checkpoint, Checkpoints, Outcome, Restart, RunError, RunOptions, Warning};

use crate::verification::tower::shipped;
use crate::workbench::{self, await_of, command, drop_bench, droptower, error, printed, refused, told};

/// Some tens of milliseconds of computing between two checkpoints: enough time to kill the run there. Few snapshots are written.
const SLOW: [&str; 8] = [
    "--set",
    "specimen.mesh.size=10mm",
    "--set",
    "specimen.symmetry=none",
    "--set",
    "loading.impact.duration=6ms",
    "--set",
    "output.frames=4",
];

fn run(folder: &Path, arguments: &[&str]) -> Output {
    droptower(folder, &[&["run", "drop.toml"], arguments].concat())
}

/// Checkpoints in the folder of `drop.toml`, oldest first.
fn checkpoints(bench: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(bench.join("runs/drop.checkpoint")).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "state")).collect();
    paths.sort();
    paths
}

/// Starts a run and kills it once it has left `count` checkpoints. One that ends before, on a busy machine, is started over.
fn killed_after(count: usize, bench: &Path, arguments: &[&str]) {
    loop {
        let mut command = command(bench, &[&["run", "drop.toml"], arguments].concat());
        let mut child = command.stderr(Stdio::null()).stdout(Stdio::null()).spawn().expect("the binary starts");
        let left = await_of(&mut child, || checkpoints(bench).len() >= count);
        child.kill().expect("killed");
        child.wait().expect("gone");
        if left && !bench.join("runs/drop").exists() {
            return;
        }
        fs::remove_dir_all(bench.join("runs/drop")).expect("a run that has ended");
    }
}

/// The summary without the figures of the machine.
fn summary(folder: &Path) -> Json {
    let mut summary = workbench::summary(folder);
    let figures = summary.as_object_mut().expect("figures");
    for of_this_run in OF_THE_MACHINE {
        assert!(figures.remove(of_this_run).is_some());
    }
    summary
}

#[test]
fn a_killed_run_resumes_to_the_same_bits() {
    let bench = drop_bench();
    printed(&run(bench.path(), &[&SLOW[..], &["--out", "runs/through", "--quiet"]].concat()));
    killed_after(1, bench.path(), &[&SLOW[..], &["--checkpoint-every", "1 ms"]].concat());
    // Taken up with the same interval and another number of threads.
    let told = told(&run(bench.path(), &[&SLOW[..], &["--resume", "--threads", "1"]].concat()));
    assert!(told.contains("note: drop resumes at "), "{told}");
    let (one, other) = (bench.path().join("runs/through"), bench.path().join("runs/drop"));
    for name in ["signals.csv", "energies.csv", "scenario.toml"] {
        let content = |folder: &Path| fs::read(folder.join(name)).expect("a file");
        assert!(content(&one) == content(&other), "{name} differs");
    }
    assert_eq!(summary(&one), summary(&other));
    assert!(!bench.path().join("runs/drop.checkpoint").exists(), "what is done needs no checkpoints");
}

#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let bench = drop_bench();
    killed_after(1, bench.path(), &[&SLOW[..], &["--checkpoint-every", "1 ms"]].concat());
    for (changed, expected) in [
        ("layers.count=9", "there `layers.count` is 8, here it is 9"),
        ("specimen.material.density=916", "there `specimen.material.density` is \""),
        ("output.frames=100", "`output.frames`"),
        ("solver.step_factor=0.5", "`solver.step_factor`"),
    ] {
        let said = refused(&run(bench.path(), &[&SLOW[..], &["--resume", "--set", changed]].concat()), expected);
        assert!(said.contains("is of another run"), "{changed}: {said}");
    }
    refused(&run(bench.path(), &[&SLOW[..], &["--resume", "--vtu"]].concat()), "it was started without --vtu");
    let output = run(bench.path(), &[&SLOW[..], &["--checkpoint-every", "1 ms"]].concat());
    for expected in ["an unfinished run left checkpoints", "--resume continues from there"] {
        refused(&output, expected);
    }
    // What is read after the run may change.
    fs::write(bench.path().join("post.rhai"), "measure(\"more\", 1);").expect("a script");
    let more = ["--resume", "--quiet", "--set", "post.script=post.rhai"];
    assert_eq!(told(&run(bench.path(), &[&SLOW[..], &more].concat())), "");
    assert_eq!(summary(&bench.path().join("runs/drop"))["more"], 1);
}

#[test]
fn a_batch_resumes_with_one_run_complete_and_one_not_started() {
    let bench = drop_bench();
    let [done, later] = ["done.toml", "later.toml"];
    for copy in [done, later] {
        fs::copy(bench.path().join("drop.toml"), bench.path().join(copy)).expect("a copy");
    }
    let all = [&["run", done, "drop.toml", later, "--resume"][..], &SLOW].concat();
    let said = refused(&droptower(bench.path(), &all), "there is no checkpoint in");
    assert_eq!(said.matches("there is no checkpoint in").count(), 3, "{said}");
    printed(&droptower(bench.path(), &[&["run", done, "--quiet"][..], &SLOW].concat()));
    killed_after(1, bench.path(), &[&SLOW[..], &["--checkpoint-every", "1 ms"]].concat());
    let said = told(&droptower(bench.path(), &all));
    for expected in [
        "note: drop resumes at ",
        "note: later starts from its beginning: there is no checkpoint in runs/later.checkpoint\n",
        "note: done is complete: runs/done\n",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
    let signals = |name: &str| fs::read(bench.path().join("runs").join(name).join("signals.csv")).expect("signals");
    assert!(signals("done") == signals("drop") && signals("later") == signals("drop"), "the signals differ");
    assert!(!bench.path().join("runs/later.checkpoint").exists());
    // A batch that is complete is left as it is; a scenario that has changed is not complete.
    let written = |name: &str| {
        let summary = bench.path().join("runs").join(name).join("summary.json");
        fs::metadata(summary).and_then(|about| about.modified()).expect("a time")
    };
    let before = [written("done"), written("later")];
    let said = told(&droptower(bench.path(), &all));
    assert_eq!(said.matches(" is complete: runs/").count(), 3, "{said}");
    let text = fs::read_to_string(bench.path().join(later)).expect("a scenario");
    let changed = text.replace("title = \"Drop test", "title = \"Another drop test");
    fs::write(bench.path().join(later), changed).expect("a scenario");
    let output = droptower(bench.path(), &all);
    assert_eq!(error(&output).matches(" is complete: runs/").count(), 2, "{}", error(&output));
    assert!(written("done") == before[0] && written("later") > before[1]);
    // A run without files for ParaView is not what is asked for.
    let for_paraview = [&["run", done, "--resume", "--vtu"][..], &SLOW].concat();
    let said = refused(&droptower(bench.path(), &for_paraview), "done is complete without ParaView files: runs/done");
    assert!(said.contains("run it without --resume for its ParaView files"), "{said}");
}

/// Whether a run of a batch is complete follows from what its files hold, not from their times.
#[test]
fn a_complete_run_is_known_by_the_content_of_its_files() {
    let bench = drop_bench();
    let path = |name: &str| bench.path().join(name);
    let set_time = |name: &str, time: SystemTime| {
        let file = fs::File::options().append(true).open(path(name)).expect("a file");
        file.set_modified(time).expect("a time");
    };
    fs::write(path("post.rhai"), "measure(\"more\", 1)").expect("a script");
    fs::write(path("one.toml"), "extends = \"drop.toml\"\npost.script = \"post.rhai\"\n").expect("a scenario");
    fs::write(path("other.toml"), "extends = \"drop.toml\"\n").expect("a scenario");
    let quick = ["--set", "specimen.mesh.size=80mm", "--set", "loading.impact.duration=1ms"];
    let all = [&["run", "one.toml", "other.toml"][..], &quick].concat();
    assert!(droptower(bench.path(), &all).status.success());
    let resumed = || error(&droptower(bench.path(), &[&all[..], &["--resume"]].concat()));
    set_time("post.rhai", SystemTime::now() + Duration::from_secs(60));
    assert_eq!(resumed().matches(" is complete: runs/").count(), 2, "only its time has changed");
    fs::write(path("post.rhai"), "measure(\"more\", 2)").expect("a script");
    set_time("post.rhai", SystemTime::now() - Duration::from_secs(3600));
    assert_eq!(resumed().matches(" is complete: runs/").count(), 1, "its content has changed");
    assert_eq!(summary(&path("runs/one"))["more"], 2);
    let one = droptower(bench.path(), &[&["run", "one.toml", "--resume", "--json"][..], &quick].concat());
    assert!(error(&one).contains("note: one is complete: runs/one"), "{}", error(&one));
    let printed: Json = serde_json::from_slice(&one.stdout).expect("its stored figures");
    assert_eq!(printed["more"], 2);
}

#[test]
fn a_run_resumes_from_the_checkpoint_before_a_damaged_one() {
    let bench = drop_bench();
    killed_after(2, bench.path(), &[&SLOW[..], &["--checkpoint-every", "1 ms"]].concat());
    let all = checkpoints(bench.path());
    let [rest @ .., older, newer] = &all[..] else { panic!("{all:?}") };
    rest.iter().for_each(|path| fs::remove_file(path).expect("a checkpoint"));
    let whole = fs::read(newer).expect("a checkpoint");
    fs::write(newer, &whole[..whole.len() / 2]).expect("cut in half");
    let resumed = [&SLOW[..], &["--resume"]].concat();
    fs::write(older, "").expect("emptied");
    refused(&run(bench.path(), &resumed), "is whole: ");
    let mut turned = whole.clone();
    turned[whole.len() / 3] ^= 4;
    fs::write(newer, &turned).expect("one bit turned");
    // The newer one, whole, under the older one's name stands in for a whole older one.
    fs::write(older, &whole).expect("restored");
    let said = told(&run(bench.path(), &resumed));
    assert!(said.contains("is damaged; "), "{said}");
}

/// A run that would take hours says so, and is killed.
#[test]
fn a_run_of_hours_has_a_forecast() {
    let bench = drop_bench();
    let long = ["--set", "specimen.mesh.size=1mm", "--set", "specimen.symmetry=none"];
    let long = [&long[..], &["--set", "loading.impact.duration=5s", "--set", "output.filter=none"]].concat();
    let slow = [&long[..], &["--set", "output.sample_rate=1kHz"]].concat();
    let told = bench.path().join("stderr");
    let mut command = command(bench.path(), &[&["run", "drop.toml"], &slow[..]].concat());
    let mut child =
        command.stderr(fs::File::create(&told).expect("a file")).stdout(Stdio::null()).spawn().expect("a run");
    let read = || fs::read_to_string(&told).expect("a text");
    let has_forecast = await_of(&mut child, || read().contains("--checkpoint-every"));
    child.kill().expect("killed");
    child.wait().expect("gone");
    let told = read();
    assert!(has_forecast && told.starts_with("note: drop will take about "), "{told}");
    assert!(told.contains("ns per element step"), "{told}");
}

/// A golden case with a few changes.
fn golden(case: &str, changes: &[&str]) -> Model {
    shipped(&format!("../tests/golden/{case}/scenario.toml"), changes)
}

/// The outcome, and every checkpoint on the way as it would be written.
fn with_checkpoints(model: &Model, every: f64, restart: Option<Restart>) -> (Outcome, Vec<Vec<u8>>) {
    let mut written = vec![];
    let mut keep = |checkpoint: &Checkpoint<'_>| written.push(postcard::to_stdvec(checkpoint).expect("plain numbers"));
    let checkpoints = Checkpoints { every, write: &mut keep };
    let options = RunOptions { restart, checkpoints: Some(checkpoints), detailed: true, ..RunOptions::default() };
    let outcome = simulate::run_with(model, options, &mut |_| {});
    (outcome.unwrap_or_else(|error| panic!("{}: {error}", model.name)), written)
}

fn bits(recording: &Recording) -> Vec<u64> {
    let values = recording.channels.iter().flat_map(|channel| &channel.values);
    recording.time.iter().chain(values).map(|value| value.to_bits()).collect()
}

fn assert_same(one: &Outcome, other: &Outcome, what: &str) {
    assert!(bits(&one.signals) == bits(&other.signals), "{what}: the signals differ");
    assert!(bits(&one.energies) == bits(&other.energies), "{what}: the energies differ");
    let untimed = |outcome: &Outcome| format!("{:?}", Outcome { wall: Duration::ZERO, ..outcome.clone() });
    assert!(untimed(one) == untimed(other), "{what}: something besides signals and energies differs");
}

/// Resumes a golden case with these changes: from its second checkpoint, or from each of them.
fn a_run_resumes_to_the_same_bits(case: &str, changes: &[&str]) {
    let mut model = golden(case, changes);
    let times = (0..8).map(|part| model.run_time() * f64::from(part) / 8.0).collect();
    model.output.motion = Some(Motion { face: 0, times });
    let every = 0.22 * model.run_time();
    let (through, written) = with_checkpoints(&model, every, None);
    let settled = through.relaxation.is_some_and(|relaxation| relaxation.steps > 0);
    assert_eq!(written.len(), 4 + usize::from(settled), "{case}");
    if thorough() {
        let detailed = RunOptions { detailed: true, ..RunOptions::default() };
        let without = simulate::run_with(&model, detailed, &mut |_| {});
        let without = without.unwrap_or_else(|error: RunError| panic!("{case}: {error}"));
        assert_same(&without, &through, case);
    }
    // Behind that of film that has settled.
    let second = 1 + usize::from(settled);
    for number in if thorough() { 0..written.len() } else { second..second + 1 } {
        let restart: Restart = postcard::from_bytes(&written[number]).expect("what was written");
        let (resumed, again) = with_checkpoints(&model, every, Some(restart));
        assert_same(&through, &resumed, &format!("{case} from checkpoint {number}"));
        assert_eq!(again.len(), written.len() - number - 1, "{case}: the checkpoints that were left");
    }
}

const FEW: &str = "output.frames=20";
const SHORT: &str = "loading.impact.duration=25ms";
const THERMAL: &str = "specimen.material.thermal={ heat = 2300, softening = 0.05 }";
const SPRINGS: &str = "frame.springs={ stiffness = 4000, count = 80, length = 0.06 }";

// Every law, loading, element and kind of impactor that the golden cases have: rupture, a rotating sphere, faces of
// their own, triangles, a slow test whose mass is scaled, a graded mesh with added mass, bars, film that leaves its
// clamp, film on springs.
thorough::cases!(a_run_resumes_to_the_same_bits {
    rupture: "drop-1508", &[FEW];
    free_sphere: "free-sphere", &[FEW];
    biaxial: "drop-1508", &[FEW, SHORT, "specimen.material.fabric.biaxial=0.5"];
    by_rate: "drop-1508", &[FEW, SHORT, "specimen.material=scenarios/materials/lldpe-rates.toml"];
    guided_box: "free-sphere", &[
        FEW,
        "impactor.guide={ line = [1, 0, -2] }",
        "impactor.shape={ box = { size = [0.1, 0.2, 0.1], edge = 0.02 } }",
    ];
    cylinder: "free-sphere", &[FEW, "impactor.shape={ cylinder = { radius = 0.06, length = 0.12 } }"];
    two_impactors: "two-impactors", &[FEW, "impactor.1.at=20ms"];
    full_integration: "dart-disc", &["specimen.mesh.element=quad4-full"];
    different_faces: "drop-different-faces", &[];
    faces_in_contact: "drop-different-faces", &["contact.film=true", "specimen.damping=20"];
    film_in_contact: "drop-1508", &[FEW, SHORT, "contact.film=true", "specimen.mesh.size=40mm"];
    triangles: "stretch-oblique-triangles", &[];
    stretch: "stretch-md", &[];
    indentation: "indent-disc", &[];
    inflation: "inflation-square", &[];
    rubber: "inflation-rubber", &[];
    viscous: "inflation-viscous", &["specimen.material.hyperelastic.wrinkling=false"];
    viscous_drop: "drop-viscous", &[FEW];
    plastic: "stretch-plastic", &[];
    plastic_and_warm: "stretch-plastic", &[THERMAL];
    plastic_drop: "drop-plastic", &[FEW, "specimen.mesh.element=quad4-full"];
    tear: "stretch-tear", &[];
    tear_in_a_drop: "drop-tear", &[FEW];
    tear_and_warm: "drop-tear", &[FEW, THERMAL];
    polygon: "dart-polygon", &[FEW];
    bars: "drop-bars", &[FEW, "loading.impact.duration=15ms"];
    clamp: "drop-bars", &[
        FEW,
        "frame.clamp={ force = \"200 N\", friction = 0.5, width = \"2 mm\" }",
        "layers.prestrain={ md = 0.0, td = 0.0 }",
        "loading.impact.duration=15ms",
    ];
    // Film that settles before the test, with air between its faces.
    air: "drop-1508", &[
        FEW,
        SHORT,
        "specimen.mesh.size=25mm",
        "specimen.symmetry=none",
        "specimen.md_angle=30deg",
        "air.cushion=adiabatic",
    ];
    springs: "drop-1508", &[FEW, SHORT, "specimen.mesh.size=20mm", SPRINGS];
});

/// The share of the work that film returned at the first tip where that decided is kept, and not found anew at another tip.
#[test]
fn a_resumed_run_keeps_the_share_that_film_returned() {
    let share = |outcome: &Outcome| {
        let found =
            |warning: &Warning| if let Warning::TearByLimit { share } = warning { Some(share.to_bits()) } else { None };
        outcome.warnings.iter().find_map(found)
    };
    let changes = [
        "specimen.mesh.size=8mm",
        "specimen.symmetry=none",
        "specimen.cuts=[[[\"-20 mm\", \"30 mm\"], [\"20 mm\", \"30 mm\"]]]",
        "specimen.material.rupture={ criterion = \"strain\", limit = 2.0, energy = \"60 kJ/m2\" }",
    ];
    let model = golden("drop-plastic", &changes);
    let every = 0.4 * model.run_time();
    let (through, written) = with_checkpoints(&model, every, None);
    let found = share(&through).expect("film that returns little");
    let last = written.last().expect("checkpoints");
    // It was found before the checkpoint.
    let before = format!("loading.impact.duration={} ms", 0.8e3 * model.run_time());
    let until =
        simulate::run(&golden("drop-plastic", &[&changes[..], &[&before]].concat()), &mut |_| {}).expect("a run");
    assert_eq!(share(&until), Some(found));
    let (resumed, _) = with_checkpoints(&model, every, Some(postcard::from_bytes(last).expect("what was written")));
    assert_eq!(share(&resumed), Some(found));
    assert_same(&through, &resumed, "resumed after the finding");
}

/// A run resumed from the checkpoint behind the equilibrium of its film does not settle again; one that is cancelled
/// while it settles ends there.
#[test]
fn film_settles_once() {
    let model = golden("drop-different-faces", &[]);
    let (outcome, written) = with_checkpoints(&model, 1.0, None);
    let settled = outcome.relaxation.expect("held film");
    assert!(settled.steps > 0);
    assert_eq!(written.len(), 1, "the equilibrium has a checkpoint");
    let settling = |restart: Option<Restart>| {
        let mut seen: Vec<f64> = vec![];
        let options = RunOptions { restart, ..RunOptions::default() };
        let mut progress = |progress: simulate::Progress| seen.extend(progress.settling.map(|s| s.residual));
        simulate::run_with(&model, options, &mut progress).expect("a run");
        seen
    };
    let seen = settling(None);
    assert!(seen.first() > seen.last(), "{seen:?}");
    let restart: Restart = postcard::from_bytes(&written[0]).expect("what was written");
    assert_eq!(settling(Some(restart)), Vec::<f64>::new());
    let cancellation = simulate::Cancellation::default();
    let mut stepped = false;
    let mut cancel = |progress: simulate::Progress| {
        stepped |= progress.settling.is_none();
        cancellation.cancel();
    };
    let options = RunOptions { cancellation: cancellation.clone(), ..RunOptions::default() };
    let cancelled = simulate::run_with(&model, options, &mut cancel);
    assert!(matches!(cancelled, Err(RunError::Cancelled)) && !stepped);
}

#[test]
fn a_state_of_another_mesh_is_refused() {
    let (_, written) = with_checkpoints(&golden("drop-different-faces", &[]), 20e-3, None);
    let restart: Restart = postcard::from_bytes(&written[0]).expect("what was written");
    let other = golden("free-sphere", &[]);
    let refused =
        simulate::run_with(&other, RunOptions { restart: Some(restart), ..RunOptions::default() }, &mut |_| {});
    assert!(matches!(refused, Err(RunError::StateMismatch(_))), "{refused:?}");
}

/// The shipped drop test on elements of this size (mm), every output on, and as many snapshots as such a mesh has, takes so
/// much memory (kB) at its peak.
#[cfg(target_os = "linux")]
fn many_elements_fit_into_memory(size: f64, elements: u64, memory: std::ops::Range<u64>) {
    let bench = tempfile::tempdir().expect("a folder");
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/drop/1008.toml");
    let mut arguments = vec!["run", shipped.to_str().expect("UTF-8"), "--out", "fine", "--quiet"];
    let size = format!("specimen.mesh.size={size}mm");
    for change in ["specimen.symmetry=none", &size, "loading.impact.duration=8us", "output.sample_rate=5MHz"] {
        arguments.extend(["--set", change]);
    }
    let mut child = command(bench.path(), &arguments).spawn().expect("the binary starts");
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut peak = 0;
    await_of(&mut child, || {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        peak = peak.max(kilobytes.unwrap_or(0));
        false
    });
    assert!(child.wait().expect("gone").success());
    let summary = summary(&bench.path().join("fine"));
    assert!(summary["elements"].as_u64() > Some(elements), "{}", summary["elements"]);
    println!("{peak} kB at the peak");
    assert!(memory.contains(&peak), "{peak} kB at the peak");
}

#[cfg(target_os = "linux")]
thorough::cases!(many_elements_fit_into_memory {
    a_tenth_of_a_million: 1.79, 99_000, 40_000..300_000;
} thorough {
    a_million: 0.566, 990_000, 400_000..2_000_000;
});
