//! `droptower watch`: a run on every save, and mistakes in between, which leave the last good page.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use serde_json::Value as Json;

use crate::workbench::{command, root};

const BASE: &str = "
extends = BASE
unset = [\"reference\", \"post\"]
specimen.mesh.size = \"80 mm\"
loading.impact.duration = \"10 ms\"
output.frames = 4
post.script = \"post.rhai\"
";

/// The command at work, and the events that it prints.
struct Watching {
    child: Child,
    events: Receiver<Json>,
}

impl Watching {
    fn begin(folder: &Path, more: &[&str]) -> Watching {
        let arguments = [&["watch", "drop.toml", "--json"], more].concat();
        let mut child = command(folder, &arguments).stdout(Stdio::piped()).spawn().expect("the binary starts");
        let (told, events) = mpsc::channel();
        let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                let event = serde_json::from_str(&line).expect("JSON");
                if told.send(event).is_err() {
                    return;
                }
            }
        });
        Watching { child, events }
    }

    fn next(&self) -> Json {
        self.events.recv_timeout(Duration::from_secs(120)).expect("an event within two minutes")
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn every_save_runs_again_and_mistakes_leave_the_last_good_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let base = toml::Value::from(root().join("scenarios/drop/1008.toml").to_str().expect("UTF-8")).to_string();
    let save = |name: &str, text: &str| fs::write(folder.join(name), text).expect("a file");
    save("base.toml", &BASE.replace("BASE", &base));
    save("post.rhai", "measure(\"mine\", 1.0);");
    let scenario = |mass: &str| format!("extends = \"base.toml\"\nimpactor.mass = \"{mass}\"\n");
    save("drop.toml", &scenario("10 kg"));
    let watching = Watching::begin(folder, &["--coarse", "160 mm"]);
    assert_eq!(watching.next()["event"], "watching");
    let place = folder.join("runs/drop");
    // Each save gives a coarse result and then the one that was asked for, whose summary is the one on the disk.
    let mut elements = 0.0;
    let mut both = || {
        let [coarse, fine] = [watching.next(), watching.next()];
        assert_eq!([&coarse["event"], &coarse["coarse"]], [&Json::from("run"), &Json::from(true)], "{coarse}");
        assert_eq!([&fine["event"], &fine["coarse"]], [&Json::from("run"), &Json::from(false)], "{fine}");
        let [few, many] = [&coarse, &fine].map(|event| event["summary"]["elements"].as_f64().expect("a number"));
        assert!(few < many);
        elements = many;
        let stored: Json =
            serde_json::from_slice(&fs::read(place.join("summary.json")).expect("results")).expect("JSON");
        assert_eq!(stored, fine["summary"]);
        fine["summary"].clone()
    };
    let first = both();
    assert_eq!(first["mine"], 1.0);
    save("drop.toml", &scenario("12 kg"));
    let second = both();
    let depth = |summary: &Json| summary["peak_displacement_m"].as_f64().expect("a number");
    assert!(depth(&second) < depth(&first), "a heavier sphere falls further");
    save("post.rhai", "measure(\"mine\", 2.0);");
    assert_eq!(both()["mine"], 2.0);
    save("base.toml", &BASE.replace("BASE", &base).replace("10 ms", "9 ms"));
    let third = both();
    assert!(third["steps"].as_u64() < second["steps"].as_u64(), "a shorter run");

    save("drop.toml", &scenario("12 mm"));
    let mistake = watching.next();
    assert_eq!(mistake["event"], "mistakes");
    assert_eq!([&mistake["diagnostics"][0]["line"], &mistake["diagnostics"][0]["column"]], [2, 17]);
    let page = fs::read_to_string(place.join("report.html")).expect("the last good page");
    assert!(page.contains("<title>"));
    // A base that is missing for a moment is a mistake, and its return is seen.
    fs::rename(folder.join("base.toml"), folder.join("away.toml")).expect("it moves");
    assert!(watching.next()["diagnostics"][0]["message"].as_str().expect("text").contains("cannot read"));
    fs::rename(folder.join("away.toml"), folder.join("base.toml")).expect("it moves");
    assert_eq!(watching.next()["event"], "mistakes");
    save("drop.toml", &scenario("12 kg"));
    both();
}

#[test]
fn a_mesh_with_a_mistake_is_watched() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = root().join("scenarios/drop/1008.toml");
    let text = format!(
        "extends = {base:?}\nunset = [\"reference\", \"post\"]\nspecimen.symmetry = \"none\"\n\
         impactor.shape = {{ mesh = \"ball.stl\" }}\n"
    );
    fs::write(folder.path().join("drop.toml"), text).expect("a scenario");
    let mesh = folder.path().join("ball.stl");
    fs::write(&mesh, "nothing").expect("a file");
    let watching = Watching::begin(folder.path(), &[]);
    let told = |event: &Json| event["diagnostics"][0]["message"].as_str().map(String::from).unwrap_or_default();
    assert_eq!(watching.next()["event"], "watching");
    let first = watching.next();
    assert!(told(&first).contains("ball.stl"), "{first}");
    fs::remove_file(&mesh).expect("a file");
    let second = watching.next();
    assert!(told(&second).contains("ball.stl") && told(&second) != told(&first), "{second}");
}

#[test]
fn a_save_during_a_run_ends_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = root().join("scenarios/drop/1008.toml");
    let save = |more: &str| {
        let text = format!("extends = {base:?}\nunset = [\"reference\", \"post\"]\n{more}\n");
        fs::write(folder.path().join("drop.toml"), text).expect("a scenario");
    };
    save("specimen.mesh.size = \"4 mm\"");
    let watching = Watching::begin(folder.path(), &[]);
    assert_eq!(watching.next()["event"], "watching");
    thread::sleep(Duration::from_millis(500));
    save("specimen.mesh.size = \"80 mm\"\nloading.impact.duration = \"10 ms\"");
    let run = watching.next();
    assert!(run["summary"]["elements"].as_f64().expect("a number") < 1000.0, "the long run gave no result");
}
