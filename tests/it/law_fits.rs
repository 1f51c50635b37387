//! `droptower fit rubber`: laws fitted to rubber in three kinds of tests, and a Prony series to a relaxation modulus.

use std::fs;
use std::path::Path;
use std::process::Output;

use droptower::experiment::relaxation::{Prony, read_relaxation};
use droptower::material::PronyTerm;
use droptower::signal::file::{self, ReadOptions};
use serde_json::Value as Json;

use crate::workbench::{data, droptower, error, figures, finding_codes, printed};

fn rubber(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| data("rubber").join(format!("{name}.csv")).display().to_string()).collect()
}

/// `droptower fit rubber` in `folder`, on `files` and with `more`.
fn fit(folder: &Path, files: &[String], more: &[&str]) -> Output {
    let arguments = ["fit", "rubber"].into_iter().chain(files.iter().map(String::as_str)).chain(more.iter().copied());
    droptower(folder, &arguments.collect::<Vec<_>>())
}

fn number(figures: &Json, pointer: &str) -> f64 {
    figures.pointer(pointer).and_then(Json::as_f64).unwrap_or_else(|| panic!("{pointer} of {figures}"))
}

const TRELOAR: [&str; 3] = ["treloar-ut", "treloar-et", "treloar-ps"];

#[test]
fn treloars_rubber_becomes_a_material_and_a_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let kawabata = rubber(&["kawabata-biaxial"]).remove(0);
    let more = ["--law", "ogden:3", "-o", "rubber.toml", "--density", "930 kg/m3", "--thickness", "0.2 mm"];
    let more: Vec<&str> = more.into_iter().chain(["--predict", &kawabata]).collect();
    let text = printed(&fit(folder.path(), &rubber(&TRELOAR), &more));
    for part in ["ogden:3, absolute residuals", "alpha_3", "biaxial tension, predicted", "stable up to the stretch 10"]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
    let material = fs::read_to_string(folder.path().join("rubber.toml")).expect("the material");
    let fitted = "# Fitted to treloar-ut (uniaxial tension, stretches 1.02 to 7.6): R2 0.99";
    assert!(material.contains(fitted), "{material}");
    assert!(material.contains("# Predicted: kawabata-biaxial (biaxial tension"), "{material}");
    let table: toml::Table = material.parse().expect("TOML");
    assert_eq!(table["hyperelastic"]["law"].as_str(), Some("ogden"));
    assert_eq!(table["hyperelastic"]["alpha"].as_array().map(Vec::len), Some(3));
    printed(&droptower(folder.path(), &["check", "rubber.toml"]));
    let page = fs::read_to_string(folder.path().join("rubber.html")).expect("the page");
    let parts = ["ogden:3 fitted to 3 tests", "treloar-ps measured", "Residuals", "Biaxial tension", "alpha_2"];
    parts.iter().chain(&["[hyperelastic]"]).for_each(|part| assert!(page.contains(part), "{part}"));
    // Again over its own files.
    let again = figures(&fit(folder.path(), &rubber(&TRELOAR), &[&more[..], &["--json"]].concat()));
    for test in 0..3 {
        assert!(number(&again, &format!("/tests/{test}/r_squared")) >= 0.995, "{again}");
    }
    assert_eq!(again["tests"][0]["stresses"], 24);
    assert!(number(&again, "/predictions/0/relative_rms") < 0.15 && again["predictions"][0]["stresses"] == 234);
    assert!(again["unstable_from"].is_null() && !finding_codes(&again).contains(&"material-incomplete"));
}

#[test]
fn a_material_without_density_and_thickness_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = figures(&fit(folder.path(), &rubber(&TRELOAR), &["--law", "yeoh", "-o", "rubber.toml", "--json"]));
    assert!(finding_codes(&found).contains(&"material-incomplete"), "{found}");
    let checked = droptower(folder.path(), &["check", "rubber.toml"]);
    for key in ["missing key `density`", "missing key `thickness`"] {
        assert!(error(&checked).contains(key), "{key} in {}", error(&checked));
    }
}

/// The verbatim files have no header: names, units and kinds are options, and the tables of `data/rubber` are the same.
#[test]
fn files_without_header_are_read_by_options() {
    let folder = tempfile::tempdir().expect("a folder");
    let sheets = ["UT", "ET", "PS"].map(|kind| data("rubber_sheet/Treloar_1944").join(kind).with_extension("txt"));
    let sheets = sheets.map(|path| path.display().to_string());
    let columns = ["--columns", "stress [MPa],stretch", "--law", "gent", "--json"];
    let coefficients = |output: &Output| figures(output)["coefficients"].to_string();
    let expected = coefficients(&fit(folder.path(), &rubber(&TRELOAR), &["--law", "gent", "--json"]));
    assert_eq!(coefficients(&fit(folder.path(), &sheets, &columns)), expected);
    let kinds = [&columns[..], &["--test", "ut,et,ps"]].concat();
    assert_eq!(coefficients(&fit(folder.path(), &sheets, &kinds)), expected);
}

/// The master curve of NREL's film with 31 terms, beside NREL's own 31.
#[test]
fn a_master_curve_becomes_a_prony_series() {
    let folder = tempfile::tempdir().expect("a folder");
    let master = data("relaxation/master.csv");
    let fit = ["fit", "prony", master.to_str().expect("UTF-8"), "--terms", "31", "-o", "film.toml", "--poisson", "0.4"];
    let found = figures(&droptower(folder.path(), &[&fit[..], &["--json"]].concat()));
    let [rms, largest] = ["/relative_rms", "/largest_relative_error"].map(|pointer| number(&found, pointer));
    println!("ours: {rms} rms, {largest} at most, {} terms", found["terms"].as_array().expect("terms").len());
    assert!(rms < 0.003 && largest < 0.02 && number(&found, "/r_squared") > 0.9999, "{rms} {largest}");
    let own = file::columns(&data("relaxation/prony-terms.csv"), &ReadOptions::default()).expect("the terms");
    let terms = own.channels[0].series.values().iter().zip(own.channels[1].series.values());
    let terms = terms.map(|(share, time)| PronyTerm { share: *share, time: *time }).collect();
    let theirs = Prony { instantaneous: 1739.03e6, terms };
    let points = read_relaxation(&master, &ReadOptions::default()).expect("a curve");
    let errors: Vec<f64> = points.iter().map(|[time, modulus]| theirs.modulus(*time) / modulus - 1.0).collect();
    let their_rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    let their_largest = errors.iter().fold(0.0, |most: f64, error| most.max(error.abs()));
    println!("NREL's: {their_rms} rms, {their_largest} at most");
    assert!(rms < 1.05 * their_rms && largest < their_largest, "{rms} {their_rms} {largest} {their_largest}");
    assert!((number(&found, "/instantaneous_modulus_Pa") / 1739.03e6 - 1.0).abs() < 0.03, "{found}");
    let material = fs::read_to_string(folder.path().join("film.toml")).expect("the material");
    let material: toml::Table = material.parse().expect("TOML");
    let terms = material["prony"].as_array().expect("terms");
    let share = |term: &toml::Value| term["share"].as_float().expect("a share");
    assert!(terms.iter().map(share).sum::<f64>() < 1.0 && terms.len() > 20);
    assert!(terms[0]["time"].as_str().is_some_and(|time| time.ends_with(" s")), "{:?}", terms[0]);
    assert!(material["elastic"]["young"].as_str().is_some_and(|young| young.ends_with(" MPa")));
    assert!(folder.path().join("film.html").exists());
}
