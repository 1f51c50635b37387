//! Virtual drops: made, reduced, and compared with the simulation they were made from; the command, the reference and
//! the scripts.

use std::fs;
use std::path::Path;
use std::process::Output;

use droptower::error::Kind;
use droptower::experiment::absorption::Body;
use droptower::experiment::drop::{self, ChannelNames, Drop, DropChannels, Reduction, Tower};
use droptower::model::{self, Model};
use droptower::post::Plan;
use droptower::scenario::{Assignment, Document};
use droptower::signal::Series;
use droptower::signal::file::{self, ReadOptions};
use serde_json::Value as Json;

use crate::workbench::{self, SHOCK_NAMES, refused, root, shocks};

const BODY: Body = Body { mass: 10.72, gravity: 9.81 };
const TESTS: [&str; 5] = ["1008", "1009", "1010", "1509", "1510"];

fn droptower(arguments: &[&str]) -> Output {
    workbench::droptower(&root(), arguments)
}

/// What was simulated.
#[derive(Clone, Debug)]
struct TrueFigures {
    height: f64,
    speed: f64,
    contact_time: f64,
    displacement: f64,
    absorption: f64,
}

/// The requirement: speed within 0.5 %, contact within 0.2 ms, absorption within 1 point, travel within 1 %.
fn assert_found(drop: &Drop, exact: &TrueFigures, what: &str) {
    let figures = drop.figures();
    let displacement = figures.peak_displacement_m.expect("a largest travel");
    let absorption = figures.energy_absorption.expect("an absorption");
    assert!((figures.impact_velocity_m_s / exact.speed - 1.0).abs() < 5e-3, "{what}: {figures:?} for {exact:?}");
    assert!((figures.contact_time_s - exact.contact_time).abs() < 2e-4, "{what}: {figures:?} for {exact:?}");
    assert!((absorption - exact.absorption).abs() < 0.01, "{what}: {figures:?} for {exact:?}");
    assert!((displacement / exact.displacement - 1.0).abs() < 0.01, "{what}: {figures:?} for {exact:?}");
}

fn reduced(acceleration: &Series, laser: Option<&Series>, height: f64) -> Drop {
    let tower = Tower { body: BODY, height: Some(height) };
    drop::reduce(acceleration, laser, &tower, &Reduction::default()).expect("a drop")
}

fn true_figures() -> Vec<(String, TrueFigures)> {
    let mut reader = csv::Reader::from_path(root().join("data/virtual/tables/virtual_drops.csv")).expect("a table");
    let rows = reader.records().map(|row| row.expect("a row"));
    let exact = |row: csv::StringRecord| {
        let number = |column: usize| row[column].parse::<f64>().expect("a number");
        let [height, speed, contact_time] = [1, 3, 4].map(number);
        (row[0].to_owned(), TrueFigures { height, speed, contact_time, displacement: number(5), absorption: number(6) })
    };
    rows.map(exact).collect()
}

#[test]
fn shipped_recordings_reduce_to_the_figures_of_their_table() {
    let true_figures = true_figures();
    assert_eq!(true_figures.iter().map(|(test, _)| test.as_str()).collect::<Vec<_>>(), TESTS);
    for (test, exact) in true_figures {
        let path = root().join(format!("data/virtual/{test}.csv"));
        let measurement = file::read(&path, &ReadOptions::default()).expect("a recording");
        let sensed = DropChannels::find(&measurement, &ChannelNames::default()).expect("an accelerometer");
        assert_eq!(sensed.laser.is_none(), test == "1509");
        assert_found(&reduced(&sensed.acceleration, sensed.laser.as_ref(), exact.height), &exact, &test);
    }
}

fn shipped(test: &str) -> DropChannels {
    let measurement = file::read(&root().join(format!("data/virtual/{test}.csv")), &ReadOptions::default());
    DropChannels::find(&measurement.expect("a recording"), &ChannelNames::default()).expect("an accelerometer")
}

/// Of 1509, which fell 1.5 m and has no laser, other heights are no explanation.
#[test]
fn without_a_laser_a_wrong_height_is_refused_or_doubted() {
    let reading = shipped("1509").acceleration;
    let close = |height: f64| {
        let tower = Tower { body: BODY, height: Some(height) };
        drop::reduce(&reading, None, &tower, &Reduction::default())
    };
    for height in thorough::first(3, [1.4, 1.6, 0.3, 0.5, 1.0, 1.3, 1.7, 2.5]) {
        let refused = close(height).expect_err("another height").to_string();
        assert!(refused.contains("the fall that was recorded has height 1."), "{height}: {refused}");
    }
    for height in thorough::first(2, [1.49, 1.51, 1.5]) {
        let [low, high] = close(height).expect("nearly the height").intervals.expect("intervals").contact_time;
        assert!(low - 5e-4 < 0.79164 && 0.79164 < high + 5e-4, "{height}: {low} to {high}");
    }
}

/// 1008 fell 1 m: with a laser another height gives the same figures, unless nothing can fall so fast.
#[test]
fn with_a_laser_a_wrong_height_has_a_warning() {
    let DropChannels { acceleration, laser, .. } = shipped("1008");
    let reduce = |height: f64| {
        let tower = Tower { body: BODY, height: Some(height) };
        drop::reduce(&acceleration, laser.as_ref(), &tower, &Reduction::default())
    };
    let right = reduce(1.0).expect("a drop");
    assert_eq!(right.warnings, []);
    for height in thorough::first(2, [0.9, 3.0, 0.5, 1.5]) {
        let drop = reduce(height).expect("a drop");
        assert!((drop.contact.velocity / right.contact.velocity - 1.0).abs() < 2e-3, "{height}: {:?}", drop.contact);
        assert!(
            drop.figures().notes.iter().any(|note| note.contains("show a height of ")),
            "{height}: {:?}",
            drop.warnings
        );
    }
}

#[test]
fn shipped_recordings_are_small_and_marked_as_virtual() {
    for test in TESTS {
        let text = fs::read_to_string(root().join(format!("data/virtual/{test}.csv"))).expect("a text");
        assert!(text.starts_with("# VIRTUAL drop test"), "{test}");
        assert!(text.len() < 200_000, "{test}: {} bytes", text.len());
    }
}

#[test]
fn the_virtual_recordings_can_be_regenerated_in_place() {
    droptower::store::check_places(&[root().join("data/virtual")]).expect("nothing in it but what the script left");
}

#[test]
fn shipped_recordings_regenerate_bit_for_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("virtual");
    let out_text = out.to_str().expect("UTF-8");
    let script = ["script", "scripts/make-virtual-tests.rhai", "--arg", "part=drops", "--out", out_text, "--quiet"];
    workbench::printed(&droptower(&script));
    let files = TESTS.iter().map(|test| format!("{test}.csv")).chain(["tables/virtual_drops.csv".into()]);
    for file in files {
        let read = |folder: &Path| fs::read(folder.join(&file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(read(&out) == read(&root().join("data/virtual")), "{file} differs from the shipped one");
    }
    assert!(!out.join("coupons").exists());
}

/// A shipped scenario on a mesh of 20 mm.
fn coarse(test: &str) -> Model {
    let path = root().join(format!("scenarios/drop/{test}.toml"));
    let change = Assignment::from_argument("specimen.mesh.size=20mm").expect("a change");
    model::check(&Document::read(&path).expect("a scenario").with(&[change])).expect("a model")
}

/// A scenario that names a recording without laser and not the height: its own speed closes the fall, with a warning,
/// and another speed than that of the test is refused.
#[test]
fn a_reference_without_laser_and_height_is_reduced_with_the_speed_of_the_run() {
    let mut model = coarse("1509");
    model.reference.as_mut().expect("a reference").written.drop_height = None;
    let with_speed = |speed: f64| {
        let mut model = model.clone();
        model.impactors[0].velocity[2] = -speed;
        Plan::prepare(&model).map_err(|error| error.to_string())
    };
    let (_, exact) = true_figures().remove(3);
    let plan = with_speed(exact.speed).expect("a reference");
    let reference = plan.comparison().expect("a comparison");
    let travel = reference.displacement.as_ref().and_then(Series::smallest).expect("a turn");
    assert!((travel[1] / exact.displacement - 1.0).abs() < 0.01, "{travel:?} for {exact:?}");
    let warnings: Vec<String> = reference.warnings().map(|warning| warning.to_string()).collect();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].starts_with("reference: VIRTUAL drop test: nothing fell"), "{warnings:?}");
    assert!(warnings[1].starts_with("reference: no laser and no height"), "{warnings:?}");
    for share in [0.85, 1.15] {
        let refused = with_speed(share * exact.speed).expect_err("another speed");
        assert!(refused.contains("the fall that was recorded has impact speed"), "{share}: {refused}");
    }
}

/// What is virtual stays virtual in figures and warnings of whatever is compared with it.
#[test]
fn a_run_reports_a_virtual_reference() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("run");
    let short = ["--set", "specimen.mesh.size=40mm", "--set", "loading.impact.duration=2ms", "--quiet"];
    let call = [&["run", "scenarios/drop/1008.toml", "--out", out.to_str().expect("UTF-8")][..], &short].concat();
    let output = droptower(&call);
    workbench::printed(&output);
    let summary = workbench::summary(&out);
    let notes = summary["reference_notes"].as_array().expect("notes");
    assert!(notes[0].as_str().expect("a note").starts_with("VIRTUAL drop test"), "{notes:?}");
    let warnings = summary["warnings"].as_array().expect("warnings");
    let is_mark = |warning: &Json| warning.as_str().is_some_and(|text| text.starts_with("reference: VIRTUAL"));
    assert!(warnings.iter().any(is_mark), "{warnings:?}");
}

#[test]
fn the_command_prints_figures_and_writes_signals() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("reduced.csv");
    let call = ["reduce", "drop", "data/virtual/1010.csv", "--mass", "10.72 kg", "--height", "10 dm", "--json"];
    let figures = workbench::figures(&droptower(&[&call[..], &["-o", out.to_str().expect("UTF-8")]].concat()));
    let (_, exact) = true_figures().remove(2);
    let figure = |name: &str| workbench::figure(&figures, name);
    assert!((figure("impact_velocity_m_s") / exact.speed - 1.0).abs() < 5e-3);
    assert!((figure("ideal_velocity_m_s") - 4.43).abs() < 5e-3);
    assert!((figure("energy_absorption") - exact.absorption).abs() < 0.01);
    assert!((figure("laser_residual_m") / 5e-5 - 1.0).abs() < 0.3);
    assert_eq!(figures["speed_from"], "laser");
    assert!(figures["notes"][0].as_str().expect("a note").starts_with("VIRTUAL drop test"), "{figures}");
    assert_eq!(figures["findings"][0]["code"], "virtual-recording", "{figures}");
    let text = fs::read_to_string(&out).expect("the reduced signals");
    assert!(text.lines().any(|line| line.starts_with("# VIRTUAL drop test: nothing fell")), "{}", &text[..500]);
    let shown = workbench::printed(&droptower(&call[..call.len() - 1]));
    assert!(shown.contains("warning[virtual-recording]: VIRTUAL drop test: nothing fell"), "{shown}");
    let written = file::read(&out, &ReadOptions::default()).expect("the reduced signals");
    let travel = &written.channel("displacement_m").expect("a channel").series;
    assert_eq!((travel.time()[0], travel.values()[0]), (0.0, 0.0));
    assert_eq!(travel.smallest().map(|[_, place]| place), Some(figure("peak_displacement_m")));
    // Without the laser the same recording gives nearly the same.
    let blind = workbench::figures(&droptower(&[&call[..], &["--without-laser"]].concat()));
    assert_eq!(blind["speed_from"], "fall");
    let blind = |name: &str| workbench::figure(&blind, name);
    workbench::close(blind("impact_velocity_m_s"), exact.speed, 5e-3);
    workbench::close(blind("peak_displacement_m"), exact.displacement, 0.015);
    assert!((blind("contact_time_s") - exact.contact_time).abs() < 3e-4);
    assert!((blind("energy_absorption") - exact.absorption).abs() < 0.015);
}

#[test]
fn bad_input_exits_with_two_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.csv");
    let shipped = fs::read_to_string(root().join("data/virtual/1008.csv")).expect("a text");
    let cut = |from: f64, to: f64| {
        workbench::with_readings(&shipped, |time, reading| (from..to).contains(&time).then(|| reading.to_string()))
    };
    let gap = shipped.replacen("\n0.3,", "\n0.3,,\n0.30001,", 1);
    let backwards = shipped.replacen("\n0.3,", "\n0.2,", 1);
    for (text, with, expected) in [
        (cut(0.0, 0.6), "", "there is no contact"),
        (cut(0.3, 9.0), "", "there is no release"),
        (gap, "", "nothing was measured at 0.3 s"),
        (backwards, "", "time does not increase"),
        (shipped.replace("laser_m", "laser_kg").replace("accelerometer_m_s2", "force_N"), "", "is an acceleration"),
        (shipped.clone(), "--laser=lasr", "no channel `lasr`"),
        (shipped.clone(), "--laser=accelerometer", "not a length"),
        (shipped.clone(), "--class=2000", "CFC 2000 needs at least 20000 samples a second"),
        (shipped.clone(), "--time-constant=-1 s", "the time constant is -1, but must be positive"),
        (shipped.clone(), "--gravity=1 kg", "expected an acceleration"),
        (String::new(), "", "recording.csv"),
    ] {
        let path = folder.path().join("recording.csv");
        fs::write(&path, text).expect("a recording");
        let mut call = vec!["reduce", "drop", path.to_str().expect("UTF-8"), "--mass", "10.72 kg", "--height", "1 m"];
        call.extend(["-o", out.to_str().expect("UTF-8")]);
        call.extend((!with.is_empty()).then_some(with));
        refused(&droptower(&call), expected);
        assert!(!out.exists(), "{expected}");
    }
}

#[test]
fn a_recording_is_never_replaced_by_its_own_signals() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("1008.csv");
    fs::copy(root().join("data/virtual/1008.csv"), &path).expect("a copy");
    let name = path.to_str().expect("UTF-8");
    refused(&droptower(&["reduce", "drop", name, "--mass", "10.72 kg", "--height", "1 m", "-o", name]), "");
    assert_eq!(fs::read(&path).expect("a file"), fs::read(root().join("data/virtual/1008.csv")).expect("a file"));
}

/// Other names and units, as a laboratory may write them.
#[test]
fn a_raw_reference_may_be_written_in_any_units_and_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let shipped = file::read(&root().join("data/virtual/1008.csv"), &ReadOptions::default()).expect("a recording");
    let [reading, laser] =
        ["accelerometer_m_s2", "laser_m"].map(|name| &shipped.channel(name).expect("a channel").series);
    let row = |i: usize| {
        let place = 1e3 * laser.values()[i];
        let place = if place.is_finite() { place.to_string() } else { String::new() };
        format!("{},{},{place},1\n", 1e3 * reading.time()[i], reading.values()[i] / 9.80665)
    };
    let rows: String = (0..reading.len()).map(row).collect();
    fs::write(folder.path().join("raw.csv"), format!("t [ms],head [g],optoNCDT [mm],stage [m]\n{rows}"))
        .expect("a table");
    let noted = rows.replace(",1\n", ",1,armed\n");
    fs::write(folder.path().join("noted.csv"), format!("t [ms],head [g],optoNCDT [mm],stage [m],status\n{noted}"))
        .expect("a table");
    let scenario = folder.path().join("raw.toml");
    let write = |keys: &str| {
        let base = root().join("scenarios/drop/1008.toml");
        let signals = if keys.starts_with("signals") { "" } else { "signals = \"raw.csv\"\n" };
        let text = format!("extends = {base:?}\n[reference]\n{signals}{keys}\n");
        fs::write(&scenario, text).expect("a scenario");
        let model = model::check(&Document::read(&scenario).expect("a scenario")).expect("a model");
        Plan::prepare(&model).map_err(|error| error.to_string())
    };
    let of_file = |test: &str| Plan::prepare(&coarse(test)).expect("a reference").comparison().cloned().expect("one");
    let named = write("displacement = \"optoNCDT\"").expect("a reference");
    let [found, expected] = [named.comparison().cloned().expect("one"), of_file("1008")];
    let peak =
        |comparison: &droptower::post::ReferenceComparison| comparison.acceleration.as_ref().and_then(Series::largest);
    let (found, expected) = (peak(&found).expect("a peak"), peak(&expected).expect("a peak"));
    assert!((found[1] / expected[1] - 1.0).abs() < 1e-3, "{found:?} for {expected:?}");
    // A text column is no obstacle where the channels are named.
    write("signals = \"noted.csv\"\nacceleration = \"head\"\ndisplacement = \"optoNCDT\"").expect("a reference");
    for (keys, expected) in [
        ("", "the channels `optoNCDT`, `stage` are each a length"),
        ("acceleration = \"had\"\ndisplacement = \"optoNCDT\"", "no channel `had`"),
    ] {
        let error = write(keys).expect_err("a mistake");
        assert!(error.contains(expected) && error.contains("raw.csv"), "{error}");
    }
}

#[test]
fn the_scripts_of_the_drops_give_the_tables_of_the_paper() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = |script: &str, table: &str| {
        let out = folder.path().join(script);
        let path = format!("scripts/{script}.rhai");
        workbench::printed(&droptower(&["script", &path, "--out", out.to_str().expect("UTF-8"), "--quiet"]));
        workbench::summary(&out)["tables"][table].as_array().cloned().unwrap_or_else(|| panic!("no {table}"))
    };
    for row in rows("reduce-drop", "virtual_drops") {
        let figure = |name: &str| workbench::figure(&row, name);
        assert!((figure("impact_velocity_m_s") / figure("paper_velocity_m_s") - 1.0).abs() < 5e-3, "{row}");
        assert!((figure("absorption_percent") - figure("simulated_absorption_percent")).abs() < 1.0, "{row}");
        assert!((figure("absorption_percent") - figure("paper_absorption_percent")).abs() < 1.5, "{row}");
        assert!(figure("contact_error_ms").abs() < 0.2, "{row}");
    }
    let table_3 = rows("paper-tables", "table_3");
    assert!(table_3.len() == 6 && table_3.iter().all(|row| row["same"] == true), "{table_3:?}");
    let summary = workbench::summary(&folder.path().join("paper-tables"));
    let means = summary["tables"]["table_7_means"].as_array().expect("means");
    assert_eq!(means.len(), 3);
    for row in means {
        // Printed with two digits: from the printed values the same averages come out.
        let gap = row["of_printed_percent"].as_f64().expect("a mean") - row["paper_percent"].as_f64().expect("a mean");
        assert!(gap.abs() < 0.0051, "{row}");
        assert!(row["difference"].as_f64().expect("a difference").abs() < 1.0, "{row}");
    }
}

/// 5 ms at 1 MHz without the fall before them.
#[test]
fn shocks_without_a_fall_are_refused() {
    let Some(path) = shocks() else {
        return;
    };
    let names = SHOCK_NAMES.map(String::from).into();
    let found = file::read(&path, &ReadOptions { names, ..ReadOptions::default() }).expect("a recording");
    let shock = &found.channel("accel 1").expect("a channel").series;
    let tower = Tower { body: BODY, height: Some(1.0) };
    let refused = drop::reduce(shock, None, &tower, &Reduction::default());
    let refused = refused.expect_err("no release");
    assert!(matches!(refused.kind(), Kind::NoRelease(_)), "{refused}");
}

/// A copy of a shipped recording whose rows `change` has changed or left out.
fn damaged(folder: &Path, change: impl Fn(f64, f64) -> Option<String>) -> String {
    let shipped = fs::read_to_string(root().join("data/virtual/1008.csv")).expect("a text");
    let path = folder.join("damaged.csv");
    fs::write(&path, workbench::with_readings(&shipped, change)).expect("a recording");
    path.to_str().expect("UTF-8").to_owned()
}

const TOWER_OF_1008: [&str; 4] = ["--mass", "10.72 kg", "--height", "1 m"];

#[test]
fn a_recording_that_begins_after_contact_is_named_as_such() {
    let folder = tempfile::tempdir().expect("a folder");
    for begin in [0.62, 0.63, 0.64, 0.65, 0.66, 0.67, 0.68] {
        let path = damaged(folder.path(), |time, reading| (time >= begin).then(|| reading.to_string()));
        let output = droptower(&[&["reduce", "drop", &path][..], &TOWER_OF_1008].concat());
        let said = refused(&output, "the recording begins after contact");
        assert!(said.contains("must begin with the rest before the release"), "{begin}: {said}");
    }
}

#[test]
fn figures_of_a_clipped_accelerometer_are_withheld() {
    let folder = tempfile::tempdir().expect("a folder");
    let reduced = |path: &str| {
        workbench::figures(&droptower(&[&["reduce", "drop", path][..], &TOWER_OF_1008, &["--json"]].concat()))
    };
    let whole = reduced("data/virtual/1008.csv");
    for level in [110.0, 60.0, 30.0] {
        let path = damaged(folder.path(), |_, reading| Some(reading.min(level).to_string()));
        let clipped = reduced(&path);
        for key in ["peak_acceleration_m_s2", "peak_displacement_m", "final_absorbed_energy_J", "energy_absorption"] {
            assert!(clipped[key].is_null() && whole[key].is_f64(), "{level}: {key}");
        }
        // The peak, and so the onset of the force that is fitted, is a smaller one.
        for key in ["contact_time_s", "impact_velocity_m_s", "impact_energy_J"] {
            let [clipped, whole] = [&clipped, &whole].map(|drop| workbench::figure(drop, key));
            assert!((clipped / whole - 1.0).abs() < 2e-3, "{level}: {key} {clipped} {whole}");
        }
        let findings = clipped["findings"].as_array().expect("findings");
        let finding = findings.iter().find(|finding| finding["code"] == "saturated-accelerometer").expect("a finding");
        let [peak, travel] =
            ["peak_acceleration_at_least_m_s2", "peak_displacement_at_least_m"].map(|key| &finding[key]);
        assert!(peak.as_f64() < whole["peak_acceleration_m_s2"].as_f64(), "{level}: {peak}");
        // Where the impactor would not turn, nothing bounds its travel.
        let is_bound = travel.as_f64() < whole["peak_displacement_m"].as_f64();
        assert!(travel.is_null() && level < 110.0 || travel.is_f64() && is_bound, "{level}: {travel}");
        let text = workbench::printed(&droptower(&[&["reduce", "drop", &path][..], &TOWER_OF_1008].concat()));
        assert!(text.contains("at least ") && text.contains("loading energy absorbed withheld"), "{text}");
    }
}

/// Gaps in the rest, the fall and the impact, as empty cells and as missing rows.
#[test]
fn gaps_can_be_bridged_and_spikes_masked() {
    let folder = tempfile::tempdir().expect("a folder");
    let exact = true_figures().into_iter().find(|(test, _)| test == "1008").expect("a test").1;
    let reduce = |path: &str, with: &[&str]| droptower(&[&["reduce", "drop", path][..], &TOWER_OF_1008, with].concat());
    let check = |path: &str, with: &[&str]| {
        let found = workbench::figures(&reduce(path, &[with, &["--json"]].concat()));
        workbench::close(workbench::figure(&found, "impact_velocity_m_s"), exact.speed, 5e-3);
        assert!((workbench::figure(&found, "energy_absorption") - exact.absorption).abs() < 0.02, "{found}");
        assert!(workbench::finding_codes(&found).contains(&"gap-bridged"), "{found}");
    };
    for [from, to] in [[0.05, 0.052], [0.4, 0.406], [0.65, 0.653]] {
        for is_missing in [true, false] {
            let path = damaged(folder.path(), |time, reading| match (from..=to).contains(&time) {
                true if is_missing => None,
                true => Some(String::new()),
                false => Some(reading.to_string()),
            });
            refused(&reduce(&path, &[]), "--bridge \"");
            check(&path, &["--bridge", "7 ms"]);
            let info = workbench::figures(&droptower(&["signal", "info", &path, "--json"]));
            let count = ((to - from) * 1e4).round() as u64 + 1;
            assert_eq!(info[0]["channels"][0]["gaps"], count, "{from}");
        }
    }
    let spike = |time: f64, reading: f64| if (0.3..0.3003).contains(&time) { 400.0 } else { reading };
    let path = damaged(folder.path(), |time, reading| Some(spike(time, reading).to_string()));
    check(&path, &["--mask", "299 ms..301 ms"]);
}

#[test]
fn a_given_contact_takes_the_place_of_laser_and_height() {
    let call = ["reduce", "drop", "data/virtual/1008.csv", "--mass", "10.72 kg", "--json"];
    let reduce = |with: &[&str]| droptower(&[&call[..], with].concat());
    let found = |with: &[&str]| workbench::figures(&reduce(with));
    let by_laser = found(&["--height", "1 m"]);
    for with in [&["--speed", "4.159 m/s"][..], &["--speed", "4.159 m/s", "--contact-time", "617.26 ms"]] {
        let given = found(with);
        workbench::close(workbench::figure(&given, "impact_velocity_m_s"), 4.159, 5e-3);
        for key in ["peak_displacement_m", "energy_absorption"] {
            workbench::close(workbench::figure(&given, key), workbench::figure(&by_laser, key), 0.02);
        }
    }
    for (with, expected) in [
        (&["--without-laser", "--contact-time", "500 s"][..], "the fall that was recorded has time of contact 0.61"),
        (&["--without-laser", "--speed", "3 m/s"], "the fall that was recorded has impact speed 4.1"),
        (&["--speed", "4.159"], "expected a velocity with its unit, such as"),
        (&["--height", "1 m +- 2"], "expected a length with its unit, such as"),
    ] {
        refused(&reduce(with), expected);
    }
    let doubtful = found(&["--speed", "3 m/s"]);
    assert!(workbench::finding_codes(&doubtful).contains(&"drop-height-differs"), "{doubtful}");
}
