//! `droptower view` and `run --live`: what they refuse, and how.

use std::fs;
#[cfg(feature = "rerun")]
use std::{net::TcpListener, process::Stdio, thread};

#[cfg(feature = "rerun")]
use crate::workbench::{await_of, command};
use crate::workbench::{droptower, error};

/// A viewer that prints another version and writes down what it is asked to open.
#[cfg(unix)]
#[test]
fn a_viewer_of_another_version_is_used_with_a_warning() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("recording.rrd"), "").expect("a file");
    let viewer = folder.path().join("viewer.sh");
    fs::write(&viewer, "#!/bin/sh\n[ \"$1\" = --version ] && echo rerun-cli 0.30.1 || echo \"$@\" > opened\n")
        .expect("a file");
    fs::set_permissions(&viewer, fs::Permissions::from_mode(0o755)).expect("executable");
    fs::write(folder.path().join("-h.rrd"), "").expect("a file");
    let output = droptower(folder.path(), &["view", "--viewer", "./viewer.sh", "--", ".", "-h.rrd"]);
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    assert!(error(&output).contains("written for the Rerun viewer 0.36"), "{}", error(&output));
    let opened = fs::read_to_string(folder.path().join("opened")).expect("opened");
    let opened: Vec<&str> = opened.split_whitespace().collect();
    let all_there = opened.iter().all(|path| path.starts_with('/') && fs::exists(path).is_ok_and(|there| there));
    assert!(opened.len() == 2 && all_there, "none can be taken for an option: {opened:?}");
}

#[cfg(feature = "rerun")]
#[test]
fn a_missing_viewer_is_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(droptower(folder.path(), &["new", "drop", "drop.toml"]).status.success());
    let coarse = ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=10ms"];
    let live = ["run", "drop.toml", "--live=rerun+http://127.0.0.1:1/proxy"];
    let output = droptower(folder.path(), &[&live[..], &coarse].concat());
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    assert!(error(&output).contains("warning: --live: no viewer answers"), "{}", error(&output));
    assert!(folder.path().join("runs/drop/recording.rrd").is_file());
}

/// A viewer that accepts every connection and never answers. The run that has stored its results waits for it for some seconds.
#[cfg(feature = "rerun")]
#[test]
fn a_viewer_that_never_answers_delays_no_results() {
    let door = TcpListener::bind("127.0.0.1:0").expect("a port");
    let live = format!("--live=rerun+http://{}/proxy", door.local_addr().expect("an address"));
    let _silence = thread::spawn(move || door.incoming().collect::<Vec<_>>());
    let folder = tempfile::tempdir().expect("a folder");
    let coarse = ["--set", "specimen.mesh.size=50mm", "--set", "loading.impact.duration=10ms"];
    for name in ["one", "two"] {
        assert!(droptower(folder.path(), &["new", "drop", &format!("{name}.toml")]).status.success());
    }
    let arguments = [&["run", "one.toml", "two.toml", &live][..], &coarse].concat();
    let mut run = command(folder.path(), &arguments).stderr(Stdio::piped()).spawn().expect("the binary starts");
    let stored = ["one", "two"].map(|name| folder.path().join("runs").join(name).join("recording.rrd"));
    assert!(await_of(&mut run, || stored.iter().any(|path| path.is_file())), "no results");
    if !thorough::thorough() {
        run.kill().and_then(|()| run.wait()).expect("a child");
        return;
    }
    let output = run.wait_with_output().expect("its output");
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    let warnings = error(&output).matches("warning: --live: ").count();
    assert!(warnings == 1 && stored.iter().all(|path| path.is_file()), "{}", error(&output));
}
