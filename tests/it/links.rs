//! Links in a project that somebody else packed: nothing is written through them.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use tempfile::TempDir;

use crate::workbench::{droptower, error};

const SENTINEL: &str = "not yours\n";

/// A run of some milliseconds.
const QUICK: [&str; 5] = ["--set", "specimen.mesh.size=80mm", "--set", "loading.impact.duration=3ms", "--quiet"];

/// A project with a drop test and a search, and a folder outside of it with a file.
fn project() -> (TempDir, TempDir) {
    let (project, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert!(droptower(project.path(), &["new", "drop", "drop.toml"]).status.success());
    let search = "minimize(\"nelder-mead\", [2.0], #{ names: [\"k1\"] }, |x| x[0] ** 2);\n";
    fs::write(project.path().join("search.rhai"), search).unwrap();
    fs::write(outside.path().join("sentinel"), SENTINEL).unwrap();
    (project, outside)
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Each path that the program makes up, as a link, with the command that writes there; whether the command goes on without
/// the link, or refuses it.
#[test]
fn nothing_is_written_through_a_link() {
    let run = ["run", "drop.toml"];
    let checkpoints = ["run", "drop.toml", "--checkpoint-every", "1 ms"];
    let sweep = ["sweep", "drop.toml", "--set", "variation.\"impactor.mass\"=[10, 11]", "--out", "swept"];
    let search = ["script", "search.rhai", "--out", "found"];
    let to_folder: [(&str, &[&str]); 5] = [
        ("runs", &run),
        ("runs", &sweep[..4]),
        ("runs/.evaluations", &sweep),
        ("runs/drop.checkpoint", &checkpoints),
        ("found.history", &search),
    ];
    for (link, arguments) in to_folder {
        let (project, outside) = project();
        let link = project.path().join(link);
        fs::create_dir_all(link.parent().unwrap()).unwrap();
        symlink(outside.path(), &link).unwrap();
        let arguments = if arguments[0] == "script" { arguments.to_vec() } else { [arguments, &QUICK].concat() };
        let refused = droptower(project.path(), &arguments);
        let message = error(&refused);
        assert!(!refused.status.success() && message.contains("is a link"), "{arguments:?}: {message}");
        assert_eq!(files(outside.path()), ["sentinel"], "{arguments:?}");
    }
    let (project, outside) = project();
    let sentinel = outside.path().join("sentinel");
    let unfinished = project.path().join("runs/drop.checkpoint/unfinished");
    fs::create_dir_all(unfinished.parent().unwrap()).unwrap();
    symlink(&sentinel, &unfinished).unwrap();
    let done = droptower(project.path(), &[&checkpoints[..], &QUICK].concat());
    assert!(done.status.success(), "{}", error(&done));
    assert_eq!(fs::read_to_string(&sentinel).unwrap(), SENTINEL);
}

/// A history is found by its name, which depends on the search alone: whoever packs the project can foretell it.
#[test]
fn a_history_that_is_a_link_is_refused() {
    let (project, outside) = project();
    let search = ["script", "search.rhai", "--out", "found"];
    let first = droptower(project.path(), &search);
    assert!(first.status.success(), "{}", error(&first));
    let folder = project.path().join("found.history");
    let history = folder.join(&files(&folder)[0]);
    fs::remove_file(&history).unwrap();
    symlink(outside.path().join("sentinel"), &history).unwrap();
    let refused = droptower(project.path(), &[&search[..], &["--force"]].concat());
    assert!(!refused.status.success() && error(&refused).contains("is a link"), "{}", error(&refused));
    assert_eq!(fs::read_to_string(outside.path().join("sentinel")).unwrap(), SENTINEL);
}

/// A link to results of one's own is told before anything is computed.
#[test]
fn results_are_not_stored_at_a_link() {
    let (project, _) = project();
    let first = droptower(project.path(), &[&["run", "drop.toml", "--out", "results"], &QUICK[..]].concat());
    assert!(first.status.success(), "{}", error(&first));
    symlink("results", project.path().join("latest")).unwrap();
    let refused = droptower(project.path(), &[&["run", "drop.toml", "--out", "latest"], &QUICK[..]].concat());
    let message = error(&refused);
    assert_eq!(refused.status.code(), Some(2), "{message}");
    assert!(message.contains("latest is a link"), "{message}");
}
