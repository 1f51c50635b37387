//! `droptower new`: every template checks, and those of standards give the figures of their standard.

use std::fs;
use std::path::Path;

use serde_json::Value as Json;
use tempfile::TempDir;

use crate::workbench::{close, column, droptower, error, figure, figures, finding_codes, printed, summary};

const STANDARDS: [&str; 6] = ["d1709-a", "d1709-b", "d7192", "d5748", "iso7765-2", "en14477"];
const MATERIALS: &str = "tearing fabric rates elastic neo-hookean compressible-neo-hookean mooney-rivlin yeoh gent ogden plastic \
                         viscous";

#[test]
fn templates_pass_the_check_and_are_not_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    for kind in ["drop", "dart", "coupon", "indent", "pressure", "volume"].iter().chain(&STANDARDS) {
        let path = format!("{kind}.toml");
        printed(&droptower(folder.path(), &["new", kind, &path]));
        assert!(printed(&droptower(folder.path(), &["check", &path])).starts_with("ok"), "{kind}");
        assert_eq!(droptower(folder.path(), &["new", kind, &path]).status.code(), Some(2));
    }
}

/// Every law that the language has, in a scenario.
#[test]
fn materials_pass_the_check_and_can_be_pulled() {
    let folder = tempfile::tempdir().expect("a folder");
    printed(&droptower(folder.path(), &["new", "coupon", "coupon.toml"]));
    for kind in MATERIALS.split(' ') {
        let path = format!("{kind}.toml");
        printed(&droptower(folder.path(), &["new", "material", kind, &path]));
        assert!(printed(&droptower(folder.path(), &["check", &path])).starts_with("ok"), "{kind}");
        let (film, out) = (format!("specimen.material={path}"), format!("runs/{kind}"));
        let changes = [&film, "specimen.mesh.size=5mm", "loading.stretch.until=0.1", "output.frames=4"];
        let changes = changes.map(|change| ["--set", change]).concat();
        printed(&droptower(folder.path(), &[&["run", "coupon.toml", "--out", &out][..], &changes].concat()));
    }
}

#[test]
fn films_of_the_library_pass_the_check_and_are_listed_with_their_sources() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = figures(&droptower(folder.path(), &["new", "material", "--list", "--json"]));
    let list = list.as_array().expect("a list");
    let films: Vec<&Json> = list.iter().filter(|entry| entry["source"].is_string()).collect();
    for name in ["ldpe", "lldpe", "pp", "pet", "pvc", "silicone", "natural-rubber"] {
        let film = films.iter().find(|film| film["name"] == name).unwrap_or_else(|| panic!("{name} is not listed"));
        let path = format!("{name}.toml");
        printed(&droptower(folder.path(), &["new", "material", name, &path]));
        assert!(printed(&droptower(folder.path(), &["check", &path])).starts_with("ok"), "{name}");
        let text = fs::read_to_string(folder.path().join(&path)).expect("a material");
        assert!(text.contains("# Source: ") && text.contains("# Assumed: "), "{text}");
        assert_eq!(film["dart"].is_string(), text.contains("a virtual dart needs"), "{text}");
    }
    assert_eq!(list.len(), MATERIALS.split(' ').count() + films.len());
    let printed = printed(&droptower(folder.path(), &["new", "material", "--list"]));
    assert!(printed.contains("assumed: ") && printed.contains("dart: 40 g at 12 um"), "{printed}");
    assert_eq!(droptower(folder.path(), &["new", "material", "pet"]).status.code(), Some(2), "without a file");
    let gone = droptower(folder.path(), &["new", "material", "tpu", "tpu.toml"]);
    assert!(error(&gone).contains("it was removed: "), "{}", error(&gone));
}

/// The summary of a template after `changes`, run in `folder`.
fn run(folder: &Path, kind: &str, changes: &[&str]) -> Json {
    let path = format!("{kind}.toml");
    let tried = printed(&droptower(folder, &["new", kind, &path]));
    assert!(tried.contains("; try: droptower "), "{tried}");
    let sets = changes.iter().flat_map(|change| ["--set", change]);
    let arguments: Vec<&str> = ["run", &path].into_iter().chain(sets).collect();
    printed(&droptower(folder, &arguments));
    summary(&folder.join("runs").join(kind))
}

/// On meshes twice as coarse, whose figures lie above the shipped ones; the bounds are those of a film that is neither
/// broken at first contact nor stretched to the depth.
#[test]
fn puncture_tests_give_force_travel_and_energy() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [
        ("d7192", "1.5mm", [3.5, 6.5], [30e-3, 40e-3]),
        ("iso7765-2", "1.5mm", [6.0, 9.0], [24e-3, 32e-3]),
        ("d5748", "2.4mm", [4.5, 8.0], [38e-3, 50e-3]),
        ("en14477", "0.15mm", [0.25, 0.45], [3.0e-3, 4.5e-3]),
    ];
    for (kind, size, force, travel) in cases {
        let mesh = format!("specimen.mesh.size={size}");
        let summary = run(folder.path(), kind, &[&mesh, "output.frames=2"]);
        let between = |name: &str, [least, most]: [f64; 2]| {
            let value = figure(&summary, name);
            assert!((least..most).contains(&value), "{kind}: {name} is {value}");
        };
        between("puncture_force_N", force);
        between("break_travel_m", travel);
        // A slow test ends with the break: its last piece, beyond the last sample, counts. Sampled four times as finely it is a
        // quarter as long.
        if kind == "d5748" {
            let other = tempfile::tempdir().expect("a folder");
            let fine = run(other.path(), kind, &[&mesh, "output.frames=2", "output.sample_rate=80 Hz"]);
            close(figure(&summary, "break_energy_J"), figure(&fine, "break_energy_J"), 2e-3);
            close(figure(&summary, "break_travel_m"), figure(&fine, "break_travel_m"), 2e-3);
            let samples = figure(&summary, "puncture_energy_J");
            assert!(figure(&summary, "break_energy_J") > 1.002 * samples, "{kind}: {samples}");
        }
        let energies = ["puncture_energy_J", "break_energy_J", "total_energy_J"].map(|name| figure(&summary, name));
        assert!(energies[1] <= energies[2] * 1.0001 && energies[0] <= energies[2] * 1.0001, "{kind}: {energies:?}");
        // Another way to the same work: the force over the depth, and the energy that the impactor lost.
        if let Some(work) = summary["work_J"].as_f64() {
            close(energies[2], work, 1e-3);
        } else {
            let absorbed = column(&folder.path().join(format!("runs/{kind}/signals.csv")), "absorbed_energy_J");
            close(energies[2], absorbed[absorbed.len() - 1], 5e-3);
        }
    }
    // Both ends of the coupling of MD and TD, in one table.
    printed(&droptower(
        folder.path(),
        &["sweep", "en14477.toml", "--set", "specimen.mesh.size=0.15mm", "--out", "ends"],
    ));
    let forces = column(&folder.path().join("ends/table.csv"), "puncture_force_N");
    assert!(forces.len() == 2 && forces[1] > 1.7 * forces[0], "{forces:?}");
}

/// The bisected mass parts darts that the film holds from those that break it, and the staircase finds it within a
/// step.
fn the_failure_mass_of_a_dart_is_found(kind: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let coarse = "specimen.mesh.size=8mm";
    let path = format!("{kind}.toml");
    printed(&droptower(folder.path(), &["new", kind, &path]));
    let search = ["script", "failure-mass", "--scenario", &path, "--set", coarse, "--arg", "scatter=0", "--force"];
    printed(&droptower(folder.path(), &search));
    let summary = summary(&folder.path().join("runs/failure-mass"));
    let mass = figure(&summary, "threshold_mass_kg");
    for (share, broke) in [(0.98, false), (1.02, true)] {
        let dart = format!("impactor.mass={}", share * mass);
        let changes = [coarse, &dart, "output.frames=4"].map(|change| ["--set", change]).concat();
        let output = droptower(folder.path(), &[&["run", &path, "--json"][..], &changes].concat());
        let runs = figures(&output);
        assert!(runs.to_string().contains(&format!("\"ruptured\":{broke}")), "{kind} at {share}: {runs}");
    }
    close(figure(&summary, "failure_mass_kg"), mass, 0.08);
    assert_eq!(summary["tables"]["drops"].as_array().map(Vec::len), Some(20));
    // Specimens that are alike tell no deviation, and why; what no coupon tells moves the mass all the same.
    assert!(summary["failure_mass_low_kg"].is_null() && summary["failure_mass_deviation_kg"].is_null(), "{summary}");
    assert!(finding_codes(&summary).contains(&"no-strength-fit"), "{summary}");
    let [low, high] = ["threshold_range_low_kg", "threshold_range_high_kg"].map(|name| figure(&summary, name));
    assert!(low < 0.8 * mass && high > 1.3 * mass, "{kind}: {low} and {high} kg about {mass} kg");
    let rows = summary["tables"]["range"].as_array().expect("a range");
    let row = |change: &str| {
        let of = |row: &&Json| row["change"].as_str().is_some_and(|text| text.starts_with(change));
        let row = rows.iter().find(of).unwrap_or_else(|| panic!("{change}: {summary}"));
        1e-3 * row["mass_g"].as_f64().expect("a mass")
    };
    // On so coarse a mesh the threshold of none is not told.
    assert!(rows.len() == 7 && summary["threshold_fine_mesh_kg"].is_null(), "{summary}");
    let answer = summary["answer"].as_str().expect("an answer");
    assert!(answer.starts_with("The mesh is too coarse to tell") && answer.contains("leave open"), "{answer}");
    assert_eq!(answer.matches(". ").count(), 2, "three sentences: {answer}");
    for (lower, higher) in [
        ("friction of the dart 0 ", "as in the scenario"),
        ("break strain times 0.2", "as in the scenario"),
        ("softened by its own heat", "as in the scenario"),
        ("as in the scenario", "friction of the dart 0.5"),
        ("as in the scenario", "break strain times 1.76"),
        ("as in the scenario", "MD and TD coupled"),
    ] {
        assert!(row(lower) < 0.98 * row(higher), "{kind}: {lower} {}, {higher} {}", row(lower), row(higher));
    }
    let ends = ["low", "high"].map(|end| rows.iter().find(|row| row["end"] == end).expect("an end"));
    close(1e-3 * ends[0]["mass_g"].as_f64().expect("a mass"), low, 1e-9);
    close(1e-3 * ends[1]["mass_g"].as_f64().expect("a mass"), high, 1e-9);
}

thorough::cases!(the_failure_mass_of_a_dart_is_found {
    d1709_a: "d1709-a";
} thorough {
    d1709_b: "d1709-b";
});

#[test]
fn the_failure_mass_of_scattered_specimens_is_found() {
    let folder = dart();
    let (first, answer) = failure_mass(&folder, &["--arg", "range=0"]);
    for name in ["failure_mass", "failure_mass_deviation"] {
        let [low, value, high] = ["_low_kg", "_kg", "_high_kg"].map(|end| figure(&first, &format!("{name}{end}")));
        assert!(0.0 < low && low < value && value < high, "{first}");
    }
    assert!(first["threshold_range_low_kg"].is_null(), "{first}");
    let doubted = |answer: &str| answer.contains("20 to 60 % of theirs");
    assert!(doubted(&answer), "{answer}");
    assert!(finding_codes(&first).contains(&"break-strain-of-coupons"), "{first}");
    // A break strain that was found is not that of coupons.
    let moved = ["--arg", "range=0", "--set", "specimen.material.fabric.md.break_factor=0.9"];
    let (_, answer) = failure_mass(&folder, &[&moved[..], &ONE].concat());
    assert!(!doubted(&answer), "{answer}");
}

/// A dart that falls through: what it took to break the film, and nothing of what came after. Film without a criterion cannot break.
#[test]
fn the_answer_of_a_run_is_its_verdict() {
    let folder = tempfile::tempdir().expect("a folder");
    printed(&droptower(folder.path(), &["new", "d1709-a", "dart.toml"]));
    let coarse = ["--set", "specimen.mesh.size=8mm", "--set", "output.frames=4", "--unset", "post", "--json"];
    let run = |more: &[&str]| {
        figures(&droptower(folder.path(), &[&["run", "dart.toml", "--force"][..], &coarse, more].concat()))
    };
    let page = || fs::read_to_string(folder.path().join("runs/dart/report.html")).expect("a page");
    let lead =
        |page: &str| page.split("class=\"lead\">").nth(1).and_then(|rest| rest.split("</p>").next()).map(str::to_owned);
    let broke = run(&["--out", "runs/dart", "--set", "impactor.mass=1kg"]).to_string();
    let answer = lead(&page()).expect("an answer");
    let parts = ["The film ruptured at ", "force ", "travel ", "energy "];
    assert!(parts.iter().all(|part| answer.contains(part)), "{answer}");
    assert!(!answer.contains("lowest") && !page().contains("lowest so far"), "{answer}");
    assert!(!broke.contains("\"unfinished\"") && broke.contains("\"verdict\":\"ruptured\""), "{broke}");
    let edges: Vec<f64> = broke
        .split("\"edge_over_radius\":")
        .skip(1)
        .filter_map(|rest| rest.split([',', '}']).next()?.parse().ok())
        .collect();
    assert!(edges.iter().all(|edge| *edge < 4.0), "edges of torn film count: {edges:?}");
    let film = "specimen.material={density=915,thickness=1e-4,elastic={young=3e7,poisson=0.4}}";
    let whole = run(&["--out", "runs/dart", "--set", film]).to_string();
    assert!(whole.contains("\"verdict\":\"cannot break\""), "{whole}");
    assert!(page().contains("The film cannot break, as it has no break criterion"), "{:?}", lead(&page()));
    let early = run(&["--out", "runs/dart", "--set", film, "--set", "loading.impact.duration=2ms"]).to_string();
    assert!(early.contains("\"verdict\":\"cannot break\""), "{early}");
    let early = run(&["--out", "runs/dart", "--set", "loading.impact.duration=2ms"]).to_string();
    assert!(early.contains("\"verdict\":\"still descending\""), "{early}");
}

/// A folder with the scenario of a dart.
fn dart() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    printed(&droptower(folder.path(), &["new", "d1709-a", "d1709-a.toml"]));
    folder
}

/// The study of a dart on coarse film.
const STUDY: [&str; 7] =
    ["script", "failure-mass", "--scenario", "d1709-a.toml", "--set", "specimen.mesh.size=12mm", "--force"];

/// No scatter of specimens.
const ONE: [&str; 2] = ["--arg", "specimens=0"];

/// The study with what `more` says, which takes the runs of those before it, and its answer.
fn failure_mass(folder: &TempDir, more: &[&str]) -> (Json, String) {
    printed(&droptower(folder.path(), &[&STUDY[..], more].concat()));
    let summary = summary(&folder.path().join("runs/failure-mass"));
    let answer = summary["answer"].as_str().expect("an answer").to_owned();
    (summary, answer)
}

/// A break strain that was found is varied within its interval alone, and not at all without one; elements that are too coarse are
/// in the headline.
#[test]
fn a_known_break_strain_is_not_varied() {
    let factor = ["md", "td"].map(|side| format!("specimen.material.fabric.{side}.break_factor=0.44"));
    let known = [&ONE[..], &["--set", &factor[0], "--set", &factor[1]]].concat();
    let changes = |summary: &Json| -> Vec<String> {
        let rows = summary["tables"]["range"].as_array().expect("a range");
        let changes = rows.iter().filter_map(|row| Some(row["change"].as_str()?.to_owned()));
        changes.filter(|row| row.contains("break")).collect()
    };
    let folder = dart();
    let (summary, answer) = failure_mass(&folder, &known);
    assert!(changes(&summary).is_empty(), "{summary}");
    assert!(answer.contains("break_factor 0.44) and not varied") && !answer.contains("calibrate"), "{answer}");
    assert!(answer.contains("too coarse to tell"), "{answer}");
    assert!(!summary["findings"].to_string().contains("implausible"), "{summary}");
    let (summary, answer) = failure_mass(&folder, &[&known[..], &["--arg", "break=0.40..0.48"]].concat());
    assert_eq!(changes(&summary), ["break_factor 0.4 (--arg break)", "break_factor 0.48 (--arg break)"], "{answer}");
}

/// A drop that ends too early neither holds nor breaks: it runs on, or the study stops. Nor does film without a threshold.
#[test]
fn a_drop_that_still_descends_does_not_hold() {
    let (folder, alone) = (dart(), [&ONE[..], &["--arg", "range=0"]].concat());
    let mass = |duration: &str| {
        let duration = format!("loading.impact.duration={duration}");
        let (summary, _) = failure_mass(&folder, &[&alone[..], &["--set", &duration]].concat());
        figure(&summary, "threshold_mass_kg")
    };
    close(mass("15ms"), mass("50ms"), 1e-9);
    let refused = |change: &str| error(&droptower(folder.path(), &[&STUDY[..], &alone, &["--set", change]].concat()));
    let text = refused("loading.impact.duration=1ms");
    assert!(text.contains("a dart of 56") && text.contains("loading.impact.duration"), "{text}");
    let text = refused("specimen.material={density=915,thickness=1e-4,elastic={young=3e7,poisson=0.4}}");
    assert!(text.contains("the film has no break criterion"), "{text}");
}
