//! Sweeps by the built binary: each run evaluated once, by any number of processes, whatever becomes of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

use serde_json::Value as Json;
use tempfile::TempDir;

use crate::workbench::{self, await_of, close, droptower, error, figures, printed, refused, scene, start};

const VARIATION: &str = r#"
[variation]
samples = 12
"impactor.mass" = ["10 kg", "11 kg", "12 kg"]
"impactor.friction" = { uniform = [0.1, 0.5] }
specimen.material.thickness = { normal = { mean = "12 um", deviation = "0.6 um" }, truncate = { low = "10 um" } }
"#;

fn sweep(folder: &Path, more: &[&str]) -> Output {
    droptower(folder, &[&["sweep", "drop.toml"], more].concat())
}

fn summary(folder: &Path, more: &[&str]) -> Json {
    figures(&sweep(folder, &[&["--json"], more].concat()))
}

/// The rows of the table of a sweep by the names of its columns.
fn table(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(folder.join("runs/drop.sweep/table.csv")).expect("a table");
    let rows = reader.deserialize().map(|row| row.expect("a row"));
    rows.collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} is {:?}", row[column]))
}

#[test]
fn each_row_is_the_run_that_its_inputs_give() {
    let scene = scene(VARIATION);
    let folder = scene.path();
    let found = summary(folder, &["--keep", "worst:1"]);
    assert_eq!([&found["runs"], &found["reused"], &found["failed"]], [12, 0, 0], "{found}");
    assert_eq!(found["rupture_probability"], 0.0);
    assert!(found["interval"][1].as_f64().expect("an interval") > 0.1, "twelve runs without rupture prove little");
    let median = &found["statistics"]["peak_displacement_m"];
    assert!(["mean", "deviation", "p05", "p50", "p95"].iter().all(|name| median[name].is_f64()), "{median}");
    let rows = table(folder);
    let masses: Vec<f64> = rows.iter().map(|row| number(row, "impactor.mass_kg")).collect();
    let count = |mass: f64| masses.iter().filter(|found| **found == mass).count();
    assert!([10.0, 11.0, 12.0].iter().all(|mass| (3..=5).contains(&count(*mass))));
    assert!(rows.iter().all(|row| number(row, "specimen.material.thickness_m") >= 10e-6));
    for row in [&rows[0], &rows[11]] {
        let change = |key: &str, column: &str| format!("{key}={}", row[column]);
        let changes = [
            change("impactor.mass", "impactor.mass_kg"),
            change("impactor.friction", "impactor.friction"),
            change("specimen.material.thickness", "specimen.material.thickness_m"),
        ];
        let set = changes.iter().flat_map(|change| ["--set", change]);
        let arguments: Vec<&str> = ["run", "drop.toml", "--json", "--out", "alone"].into_iter().chain(set).collect();
        let alone = figures(&droptower(folder, &arguments));
        for figure in ["peak_acceleration_m_s2", "peak_displacement_m", "energy_balance_error", "time_step_s"] {
            // Numbers of JSON are read to the last digit but one.
            close(alone[figure].as_f64().expect(figure), number(row, figure), 1e-15);
        }
    }
    let kept: Vec<_> = fs::read_dir(folder.join("runs/drop.sweep.runs")).expect("a folder").flatten().collect();
    assert_eq!(kept.len(), 1);
    let place: usize = kept[0].file_name().to_string_lossy().parse().expect("a number");
    let peak = |row: &BTreeMap<String, String>| number(row, "peak_acceleration_m_s2");
    assert!(rows.iter().all(|row| peak(row) <= peak(&rows[place - 1])));
    assert!(kept[0].path().join("signals.csv").is_file());
    let page = fs::read_to_string(folder.join("runs/drop.sweep/report.html")).expect("a page");
    let repeat = "droptower run drop.toml <span class=\"option\">--set</span> &#39;impactor.mass=";
    assert!(page.contains(repeat), "the page says how a run is repeated");
    for words in ["<p class=\"lead\">Peak deceleration ", "of 12 runs 12 end before the lowest point"] {
        assert!(page.contains(words), "no answer, or one that its runs do not give: {words}");
    }
    let place = |what: &str| page.find(what).unwrap_or_else(|| panic!("the page has no {what}"));
    assert!(place("<figure class=\"plot\">") < place("<table") && place("class=\"ranges\"") < place("<table"));
    assert!(page.contains("title=\"specimen.material.thickness\">Thickness of one layer (µm)</th>"));
    assert!(page.contains("not distinguishable from 0 with 12 runs") && !page.contains("class=\"said\">\u{2212}"));
    let text = printed(&sweep(folder, &[]));
    let is_shown = |own: &str| page.replace('\u{a0}', " ").contains(own);
    assert!(text.starts_with("  Peak deceleration ") && found["answer"].as_str().is_some_and(is_shown), "{text}");
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(" g 9 of 10 runs ") && words.contains(" mm "), "{text}");
}

#[test]
fn what_was_computed_is_taken_by_larger_sweeps_and_other_scripts() {
    let scene = scene(VARIATION);
    let folder = scene.path();
    let counts = |found: &Json| [found["runs"].as_u64(), found["reused"].as_u64()].map(|count| count.expect("a count"));
    assert_eq!(counts(&summary(folder, &["-n", "6"])), [6, 0]);
    let first = table(folder);
    assert_eq!(counts(&summary(folder, &["-n", "12"])), [12, 6]);
    assert_eq!(table(folder)[..6], first, "a larger sweep begins with the runs of a smaller one");
    assert_eq!(counts(&summary(folder, &["-n", "12", "--set", "title=\"other\""])), [12, 12]);
    assert_eq!(counts(&summary(folder, &["-n", "4", "--set", "layers.count=9"])), [4, 0]);
    // A script needs the signals, which are not kept where there was none.
    fs::write(folder.join("a.rhai"), "measure(\"early_m_s\", run.velocity.at(0.001));").expect("a script");
    fs::write(folder.join("b.rhai"), "measure(\"late_m_s\", run.velocity.at(0.009));").expect("a script");
    let script = |name: &str, more: &[&str]| {
        let change = format!("post.script=\"{name}\"");
        printed(&sweep(folder, &[&["-n", "4", "--set", &change], more].concat()))
    };
    script("a.rhai", &[]);
    let computed = || stored(folder, "runs/*/*.run").len();
    let before = computed();
    let text = script("b.rhai", &[]);
    assert!(text.contains("4 of them taken from earlier ones"), "{text}");
    assert_eq!(computed(), before, "the signals of the first script serve the second");
    assert!(table(folder).iter().all(|row| number(row, "late_m_s") < 0.0));
}

#[test]
fn what_varies_can_be_held() {
    let scene = scene(VARIATION);
    printed(&sweep(scene.path(), &["-n", "2", "--set", "variation.\"impactor.mass\"=[\"11 kg\"]"]));
    assert!(table(scene.path()).iter().all(|row| row["impactor.mass_kg"] == "11"));
}

/// Of some records a part is left, as after a failure of the machine; the claims cannot be written, then they can.
#[test]
fn a_sweep_whose_records_are_damaged_or_cannot_be_written_goes_on_from_there() {
    let scene = scene(VARIATION);
    let folder = scene.path();
    printed(&sweep(folder, &["-n", "20"]));
    let records = stored(folder, "records/*/*.record");
    assert_eq!(records.len(), 20);
    fs::write(&records[3], &fs::read(&records[3]).expect("a record")[..40]).expect("writable");
    fs::write(&records[7], "").expect("writable");
    let claims = stored(folder, "claims").remove(0);
    fs::remove_dir_all(&claims).expect("a folder");
    fs::write(&claims, "").expect("writable");
    let full = sweep(folder, &["-n", "24"]);
    assert_eq!(full.status.code(), Some(1), "{}", error(&full));
    assert!(error(&full).contains("runs/.evaluations: "), "{}", error(&full));
    fs::remove_file(&claims).expect("a file");
    let found = summary(folder, &["-n", "24"]);
    assert_eq!([&found["runs"], &found["reused"]], [24, 18]);
}

#[test]
fn failed_and_refused_runs_are_rows_with_their_cause() {
    let variation = "specimen.symmetry = \"none\"\n[variation]\n\"layers.count\" = [8, 9]\n\"impactor.position\" = [[\"0 mm\", \"0 mm\"], [\"0 mm\", \"0 mm\", \"0 mm\"]]\n";
    let scene = scene(variation);
    let output = sweep(scene.path(), &[]);
    assert_eq!(output.status.code(), Some(3), "{}", error(&output));
    assert!(error(&output).contains("2 of 4 runs failed: the impactor starts "), "{}", error(&output));
    let rows = table(scene.path());
    let status: Vec<&str> = rows.iter().map(|row| row["status"].as_str()).collect();
    assert_eq!(status, ["finished", "failed", "finished", "failed"]);
    assert!(rows[1]["failure"].starts_with("the impactor starts "));
    assert!(rows[1]["peak_displacement_m"].is_empty());
}

/// What a run has until it fails is no result of a test: it held until then.
#[test]
fn a_run_that_fails_has_no_figures() {
    let scene = scene("[variation]\n\"impactor.mass\" = [10.0, 1e308]\n");
    let output = sweep(scene.path(), &[]);
    assert!(error(&output).contains("1 of 2 runs failed: the motion of the impactor "), "{}", error(&output));
    let rows = table(scene.path());
    assert_eq!([&rows[0]["ruptured"], &rows[1]["ruptured"]], ["false", ""]);
    assert!(rows[1]["peak_displacement_m"].is_empty());
}

/// A finding that follows from what is written, and not from the model: the default in words is another run.
#[test]
fn findings_of_the_scenario_are_those_of_its_run() {
    let scene = scene("[variation]\n\"impactor.mass\" = [\"10 kg\"]\n");
    let flagged = |more: [&str; 2]| {
        let whole = ["--set", "loading.impact.duration=90 ms", "--force"];
        let found = sweep(scene.path(), &[&more[..], &whole].concat());
        assert!(found.status.success(), "{}", error(&found));
        table(scene.path())[0]["findings"].contains("absorption-not-given")
    };
    let given = ["--set", "specimen.material.fabric.absorption=0"];
    let not = ["--unset", "specimen.material.fabric.absorption"];
    assert!(flagged(not) && !flagged(given) && flagged(not));
}

#[test]
fn a_distribution_of_values_that_cannot_be_has_a_warning() {
    let scene = scene(
        "[variation]\n\"impactor.friction\" = { normal = { mean = 0.2, deviation = 0.1 } }\n\
         \"layers.prestrain.md\" = { uniform = [0.0, 0.2] }\n",
    );
    let checked = figures(&droptower(scene.path(), &["check", "drop.toml", "--json"]));
    let refused = |findings: &Json| -> Vec<Json> {
        let all = findings.as_array().expect("a list").iter();
        all.filter(|finding| finding["code"] == "values-refused").cloned().collect()
    };
    let found = refused(&checked[0]["findings"]);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!([&found[0]["key"], &found[0]["low"]], [&Json::from("impactor.friction"), &Json::from(0.0)]);
    // The normal distribution is below its mean by two deviations with a probability of 0.02275.
    assert!((found[0]["share"].as_f64().expect("a share") - 0.02275).abs() < 1e-5, "{found:?}");
    let output = sweep(scene.path(), &["-n", "64"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(error(&output).contains("runs failed: `impactor.friction`: out of range"), "{}", error(&output));
    assert_eq!(refused(&workbench::summary(&scene.path().join("runs/drop.sweep"))["findings"]), found);
}

/// Files of the store of one build.
fn stored(folder: &Path, pattern: &str) -> Vec<PathBuf> {
    let pattern = folder.join("runs/.evaluations/*").join(pattern);
    glob::glob(pattern.to_str().expect("UTF-8")).expect("a pattern").flatten().collect()
}

/// Records in the folder.
fn evaluations(folder: &Path) -> u64 {
    let listed = figures(&droptower(folder, &["store", "list", "--json"]));
    listed.as_array().expect("a list").iter().filter_map(|build| build["evaluations"].as_u64()).sum()
}

#[test]
fn shares_of_processes_make_the_same_table_and_compute_nothing_twice() {
    let [alone, shared] = [scene(VARIATION), scene(VARIATION)];
    printed(&sweep(alone.path(), &["-n", "24"]));
    let shares = ["1/3", "2/3", "3/3"]
        .map(|share| start(shared.path(), &["sweep", "drop.toml", "-n", "24", "--json", "--shard", share]));
    let outputs = shares.map(|share| share.wait_with_output().expect("it ends"));
    let computed: u64 = outputs.iter().map(|output| figures(output)["computed"].as_u64().expect("a count")).sum();
    assert_eq!(computed, 24);
    assert_eq!(evaluations(shared.path()), 24);
    let merged = summary(shared.path(), &["-n", "24", "--merge"]);
    assert_eq!([&merged["runs"], &merged["reused"]], [24, 24]);
    let table = |scene: &TempDir| fs::read(scene.path().join("runs/drop.sweep/table.csv")).expect("a table");
    assert!(table(&alone) == table(&shared), "the tables are equal byte by byte");
}

#[cfg(unix)]
#[test]
fn a_sweep_that_was_killed_or_terminated_goes_on_from_there() {
    // One that ends before it is stopped, on a busy machine, is started over.
    let stopped = |signal: &str| loop {
        let scene = scene(VARIATION);
        let mut child = start(scene.path(), &["sweep", "drop.toml", "-n", "100"]);
        let has_begun = await_of(&mut child, || evaluations(scene.path()) >= 3);
        let kill = std::process::Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).output();
        let (_, status) = (kill.expect("kill starts"), child.wait().expect("it ends"));
        if has_begun && !status.success() {
            break (scene, status);
        }
    };
    for signal in ["KILL", "TERM"] {
        let (scene, status) = stopped(signal);
        let folder = scene.path();
        assert_eq!(status.code(), if signal == "TERM" { Some(1) } else { None });
        assert!(!folder.join("runs/drop.sweep").exists(), "a part is not stored as the whole");
        let before = evaluations(folder);
        assert!((3..100).contains(&before), "{before}");
        let found = summary(folder, &["-n", "100"]);
        assert_eq!([&found["runs"], &found["reused"]], [100, before]);
    }
}

#[test]
fn a_sweep_stops_before_its_time_is_over() {
    let scene = scene(VARIATION);
    let output = sweep(scene.path(), &["-n", "100000", "--stop-after", "300 ms"]);
    assert_eq!(output.status.code(), Some(1), "{}", error(&output));
    assert!(error(&output).contains("of 100000 runs are not done"), "{}", error(&output));
    assert!(error(&output).contains("the same command goes on from there"));
}

#[test]
fn evaluations_are_listed_and_removed() {
    let scene = scene(VARIATION);
    let folder = scene.path();
    fs::write(folder.join("a.rhai"), "measure(\"early_m_s\", run.velocity.at(0.001));").expect("a script");
    let with_script = ["-n", "3", "--set", "post.script=\"a.rhai\""];
    printed(&sweep(folder, &with_script));
    // A script needs the signals of whole runs.
    let whole = || stored(folder, "runs/*/*.run").len();
    assert_eq!(whole(), 3);
    let listed = figures(&droptower(folder, &["store", "list", "--json"]));
    assert_eq!(listed[0]["runs"], 3, "{listed}");
    let prune = |more: &[&str]| figures(&droptower(folder, &[&["store", "prune", "--json"], more].concat()));
    let left = |found: Json| [found["removed"].as_u64(), found["left"].as_u64()].map(|count| count.expect("a count"));
    // What is being written is not removed, nor what this build may take.
    assert_eq!(left(prune(&["--all"])), [0, 3]);
    for path in stored(folder, "r*/*/*.r*") {
        let file = fs::OpenOptions::new().append(true).open(path).expect("a file");
        file.set_modified(std::time::SystemTime::now() - Duration::from_secs(7200)).expect("a time");
    }
    assert_eq!(left(prune(&[])), [0, 3]);
    assert_eq!(left(prune(&["--older-than", "3 h"])), [0, 3]);
    assert_eq!(left(prune(&["--older-than", "1 h"])), [3, 0]);
    assert_eq!(whole(), 0);
    assert_eq!(summary(folder, &with_script)["reused"], 0);
}

#[test]
fn correlated_keys_and_tables_of_points() {
    let correlated = format!(
        "{VARIATION}correlation = {{ keys = [\"impactor.friction\", \"specimen.material.thickness\"], matrix = [[1, 0.99], [0.99, 1]] }}\n"
    );
    let scene = scene(&correlated);
    let folder = scene.path();
    summary(folder, &["-n", "16"]);
    let rows = table(folder);
    let of = |column: &str| rows.iter().map(|row| number(row, column)).collect::<Vec<f64>>();
    let (friction, thickness) = (of("impactor.friction"), of("specimen.material.thickness_m"));
    let rank = |values: &[f64]| values.iter().map(|x| values.iter().filter(|y| *y < x).count()).collect::<Vec<usize>>();
    let apart = rank(&friction).into_iter().zip(rank(&thickness)).map(|(a, b)| a.abs_diff(b)).sum::<usize>();
    assert!(apart <= 32, "ranks of correlated keys: {friction:?} {thickness:?}");
    // The table of a sweep is a table of points: its inputs give the same runs.
    let points: Vec<String> = rows
        .iter()
        .map(|row| format!("{},{}", row["impactor.friction"], row["specimen.material.thickness_m"]))
        .collect();
    let text = format!("impactor.friction,specimen.material.thickness_m\n{}\n", points.join("\n"));
    fs::write(folder.join("points.csv"), text).expect("a table");
    let again = "extends = \"drop.toml\"\nunset = [\"variation\"]\nvariation.method = { table = \"points.csv\" }\n";
    fs::write(folder.join("again.toml"), again).expect("a scenario");
    let found = figures(&droptower(folder, &["sweep", "again.toml", "--json", "--set", "impactor.mass=\"10 kg\""]));
    assert_eq!(found["runs"], 16);
    let same = of("impactor.mass_kg").iter().filter(|mass| **mass == 10.0).count();
    assert_eq!(found["reused"], same);
}

#[test]
fn a_table_of_points_has_values_with_their_units() {
    let scene = scene("variation.method = { table = \"points.csv\" }");
    fs::write(scene.path().join("points.csv"), "layers.count,impactor.mass\n8,10 kg\n9,11000 g\n").expect("a table");
    assert_eq!(summary(scene.path(), &[])["runs"], 2);
    assert_eq!(table(scene.path())[1]["impactor.mass_kg"], "11");
}

const SCRIPT: &str = include_str!("studies/six-runs.rhai");

#[test]
fn a_script_is_computed_by_several_processes() {
    let scene = scene("");
    let folder = scene.path();
    fs::write(folder.join("study.rhai"), SCRIPT).expect("a script");
    let part = |share: &str| start(folder, &["script", "study.rhai", "--json", "--shard", share]);
    let parts = ["1/2", "2/2"].map(part).map(|child| figures(&child.wait_with_output().expect("an end")));
    let computed: u64 = parts.iter().map(|part| part["computed"].as_u64().expect("a count")).sum();
    // Four runs and one that cannot start, to which both processes may come at the same moment.
    assert!((5..=6).contains(&computed), "{parts:?}");
    assert!(!folder.join("runs/study").exists(), "a part has no results");
    let whole = droptower(folder, &["script", "study.rhai"]);
    assert!(error(&whole).contains("6 of 6 runs were computed before"), "{}", error(&whole));
    assert!(error(&whole).contains("failed: drop: the impactor starts "), "{}", error(&whole));
    let table = fs::read_to_string(folder.join("runs/study/tables/runs.csv")).expect("a table");
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows.len() == 6 && rows[3] == rows[5], "{table}");
}

/// Whatever the name of the scenario, its script gives the program the words that were meant: the task, and without one the merge.
#[cfg(unix)]
#[test]
fn an_array_job_of_slurm_has_the_words_that_were_meant() {
    use std::os::unix::fs::PermissionsExt;

    let scene = scene(VARIATION);
    let folder = scene.path();
    let name = "it's \"$HOME\" `id`\n#SBATCH --array=0.toml";
    fs::rename(folder.join("drop.toml"), folder.join(name)).expect("a scenario");
    let new = ["new", "slurm", "sweep.sbatch", "--scenario", name, "-n", "20", "--tasks", "3"];
    assert!(printed(&droptower(folder, &new)).contains("; try: sbatch sweep.sbatch "));
    refused(&droptower(folder, &new), "sweep.sbatch already exists");
    let script = fs::read_to_string(folder.join("sweep.sbatch")).expect("a script");
    let read_by_slurm = script.lines().take_while(|line| line.starts_with('#')).filter(|line| line.contains("--array"));
    assert_eq!(read_by_slurm.map(|line| line.split(' ').nth(1)).collect::<Vec<_>>(), [Some("--array=1-3")]);
    let stub = folder.join("droptower");
    fs::write(&stub, "#!/bin/sh\nprintf '<%s>' \"$@\"\n").expect("a stub");
    fs::set_permissions(&stub, fs::Permissions::from_mode(0o755)).expect("a program");
    let task = [("SLURM_ARRAY_TASK_ID", "2"), ("SLURM_ARRAY_TASK_MAX", "3"), ("SLURM_CPUS_PER_TASK", "16")];
    for (variables, rest) in [(&task[..], "<--shard><2/3><--threads><16>"), (&[], "<--merge>")] {
        let mut shell = Command::new("/bin/sh");
        shell.arg("sweep.sbatch").current_dir(folder).env("PATH", folder).envs(variables.iter().copied());
        let given = printed(&shell.output().expect("a shell"));
        assert_eq!(given, format!("<sweep><{name}><-n><20>{rest}"));
    }
}

/// A script with one expression over a drop of a millisecond whose speed varies evenly from 4 to 4.2 m/s.
fn studied(folder: &Path, expression: &str) -> Output {
    let script = format!(
        "let drop = scenario(args.scenario).with(#{{ \"loading.impact.duration\": \"1 ms\" }});\n\
         let vary = #{{ \"loading.impact.velocity\": #{{ uniform: [4.0, 4.2] }} }};\n{expression};\n"
    );
    fs::write(folder.join("study.rhai"), script).expect("a script");
    droptower(folder, &["script", "study.rhai", "--scenario", "drop.toml", "--force", "--json"])
}

/// Probabilities beyond one half, limits that a figure is equal to or never reaches, and what is said of each.
#[test]
fn probabilities_of_failure_and_their_findings() {
    let scene = scene("");
    // The displacement after a millisecond is 1 ms times the speed, nearly: -4.0 to -4.2 mm.
    for (options, low, high, code) in [
        ("above: -3.9e-3, method: \"subset\", samples: 20", 0.0, 0.05, Some("failure-not-reached")),
        ("above: -5e-3, method: \"subset\", samples: 20", 0.83, 1.0, None),
        ("above: 0, figure: \"ruptured\", method: \"monte-carlo\", samples: 20", 0.0, 0.17, None),
        ("below: 0, figure: \"ruptured\", method: \"monte-carlo\", samples: 20", 0.0, 0.17, None),
    ] {
        let figure = if options.contains("figure") { "" } else { "figure: \"peak_displacement_m\", " };
        let expression = format!(
            "let found = failure_probability(drop, #{{ {figure}{options}, vary: vary }}); measure(\"low\", found.interval[0]); \
             measure(\"high\", found.interval[1]); measure(\"runs\", found.runs)"
        );
        let summary = figures(&studied(scene.path(), &expression));
        let [found_low, found_high] = ["low", "high"].map(|name| workbench::figure(&summary, name));
        assert!(found_low >= low && found_high <= high && found_low < found_high, "{options}: {summary}");
        let codes = workbench::finding_codes(&summary);
        assert!(code.is_none_or(|code| codes.contains(&code)), "{options}: {codes:?}");
        assert!(workbench::figure(&summary, "runs") >= 20.0, "{summary}");
    }
    let few = studied(
        scene.path(),
        "failure_probability(drop, #{ figure: \"ruptured\", below: 0, samples: 20, vary: vary })",
    );
    refused(&few, "\"monte-carlo\"");
}

/// The energy ½ m v² hardly scatters where a heavy impactor is a slow one, and is above its mean by a fifth of its deviation in four
/// of ten runs where they are independent.
#[test]
fn a_probability_of_failure_knows_what_is_correlated() {
    let scene = scene("post.script = \"energy.rhai\"");
    let energy = "measure(\"energy\", 0.5 * run.model.mass * run.velocity.at(0) ** 2)";
    fs::write(scene.path().join("energy.rhai"), energy).expect("a script");
    for (correlation, low, high) in [("0.0", 0.25, 0.6), ("-0.9999", 0.0, 0.1)] {
        let vary = format!(
            "#{{ \"impactor.mass\": #{{ lognormal: #{{ mean: 10.0, deviation: 0.2 }} }}, \"loading.impact.velocity\": #{{ lognormal: \
             #{{ mean: 4.0, deviation: 0.04 }} }}, correlation: #{{ keys: [\"impactor.mass\", \"loading.impact.velocity\"], \
             matrix: [[1.0, {correlation}], [{correlation}, 1.0]] }} }}"
        );
        let expression = format!(
            "let found = failure_probability(drop, #{{ figure: \"energy\", above: 80.4, method: \"monte-carlo\", samples: 100, \
             vary: {vary} }}); measure(\"found\", found.probability)"
        );
        let found = workbench::figure(&figures(&studied(scene.path(), &expression)), "found");
        assert!((low..=high).contains(&found), "{correlation}: {found}");
        let surrogate = studied(scene.path(), &format!("surrogate(drop, #{{ samples: 8, vary: {vary} }})"));
        refused(&surrogate, "these are correlated");
    }
}

#[test]
fn a_staircase_takes_whole_numbers_and_says_where_it_came_to() {
    let scene = scene("");
    for (options, expected) in [
        ("key: \"layers.count\", start: 4, step: 1", "all had the same outcome"),
        (
            "key: \"loading.impact.velocity\", start: 0.2, step: 0.1",
            "the staircase came to loading.impact.velocity = 0, which the scenario does not take",
        ),
        ("key: \"layers.count\", start: 2, step: 1", "the staircase came to layers.count = 0"),
    ] {
        let expression = format!(
            "staircase(drop, #{{ {options}, specimens: 4, figure: \"peak_displacement_m\", below: 0, vary: #{{ \"impactor.friction\": #{{ uniform: [0.1, 0.3] }} }} }})"
        );
        refused(&studied(scene.path(), &expression), expected);
    }
    let named = studied(
        scene.path(),
        "sweep(drop, #{ vary: #{ \"loading.impact.velocity\": #{ mean: 4.1, deviation: 0.05 } } })",
    );
    assert!(error(&named).contains("`normal`"), "{}", error(&named));
}

/// Both runs end in contact, which a study of them says as they do.
#[test]
fn a_study_says_which_warnings_its_runs_have() {
    let scene = scene("");
    let output = studied(scene.path(), "simulate_all([drop, drop.with(#{ \"impactor.mass\": 11.0 })])");
    let summary = figures(&output);
    let of_runs = |summary: &Json| {
        let findings = summary["findings"].as_array().expect("a list").iter();
        findings.filter(|own| own["code"] == "warnings-of-runs").cloned().collect::<Vec<Json>>()
    };
    let found = of_runs(&summary);
    assert!(found.len() == 1 && found[0]["runs"] == 2 && found[0]["codes"]["unfinished"] == 2, "{summary}");
    assert!(error(&output).contains("warning[warnings-of-runs]: all 2 runs have warnings: "), "{}", error(&output));
    let page = fs::read_to_string(scene.path().join("runs/study/report.html")).expect("a page");
    assert!(page.contains("warnings-of-runs"));
    let swept = summary_of_sweep(&scene);
    assert_eq!(of_runs(&swept)[0]["codes"]["unfinished"], 3, "{swept}");
}

fn summary_of_sweep(scene: &TempDir) -> Json {
    let text = fs::read_to_string(scene.path().join("drop.toml")).expect("a scenario");
    let varied = format!("{text}\n[variation]\n\"impactor.mass\" = [\"10 kg\", \"11 kg\", \"12 kg\"]\n");
    fs::write(scene.path().join("drop.toml"), varied).expect("a scenario");
    summary(scene.path(), &[])
}

/// A run, a sweep and a script that replace their own results say what was given otherwise before, unless it was the same or
/// `--force` asks for it.
#[test]
fn results_of_other_changes_are_not_replaced_without_a_word() {
    let scene = scene("[variation]\n\"impactor.mass\" = [\"10 kg\", \"11 kg\"]\n");
    let folder = scene.path();
    fs::write(folder.join("count.rhai"), "//! --arg n=1  a number\nmeasure(\"n\", args.n);").expect("a script");
    let friction = ["--set", "impactor.friction=0.2"];
    let note = |what: &str, keys: &str| format!("note: runs/{what} with other {keys}; --out keeps both\n");
    for (command, more, expected) in [
        (["run", "drop.toml"], &friction[..], note("drop replaces a run", "`impactor.friction`")),
        (["sweep", "drop.toml"], &friction, note("drop.sweep replaces a sweep", "`impactor.friction`")),
        (["script", "count.rhai"], &["--arg", "n=2"], note("count replaces results", "`--arg n`")),
    ] {
        let told = |more: &[&str]| {
            let output = droptower(folder, &[&command[..], more].concat());
            printed(&output);
            error(&output).contains(&expected)
        };
        assert_eq!([&[][..], &[], more, more].map(told), [false, false, true, false], "{command:?}");
        assert!(!told(&["--force"]) && told(more), "{command:?}");
    }
}
