//! The built binary, for the commands that do not simulate.

use std::fs;
use std::path::Path;
use std::process::Output;

use droptower::scenario::grammar::{self, Rule};
use serde_json::Value as Json;

use crate::workbench;

fn droptower(arguments: &[&str]) -> Output {
    workbench::droptower(&workbench::root(), arguments)
}

fn standard_output(arguments: &[&str]) -> String {
    workbench::printed(&droptower(arguments))
}

#[test]
fn mistakes_exit_with_two_and_are_printed_as_json() {
    let tower = "tests/it/broken/parts/tower.toml";
    let output = droptower(&["check", "--json", tower, "--set", "layers.count=0"]);
    assert_eq!(output.status.code(), Some(2));
    let verdicts: Json = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(verdicts[0]["ok"], false);
    assert_eq!(verdicts[0]["mistakes"][0]["file"], "--set");
    assert_eq!(verdicts[0]["mistakes"][0]["column"], 14);
}

#[test]
fn all_scenarios_of_a_glob_are_checked_at_once() {
    let output = droptower(&["check", "tests/it/broken/un*.toml", "tests/it/broken/parts/tower.toml"]);
    let mistakes = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(mistakes.contains("units.toml:2:") && mistakes.contains("unknown-keys.toml:2:"));
    assert!(String::from_utf8_lossy(&output.stdout).contains("tower.toml"));
    assert_eq!(droptower(&["check", "nothing/*.toml"]).status.code(), Some(2));
}

#[test]
fn a_material_is_checked_without_a_scenario() {
    let good = standard_output(&["check", "tests/it/broken/parts/film.toml", "tests/it/broken/parts/tower.toml"]);
    assert_eq!(good.lines().filter(|line| line.starts_with("ok")).count(), 2, "{good}");
    let output = droptower(&["check", "--json", "tests/it/broken/parts/thicknes.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let verdicts: Json = serde_json::from_slice(&output.stdout).expect("JSON");
    let mistakes = verdicts[0]["mistakes"].as_array().expect("a list").iter();
    let messages: Vec<&str> = mistakes.filter_map(|mistake| mistake["message"].as_str()).collect();
    assert_eq!(messages[..2], ["missing key `thickness`", "unknown key `thicknes`"]);
    let set = droptower(&["check", "tests/it/broken/parts/film.toml", "--set", "fabric.scale.k1=-1"]);
    assert_eq!(set.status.code(), Some(2));
}

/// A file with the table of a law alone is a material of which the rest is missing.
#[test]
fn the_table_of_any_law_makes_a_material() {
    let folder = tempfile::tempdir().expect("a folder");
    for law in ["fabric", "elastic", "hyperelastic", "plastic"] {
        let file = folder.path().join(format!("{law}.toml"));
        std::fs::write(&file, format!("[{law}]\n")).expect("a file");
        let output = droptower(&["check", file.to_str().expect("UTF-8")]);
        let mistakes = String::from_utf8_lossy(&output.stderr);
        assert!(mistakes.contains("missing key `density`") && !mistakes.contains("specimen"), "{mistakes}");
    }
}

#[test]
fn findings_are_printed_with_severity_and_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let out = out.to_str().expect("UTF-8");
    let short = ["--set", "specimen.mesh.size=40mm", "--set", "loading.impact.duration=2ms", "--out", out];
    let drop = ["signal", "drop", "data/virtual/1509.csv", "--mass", "10.72 kg", "--height", "1.5 m"];
    let cases: [(Vec<&str>, &[&str]); 3] = [
        (
            [&["run", "scenarios/drop/1509.toml"], &short[..]].concat(),
            &["  note[no-laser]: reference: no laser", "  warning[virtual-reference]: reference: VIRTUAL drop test"],
        ),
        (drop.to_vec(), &["  note[no-laser]: no laser", "  warning[virtual-recording]: VIRTUAL drop test"]),
        (vec!["signal", "info", "data/virtual/1509.csv"], &["  warning[virtual-recording]: VIRTUAL drop test"]),
    ];
    for (arguments, expected) in cases {
        let text = standard_output(&arguments);
        for start in expected {
            assert_eq!(text.lines().filter(|line| line.starts_with(start)).count(), 1, "{start}: {text}");
        }
    }
    let read = |file: &str| std::fs::read_to_string(folder.path().join("run").join(file)).expect("a file");
    let summary: Json = serde_json::from_str(&read("summary.json")).expect("JSON");
    let has = |list: &str, code: &str| summary[list].as_array().expect(list).iter().any(|found| found["code"] == code);
    assert!(has("findings", "no-laser") && has("findings", "virtual-reference"), "{summary}");
    assert!(!summary["warnings"].to_string().contains("no laser"), "a note is no warning: {summary}");
    let page = read("report.html");
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text}"));
    let (warning, note) = (place("<code>virtual-reference</code>"), place("<code>no-laser</code>"));
    assert!(warning < place("<h2>Notes</h2>") && place("<h2>Notes</h2>") < note);
}

#[test]
fn a_material_is_not_run() {
    let output = droptower(&["run", "tests/it/broken/parts/film.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let mistakes = String::from_utf8_lossy(&output.stderr);
    assert!(mistakes.contains("film.toml is a material, not a scenario"), "{mistakes}");
    assert_eq!(mistakes.matches("error").count(), 1, "{mistakes}");
}

#[test]
fn angles_lie_within_a_turn() {
    let tower = "tests/it/broken/parts/tower.toml";
    for (angle, fits) in [("45", false), ("400 deg", false), ("-360 deg", true), ("0.7", true)] {
        let set = format!("specimen.md_angle={angle}");
        let output = droptower(&["check", tower, "--set", "specimen.symmetry=none", "--set", &set]);
        assert_eq!(output.status.success(), fits, "{angle}");
        let hinted = String::from_utf8_lossy(&output.stderr).contains("write it like \"45 deg\"");
        assert!(fits || hinted, "{angle}");
    }
}

#[test]
fn explain_gives_unit_range_default_and_sentence() {
    let text = standard_output(&["explain", "output.sample_rate"]);
    for part in ["Samples per second", "a bare number is in Hz", "more than 0", "default \"10 kHz\""] {
        assert!(text.contains(part), "{part} is missing in {text}");
    }
    let keys: Json = serde_json::from_str(&standard_output(&["explain", "specimen.mesh", "--json"])).expect("JSON");
    assert_eq!(keys[2]["key"], "specimen.mesh.size");
    assert_eq!(keys[2]["unit"], "m");
    let all: Json = serde_json::from_str(&standard_output(&["explain", "keys", "--json"])).expect("JSON");
    let is_listed = |key: &Json| all.as_array().expect("a list").contains(key);
    assert!(is_listed(&keys[0]) && all[0]["key"] == "title", "{all}");
    assert!(
        standard_output(&["explain", "mesh.size"]).starts_with("specimen.mesh.size\nlayer.mesh.size\n    Target edge")
    );
    // The limit of a strain is a number, that of a stress a quantity.
    let text = standard_output(&["explain", "specimen.material.rupture.limit"]);
    assert!(text.contains("a pressure or a number") && !text.contains("a bare number is in"), "{text}");
    let function = standard_output(&["explain", "write_csv"]);
    assert!(function.contains("write_csv(name,") && !function.contains("measure(name"), "{function}");
    let unknown = droptower(&["explain", "specimen.mehs"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("did you mean `mesh`?"));
}

#[test]
fn implausible_values_are_findings_of_check_and_run() {
    let tower = "tests/it/broken/parts/tower.toml";
    let warning = "  warning[implausible-value]: ";
    for (set, expected) in [
        (
            "specimen.material.thickness=12 mm",
            "is 12 mm, which is implausible: usual are 1 um to 2 mm; did you mean \"12 um\"?",
        ),
        (
            "loading.impact.duration=120 s",
            "is 120 s, which is implausible: usual are 1 us to 5 s; did you mean \"120 ms\"?",
        ),
        (
            "impactor.mass=10720",
            "is 10720 kg, which is implausible: usual are 0.001 kg to 2000 kg; did you mean \"10720 g\"?",
        ),
        (
            "specimen.material.density=0.92",
            "is 0.92 kg/m3, which is implausible: usual are 20 kg/m3 to 25000 kg/m3; did you mean \"0.92 g/cm3\"?",
        ),
        ("specimen.material.elastic={ young = 10, poisson = 0.4 }", "did you mean \"10 MPa\"?"),
        ("specimen.material.elastic={ young = 4000, poisson = 0.4 }", "did you mean \"4000 MPa\"?"),
        ("specimen.material.fabric.md.curve=[[139, \"29.3 MPa\"]]", "did you mean \"139 %\"?"),
        ("specimen.material.fabric.md.curve=[[1.39, 29.3]]", "did you mean \"29.3 MPa\"?"),
        ("layers.faces=[0, -30]", "did you mean \"-30 mm\"?"),
    ] {
        let text = standard_output(&["check", tower, "--set", set]);
        let found: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix(warning)).collect();
        assert!(matches!(found.as_slice(), [one] if one.contains(expected)), "{set}: {text}");
    }
    let checked = standard_output(&["check", "--json", tower, "--set", "impactor.mass=5000"]);
    let checked: Json = serde_json::from_str(&checked).expect("JSON");
    assert_eq!(
        (&checked[0]["ok"], &checked[0]["findings"][0]["key"]),
        (&Json::from(true), &Json::from("impactor.mass"))
    );
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let short = ["--set", "specimen.mesh.size=40mm", "--set", "loading.impact.duration=2ms", "--out"];
    let heavy = [&["run", tower, "--set", "impactor.mass=5000"], &short[..], &[out.to_str().expect("UTF-8")]].concat();
    assert!(standard_output(&heavy).contains(warning));
}

#[test]
fn a_mesh_in_millimetres_is_a_finding() {
    let folder = tempfile::tempdir().expect("a folder");
    let square = "v 0 0 0\nv 80 0 0\nv 80 80 0\nv 0 80 0\nf 1 2 3 4\n";
    std::fs::write(folder.path().join("film.obj"), square).expect("writable");
    let tower = workbench::root().join("tests/it/broken/parts/tower.toml");
    let text = format!(
        "extends = '{}'\nunset = [\"specimen.mesh.size\", \"specimen.symmetry\"]\nspecimen.shape.mesh = 'film.obj'\n",
        tower.display()
    );
    let path = folder.path().join("imported.toml");
    std::fs::write(&path, text).expect("writable");
    let text = standard_output(&["check", path.to_str().expect("UTF-8")]);
    let expected = "the mesh of `specimen.shape.mesh` is 80 m wide, which is implausible; coordinates in mm are `specimen.shape.mesh = {";
    assert!(text.contains(expected), "{text}");
}

#[test]
fn shipped_scenarios_are_plausible() {
    for pattern in ["scenarios/*/*.toml", "tests/golden/*/scenario.toml"] {
        let text = standard_output(&["check", pattern]);
        assert!(text.lines().count() > 2 && !text.contains("implausible"), "{text}");
    }
}

#[test]
fn explain_finds_a_key_at_any_depth_by_the_end_of_its_path() {
    for (end, paths) in [
        ("mesh", &["specimen.mesh", "specimen.shape.mesh", "impactor.shape.mesh", "layer.mesh"][..]),
        ("md", &["specimen.material.fabric.md", "layers.prestrain.md"]),
        ("k1", &["specimen.material.fabric.scale.k1", "layer.material.fabric.td.rates.scale.k1"]),
        ("scale", &["specimen.material.fabric.scale", "specimen.material.fabric.md.scale"]),
    ] {
        let text = standard_output(&["explain", end]);
        let found: Vec<&str> = text.lines().filter(|line| line.ends_with(end) && !line.starts_with(' ')).collect();
        assert!(paths.iter().all(|path| found.contains(path)), "{text}");
    }
    let one = standard_output(&["explain", "drop_height"]);
    assert!(one.contains("loading.impact.drop_height\n    Drop height of an ideal"), "{one}");
}

#[test]
fn a_file_that_is_no_scenario_has_one_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let utf16 = folder.path().join("utf-16.toml");
    std::fs::write(&utf16, "title = \"a\"\n".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
        .expect("writable");
    for (file, expected) in [
        ("README.md", "README.md is no scenario: it is not a TOML file"),
        ("Cargo.toml", "Cargo.toml is no scenario: it has none of the keys of one"),
        (utf16.to_str().expect("UTF-8"), "utf-16.toml: it is UTF-16 text"),
    ] {
        let output = droptower(&["check", file]);
        let mistakes = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), mistakes.matches("error").count()), (Some(2), 1), "{mistakes}");
        assert!(mistakes.contains(expected), "{mistakes}");
    }
}

#[test]
fn explain_gives_meaning_and_remedy_of_findings() {
    let one = standard_output(&["explain", "coarse-contact"]);
    assert!(one.starts_with("coarse-contact (warning)\n") && one.contains("what to do: use a smaller"), "{one}");
    assert_eq!(standard_output(&["explain", "warning[coarse-contact]"]), one);
    let all: Json = serde_json::from_str(&standard_output(&["explain", "findings", "--json"])).expect("JSON");
    let code = |code: &&Json| code["name"] == "coarse-contact" && code["severity"] == "warning";
    assert_eq!(all.as_array().expect("a list").iter().filter(code).count(), 1);
    let unknown = droptower(&["explain", "corse-contact"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("did you mean the finding `coarse-contact`?"));
}

#[test]
fn explain_knows_the_columns_of_signals() {
    let slip = standard_output(&["explain", "clamp_slip_m"]);
    assert!(slip.contains("Largest slip of film in the frame's clamp.\n    column of signals.csv; in m; where there is a `frame.clamp`"), "{slip}");
    let head = standard_output(&["explain", "head_displacement_m"]);
    assert!(head.contains("of the impactor \"head\"") && head.contains("`run.head_displacement`"), "{head}");
    let json: Json = serde_json::from_str(&standard_output(&["explain", "film_distance_m", "--json"])).expect("JSON");
    assert!(json[0]["sentence"].as_str().expect("a text").contains("at least"));
    let all = standard_output(&["explain", "columns"]);
    assert!(all.starts_with("displacement_m\n") && all.contains(slip.trim_end()), "{all}");
    let hourglass = standard_output(&["explain", "hourglass_J"]);
    assert!(
        hourglass.contains("column of energies.csv; in J; of every run\n    in scripts `run.energies.hourglass_J`"),
        "{hourglass}"
    );
    assert!(all.contains(hourglass.trim_end()) && all.contains("sum_J\n"), "{all}");
    for (unknown, hint) in [
        ("clamp_slp_m", "did you mean the column `clamp_slip_m`?"),
        ("head_max_strain_md", "no key `head_max_strain_md`"),
    ] {
        let output = droptower(&["explain", unknown]);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(hint), "{unknown}");
    }
}

#[test]
fn every_key_has_a_sentence() {
    fn without_sentence(rule: &Rule, name: &str, found: &mut Vec<String>) {
        let table = rule.table().or_else(|| rule.item(0)?.table());
        for key in table.into_iter().flat_map(|table| &table.keys) {
            let name = format!("{name}.{}", key.name);
            if key.sentence.is_none() {
                found.push(name.clone());
            }
            without_sentence(&key.rule, &name, found);
        }
    }
    let mut found = Vec::new();
    without_sentence(grammar::scenario(), "", &mut found);
    assert!(found.is_empty(), "no sentence for {found:?}");
}

#[test]
fn the_schema_allows_no_further_keys_and_requires_none() {
    let schema: Json = serde_json::from_str(&standard_output(&["schema"])).expect("JSON");
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["properties"]["specimen"]["additionalProperties"], false);
    assert_eq!(schema["properties"]["specimen"]["properties"]["mesh"]["properties"]["size"]["x-unit"], "m");
    assert!(!schema.to_string().contains("\"required\""));
}

#[test]
fn list_prints_scenarios_without_materials() {
    let listed: Json =
        serde_json::from_str(&standard_output(&["list", "tests/it/broken/parts", "--json"])).expect("JSON");
    let listed = listed.as_array().expect("a list");
    let named = |name: &str| listed.iter().find(|entry| entry["name"] == name);
    assert_eq!(named("tower").map(|entry| &entry["title"]), Some(&Json::from("Drop tower")));
    assert!(named("film").is_none());
    assert!(!Path::new("runs").join("tower").exists());
}

#[test]
fn list_without_a_folder_searches_below_the_working_directory() {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, text) in [
        ("mine/drop.toml", "title = \"Mine\"\n[specimen]\n"),
        ("runs/drop/scenario.toml", "title = \"Stored\"\n[specimen]\n"),
        ("runs/drop/summary.json", "{}"),
        (".hidden/drop.toml", "[specimen]\n"),
        ("begun.toml", "[specimen\n"),
        ("pyproject.toml", "[project\n"),
    ] {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("a file");
    }
    let output = workbench::droptower(folder.path(), &["list"]);
    let lines = workbench::printed(&output);
    let listed = ["begun.toml      (not readable; see droptower check)", "mine/drop.toml  Mine"];
    assert_eq!(lines.lines().collect::<Vec<_>>(), listed);
    assert!(workbench::error(&output).contains("the scenarios of result folders are left out: 1"));
}

#[test]
fn results_of_another_script_are_replaced_with_force_only() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["a", "b"] {
        fs::write(folder.path().join(format!("{name}.rhai")), format!("measure(\"{name}\", 1);")).expect("a script");
    }
    let script = |name: &str, with: &[&str]| {
        workbench::droptower(folder.path(), &[&["script", name, "--out", "out"][..], with].concat())
    };
    let stored = || fs::read_to_string(folder.path().join("out/summary.json")).expect("a summary");
    workbench::printed(&script("a.rhai", &[]));
    workbench::printed(&script("./a.rhai", &[]));
    let refused = script("b.rhai", &[]);
    assert_eq!(refused.status.code(), Some(2));
    let error = workbench::error(&refused);
    assert!(error.contains("out holds the results of a.rhai and is not replaced"), "{error}");
    assert!(error.contains("give another --out, or --force"), "{error}");
    assert!(stored().contains("\"a\": 1"));
    workbench::printed(&script("b.rhai", &["--force"]));
    assert!(stored().contains("\"b\": 1"));
}

#[test]
fn equal_names_in_two_projects_are_two_scripts() {
    let folder = tempfile::tempdir().expect("a folder");
    for project in ["one", "other"] {
        fs::create_dir(folder.path().join(project)).expect("a folder");
        fs::write(folder.path().join(project).join("a.rhai"), "measure(\"a\", 1);").expect("a script");
    }
    let script = |project: &str| {
        let out = folder.path().join("out").display().to_string();
        workbench::droptower(&folder.path().join(project), &["script", "a.rhai", "--out", &out])
    };
    workbench::printed(&script("one"));
    workbench::printed(&script("one"));
    let refused = script("other");
    assert_eq!(refused.status.code(), Some(2));
    assert!(workbench::error(&refused).contains("one/a.rhai and is not replaced"), "{}", workbench::error(&refused));
}

/// What a scenario hardly means is printed before its run and is a finding of a script; a rebound that says nothing is
/// one of runs that rebound.
#[test]
fn early_findings_are_printed_before_a_run_and_are_those_of_scripts() {
    let folder = tempfile::tempdir().expect("a folder");
    workbench::droptower(folder.path(), &["new", "drop", "drop.toml"]);
    let text =
        "let t = scenario(\"drop.toml\"); t.with(#{ title: \"again\" }); measure(\"duration\", t.model.duration);";
    fs::write(folder.path().join("read.rhai"), text).expect("a script");
    let changes = ["--set", "impactor.friction=5", "--unset", "specimen.material.fabric.absorption"];
    let codes = |summary: &str| -> Vec<String> {
        let text = fs::read_to_string(folder.path().join(summary)).expect("a summary");
        let summary: Json = serde_json::from_str(&text).expect("JSON");
        let codes = summary["findings"].as_array().expect("findings").iter().map(|finding| &finding["code"]);
        codes.filter_map(Json::as_str).map(String::from).collect()
    };
    workbench::printed(&workbench::droptower(folder.path(), &[&["script", "read.rhai"][..], &changes].concat()));
    assert_eq!(codes("runs/read/summary.json"), ["implausible-value", "absorption-not-given"], "each once");
    let quick = ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=2ms"];
    let run = workbench::droptower(folder.path(), &[&["run", "drop.toml"][..], &changes, &quick].concat());
    assert!(workbench::error(&run).contains("warning[implausible-value]: `impactor.friction`"));
    let found = codes("runs/drop/summary.json");
    assert!(found.contains(&"implausible-value".to_owned()), "{found:?}");
    assert!(!found.contains(&"absorption-not-given".to_owned()), "no rebound: {found:?}");
}

#[test]
fn quantities_of_options_are_refused_with_the_form_that_is_expected() {
    let drop = ["signal", "drop", "data/virtual/1008.csv", "--height", "1 m", "--mass"];
    let hic = ["signal", "hic", "data/virtual/1008.csv", "--column", "accelerometer", "--window"];
    for (call, value, expected) in [
        (drop, "10.72", "expected a mass with its unit, such as \"10.72 kg\", found \"10.72\""),
        (drop, "10,72 kg", "; write it with a decimal point: \"10.72 kg\""),
        (hic, "15,5", "; write it with a decimal point: \"15.5\""),
        (hic, "15 mm", "expected a time in ms, such as 15 or \"15 ms\", found \"15 mm\""),
    ] {
        let output = droptower(&[&call[..], &[value]].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(workbench::error(&output).contains(expected), "{}", workbench::error(&output));
    }
    assert_eq!(standard_output(&[&hic[..], &["15 ms"]].concat()), standard_output(&[&hic[..], &["15"]].concat()));
}

#[test]
fn explain_knows_the_figures_of_runs() {
    let peak = standard_output(&["explain", "peak_acceleration_m_s2"]);
    let expected = "Largest filtered acceleration; none where it met nothing.\n    figure of summary.json; in m/s2; of loading.impact\n    \
                    in scripts `run.summary.peak_acceleration_m_s2`";
    assert!(peak.contains(expected), "{peak}");
    let left = standard_output(&["explain", "left_peak_acceleration_m_s2"]);
    assert!(left.contains("of the impactor \"left\""), "{left}");
    let all = standard_output(&["explain", "figures"]);
    assert!(all.contains(peak.trim_end()) && all.contains("energy_balance_error\n"), "{all}");
    let output = droptower(&["explain", "energy_absorbtion"]);
    assert_eq!(output.status.code(), Some(2));
    let hint = "did you mean the figure `energy_absorption`?";
    assert!(String::from_utf8_lossy(&output.stderr).contains(hint), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_study_with_a_module_shows_it_and_tells_its_mistakes() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let module = |body: &str| {
        fs::create_dir_all(at.join("modules")).expect("a folder");
        fs::write(at.join("modules/double.rhai"), format!("fn doubled(args) {{\n    {body}\n}}\n")).expect("a module");
    };
    let script = "//! Doubles.\n//!\n//! --arg number=2  what is doubled\n\nimport \"double\" as double;\nmeasure(\"twice\", double::doubled(args));\n";
    fs::write(at.join("study.rhai"), script).expect("a script");
    module("2 * args.number");
    assert_eq!(
        workbench::figures(&workbench::droptower(at, &["script", "study.rhai", "--json", "--arg", "number=4"]))["twice"],
        8
    );
    let page = fs::read_to_string(at.join("runs/study/report.html")).expect("the page");
    assert!(page.contains("Module double") && page.contains("2 * args.number"));
    module("2 * args.nummer.sqroot()");
    let output = workbench::droptower(at, &["script", "--check", "study.rhai"]);
    assert!(
        output.status.code() == Some(2) && workbench::error(&output).contains("double.rhai:2:21"),
        "{}",
        workbench::error(&output)
    );
    fs::write(at.join("post.rhai"), "import \"double\" as double;\nmeasure(\"x\", 1);\n").expect("a script");
    let scenario = workbench::root().join("scenarios/indent/rubber.toml");
    let post = format!("post.script={}", at.join("post.rhai").display());
    let output = workbench::droptower(at, &["check", scenario.to_str().expect("UTF-8"), "--set", &post]);
    assert!(
        output.status.code() == Some(2) && workbench::error(&output).contains("a post script imports only"),
        "{}",
        workbench::error(&output)
    );
    fs::write(
        at.join("post.rhai"),
        "import \"droptower/tables\" as tables;\nmeasure(\"x\", tables::rounded(1.26, 1));\n",
    )
    .expect("a script");
    let coarse =
        ["run", scenario.to_str().expect("UTF-8"), "--set", &post, "--set", "specimen.mesh.size=20mm", "--json"];
    assert_eq!(workbench::figures(&workbench::droptower(at, &coarse))["x"], 1.3);
}
