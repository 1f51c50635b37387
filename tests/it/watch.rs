//! `droptower watch`: a run on every save, mistakes in between, and the page that shows both.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use serde_json::Value as Json;

use crate::workbench::{command, droptower, error, root};

const BASE: &str = "
extends = BASE
unset = [\"reference\", \"post\"]
specimen.mesh.size = \"80 mm\"
loading.impact.duration = \"10 ms\"
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

/// What the page's server answers: status and text.
fn fetch(address: &str, path: &str, host: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(address).expect("it answers");
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").expect("it reads");
    let mut text = String::new();
    stream.read_to_string(&mut text).expect("text");
    let status = text.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
    (status, text)
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
    let address =
        watching.next()["page"].as_str().and_then(|page| page.strip_prefix("http://")).expect("a page").to_owned();
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

    let (status, shown) = fetch(&address, "/shown", &address);
    assert_eq!(status, 200);
    assert!(shown.ends_with("{\"result\":8,\"mistakes\":\"\"}"), "{shown}");
    save("drop.toml", &scenario("12 mm"));
    let mistake = watching.next();
    assert_eq!(mistake["event"], "mistakes");
    assert_eq!([&mistake["diagnostics"][0]["line"], &mistake["diagnostics"][0]["column"]], [2, 17]);
    let page = fetch(&address, "/shown", &address).1;
    assert!(page.contains("expected a mass") && page.contains("\"result\":8"), "{page}");
    let (status, report) = fetch(&address, "/run/report.html?result=8", &address);
    assert!(status == 200 && report.contains("<title>"), "the last good page is served");
    assert!(fetch(&address, "/", &address).1.contains("report.html"));
    for (path, host, refused) in [
        ("/shown", "example.org", 403),
        ("/run/../drop.toml", address.as_str(), 404),
        ("/run/%2e%2e/drop.toml", &address, 404),
        ("/run/tables", &address, 404),
    ] {
        assert_eq!(fetch(&address, path, host).0, refused, "{path}");
    }
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
    let watching = Watching::begin(folder.path(), &["--no-page"]);
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
    let watching = Watching::begin(folder.path(), &["--no-page"]);
    assert_eq!(watching.next()["page"], Json::Null);
    thread::sleep(Duration::from_secs(2));
    save("specimen.mesh.size = \"80 mm\"\nloading.impact.duration = \"10 ms\"");
    let run = watching.next();
    assert!(run["summary"]["elements"].as_f64().expect("a number") < 1000.0, "the long run gave no result");
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = droptower(folder.path(), &["watch", "none.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error(&output).contains("there is no scenario none.toml"));
}
