//! What a shell and an editor know of droptower: completion, manual pages, the schema.

use std::fs;
use std::path::Path;

use crate::workbench::{command, droptower, printed, refused};

/// What a shell is offered for the words behind `droptower`, the last of which is not complete.
fn offered(folder: &Path, words: &[&str]) -> Vec<String> {
    let arguments = [&["--", "droptower"], words].concat();
    let output = command(folder, &arguments).env("DROPTOWER_COMPLETE", "fish").output().expect("the binary starts");
    printed(&output).lines().map(|line| line.split('\t').next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn shells_complete_commands_keys_and_files() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["drop.toml", "notes.txt", "study.rhai"] {
        fs::write(folder.path().join(name), "").expect("a file");
    }
    assert_eq!(offered(folder.path(), &["swe"]), ["sweep"]);
    assert_eq!(offered(folder.path(), &["run", "drop.toml", "--set", "impactor.ma"]), ["impactor.mass="]);
    assert_eq!(offered(folder.path(), &["run", "x", "--set", "specimen.symmetry=q"]), ["specimen.symmetry=quarter"]);
    assert_eq!(offered(folder.path(), &["explain", "specimen.mesh.si"]), ["specimen.mesh.size"]);
    assert_eq!(offered(folder.path(), &["run", "d"]), ["drop.toml"]);
    assert_eq!(offered(folder.path(), &["script", "s"]), ["study.rhai"]);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = printed(&droptower(folder.path(), &["completions", shell]));
        assert!(script.contains("DROPTOWER_COMPLETE"), "{shell}: {script}");
    }
    refused(&droptower(folder.path(), &["completions", "tcsh"]), "bash, ");
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(printed(&droptower(folder.path(), &["man"])).contains(".TH droptower 1"));
    printed(&droptower(folder.path(), &["man", "pages"]));
    for page in ["droptower.1", "droptower-run.1", "droptower-signal-filter.1"] {
        assert!(folder.path().join("pages").join(page).is_file(), "{page}");
    }
}

#[test]
fn a_new_scenario_names_its_schema() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a file");
    printed(&droptower(folder.path(), &["new", "drop", "mine.toml"]));
    assert!(read("mine.toml").starts_with("#:schema droptower.schema.json\n"));
    let schema: serde_json::Value = serde_json::from_str(&read("droptower.schema.json")).expect("JSON");
    assert!(schema["properties"]["impactor"].is_object(), "the schema of scenarios");
    fs::write(folder.path().join("droptower.schema.json"), "mine").expect("a file");
    printed(&droptower(folder.path(), &["new", "coupon", "other.toml"]));
    assert_eq!(read("droptower.schema.json"), "mine", "a file of the user's is left");
}
