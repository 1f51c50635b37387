//! Recordings on the command line and through the library: measures of impact and ratings.

use std::fs;
use std::process::Output;

use droptower::signal::clip::{Counting, clip};
use droptower::signal::file::{self, ReadOptions};
use droptower::signal::filter::{self, Standard};
use droptower::signal::hic::head_injury_criterion;
use droptower::signal::rating::{self, Rating};
use droptower::signal::{Series, integrate};
use droptower::units::{Acceleration, STANDARD_GRAVITY};
use serde_json::Value as Json;

use crate::workbench::{self, SHOCK_NAMES, figure, shocks};

/// Ratings that the authors of the curves in `data/iso18571` state for them: yeonsoo-p/ISO18571,
/// `examples/quickstart.ipynb`, 00b2488.
const STATED: [(&str, f64); 5] = [
    ("corridor", 0.652_890_716_899_321_8),
    ("phase", 0.941_666_666_666_666_7),
    ("magnitude", 0.950_654_019_291_195_4),
    ("slope", 0.956_686_509_230_894_4),
    ("overall", 0.830_957_725_797_480_1),
];

fn droptower(arguments: &[&str]) -> Output {
    workbench::droptower(&workbench::root(), &[&["signal"], arguments].concat())
}

fn json(arguments: &[&str]) -> Json {
    workbench::figures(&droptower(arguments))
}

/// A folder with files of these names and texts.
fn folder(files: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

fn table(header: &str, step: f64, count: usize, value: impl Fn(f64) -> f64) -> String {
    let row = |i: usize| format!("{},{}\n", i as f64 * step, value(i as f64 * step));
    format!("{header}\n{}", (0..count).map(row).collect::<String>())
}

fn square(t: f64) -> f64 {
    if (0.0295..0.0505).contains(&t) { 50.0 } else { 0.0 }
}

#[test]
fn reference_curves_get_the_stated_ratings() {
    let [reference, comparison] = ["reference", "comparison"].map(|name| format!("data/iso18571/{name}.csv"));
    let figures = json(&["rate", &reference, &comparison, "--json"]);
    for (name, stated) in STATED {
        assert!((figure(&figures, name) - stated).abs() < 1e-12, "{name}: {figures}");
    }
    assert_eq!(figures["grade"], "good");
    assert_eq!(figures["samples"], 600);
    assert!((figure(&figures, "shift_s") - 7e-4).abs() < 1e-12, "{figures}");
}

#[test]
fn real_shocks_have_measures_within_their_bounds() {
    let Some(path) = shocks() else {
        return;
    };
    let names = SHOCK_NAMES.map(str::to_owned).to_vec();
    let shocks = file::read(&path, &ReadOptions { names, ..ReadOptions::default() }).expect("readable");
    assert_eq!(shocks.channels.len(), 5);
    for shock in &shocks.channels {
        let raw = shock.quantity(Acceleration::DIMENSION).expect("an acceleration");
        let filtered = filter::channel(raw, 1000.0, Standard::Iso6487).expect("complete and even");
        let (peak, whole) = (raw.largest().expect("samples")[1], integrate::total(raw));
        // The gain at rest is one: filtering moves speed about and keeps it, but for what leaves at the ends.
        let passed = integrate::total(&filtered) / whole;
        assert!((passed - 1.0).abs() < 0.05, "{}: {passed}", shock.name);
        let hic = head_injury_criterion(raw, 0.015).expect("a shock");
        let bound = (hic.end - hic.start) * (peak / STANDARD_GRAVITY).powf(2.5);
        assert!(hic.value > 0.0 && hic.value <= bound && hic.end - hic.start <= 0.005, "{}: {hic:?}", shock.name);
        let [cumulative, contiguous] = [Counting::Cumulative, Counting::Contiguous]
            .map(|counting| clip(&filtered, 5e-4, counting).expect("long enough").level);
        assert!(contiguous <= cumulative && cumulative < peak, "{}: {contiguous} {cumulative} {peak}", shock.name);
        let Rating { overall, .. } = rating::rate(raw, raw).expect("rated");
        assert!((overall - 1.0).abs() < 1e-12, "{}: {overall}", shock.name);
    }
}

#[test]
fn a_square_pulse_has_its_criterion_and_its_clip() {
    let folder = folder(&[("a.csv", table("time [ms],accel", 1.0, 81, |t| square(1e-3 * t)))]);
    let path = folder.path().join("a.csv");
    let path = path.to_str().expect("UTF-8");
    let hic = json(&["hic", path, "--column", "accel", "--unit", "g", "--window", "15", "--json"]);
    assert!((figure(&hic, "hic") - 265.165).abs() < 1e-3, "{hic}");
    assert_eq!((figure(&hic, "window_ms"), figure(&hic, "duration_ms")), (15.0, 15.0));
    let [mean, from, to] = ["mean_g", "t1_s", "t2_s"].map(|name| figure(&hic, name));
    assert!((mean - 50.0).abs() < 1e-9 && from >= 0.03 && to <= 0.05, "{hic}");
    assert!(hic.get("filter_class").is_none() && hic.get("hic_d").is_none(), "{hic}");
    let hic = json(&["hic", path, "--unit", "g", "--window", "36", "--json"]);
    assert!((figure(&hic, "hic_d") - (0.75446 * figure(&hic, "hic") + 166.4)).abs() < 1e-9, "{hic}");
    for counting in ["cumulative", "contiguous"] {
        let clip = json(&["clip", path, "--unit", "g", "--counting", counting, "--json"]);
        assert!((figure(&clip, "clip_g") - 50.0).abs() < 1e-9, "{clip}");
        assert_eq!(clip["counting"], counting);
    }
}

/// The head hits with 60 g, and with 90 g on its rebound.
#[test]
fn the_rebound_can_be_left_out() {
    let pulses = |t: f64| match t {
        t if (0.010..0.020).contains(&t) => 60.0,
        t if (0.060..0.070).contains(&t) => 90.0,
        _ => 0.0,
    };
    let folder = folder(&[("a.csv", table("time_s,accel [g]", 1e-4, 1001, pulses))]);
    let path = folder.path().join("a.csv");
    let path = path.to_str().expect("UTF-8");
    let clip = |more: &[&str]| json(&[&["clip", path, "--json"], more].concat());
    assert!((figure(&clip(&[]), "clip_g") - 90.0).abs() < 1e-9);
    let cut = clip(&["--until", "40 ms"]);
    assert!((figure(&cut, "clip_g") - 60.0).abs() < 1e-9 && figure(&cut, "until_ms") == 40.0, "{cut}");
    let hic = json(&["hic", path, "--json", "--until", "40"]);
    assert!((figure(&hic, "hic") - 0.01 * 60_f64.powf(2.5)).abs() < 3.0, "{hic}");
    let said = workbench::error(&droptower(&["clip", path, "--until", "-1"]));
    assert!(said.contains("the record begins at 0 ms and ends at 100 ms, none of it before -1 ms"), "{said}");
}

#[test]
fn a_class_filters_first() {
    // A whistle of 4 kHz above a half-sine.
    let half_sine =
        |t: f64| if (0.01..0.03).contains(&t) { 80.0 * (std::f64::consts::PI * (t - 0.01) / 0.02).sin() } else { 0.0 };
    let whistle = |t: f64| 30.0 * (2.0 * std::f64::consts::PI * 4000.0 * t).sin();
    let folder = folder(&[
        ("clean.csv", table("time_s,accel [g]", 2e-5, 2500, half_sine)),
        ("loud.csv", table("time_s,accel [g]", 2e-5, 2500, |t| half_sine(t) + whistle(t))),
    ]);
    let clip = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        json(&[&["clip", path.to_str().expect("UTF-8"), "--json"], more].concat())
    };
    let (clean, loud) = (figure(&clip("clean.csv", &[]), "clip_g"), figure(&clip("loud.csv", &[]), "clip_g"));
    let filtered = clip("loud.csv", &["--class", "600"]);
    assert_eq!(figure(&filtered, "filter_class"), 600.0);
    assert_eq!(clip("loud.csv", &["--class", "CFC600"]), filtered);
    let other = clip("loud.csv", &["--class", "999"])["notes"].to_string();
    assert!(other.contains("CFC 999 is none of the standards' classes"), "{other}");
    assert!((loud / clean - 1.0).abs() > 0.02, "{loud} {clean}");
    assert!((figure(&filtered, "clip_g") / clean - 1.0).abs() < 2e-3, "{filtered} {clean}");
}

/// `cargo bench --bench signal` measures how long this takes.
#[test]
fn a_million_samples_are_filtered_integrated_and_rated() {
    let time: Vec<f64> = (0..1_000_000).map(|i| 1e-6 * f64::from(i)).collect();
    let shock = |late: f64| {
        let value = |t: &f64| 500.0 * (-((t - 0.4 - late) / 0.02).powi(2)).exp() * (1.0 + 0.1 * (6e4 * t).sin());
        Series::new(time.clone(), time.iter().map(value).collect::<Vec<_>>())
    };
    let (reference, comparison) = (shock(0.0), shock(0.003));
    let filtered = filter::channel(&comparison, 1000.0, Standard::Iso6487).expect("even");
    let speed = integrate::once(&filtered, 0.0);
    let rating = rating::rate(&reference, &filtered).expect("rated");
    assert!((rating.shift - 0.003).abs() < 1.5e-4 && speed.len() == 1_000_000, "{rating:?}");
}
