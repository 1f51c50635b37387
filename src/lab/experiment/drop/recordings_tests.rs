//! Recordings of sensors of all kinds, made apart from engine and reduction: what is refused, how often the intervals hold the
//! truth, how far figures are off, how much wider the intervals are than they could be.
//!
//! `DROPTOWER_THOROUGH=1 cargo test --release -p droptower-lab sensor_is_reduced -- --nocapture` prints the table of
//! docs/verification.md.

use std::ops::Range;

use rayon::prelude::*;
use recordings::{GRAVITY, HEIGHT_ERROR, Setup};
use thorough::thorough;

use super::reduce::{Explained, even, finish};
use super::{Reduction, Tower, fit};
use crate::experiment::absorption::Body;
use crate::signal::{Series, resample};

/// What is found of contact (s), impact speed (m/s), travel (m) and absorption.
type Found = [Figure; 4];

#[derive(Clone, Copy)]
struct Figure {
    value: f64,
    interval: [f64; 2],
    truth: f64,
    /// Least standard deviation by the model.
    least: f64,
}

/// A group of recordings, which of them it holds.
type Group = (&'static str, fn(&Setup) -> bool);

const GROUPS: [Group; 11] = [
    ("all", |_| true),
    ("noise to 0.05 g", |setup| setup.noise <= 0.05 * GRAVITY),
    ("noise to 0.07 g", |setup| setup.noise <= 0.0707 * GRAVITY),
    ("noise above 0.07 g", |setup| setup.noise > 0.0707 * GRAVITY),
    ("DC-coupled", |setup| setup.coupling == 0.0),
    ("AC-coupled", |setup| setup.coupling > 0.0),
    ("force of exponent below 2", |setup| setup.exponent < 2.0),
    ("force of exponent above 2", |setup| setup.exponent >= 2.0),
    ("travel below 55 mm", |setup| setup.travel < 0.055),
    ("laser", |setup| setup.has_laser),
    ("no laser", |setup| !setup.has_laser),
];

fn reduced(setup: &Setup) -> Result<Found, String> {
    let made = setup.record();
    let series = |values: &[f64]| Series::new(made.time.as_slice(), values.to_vec());
    let tower = Tower { body: Body { mass: 10.0, gravity: GRAVITY }, height: Some(made.height) };
    let reduction = Reduction { height_error: Some(HEIGHT_ERROR), ..Reduction::default() };
    let laser = made.laser.as_deref().map(series);
    let refused = |error: crate::Error| error.to_string();
    let reading = even(&series(&made.accelerometer)).map_err(refused)?;
    let step = resample::common_step(reading.time()).ok_or("no common step")?;
    let explained = Explained::find(&reading, step, laser.as_ref(), &tower, &reduction).map_err(refused)?;
    let drop = finish(&explained, &tower, &reduction, None, None).map_err(refused)?;
    let (figures, truth) = (drop.figures(), made.truth);
    let intervals = drop.intervals.ok_or("no intervals")?;
    let model = explained.recorded.model(&explained.known, GRAVITY);
    let least = fit::least_deviations(&explained.recorded, &model, &explained.fit, tower.body);
    let least = least.ok_or("no bound")?;
    let ends = intervals.energy_absorption.ok_or("no interval of the absorption")?;
    let found = [
        (figures.contact_time_s, intervals.contact_time, truth.contact),
        (figures.impact_velocity_m_s, intervals.impact_speed, truth.speed),
        (figures.peak_displacement_m.ok_or("no travel")?, intervals.displacement, truth.travel),
        (figures.energy_absorption.ok_or("no absorption")?, ends, truth.absorption),
    ];
    Ok([0, 1, 2, 3].map(|k| {
        let (value, interval, truth) = found[k];
        Figure { value, interval, truth, least: least[k] }
    }))
}

/// Share (%) of the intervals that hold the truth.
fn held(found: &[Found], figure: usize) -> f64 {
    let holds = |Figure { interval: [low, high], truth, .. }: Figure| (low..=high).contains(&truth);
    100.0 * found.iter().filter(|own| holds(own[figure])).count() as f64 / found.len() as f64
}

/// Median and nine tenths of `values`.
fn spread(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    [0.5, 0.9].map(|share| values[((share * values.len() as f64) as usize).min(values.len() - 1)])
}

/// Widths of the intervals over those of the bound.
fn widths(found: &[Found], figure: usize) -> [f64; 2] {
    spread(found.iter().map(|own| {
        let Figure { interval: [low, high], least, .. } = own[figure];
        (high - low) / (2.0 * 1.96 * least)
    }))
}

/// Errors: ms, %, %, points.
fn errors(found: &[Found], figure: usize) -> [f64; 2] {
    spread(found.iter().map(|own| {
        let Figure { value, truth, .. } = own[figure];
        let scale = [1e3, 100.0 / truth.abs(), 100.0 / truth.abs(), 100.0][figure];
        scale * (value - truth).abs()
    }))
}

#[test]
fn any_sensor_is_reduced_and_its_intervals_hold_the_truth() {
    check(if thorough() { 0..400 } else { 0..40 });
}

/// Recordings by which no constant of the reduction was chosen.
#[test]
fn any_other_sensor_is_reduced_as_well() {
    if thorough() {
        check(400..800);
    }
}

fn check(seeds: Range<u64>) {
    let setups: Vec<Setup> = seeds.clone().map(Setup::of).collect();
    let all: Vec<Result<Found, String>> = setups.par_iter().map(reduced).collect();
    let refused: Vec<String> = setups
        .iter()
        .zip(&all)
        .filter_map(|(setup, found)| Some(format!("{setup:?}: {}", found.as_ref().err()?)))
        .collect();
    println!("seeds {seeds:?}: {} refused", refused.len());
    assert!(refused.len() * 100 <= setups.len(), "{refused:#?}");
    println!(
        "| recordings | n | contact | speed | travel | absorption | contact (ms) | speed (%) | travel (%) | absorption (points) | widths |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let mut faults = vec![];
    for (name, is_in) in GROUPS {
        let found = setups.iter().zip(&all).filter(|(setup, _)| is_in(setup));
        let found: Vec<Found> = found.filter_map(|(_, found)| found.clone().ok()).collect();
        let held = [0, 1, 2, 3].map(|figure| held(&found, figure));
        let errors = [0, 1, 2, 3].map(|figure| errors(&found, figure));
        let cells = held.map(|share| format!("{share:.1} %")).join(" | ");
        let off = errors.map(|[median, most]| format!("{median:.2}, {most:.2}")).join(" | ");
        let widths = [0, 1, 2, 3].map(|figure| widths(&found, figure));
        let wide = widths.map(|[median, most]| format!("{median:.2}, {most:.2}")).join("; ");
        println!("| {name} | {} | {cells} | {off} | {wide} |", found.len());
        // Of 40 recordings 95 % are held by chance in 85 to 100 %, of fewer in less.
        // Of 100 to 200 recordings 95 % are held in 91.5 to 98.5 % nineteen times in twenty; there are 88 such shares.
        let least = if thorough() { 91.5 } else { 95.0 - 350.0 * (0.05 * 0.95 / found.len() as f64).sqrt() };
        let most = if thorough() { 99.5 } else { 100.0 };
        if held.iter().any(|share| !(least..=most).contains(share)) {
            faults.push(format!("{name}: {held:?} % held"));
        }
        let nine_tenths = if name == "all" { 1.3 } else { f64::INFINITY };
        if widths.iter().any(|[median, most]| *median > 1.3 || *most > nine_tenths) {
            faults.push(format!("{name}: intervals are {widths:?} times as wide as the bound"));
        }
        let allowed = if name == "noise to 0.05 g" { [0.3, 1.5] } else { [0.8, 4.0] };
        // The median of a dozen recordings is known to some 40 %.
        let allowed = allowed.map(|most| if thorough() { most } else { 1.4 * most });
        if errors[2][0] > allowed[0] || errors[2][1] > allowed[1] {
            faults.push(format!("{name}: travel is off by {:?} %", errors[2]));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
