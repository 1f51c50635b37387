//! `droptower repl` with piped input, and scripts that import modules.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Output, Stdio};

use crate::workbench::{command, droptower, error, figures, printed, root};

/// The session of these lines.
fn typed(folder: &Path, options: &[&str], lines: &str) -> Output {
    let words = [&["repl"], options].concat();
    let mut child = command(folder, &words)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    child.stdin.take().expect("a pipe").write_all(lines.as_bytes()).expect("it reads");
    child.wait_with_output().expect("it ends")
}

#[test]
fn a_piped_session_prints_values_tables_and_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::write(at.join("tower.rhai"), "const MASS = 10.72;\nfn energy(height) { global::MASS * 9.81 * height }\n")
        .expect("a module");
    let lines = "let heights = [1.0,\n    1.5];\nimport \"tower\" as tower;\nheights.map(|h| tower::energy(h))\n\
        table(\"drops\", heights.map(|h| #{ height_m: h, energy_J: tower::energy(h) }));\n\
        let fall = signal([0, 1, 2], [0, 4, 1]);\nfall\nargs.most + 1\n:save typed.rhai\n:vars\n";
    let output = typed(at, &["--arg", "most=12"], lines);
    let told = printed(&output);
    for part in ["[105.2, 157.7]", "energy_J", "time (s)", "⠑", "\n13\n", "typed.rhai: ", "fall  signal of 3 samples"]
    {
        assert!(told.contains(part), "{part}\n{told}");
    }
    let saved = fs::read_to_string(at.join("typed.rhai")).expect("the file");
    assert!(saved.starts_with("let heights = [1.0,\n    1.5];\n") && !saved.contains(":vars"), "{saved}");
    let again = typed(at, &["--arg", "most=1"], ":save typed.rhai\n");
    assert!(
        again.status.code() == Some(2) && error(&again).contains("already exists and was not written by droptower")
    );
    for (name, expected) in [("typed.txt", "does not end in .rhai"), ("other/typed.rhai", "would not find its modules")]
    {
        let refused = typed(at, &[], &format!("import \"tower\" as tower;\n:save {name}\n"));
        assert!(refused.status.code() == Some(2) && error(&refused).contains(expected), "{}", error(&refused));
        assert!(!at.join(name).exists());
    }
    let loaded = typed(at, &["--arg", "most=1"], ":load typed.rhai\nheights.len()\n");
    assert!(printed(&loaded).ends_with("2\n"), "{}", printed(&loaded));
}

#[test]
fn a_script_is_loaded_with_its_modules_and_the_defaults_of_its_arguments() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::create_dir_all(at.join("studies")).expect("a folder");
    fs::write(at.join("studies/tower.rhai"), "fn energy(height) { 100 * height }\n").expect("a module");
    let script = "//! Energy.\n//!\n//! --arg height=2  of the fall\n//! --arg table  to read\n\nimport \"tower\" as tower;\n\
        fn energy_of(x) { tower::energy(x) }\nlet energy = energy_of(args.height);\nmeasure(\"energy\", energy);\nargs.table\n";
    fs::write(at.join("studies/s.rhai"), script).expect("a script");
    let session = ":load studies/s.rhai\nfn energy_of(x) { 7 }\nenergy + energy_of(1)\n:save studies/again.rhai\n";
    let told = printed(&typed(at, &["--arg", "table=a.csv", "--arg", "other=1"], session));
    assert!(told.contains("a.csv\n207\n"), "{told}");
    let given = printed(&typed(at, &["--arg", "table=a.csv", "--arg", "height=3"], ":load studies/s.rhai\nenergy\n"));
    assert!(given.ends_with("\n300\n"), "{given}");
    let again = droptower(at, &["script", "studies/again.rhai", "--json", "--arg", "table=a.csv"]);
    assert_eq!(figures(&again)["energy"], 7);
    for (lines, expected) in [
        (":load studies/s.rhai\n", "--arg table is missing"),
        (":load studies/wrong.rhai\n", "wrong.rhai:2:11"),
        (":load studies/nosuch.rhai\n", "cannot read"),
    ] {
        fs::write(at.join("studies/wrong.rhai"), "let a = 1;\nlet b = a.sqroot();\n").expect("a script");
        let output = typed(at, &[], lines);
        assert!(output.status.code() == Some(2) && error(&output).contains(expected), "{}", error(&output));
    }
    let shipped = root().join("scripts/layers.rhai");
    let shipped = typed(at, &[], &format!(":load {}\n", shipped.display()));
    assert!(error(&shipped).contains("the script needs `scenario`"), "{}", error(&shipped));
}

#[test]
fn a_long_input_is_read_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let lines = format!("(40 +\n{}2)\n\"20 °C\" // °\n", "// a line\n".repeat(60_000));
    assert_eq!(printed(&typed(folder.path(), &[], &lines)), "42\n20 °C\n");
}

#[test]
fn the_first_mistake_of_a_piped_session_ends_it() {
    let folder = tempfile::tempdir().expect("a folder");
    for (lines, expected) in [
        ("let a = 1;\nlet b = a.sqroot();\nprint(a)\n", "<input>:2:11"),
        ("fn f(x) {\n    x.nosuch\n}\nf(1)\n", "<input>:2:7"),
        ("(1 + 2\n", "<input>:1:"),
        (":lod x\n", "did you mean `:load`?"),
        (":explain nosuch\n", "there is no function `nosuch`"),
    ] {
        let output = typed(folder.path(), &[], lines);
        assert_eq!(output.status.code(), Some(2), "{lines}");
        assert!(error(&output).contains(expected), "{lines}\n{}", error(&output));
    }
    let json = typed(folder.path(), &["--json"], "[1, 2.5]\n#{ a: 1 }\nlet x = 2;\n");
    assert_eq!(printed(&json), "[1,2.5]\n{\"a\":1}\n");
}

#[test]
fn a_scenario_is_run_in_a_session() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = root().join("scenarios/indent/rubber.toml");
    let scenario = scenario.to_str().expect("UTF-8");
    let lines = "let run = scenario(args.scenario).simulate();\nrun.summary.peak_force_N\nrun.force\n";
    let output = typed(folder.path(), &["--scenario", scenario, "--set", "specimen.mesh.size=20mm"], lines);
    let told = printed(&output);
    assert!(
        told.lines().next().is_some_and(|line| line.ends_with(" N")) && told.contains("time (s)"),
        "{told}{}",
        error(&output)
    );
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
    assert_eq!(figures(&droptower(at, &["script", "study.rhai", "--json", "--arg", "number=4"]))["twice"], 8);
    let page = fs::read_to_string(at.join("runs/study/report.html")).expect("the page");
    assert!(page.contains("Module double") && page.contains("2 * args.number"));
    let traced = command(at, &["script", "study.rhai", "--trace", "--profile"]).output().expect("the binary starts");
    let told = String::from_utf8_lossy(&traced.stderr);
    assert!(told.contains("double.rhai:    2      2 * args.number") && told.contains("time (s)"), "{told}");
    module("2 * args.nummer.sqroot()");
    let output = droptower(at, &["script", "--check", "study.rhai"]);
    assert!(output.status.code() == Some(2) && error(&output).contains("double.rhai:2:21"), "{}", error(&output));
    fs::write(at.join("post.rhai"), "import \"double\" as double;\nmeasure(\"x\", 1);\n").expect("a script");
    let scenario = root().join("scenarios/indent/rubber.toml");
    let post = format!("post.script={}", at.join("post.rhai").display());
    let output = droptower(at, &["check", scenario.to_str().expect("UTF-8"), "--set", &post]);
    assert!(
        output.status.code() == Some(2) && error(&output).contains("a post script imports only"),
        "{}",
        error(&output)
    );
    fs::write(
        at.join("post.rhai"),
        "import \"droptower/tables\" as tables;\nmeasure(\"x\", tables::rounded(1.26, 1));\n",
    )
    .expect("a script");
    let coarse =
        ["run", scenario.to_str().expect("UTF-8"), "--set", &post, "--set", "specimen.mesh.size=20mm", "--json"];
    assert_eq!(figures(&droptower(at, &coarse))["x"], 1.3);
}
