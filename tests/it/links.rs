//! Links in a project that somebody else packed: nothing is written through them.

use std::fs;
use std::os::unix::fs::symlink;

use tempfile::TempDir;

use crate::workbench::{drop_bench, droptower, error, names, printed, refused};

const SENTINEL: &str = "not yours\n";

/// A run of some milliseconds.
const QUICK: [&str; 5] = ["--set", "specimen.mesh.size=80mm", "--set", "loading.impact.duration=3ms", "--quiet"];

/// A project with a drop test, and a folder outside of it with a file.
fn project() -> (TempDir, TempDir) {
    let (project, outside) = (drop_bench(), tempfile::tempdir().unwrap());
    fs::write(outside.path().join("sentinel"), SENTINEL).unwrap();
    (project, outside)
}

/// Each path that the program makes up, as a link, with the command that writes there; whether the command goes on without
/// the link, or refuses it.
#[test]
fn nothing_is_written_through_a_link() {
    let run = ["run", "drop.toml"];
    let checkpoints = ["run", "drop.toml", "--checkpoint-every", "1 ms"];
    let sweep = ["sweep", "drop.toml", "--set", "variation.\"impactor.mass\"=[10, 11]", "--out", "swept"];
    let to_folder: [(&str, &[&str]); 4] =
        [("runs", &run), ("runs", &sweep[..4]), ("runs/.evaluations", &sweep), ("runs/drop.checkpoint", &checkpoints)];
    for (link, arguments) in to_folder {
        let (project, outside) = project();
        let link = project.path().join(link);
        fs::create_dir_all(link.parent().unwrap()).unwrap();
        symlink(outside.path(), &link).unwrap();
        let arguments = [arguments, &QUICK].concat();
        let refused = droptower(project.path(), &arguments);
        let message = error(&refused);
        assert!(!refused.status.success() && message.contains("is a link"), "{arguments:?}: {message}");
        assert_eq!(names(outside.path()), ["sentinel"], "{arguments:?}");
    }
    let (project, outside) = project();
    let sentinel = outside.path().join("sentinel");
    let unfinished = project.path().join("runs/drop.checkpoint/unfinished");
    fs::create_dir_all(unfinished.parent().unwrap()).unwrap();
    symlink(&sentinel, &unfinished).unwrap();
    printed(&droptower(project.path(), &[&checkpoints[..], &QUICK].concat()));
    assert_eq!(fs::read_to_string(&sentinel).unwrap(), SENTINEL);
}

/// A link to results of one's own is told before anything is computed.
#[test]
fn results_are_not_stored_at_a_link() {
    let (project, _) = project();
    printed(&droptower(project.path(), &[&["run", "drop.toml", "--out", "results"], &QUICK[..]].concat()));
    symlink("results", project.path().join("latest")).unwrap();
    let second = droptower(project.path(), &[&["run", "drop.toml", "--out", "latest"], &QUICK[..]].concat());
    refused(&second, "latest is a link");
}
