//! What the tests of the built binary share: the program, the repository, and recordings from outside of it.

use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use droptower::signal::{Annotations, ReadOptions, file, resample};
use droptower::units::Unit;
use proptest::collection::vec;
use proptest::prelude::*;
use serde_json::Value as Json;

/// The repository.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A file or folder of `data/`.
pub fn data(path: &str) -> PathBuf {
    root().join("data").join(path)
}

/// The program with `arguments`, ready to start in `folder`.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_droptower"));
    command.current_dir(folder).args(arguments);
    command
}

/// What the program leaves when started in `folder`.
pub fn droptower(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("the binary starts")
}

/// Names in a folder, in alphabetical order.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())).flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// The program at work in `folder`; what it prints is kept.
pub fn start(folder: &Path, arguments: &[&str]) -> Child {
    command(folder, arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the binary starts")
}

/// A folder with the template of a drop test in it.
pub fn drop_bench() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    printed(&droptower(folder.path(), &["new", "drop", "drop.toml"]));
    folder
}

/// Waits until something holds of what a program does; whether it did before the program ended. A machine may be as slow as
/// it likes: only a program that hangs is given up, after a quarter of an hour.
pub fn await_of(program: &mut Child, mut holds: impl FnMut() -> bool) -> bool {
    let begin = Instant::now();
    loop {
        let has_ended = program.try_wait().expect("a state").is_some();
        if holds() {
            return true;
        }
        if has_ended {
            return false;
        }
        if begin.elapsed() > Duration::from_secs(900) {
            program.kill().expect("killed");
            panic!("the program neither ends nor does what is waited for");
        }
        thread::sleep(Duration::from_millis(1));
    }
}

/// Its standard error.
pub fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What it prints where it succeeds.
pub fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", error(output));
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

/// What it prints, whether it succeeds or not.
pub fn printed_text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What it says beside its output where it succeeds.
pub fn told(output: &Output) -> String {
    printed(output);
    error(output)
}

/// What it says where it refuses its input, `expected` among it.
pub fn refused(output: &Output, expected: &str) -> String {
    let said = error(output);
    assert!(output.status.code() == Some(2) && said.contains(expected), "{expected}: {said}");
    said
}

/// The figures that it prints where it succeeds.
pub fn figures(output: &Output) -> Json {
    serde_json::from_str(&printed(output)).expect("JSON")
}

/// The JSON in a file.
pub fn json(path: &Path) -> Json {
    serde_json::from_slice(&fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))).expect("JSON")
}

/// The figures in the folder of a run or a study.
pub fn summary(folder: &Path) -> Json {
    json(&folder.join("summary.json"))
}

/// A figure that is there.
pub fn figure(figures: &Json, name: &str) -> f64 {
    figures[name].as_f64().unwrap_or_else(|| panic!("no {name} in {figures}"))
}

/// The codes of the findings among figures.
pub fn finding_codes(figures: &Json) -> Vec<&str> {
    figures["findings"].as_array().expect("findings").iter().filter_map(|finding| finding["code"].as_str()).collect()
}

/// Numbers of a column of a table, where there are any.
pub fn column(table: &Path, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(table).expect("a table");
    let place = reader.headers().expect("a header").iter().position(|own| own == name).expect(name);
    reader.records().map(|row| row.expect("a row")[place].parse().unwrap_or(f64::NAN)).collect()
}

/// A folder with a short drop on a coarse film in `drop.toml`, with these lines more.
pub fn scene(more: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let base = root().join("scenarios/drop/1008.toml");
    let text = format!(
        "extends = {base:?}\nunset = [\"reference\", \"post\"]\nspecimen.mesh.size = \"80 mm\"\n\
         loading.impact.duration = \"10 ms\"\noutput.frames = 4\n{more}\n"
    );
    fs::write(folder.path().join("drop.toml"), text).expect("a scenario");
    folder
}

/// A recording of a drop with other readings of its accelerometer, by time and reading; without the rows of none.
pub fn with_readings(recording: &str, change: impl Fn(f64, f64) -> Option<String>) -> String {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        match (cells[0].parse::<f64>(), cells.get(1).and_then(|cell| cell.parse::<f64>().ok())) {
            (Ok(time), Some(reading)) => Some(format!("{},{},{}\n", cells[0], change(time, reading)?, cells[2])),
            _ => Some(format!("{line}\n")),
        }
    };
    recording.lines().filter_map(row).collect()
}

/// The blocks of a list of `broken/files/`: the head of each, and its content, which a backslash ends where no line does.
pub fn blocks(list: &str) -> Vec<[String; 2]> {
    let text = fs::read_to_string(root().join("tests/it/broken/files").join(list)).expect("a list");
    let text = text.strip_prefix("=== ").and_then(|text| text.strip_suffix('\n')).expect("a head");
    let parts = text.split("\n=== ").map(|block| {
        // The head of a file without content ends with the next one.
        let (head, content) =
            block.split_once('\n').map_or((block, String::new()), |(head, own)| (head, format!("{own}\n")));
        [head, content.strip_suffix("\\\n").unwrap_or(&content)].map(str::to_owned)
    });
    parts.collect()
}

/// The files with a mistake in such a list: name, what is said of it, and content.
pub fn mistaken(list: &str) -> Vec<[String; 3]> {
    let parts = blocks(list).into_iter().map(|[head, content]| {
        let (name, said) = head.split_once(": ").expect("what is said");
        [name.to_owned(), said.to_owned(), content]
    });
    parts.collect()
}

/// The codes of what reading a file reported.
pub fn codes(annotations: &Annotations) -> Vec<String> {
    annotations.findings().into_iter().map(|finding| finding.code).collect()
}

/// The unit with this symbol.
pub fn unit(symbol: &str) -> Unit {
    Unit::parse(symbol).expect("a unit")
}

/// The files of a test of ISO-MME with the channels of a table, by their names.
pub fn container(table: &Path) -> Vec<(String, Vec<u8>)> {
    let found = file::read(table, &ReadOptions::default()).expect("a table");
    let mut files = vec![("T.mme".to_owned(), b"Test number:1\n".to_vec())];
    let mut list = format!("Number of channels:{}\n", found.channels.len());
    for (number, channel) in (1..).zip(&found.channels) {
        let (name, time) = (&channel.name, channel.series.time());
        list += &format!("Name of channel {number:03}:{name}\n");
        let mut text = format!(
            "Channel code:{name}\nUnit:{}\nReference channel:implicit\nTime of first sample:{:E}\nSampling interval:{:E}\nNumber of \
             samples:{}\n",
            channel.value_unit().expect("a unit"),
            time[0],
            resample::common_step(time).expect("even steps"),
            time.len()
        );
        let value = |value: &f64| if value.is_nan() { "NOVALUE\n".to_owned() } else { format!("{value:E}\n") };
        text.extend(channel.series.values().iter().map(value));
        files.push((format!("Channel/T.{number:03}"), text.into()));
    }
    files.push(("Channel/T.chn".into(), list.into()));
    files
}

/// Writes the files of a test of ISO-MME to `folder`; the path of its head.
pub fn lay_down(folder: &Path, files: &[(String, Vec<u8>)]) -> PathBuf {
    fs::create_dir_all(folder.join("Channel")).expect("a folder");
    files.iter().for_each(|(name, content)| fs::write(folder.join(name), content).expect("written"));
    folder.join("T.mme")
}

/// Asserts that two numbers agree within a share.
pub fn close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} instead of {expected}");
}

/// Error of the energy balance from the table alone: the largest change of the sum over the energy in play, which is that
/// exchanged between the terms and at least a fiftieth of the impactors' at the start.
pub fn imbalance(energies: &[(String, Vec<f64>)]) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let changes = |values: &[f64]| -> Vec<f64> { values.iter().map(|value| (value - values[0]).abs()).collect() };
    let (mut gap, mut launched, mut magnitude) = (0.0, 0.0, 0.0);
    let mut exchanged = vec![0.0; energies.first().map_or(0, |(_, values)| values.len())];
    for (name, values) in energies.iter().filter(|(_, values)| !values.is_empty()) {
        match name.as_str() {
            "time_s" => continue,
            "sum_J" => gap = largest(&mut changes(values).into_iter()),
            _ => {
                exchanged.iter_mut().zip(changes(values)).for_each(|(sum, change)| *sum += 0.5 * change);
                magnitude = largest(&mut values.iter().map(|value| value.abs())).max(magnitude);
            }
        }
        if name == "kinetic_impactor_J" {
            launched = values[0];
        }
    }
    let in_play = largest(&mut exchanged.into_iter()).max(0.02 * launched).max(1e-12 * magnitude);
    if gap == 0.0 { 0.0 } else { gap / in_play }
}

/// Shocks in a drop tower at 1 MHz (Dodson, Hong and Beliveau 2019, data set 1), up to tens of thousands of g and full
/// of ringing, in six columns without usable names. They may not be copied: see data/README.md. None where they are
/// missing, which is printed.
pub fn shocks() -> Option<PathBuf> {
    let beside = || root().parent().map(|folder| folder.join("shared/data"));
    let folder = std::env::var_os("DROPTOWER_SHARED_DATA").map(PathBuf::from).or_else(beside)?;
    let path = folder.join("droptower_highrate/accel_1.csv");
    if !path.is_file() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    Some(path)
}

/// Names for those six columns: time, accelerometers 1 to 4, and one of the two that follow; in thousands of g.
pub const SHOCK_NAMES: [&str; 6] =
    ["time [s]", "accel 1 [kg_n]", "accel 2 [kg_n]", "accel 3 [kg_n]", "accel 4 [kg_n]", "accel 5 [kg_n]"];

/// Text of any characters.
pub fn any_text(length: RangeInclusive<usize>) -> impl Strategy<Value = String> {
    vec(any::<char>(), length).prop_map(String::from_iter)
}
