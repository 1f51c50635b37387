//! What a script says of itself, its arguments, mistakes without a run, and where its time goes.

use std::fs;

use serde_json::json;

use crate::workbench::{droptower, error, figures, printed, root};

const SCRIPT: &str = "//! Doubles a number.
//!
//! --arg number=2   what is doubled
//! --arg unit=      appended where it is given

let twice = 2 * args.number;
if \"unit\" in args { print(args.unit); }
fn tell(x) {
    measure(\"twice\", x);
}
tell(twice);
";

#[test]
fn a_script_explains_itself_and_its_arguments_have_kinds() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::write(at.join("double.rhai"), SCRIPT).expect("a script");
    let told = printed(&droptower(at, &["script", "double.rhai", "--help"]));
    for part in
        ["Doubles a number.", "--arg number=2  what is doubled", "--arg unit      appended", "Usage: droptower script"]
    {
        assert!(told.contains(part), "{told}");
    }
    let about = figures(&droptower(at, &["script", "double.rhai", "--help", "--json"]));
    assert_eq!(
        about["arguments"][0],
        json!({"name": "number", "default": "2", "kind": "number", "text": "what is doubled"})
    );
    assert!(printed(&droptower(at, &["script", "--help"])).contains("--check"));
    assert_eq!(figures(&droptower(at, &["script", "double.rhai", "--json"]))["twice"], 4);
    let given = ["script", "double.rhai", "--arg", "number=3.5", "--out", "other", "--json"];
    assert_eq!(figures(&droptower(at, &given))["twice"], 7.0);
    for (argument, expected) in
        [("nummer=3", "did you mean `number`?"), ("number=three", "--arg number: expected a number, found `three`")]
    {
        let output = droptower(at, &["script", "double.rhai", "--arg", argument]);
        assert!(output.status.code() == Some(2) && error(&output).contains(expected), "{}", error(&output));
    }
    fs::write(at.join("unread.rhai"), "//! --arg more=1  nothing\nmeasure(\"x\", 1);\n").expect("a script");
    let output = droptower(at, &["script", "unread.rhai"]);
    assert!(error(&output).contains("declares --arg more and does not read it"), "{}", error(&output));
}

#[test]
fn mistakes_are_found_without_a_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::write(at.join("good.rhai"), SCRIPT).expect("a script");
    assert!(printed(&droptower(at, &["script", "--check", "good.rhai"])).contains("no mistakes"));
    fs::write(at.join("bad.rhai"), "let a = scenaro(\"x.toml\");\na.simulate();\n").expect("a script");
    let output = droptower(at, &["script", "--check", "bad.rhai"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("bad.rhai:1:9") && error(&output).contains("scenaro"), "{}", error(&output));
    assert!(!at.join("runs").exists(), "nothing is written");
}

#[test]
fn every_shipped_script_is_without_mistakes() {
    for script in glob::glob(root().join("scripts/*.rhai").to_str().expect("UTF-8")).expect("a pattern").flatten() {
        let script = script.to_str().expect("UTF-8").to_owned();
        let output = droptower(&root(), &["script", "--check", &script]);
        assert!(output.status.success(), "{}", error(&output));
    }
}
