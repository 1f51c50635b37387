//! Pages, drawings and tables of recorded drops, reduced or not.

use std::fs;
use std::path::Path;
use std::process::Output;

use droptower::plot::{Mark, Plot};
use droptower::report::StoredPage;
use serde_json::Value as Json;
use tempfile::TempDir;

use crate::workbench::{self, close, container, data, error, figures, lay_down, printed, printed_text, refused, root};

const TOWER: [&str; 4] = ["--mass", "10.72 kg", "--height", "1 m"];

fn drop(arguments: &[&str]) -> Output {
    workbench::droptower(&root(), &[&["reduce", "drop"], arguments].concat())
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// A page, and its answer.
fn read(page: &Path) -> (String, String) {
    let html = fs::read_to_string(page).expect("a page").replace('\u{a0}', " ");
    let (_, lead) = html.split_once("<p class=\"lead\">").expect("an answer");
    let lead = lead.split_once("</p>").expect("its end").0.to_owned();
    (html, lead)
}

/// The plots of a page, by their headings.
fn plots(page: &Path) -> Vec<Plot> {
    StoredPage::read(page).expect("a page").plots
}

fn plot<'p>(plots: &'p [Plot], title: &str) -> &'p Plot {
    plots.iter().find(|plot| plot.title == title).unwrap_or_else(|| panic!("no {title}"))
}

fn at(marks: &[Mark], label: &str) -> f64 {
    marks.iter().find(|mark| mark.label == label).unwrap_or_else(|| panic!("no {label} in {marks:?}")).at
}

/// Whether a text has a line drawn in characters of braille.
fn is_drawn(text: &str) -> bool {
    text.chars().any(|letter| ('\u{2801}'..='\u{28ff}').contains(&letter))
}

#[test]
fn the_page_of_a_drop_answers_and_marks_where_its_figures_were_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("drop.html");
    let call = [&["data/virtual/1008.csv", "--page", text(&page)][..], &TOWER].concat();
    let found = figures(&drop(&[&call[..], &["--json"]].concat()));
    let number = |key: &str| workbench::figure(&found, key);
    let (html, lead) = read(&page);
    assert!(lead.starts_with("Virtual, not measured: the impactor of 10.72 kg met the film at 4.15"), "{lead}");
    let film = ["stopped after 169.", "mm (95 %: 169.", "the film absorbed 89."];
    for words in ["m/s (95 %: 4.15", "was slowed by 14.3 g at most"].iter().chain(&film) {
        assert!(lead.contains(words), "{words}: {lead}");
    }
    assert!(html.find("<figure") < html.find("<table"), "a picture stands above the figures");
    for words in ["10.72 kg from 1 m", "virtual-recording", "data/virtual/1008.csv", "--page", "SHA-256"] {
        assert!(html.contains(words), "{words}");
    }
    let plots = plots(&page);
    let whole = &plot(&plots, "The recording").marks;
    let contact = number("contact_time_s");
    for (label, expected) in [
        ("release", number("release_time_s")),
        ("contact", contact),
        ("lowest point", contact + number("time_of_peak_displacement_s")),
        ("rebound", contact + number("time_of_rebound_s")),
    ] {
        close(at(whole, label), expected, 1e-5);
    }
    let velocity = plot(&plots, "Velocity");
    assert_eq!(at(&velocity.marks, "contact"), 0.0);
    let nearest = |plot: &Plot, time: f64| {
        let far = |point: &&[f64; 2]| (point[0] - time).abs();
        plot.curves[0].points.iter().min_by(|a, b| far(a).total_cmp(&far(b))).copied().expect("points")[1]
    };
    close(nearest(velocity, 0.0), -number("impact_velocity_m_s"), 2e-3);
    assert!(nearest(velocity, at(&velocity.marks, "lowest point")).abs() < 0.05, "it stands still at the lowest point");
    close(nearest(velocity, at(&velocity.marks, "rebound")), number("rebound_velocity_m_s"), 2e-3);
    let displacement = plot(&plots, "Displacement");
    close(nearest(displacement, at(&displacement.marks, "lowest point")), 1e3 * number("peak_displacement_m"), 2e-3);
    // The force is largest about the lowest point, and M(a + g) of the peak.
    let force = &plot(&plots, "Force on the impactor over travel").curves[0].points;
    let largest = force.iter().map(|point| point[1]).fold(0.0, f64::max);
    close(largest, 10.72 * (number("peak_acceleration_m_s2") + 9.81), 1e-3);
    let shown = printed(&drop(&call));
    assert!(is_drawn(&shown) && shown.contains("lowest point 0.674") && shown.contains(text(&page)), "{shown}");
    assert_eq!(printed(&drop(&[&call[..], &["--quiet"]].concat())), "");
}

/// A copy of a shipped recording in `folder`, changed.
fn copy(folder: &TempDir, name: &str, of: &str, change: impl Fn(String) -> String) -> std::path::PathBuf {
    let shipped = fs::read_to_string(data(&format!("virtual/{of}.csv"))).expect("a recording");
    let path = folder.path().join(name);
    fs::write(&path, change(shipped)).expect("a copy");
    path
}

/// With a laser that reads zero throughout.
fn with_laser_of_zero(text: String) -> String {
    let line = |line: &str| match line.rsplit_once(',') {
        Some((before, _)) if !line.starts_with(['#', 't']) => format!("{before},0\n"),
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[test]
fn a_recording_that_cannot_be_reduced_is_drawn_with_what_was_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let [page, out] = ["drop.html", "drop.csv"].map(|name| folder.path().join(name));
    let zero = copy(&folder, "zero.csv", "1008", with_laser_of_zero);
    let high = ["--mass", "10.72 kg", "--height", "3 m"];
    let call = [&[text(&zero), "--page", text(&page), "-o", text(&out)][..], &high].concat();
    let failed = drop(&call);
    let said = refused(&failed, "release 0.127");
    assert!(is_drawn(&said), "{said}");
    assert!(said.contains("--height \"1 m +- 5 mm\"") && said.contains("drop.html shows the recording"), "{said}");
    assert!(failed.stdout.is_empty() && !out.exists(), "nothing but the page is written");
    let (_, lead) = read(&page);
    let expected = "No drop was reduced: acceleration: the fall that was recorded has height";
    assert!(lead.starts_with(expected), "{lead}");
    let plots = plots(&page);
    let titles: Vec<&str> = plots.iter().map(|plot| plot.title.as_str()).collect();
    assert_eq!(titles, ["The recording", "Height over the film"]);
    assert!(at(&plots[0].marks, "impact (1 g)") > at(&plots[0].marks, "release"));
    for with in [&["--quiet"][..], &["--diagnostics", "json"]] {
        let said = error(&drop(&[&call[..], with].concat()));
        assert!(!is_drawn(&said) && said.contains("the fall that was recorded has height"), "{said}");
    }
    let without = figures(&drop(&[&[text(&zero), "--without-laser", "--json"][..], &TOWER].concat()));
    close(without["impact_velocity_m_s"].as_f64().expect("a speed"), 4.16, 5e-3);
}

#[test]
fn what_cannot_be_read_leaves_no_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("drop.html");
    let broken = copy(&folder, "broken.csv", "1008", |text| text.replacen("\n0.3,", "\n0.2,", 1));
    for call in [[text(&broken), "--mass"], ["data/virtual/1008.csv", "--gravity"]] {
        let value = if call[1] == "--mass" { "10.72 kg" } else { "9.81 m/s2" };
        let said = refused(&drop(&[&call[..], &[value, "--height", "1 m", "--page", text(&page)]].concat()), "");
        assert!(!page.exists() && !is_drawn(&said), "{said}");
    }
    refused(&drop(&[&["data/virtual/1008.csv", "--page", "page.txt"][..], &TOWER].concat()), "does not end in .html");
}

/// A folder with the three falls of 1 m, two of 1.5 m as their headers state, one that is cut, and other files.
fn laboratory() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["1008", "1009", "1010"] {
        copy(&folder, &format!("{name}.csv"), name, |text| format!("# height: 1 m\n# mass: 10.72 kg\n{text}"));
    }
    for name in ["1509", "1510"] {
        copy(&folder, &format!("{name}.csv"), name, |text| format!("# Height: 150 cm\n# mass: 10720 g\n{text}"));
    }
    let before_impact =
        |line: &&str| line.split(',').next().and_then(|t| t.parse::<f64>().ok()).is_none_or(|t| t < 0.5);
    copy(&folder, "cut.csv", "1008", |text| {
        let lines: Vec<&str> = text.lines().filter(before_impact).collect();
        format!("# height: 1 m\n# mass: 10.72 kg\n{}\n", lines.join("\n"))
    });
    fs::write(folder.path().join("README.txt"), "Five drops.\n").expect("a text");
    fs::write(folder.path().join("photo.jpg"), "x").expect("a picture");
    fs::create_dir(folder.path().join("raw")).expect("a folder");
    folder
}

#[test]
fn a_folder_of_recordings_gives_one_table_one_page_and_the_scatter() {
    let folder = laboratory();
    let [page, out] = ["drops.html", "drops.csv"].map(|name| folder.path().join(name));
    let call = [text(folder.path()), "--page", text(&page), "-o", text(&out), "--force"];
    let reduced = || {
        let output = drop(&[&call[..], &["--json"]].concat());
        assert_eq!(output.status.code(), Some(1), "one of six has no drop: {}", error(&output));
        assert!(error(&output).contains("cut.csv: acceleration: there is no contact"), "{}", error(&output));
        serde_json::from_slice::<Json>(&output.stdout).expect("JSON")
    };
    let found = reduced();
    assert_eq!((&found["reduced"], &found["failed"]), (&Json::from(5), &Json::from(1)));
    let rows = found["recordings"].as_array().expect("rows");
    let name = |row: &Json| row["recording"].as_str().expect("a name").rsplit('/').next().map(String::from);
    let names: Vec<String> = rows.iter().filter_map(name).collect();
    assert_eq!(names, ["1008.csv", "1009.csv", "1010.csv", "1509.csv", "1510.csv", "cut.csv"]);
    let left_out: Vec<String> = found["left_out"].as_array().expect("names").iter().map(Json::to_string).collect();
    assert_eq!(left_out.len(), 3, "{left_out:?}");
    assert!(left_out.iter().any(|name| name.contains("README.txt")), "a text without numbers: {left_out:?}");
    // Each recording alone gives the same figures.
    for (row, name) in rows.iter().zip(&names).take(5) {
        let alone = figures(&drop(&[text(&folder.path().join(name)), "--json"]));
        for key in ["impact_velocity_m_s", "peak_displacement_m", "energy_absorption", "mass_kg", "height_m"] {
            assert_eq!(row[key], alone[key], "{name}: {key}");
        }
        assert_eq!(row["sha256"].as_str().map(str::len), Some(64));
    }
    let cut = &rows[5];
    assert!(cut["error"].as_str().is_some_and(|error| error.starts_with("acceleration: there is no contact")), "{cut}");
    assert!(cut.get("impact_velocity_m_s").is_none(), "{cut}");
    // Drops of another height do not share a median.
    let scatter = found["scatter"].as_array().expect("groups");
    assert_eq!(scatter.len(), 2, "{scatter:?}");
    assert_eq!([&scatter[0]["height_m"], &scatter[1]["height_m"]], [&Json::from(1.0), &Json::from(1.5)]);
    let speed = &scatter[0]["figures"][0];
    let mut speeds: Vec<f64> = rows[..3].iter().map(|row| row["impact_velocity_m_s"].as_f64().expect("one")).collect();
    speeds.sort_by(f64::total_cmp);
    let quartiles = [0.5 * (speeds[0] + speeds[1]), 0.5 * (speeds[1] + speeds[2])];
    assert_eq!((&speed["figure"], &speed["count"]), (&Json::from("impact_velocity_m_s"), &Json::from(3)));
    close(speed["median"].as_f64().expect("a median"), speeds[1], 1e-12);
    for at in [0, 1] {
        close(speed["quartiles"][at].as_f64().expect("a quartile"), quartiles[at], 1e-12);
        close(speed["range"][at].as_f64().expect("an end"), speeds[2 * at], 1e-12);
    }
    // The table has a row a recording, also that without a drop.
    let mut table = csv::Reader::from_path(&out).expect("a table");
    let head = table.headers().expect("a head").clone();
    let column = |name: &str| head.iter().position(|own| own == name).unwrap_or_else(|| panic!("no {name}: {head:?}"));
    let lines: Vec<csv::StringRecord> = table.records().map(|line| line.expect("a line")).collect();
    assert_eq!(lines.len(), 6);
    let speeds: Vec<Option<f64>> = lines.iter().map(|line| line[column("impact_velocity_m_s")].parse().ok()).collect();
    let expected: Vec<Option<f64>> = rows.iter().map(|row| row["impact_velocity_m_s"].as_f64()).collect();
    assert_eq!(speeds, expected);
    assert!(lines[5][column("error")].contains("there is no contact"), "{:?}", lines[5]);
    // The page: curves of all drops aligned at contact, and the cause of the one without.
    let (html, lead) = read(&page);
    for words in [
        "10.72 kg from 1 m (3 drops): impact speed 4.16 m/s (4.15 to 4.17)",
        "1 of 6 recordings could not be reduced: cut.csv",
    ] {
        assert!(lead.contains(words), "{words}: {lead}");
    }
    assert!(html.contains("cut.csv: acceleration: there is no contact"), "the cause is on the page");
    let plots = plots(&page);
    let overlaid = plot(&plots, "Acceleration");
    let curves: Vec<&str> = overlaid.curves.iter().map(|curve| curve.name.as_str()).collect();
    assert_eq!(curves, &names[..5]);
    assert_eq!(plots.len(), 3 + 6, "three of all, and one of each");
    // A second call does not take its own table for a recording.
    assert_eq!(reduced()["recordings"], found["recordings"]);
    let shown = printed_text(&drop(&call[..1]));
    let line = |start: &str| shown.lines().find(|line| line.trim_start().starts_with(start)).expect(start).to_owned();
    assert!(line("1008.csv").contains("4.159") && line("1008.csv").contains("virtual-recording"), "{shown}");
    assert!(line("cut.csv").contains("there is no contact"), "{shown}");
    assert!(line("10.72 kg from 1.5 m, 2 drops").contains("median"), "{shown}");
    assert!(shown.contains("warning[virtual-recording]: 6 of 6: "), "{shown}");
}

#[test]
fn several_recordings_fail_as_a_whole_only_where_none_is_reduced() {
    let folder = laboratory();
    let [good, cut] = ["1008.csv", "cut.csv"].map(|name| folder.path().join(name));
    let [first, second] = ["1009.csv", "1010.csv"].map(|name| folder.path().join(name));
    let status = |arguments: &[&str]| drop(arguments).status.code();
    assert_eq!(status(&[text(&good), text(&first), text(&second)]), Some(0));
    assert_eq!(status(&[text(&good), text(&cut)]), Some(1));
    let other = copy(&folder, "other.csv", "1008", |_| "a,b\n1,2\n".into());
    assert_eq!(status(&[text(&other), text(&cut)]), Some(2));
    let glob = folder.path().join("15*.csv");
    let found = figures(&drop(&[text(&glob), "--json"]));
    assert_eq!(found["reduced"], 2);
    // The same recording twice is one.
    let twice = figures(&drop(&[text(&good), text(&good), "--json"]));
    assert_eq!(twice["recordings"].as_array().map(Vec::len), Some(1));
}

#[test]
fn mass_and_height_are_those_of_the_header_unless_they_are_given() {
    let folder = laboratory();
    let recording = folder.path().join("1510.csv");
    let headed = figures(&drop(&[text(&recording), "--json"]));
    assert_eq!((&headed["mass_kg"], &headed["height_m"]), (&Json::from(10.72), &Json::from(1.5)));
    assert!(!workbench::finding_codes(&headed).contains(&"head-replaced"), "{headed}");
    let given = figures(&drop(&[text(&recording), "--mass", "5.36 kg", "--json"]));
    assert!(workbench::finding_codes(&given).contains(&"head-replaced"), "{given}");
    let energy = |found: &Json| found["impact_energy_J"].as_f64().expect("an energy");
    close(energy(&given), 0.5 * energy(&headed), 1e-9);
    for (arguments, expected) in [
        (&["data/virtual/1008.csv", "--height", "1 m"][..], "the mass of the impactor is not known"),
        (&["data/virtual/1008.csv", "--mass", "10.72 kg"], "the height of fall is not known"),
    ] {
        let said = refused(&drop(arguments), expected);
        assert!(said.contains("header"), "{said}");
    }
    let wrong = copy(&folder, "wrong.csv", "1008", |text| format!("# mass: heavy\n{text}"));
    refused(&drop(&[text(&wrong), "--height", "1 m"]), "its header: expected a mass");
}

/// A test of ISO-MME is one recording, though it is a folder.
#[test]
fn the_folder_of_a_test_of_isomme_is_one_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let test = lay_down(&folder.path().join("test"), &container(&data("virtual/1008.csv")));
    let alone = figures(&drop(&[&[text(&folder.path().join("test")), "--json"][..], &TOWER].concat()));
    close(alone["impact_velocity_m_s"].as_f64().expect("a speed"), 4.159, 1e-3);
    let beside = figures(&drop(&[&[text(folder.path()), "--json"][..], &TOWER].concat()));
    assert_eq!(beside["recordings"][0]["impact_velocity_m_s"], alone["impact_velocity_m_s"]);
    // The fingerprint is that of all its channels, also where the head alone is named.
    let digest = |path: &Path| {
        let found = figures(&drop(&[&[text(path), "data/virtual/1009.csv", "--json"][..], &TOWER].concat()));
        found["recordings"][0]["sha256"].as_str().expect("a fingerprint").to_owned()
    };
    let before = [digest(&folder.path().join("test")), digest(&test)];
    let channel = fs::read_dir(folder.path().join("test/Channel")).expect("channels").flatten().next().expect("one");
    let mut content = fs::read(channel.path()).expect("a channel");
    content.extend(b"\n");
    fs::write(channel.path(), content).expect("a channel");
    let after = [digest(&folder.path().join("test")), digest(&test)];
    assert!(before[0] != after[0] && before[1] != after[1], "{before:?} {after:?}");
}

/// What a recording does not show, the sentence does not say.
#[test]
fn the_answer_of_a_clipped_or_short_recording_is_a_bound() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("drop.html");
    let clipped = copy(&folder, "clipped.csv", "1008", |text| {
        workbench::with_readings(&text, |_, value| Some(value.min(60.0).to_string()))
    });
    let short = copy(&folder, "short.csv", "1008", |text| {
        workbench::with_readings(&text, |time, value| (time < 0.66).then(|| value.to_string()))
    });
    for (path, expected) in [(clipped, "was slowed by at least "), (short, "and still descended after ")] {
        printed(&drop(&[&[text(&path), "--page", text(&page)][..], &TOWER].concat()));
        let (_, lead) = read(&page);
        assert!(lead.contains(expected) && !lead.contains("absorbed"), "{expected}: {lead}");
        let plots = plots(&page);
        let found: Vec<&str> = plot(&plots, "The recording").marks.iter().map(|mark| mark.label.as_str()).collect();
        assert_eq!(found, ["release", "contact"], "{expected}");
    }
}
