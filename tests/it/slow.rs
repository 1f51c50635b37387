//! Slow indentation and inflation through the built binary: their results, and how they end.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value as Json;
use tempfile::TempDir;

use droptower::signal::{Recording, csv};

use crate::workbench::{droptower, figure, summary};

/// A folder with the template of a slow test in it, made coarse and quick.
fn bench(kind: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(droptower(folder.path(), &["new", kind, "slow.toml"]).status.success());
    folder
}

/// Runs the scenario with changes; its exit status, signals and summary.
fn run(folder: &Path, changes: &[&str]) -> (Output, Recording, Json) {
    let changes =
        ["specimen.mesh.size=5mm", "output.frames=4"].iter().chain(changes).flat_map(|change| ["--set", change]);
    let arguments: Vec<&str> = ["run", "slow.toml"].into_iter().chain(changes).collect();
    let output = droptower(folder, &arguments);
    let place = if output.status.success() { "runs/slow" } else { "runs/slow.failed" };
    let place = folder.join(place);
    let signals = csv::read(&place.join("signals.csv"))
        .unwrap_or_else(|error| panic!("{error}: {}", standard_error_and_output(&output)));
    (output, signals, summary(&place))
}

fn standard_error_and_output(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat()
}

fn header(folder: &Path) -> String {
    let text = fs::read_to_string(folder.join("runs/slow/signals.csv")).expect("signals");
    text.lines().next().expect("a header").to_owned()
}

fn last(signals: &Recording, name: &str) -> f64 {
    *signals.channel(name).and_then(<[f64]>::last).expect("a sample")
}

#[test]
fn an_indentation_records_depth_and_force() {
    let bench = bench("indent");
    let (output, signals, summary) = run(bench.path(), &["loading.indent.depth=15mm"]);
    assert_eq!(output.status.code(), Some(0), "{}", standard_error_and_output(&output));
    assert_eq!(header(bench.path()), "time_s,depth_m,force_N");
    assert_eq!(signals.channel("depth_m").map(|depth| depth[0]), Some(0.0), "the depth starts at first contact");
    assert!((last(&signals, "depth_m") - 0.015).abs() < 1e-12);
    assert_eq!(figure(&summary, "final_force_N"), last(&signals, "force_N"));
    assert!(figure(&summary, "kinetic_share") < 1e-3);
    assert!(figure(&summary, "energy_balance_error") < 1e-3);
    // What the impactor gave is the integral of its force, and what the film and damping took.
    let energies = csv::read(&bench.path().join("runs/slow/energies.csv")).expect("energies");
    let given = -last(&energies, "external_J");
    assert!((figure(&summary, "work_J") / given - 1.0).abs() < 0.02, "{} of {given}", summary["work_J"]);
    // Also on such coarse elements, of which one alone touches the ball near the pole.
    let friction = energies.channel("friction_J").expect("a channel");
    assert!(friction.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12), "friction takes energy");
    assert!(standard_error_and_output(&output).contains("kinetic share 0.0"));
}

#[test]
fn an_inflation_comes_to_rest() {
    let bench = bench("pressure");
    let (output, signals, summary) = run(bench.path(), &[]);
    assert_eq!(output.status.code(), Some(0), "{}", standard_error_and_output(&output));
    assert_eq!(header(bench.path()), "time_s,pressure_Pa,deflection_m,volume_m3");
    assert_eq!(last(&signals, "pressure_Pa"), 5e3);
    assert_eq!(figure(&summary, "final_deflection_m"), last(&signals, "deflection_m"));
    assert!(figure(&summary, "settling") < 1e-6);
    assert!(figure(&summary, "energy_balance_error") < 1e-4);
}

/// Quarter and whole film; slow and slower, each with a mass of its own.
#[test]
fn neither_symmetry_nor_speed_changes_the_result() {
    let bench = bench("indent");
    let force = |changes: &[&str]| {
        let all = [
            &["loading.indent.depth=15mm", thorough::choose("specimen.mesh.size=6mm", "specimen.mesh.size=2.5mm")],
            changes,
        ]
        .concat();
        last(&run(bench.path(), &all).1, "force_N")
    };
    let quarter = force(&[]);
    let whole = force(&["specimen.symmetry=none"]);
    let faster = force(&["loading.indent.velocity=0.02 m/s", "output.sample_rate=100Hz"]);
    for (other, bound) in [(whole, thorough::choose(4e-3, 3e-4)), (faster, 5e-3)] {
        assert!((other / quarter - 1.0).abs() < bound, "{other} for {quarter}");
    }
}

#[test]
fn a_run_that_is_not_quasi_static_fails_and_is_stored() {
    let bench = bench("indent");
    let fast = ["loading.indent.velocity=10 m/s", "output.sample_rate=20 kHz"];
    let (output, signals, summary) = run(bench.path(), &fast);
    assert_eq!(output.status.code(), Some(3), "{}", standard_error_and_output(&output));
    let said = standard_error_and_output(&output);
    assert!(said.contains("not quasi-static: at 0.00"), "{said}");
    assert!(signals.time.len() > 10 && figure(&summary, "kinetic_share") > 0.01);
    let cause = fs::read_to_string(bench.path().join("runs/slow.failed/failure.txt")).expect("a cause");
    assert!(cause.contains("load it more slowly"), "{cause}");
}

/// A film that breaks ends the test: its last sample is the last before the break.
#[test]
fn a_break_ends_the_test() {
    let brittle = "specimen.material.fabric.md={curve=[[0.05,'5 MPa'],[0.1,'6 MPa']]}";
    let (burst, puncture) = (bench("pressure"), bench("indent"));
    let (output, signals, summary) = run(burst.path(), &[brittle]);
    assert_eq!(output.status.code(), Some(0), "{}", standard_error_and_output(&output));
    assert_eq!(summary["ruptured"], true);
    assert_eq!(figure(&summary, "burst_pressure_Pa"), last(&signals, "pressure_Pa"));
    let said = standard_error_and_output(&output);
    assert!(last(&signals, "pressure_Pa") < 5e3 && said.contains("burst pressure"), "{said}");

    let film = "specimen.material.fabric={md={curve=[[0.02,'5 MPa'],[0.04,'6 MPa']]},td={curve=[[0.02,'5 MPa'],[2,'6 MPa']]},\
                shear={curve=[[1,'5 MPa']]}}";
    let (output, signals, summary) = run(puncture.path(), &[film, "loading.indent.depth=12mm"]);
    assert_eq!(output.status.code(), Some(0), "{}", standard_error_and_output(&output));
    let depth = figure(&summary, "depth_at_break_m");
    // A sample is a mean from half an interval before it to half after it, which the break may cut.
    assert!(depth < 0.012 && (last(&signals, "depth_m") - depth).abs() < 1.5 * 4e-3 / 20.0, "{depth}");
}
