//! Measures and post scripts on a run made by hand: half a sine of braking, then free flight.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::time::Duration;

use super::*;
use crate::script::Fault;
use lab::signal::{Channel, Recording};
use scene::model::{Model, Output};
use scene::scenario::Document;
use scene::simulate::Outcome;

const MASS: f64 = 10.72;
const PEAK: f64 = 150.0;
const PULSE: f64 = 0.09;
const SPEED: f64 = 6.0;

const SCENARIO: &str = r#"
title = "A half-sine pulse"
output.filter = "CFC1000"
loading.impact = { velocity = 6, gravity = 0, duration = 0.12 }
impactor = { shape = { sphere = { radius = 0.15 } }, mass = 10.72, friction = 0 }
layers.count = 8
[specimen]
shape = { circle = { radius = 0.2 } }
mesh.size = 0.01
material = { name = "film", density = 915, thickness = 12e-6, elastic = { young = 50e6, poisson = 0.44 } }
"#;

pub(super) fn model() -> Model {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "")
}

/// The model of the scenario with `more` at its end, written to `folder`.
fn written(folder: &Path, more: &str) -> Model {
    let path = folder.join("scenario.toml");
    fs::write(&path, format!("{SCENARIO}{more}")).unwrap();
    scene::model::check(&Document::read(&path).unwrap()).unwrap()
}

/// a = A sin(πt/T), and its integrals from −v₀ and 0.
fn motion(t: f64) -> [f64; 3] {
    let speed_gained = |t: f64| PEAK * PULSE / PI * (1.0 - (PI * t / PULSE).cos());
    let place = |t: f64| {
        let curved = PEAK * PULSE / PI * (t - PULSE / PI * (PI * t / PULSE).sin());
        curved - SPEED * t
    };
    if t <= PULSE {
        return [place(t), speed_gained(t) - SPEED, PEAK * (PI * t / PULSE).sin()];
    }
    let speed = speed_gained(PULSE) - SPEED;
    [place(PULSE) + speed * (t - PULSE), speed, 0.0]
}

fn outcome() -> Outcome {
    let time: Vec<f64> = (0..=1200).map(|i| f64::from(i) * 1e-4).collect();
    let channel = |name: &str, index: usize| Channel {
        name: name.into(),
        values: time.iter().map(|t| motion(*t)[index]).collect(),
    };
    let mut channels = vec![channel("displacement_m", 0), channel("velocity_m_s", 1), channel("acceleration_m_s2", 2)];
    let force = channels[2].values.iter().map(|acceleration| MASS * acceleration).collect();
    channels.push(Channel { name: "contact_force_N".into(), values: force });
    let energies = Recording {
        time: time.clone(),
        channels: vec![Channel { name: "elastic_J".into(), values: vec![0.0; time.len()] }],
    };
    Outcome {
        signals: Recording { time, channels },
        energies,
        energy_balance_error: 0.0004,
        penetration: Some(f64::NAN),
        elements: 400,
        threads: 2,
        steps: 1000,
        time_step: 1.2e-4,
        wall: Duration::from_millis(40),
        ..Outcome::default()
    }
}

fn impact(results: &Results) -> &Impact {
    match &results.measures {
        Measures::Impact(impact) => impact,
        _ => panic!("an impact was measured as something else"),
    }
}

fn close(found: Option<f64>, expected: f64, tolerance: f64) {
    let found = found.unwrap();
    assert!((found - expected).abs() <= tolerance, "{found} for {expected}");
}

/// The run with a post script, in a folder of its own.
fn with_script(text: &str) -> Result<Results, EvaluateError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("post.rhai");
    fs::write(&path, text).unwrap();
    let model = Model { post: Some(path), ..model() };
    let plan = Plan::prepare(&model).unwrap();
    plan.evaluate(&model, &outcome())
}

#[test]
fn a_pulse_has_the_measures_of_its_formula() {
    let plan = Plan::prepare(&model()).unwrap();
    let results = plan.evaluate(&model(), &outcome()).unwrap();
    let impact = impact(&results);
    close(impact.first().peak_acceleration_m_s2, PEAK, 0.01);
    close(impact.first().time_of_peak_acceleration_s, PULSE / 2.0, 1e-9);
    let lowest = PULSE / PI * (1.0 - SPEED * PI / (PEAK * PULSE)).acos();
    close(impact.first().time_of_peak_displacement_s, lowest, 1e-4);
    close(impact.first().peak_displacement_m, motion(lowest)[0], 1e-6);
    let rebound = 2.0 * PEAK * PULSE / PI - SPEED;
    close(impact.first().rebound_velocity_m_s, rebound, 1e-9);
    close(impact.first().energy_absorption, 1.0 - (rebound / SPEED).powi(2), 1e-4);
    assert_eq!(impact.acceleration_error, None);
    assert_eq!(results.audit.ns_per_element_step, 100.0);
    let names: Vec<&str> = results.signals.channels.iter().map(|c| c.name.as_str()).collect();
    let filtered = "acceleration_filtered_m_s2";
    assert_eq!(names, ["displacement_m", "velocity_m_s", "acceleration_m_s2", filtered, "contact_force_N"]);
}

#[test]
fn what_is_not_finite_is_null_in_the_summary() {
    let results = Plan::prepare(&model()).unwrap().evaluate(&model(), &outcome()).unwrap();
    let summary = results.summary(&model());
    assert!(summary["penetration"].is_null());
    assert!(summary["acceleration_error"].is_null());
    assert_eq!(summary["ruptured"], false);
}

#[test]
fn a_run_that_ends_before_the_lowest_point_has_no_rebound() {
    let mut short = outcome();
    short.signals.time.truncate(100);
    short.signals.channels.iter_mut().for_each(|c| c.values.truncate(100));
    let results = Plan::prepare(&model()).unwrap().evaluate(&model(), &short).unwrap();
    assert_eq!(impact(&results).first().rebound_velocity_m_s, None);
    assert_eq!(impact(&results).first().energy_absorption, None);
}

fn reference(rows: impl Fn(f64) -> String, header: &str) -> (tempfile::TempDir, Model) {
    let folder = tempfile::tempdir().unwrap();
    let signals = folder.path().join("reference.csv");
    let rows = (0..=1100).map(|i| rows(f64::from(i) * 1e-4));
    fs::write(&signals, format!("{header}\n{}", rows.collect::<String>())).unwrap();
    let model = written(folder.path(), "[reference]\nsignals = \"reference.csv\"\n");
    (folder, model)
}

#[test]
fn a_reference_ten_per_cent_low_gives_its_error() {
    let row = |t: f64| format!("{t},{},{}\n", motion(t)[2] / 1.1, motion(t)[0]);
    let (_folder, model) = reference(row, "time_s,acceleration_m_s2,displacement_m");
    let plan = Plan::prepare(&model).unwrap();
    let results = plan.evaluate(&model, &outcome()).unwrap();
    close(impact(&results).acceleration_error, 0.1, 1e-4);
    close(impact(&results).displacement_error, 0.0, 1e-9);
}

#[test]
fn loading_ends_at_zero_speed_where_the_laser_has_gaps() {
    let laser = |t: f64| if t < 0.02 { motion(t)[0].to_string() } else { String::new() };
    let row = |t: f64| format!("{t},{},{}\n", motion(t)[2], laser(t));
    let (_folder, model) = reference(row, "time_s,acceleration_m_s2,displacement_m");
    let plan = Plan::prepare(&model).unwrap();
    let lowest = PULSE / PI * (1.0 - SPEED * PI / (PEAK * PULSE)).acos();
    close(plan.comparison().map(|c| c.window[1]), lowest, 2e-4);
}

#[test]
fn a_reference_without_signals_is_refused_before_the_run() {
    let (_folder, model) = reference(|t| format!("{t},1\n"), "time_s,force_N");
    let error = Plan::prepare(&model).unwrap_err();
    assert!(matches!(error, PrepareError::Reference(_)), "{error}");
    let message = error.to_string();
    assert!(message.contains("none of the channels `force` is an acceleration; the file has no column"), "{message}");
    assert!(message.contains("is read as a raw recording"), "{message}");
}

#[test]
fn a_filter_too_high_for_the_rate_is_refused_before_the_run() {
    let slow = Output { sample_rate: 1e3, ..model().output };
    let error = Plan::prepare(&Model { output: slow, ..model() }).unwrap_err();
    assert!(error.to_string().starts_with("output.filter: CFC 1000 needs"), "{error}");
}

#[test]
fn a_post_script_adds_to_the_summary() {
    let results = with_script(
        "measure(\"speed_lost\", run.velocity.at(0.1) - run.velocity.at(0));
         table(\"layers\", #{ n: run.model.layers[0] });
         log(run.summary.elements)",
    )
    .unwrap();
    let summary = results.summary(&model());
    close(summary["speed_lost"].as_f64(), 2.0 * PEAK * PULSE / PI, 1e-3);
    assert_eq!(summary["tables"]["layers"][0]["n"], 8);
    assert_eq!(results.script_output.log, ["400"]);
}

#[test]
fn a_warning_of_a_post_script_is_a_finding_of_the_run() {
    let summary = with_script("warn(\"hard-impact\", \"the peak exceeds 100 m/s²\")").unwrap().summary(&model());
    assert_eq!(summary["warnings"].as_array().unwrap().last().unwrap(), "the peak exceeds 100 m/s²");
    let finding = summary["findings"].as_array().unwrap().last().unwrap();
    assert_eq!((&finding["code"], &finding["severity"]), (&"hard-impact".into(), &"warning".into()));
}

#[test]
fn a_post_script_can_neither_replace_a_figure_nor_read_a_missing_one() {
    for (text, expected) in [
        ("measure(\"elements\", 1)", "`elements` is a field of the summary"),
        ("measure(\"tables\", 1)", "`tables` is a field of the summary"),
        ("measure(\"warnings\", 1)", "cannot be replaced: report a warning with `warn(code, text)`"),
        ("table(\"findings\", #{ n: 1 })", "`findings` is a field of the summary"),
        ("run.nosuch", "a run has no `nosuch`; it has displacement, velocity, acceleration"),
        ("run.signals.nosuch", "a recording has no `nosuch`; it has displacement_m"),
        ("let s = run.summary; s.nosuch", "there is no property `nosuch`"),
    ] {
        let Err(EvaluateError::Script(Fault { message, line, .. })) = with_script(text) else {
            panic!("{text} was accepted");
        };
        assert!(message.contains(expected), "{text} gave: {message}");
        assert_eq!(line, 1);
    }
}

#[test]
fn the_shipped_script_measures_the_pulse() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/post/impact.rhai");
    let results = with_script(&fs::read_to_string(shipped).unwrap()).unwrap();
    let output = &results.script_output;
    assert_eq!(output.plots.iter().map(|plot| plot.title.as_str()).collect::<Vec<_>>(), ["Deceleration over travel"]);
    assert_eq!(output.files.names(), ["loading.csv"]);
    let measures = &output.measures;
    let lowest = PULSE / PI * (1.0 - SPEED * PI / (PEAK * PULSE)).acos();
    close(measures["loading_duration_s"].as_f64(), lowest, 1e-4);
    close(measures["mean_deceleration_m_s2"].as_f64(), SPEED / lowest, 0.2);
    close(measures["stopping_distance_m"].as_f64(), -motion(lowest)[0], 1e-6);
}
