//! How often the intervals of whole calibrations hold the truth, where nothing of the truth comes from the calibration: drops
//! simulated on elements of a quarter of the size, an error of the law drawn at the samples, and recordings by sensors of many kinds
//! (`tests/recordings`), reduced as a user does it. Speed, time of contact, noise, size and shape of the error are unknown.
//!
//! `DROPTOWER_STUDIES=200 DROPTOWER_THOROUGH=1 cargo test --release --test it coverage -- --nocapture` prints the table of
//! docs/calibration.md. `DROPTOWER_STUDIES=101..201` runs those of these seeds; with `DROPTOWER_KEEP=FOLDER` each leaves its
//! files there and is not run again.

use std::fs;
use std::ops::Range;
use std::path::Path;

use droptower::model;
use droptower::post::Plan;
use droptower::scenario::{Assignment, Document};
use droptower::simulate;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rayon::prelude::*;
use recordings::{GRAVITY, Given, Setup};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thorough::thorough;

use crate::workbench::{droptower, error, figures, root};

/// Elements of the calibration, and of the truth: on half the size it would be off the limit, to which signals are corrected, by
/// just what the correction states as its error.
const SIZES: [&str; 2] = ["20 mm", "5 mm"];
/// A sphere that is so large that these elements are not coarse in contact, where a calibration claims nothing.
const RADIUS: &str = "180 mm";
/// Time between samples of the truth, s.
const STEP: f64 = 2.5e-5;
const HEIGHT_ERROR: f64 = 2e-3;

/// Parameter, key, mean and deviation of what is known before, bounds.
const PARAMETERS: [(&str, &str, [f64; 2], [f64; 2]); 4] = [
    ("k1", "specimen.material.fabric.scale.k1", [2.75, 0.5], [0.5, 8.0]),
    ("ke", "specimen.material.fabric.scale.ke", [3.4, 0.5], [1.0, 8.0]),
    ("ky", "specimen.material.fabric.scale.ky", [1.0, 0.1], [0.5, 2.0]),
    ("friction", "impactor.friction", [0.4, 0.05], [0.15, 0.8]),
];

/// What a study found of a parameter.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Found {
    parameter: String,
    truth: f64,
    median: f64,
    lower: [f64; 3],
    upper: [f64; 3],
    verdict: String,
}

impl Found {
    fn holds(&self, level: usize) -> bool {
        (self.lower[level]..=self.upper[level]).contains(&self.truth)
    }
}

const LEVELS: [&str; 3] = ["95", "80", "50"];

/// A study of one virtual drop, in a folder.
fn study(seed: u64, folder: &Path) -> Result<Vec<Found>, String> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0xc07e);
    // A drop in which the film holds.
    let (truth, speed, clean) = loop {
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let truth = PARAMETERS.map(|(_, _, [mean, deviation], _)| {
            let spread = (1.0 + (deviation / mean).powi(2)).ln().sqrt();
            mean * (spread * normal() - 0.5 * spread * spread).exp()
        });
        let speed = 3.6 + 0.3 * normal();
        if let Some(clean) = simulated(&truth, speed) {
            break (truth, speed, clean);
        }
    };
    let normal: f64 = StandardNormal.sample(&mut random);
    let share = 0.02 * (0.5 * normal).exp();
    let law = error_of_the_law(&mut random, &clean, share);
    let acceleration = clean.iter().zip(law).map(|(value, error)| value + error).collect();

    let setup = Setup::of(seed);
    // The highest class that the recorder's rate permits.
    let filter = if setup.rate < 1e4 { "CFC180" } else { "CFC1000" };
    let made = setup.record_given(&Given { speed, step: STEP, acceleration });
    let columns = if made.laser.is_some() { ",laser_m" } else { "" };
    let mut table = format!("# VIRTUAL drop\ntime_s,accelerometer_m_s2{columns}\n");
    for (place, (time, value)) in made.time.iter().zip(&made.accelerometer).enumerate() {
        let laser = match made.laser.as_ref().map(|laser| laser[place]) {
            Some(laser) if laser.is_nan() => ",".to_owned(),
            laser => laser.map_or_else(String::new, |laser| format!(",{laser:.6}")),
        };
        table += &format!("{time:.7},{value:.5}{laser}\n");
    }
    fs::write(folder.join("drop.csv"), table).expect("written");

    // As a user does: the speed of the scenario is that of the reduced recording.
    let height = format!("{:.4} m", made.height);
    let tower = ["--mass", "10.72 kg", "--height", &format!("{height} +- {HEIGHT_ERROR} m"), "--json"];
    let reduced = droptower(folder, &[&["reduce", "drop", "drop.csv"], &tower[..]].concat());
    if !reduced.status.success() {
        return Err(error(&reduced));
    }
    let reduced = figures(&reduced);
    let contact = reduced["contact_time_interval_s"].as_array().ok_or_else(|| reduced.to_string())?;
    let ends: Vec<f64> = contact.iter().filter_map(Value::as_f64).collect();
    let held = (ends[0]..=ends[1]).contains(&made.truth.contact);
    println!("{seed}: laser {}, contact {:.5} s in {ends:.5?}: {held}", made.laser.is_some(), made.truth.contact);
    let measured = reduced["impact_velocity_m_s"].as_f64().ok_or_else(|| reduced.to_string())?;
    let scenario = format!(
        "extends = \"{}\"\nspecimen.mesh.size = \"{}\"\nimpactor.shape.sphere.radius = \"{RADIUS}\"\nloading.impact.velocity = \"{measured} m/s\"\n\
         loading.impact.duration = \"90 ms\"\n\
         output.filter = \"{filter}\"\n[reference]\nsignals = \"drop.csv\"\ndrop_height = \"{height}\"\nheight_error = \"{HEIGHT_ERROR} m\"\nwindow = \"loading\"\n",
        root().join("scenarios/drop/1008.toml").display(),
        SIZES[0],
    );
    fs::write(folder.join("drop.toml"), scenario).expect("written");
    let mut text = "[[test]]\nscenario = \"drop.toml\"\ncompare = \"acceleration\"\n[parameters]\n".to_owned();
    for (name, key, [mean, deviation], [from, to]) in PARAMETERS {
        text.push_str(&format!(
            "{name} = {{ key = \"{key}\", start = {mean}, within = [{from}, {to}], log = true, \
             prior = {{ lognormal = {{ mean = {mean}, deviation = {deviation} }} }} }}\n"
        ));
    }
    text.push_str("[posterior]\n");
    fs::write(folder.join("study.toml"), text).expect("written");
    let found = droptower(folder, &["calibrate", "study.toml", "--out", "found", "--force"]);
    if !found.status.success() {
        return Err(error(&found));
    }
    let truths: Vec<(&str, f64)> =
        PARAMETERS.iter().map(|own| own.0).zip(truth).chain([("model error", share)]).collect();
    Ok(posterior(&folder.join("found/tables/posterior.csv"), &truths))
}

/// The impactor's acceleration from contact on, m/s², upward; none where the film breaks.
fn simulated(truth: &[f64; 4], speed: f64) -> Option<Vec<f64>> {
    let mut keys = vec![
        format!("specimen.mesh.size={}", SIZES[1]),
        format!("impactor.shape.sphere.radius={RADIUS}"),
        format!("loading.impact.velocity={speed} m/s"),
        "output.sample_rate=40 kHz".to_owned(),
    ];
    keys.extend(PARAMETERS.iter().zip(truth).map(|((_, key, ..), value)| format!("{key}={value}")));
    let assignments: Vec<Assignment> =
        keys.iter().map(|key| Assignment::from_argument(key).expect("an assignment")).collect();
    let document = Document::read(&root().join("scenarios/drop/1008.toml")).expect("a scenario").with(&assignments);
    let model = model::check(&document).expect("a model");
    let plan = Plan::prepare(&model).expect("a plan");
    let outcome = simulate::run(&model, &mut |_| {}).expect("a run");
    let results = plan.measure(&model, &outcome).expect("results");
    let signal = results.signals.series("acceleration_m_s2").expect("a signal");
    outcome.rupture_time.is_none().then(|| signal.values().to_vec())
}

/// An exponentially correlated process or a smooth sum of waves over 2 to 30 % of the loading, of a share of the signal's root mean
/// square; it begins with the force of the film.
fn error_of_the_law(random: &mut ChaCha8Rng, clean: &[f64], share: f64) -> Vec<f64> {
    let lowest = clean.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).expect("samples").0 + 1;
    let level = (clean[..lowest].iter().map(|v| v * v).sum::<f64>() / lowest as f64).sqrt();
    let uniform = |random: &mut ChaCha8Rng| -> f64 { StandardUniform.sample(random) };
    let normal = |random: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(random) };
    // Where film hardly carries, a law cannot be off by much: the error grows with the force, up to half the level.
    let grown = |place: usize| (2.0 * (clean[place] + GRAVITY) / level).clamp(0.0, 1.0);
    let grown_level = ((0..lowest).map(|place| grown(place).powi(2)).sum::<f64>() / lowest as f64).sqrt();
    let size = |place: usize| share * level * grown(place) / grown_level;
    let length = lowest as f64 * 0.02 * 15.0_f64.powf(uniform(random));
    if uniform(random) < 0.5 {
        let keep = (-1.0 / length).exp();
        let mut error = normal(random);
        return (0..clean.len())
            .map(|place| {
                error = keep * error + (1.0 - keep * keep).sqrt() * normal(random);
                size(place) * error
            })
            .collect();
    }
    // Of a Gaussian spectrum: correlation exp(−(Δ/length)²/2).
    let waves: Vec<[f64; 3]> = (0..200).map(|_| [normal(random) / length, normal(random), normal(random)]).collect();
    (0..clean.len())
        .map(|place| {
            let sum: f64 =
                waves.iter().map(|[w, a, b]| a * (w * place as f64).cos() + b * (w * place as f64).sin()).sum();
            size(place) * sum / (waves.len() as f64).sqrt()
        })
        .collect()
}

fn posterior(table: &Path, truths: &[(&str, f64)]) -> Vec<Found> {
    let mut reader = csv::Reader::from_path(table).expect("a table");
    let head: Vec<String> = reader.headers().expect("a head").iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    let place = |name: &str| head.iter().position(|own| own == name).unwrap_or_else(|| panic!("no {name} in {head:?}"));
    let row_of = |name: &str| rows.iter().find(|row| &row[place("parameter")] == name).expect("a row");
    truths
        .iter()
        .map(|&(name, truth)| {
            let row = row_of(name);
            let number = |column: &str| row[place(column)].parse::<f64>().expect("a number");
            Found {
                parameter: name.to_owned(),
                truth,
                median: number("median"),
                lower: LEVELS.map(|level| number(&format!("lower_{level}"))),
                upper: LEVELS.map(|level| number(&format!("upper_{level}"))),
                verdict: row[place("verdict")].to_owned(),
            }
        })
        .collect()
}

fn seeds() -> Range<u64> {
    let asked = std::env::var("DROPTOWER_STUDIES").unwrap_or("4".to_owned());
    let number = |text: &str| text.parse::<u64>().expect("DROPTOWER_STUDIES is a number or a range such as 1..201");
    match asked.split_once("..") {
        Some((from, to)) => number(from)..number(to),
        None => 1..number(&asked) + 1,
    }
}

#[test]
fn intervals_of_studies_by_sensors_of_many_kinds_hold_the_truth() {
    if !thorough() {
        return;
    }
    let own = tempfile::tempdir().expect("a folder");
    let keep = std::env::var("DROPTOWER_KEEP").map_or(own.path().to_owned(), Into::into);
    let seeds = seeds();
    let all: Vec<Result<Vec<Found>, String>> = seeds
        .clone()
        .into_par_iter()
        .map(|seed| {
            let folder = keep.join(seed.to_string());
            let kept = folder.join("coverage.json");
            if let Ok(text) = fs::read_to_string(&kept) {
                return serde_json::from_str(&text).expect("what a study left");
            }
            fs::create_dir_all(&folder).expect("a folder");
            let found = study(seed, &folder);
            println!("{seed}: {found:?}");
            fs::write(&kept, serde_json::to_string(&found).expect("JSON")).expect("written");
            found
        })
        .collect();
    let refused: Vec<&String> = all.iter().filter_map(|found| found.as_ref().err()).collect();
    println!("studies {seeds:?}: {} refused", refused.len());
    assert!(refused.len() * 20 <= all.len(), "{refused:#?}");
    let found: Vec<&Found> = all.iter().flatten().flatten().collect();
    println!("| | intervals | 95 % | 80 % | 50 % | median over truth |");
    println!("|---|---|---|---|---|---|");
    let mut faults = vec![];
    for name in ["k1", "ke", "ky", "friction", "model error"] {
        let own: Vec<&&Found> = found.iter().filter(|own| own.parameter == name).collect();
        let n = own.len() as f64;
        let held = [0, 1, 2].map(|level| own.iter().filter(|own| own.holds(level)).count() as f64 / n);
        let mut ratios: Vec<f64> = own.iter().map(|own| own.median / own.truth).collect();
        ratios.sort_by(f64::total_cmp);
        let shares = held.map(|share| format!("{:.1} %", 100.0 * share)).join(" | ");
        println!("| {name} | {n} | {shares} | {:.3} |", ratios[ratios.len() / 2]);
        // Within three deviations of what chance leaves.
        for (share, level) in held.iter().zip([0.95, 0.8]) {
            if *share < level - 3.0 * (level * (1.0 - level) / n).sqrt() {
                faults.push(format!("{name}: {share} of the intervals of {level} hold the truth"));
            }
        }
    }
    let mut verdicts: Vec<&&Found> = found.iter().filter(|own| !own.verdict.is_empty()).collect();
    verdicts.sort_by_key(|own| &own.verdict);
    for same in verdicts.chunk_by(|a, b| a.verdict == b.verdict) {
        let held = same.iter().filter(|own| own.holds(0)).count();
        println!("{}: {held} of {} intervals of 95 % hold", same[0].verdict, same.len());
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
