//! Recordings of sensors of all kinds, made apart from engine and reduction: what is refused, how often the intervals hold the
//! truth, how far figures are off.
//!
//! `DROPTOWER_THOROUGH=1 cargo test --release --test it sensor_is_reduced -- --nocapture` prints the table of
//! docs/verification.md.

use std::ops::Range;

use droptower::experiment::absorption::Body;
use droptower::experiment::drop::{self, Reduction, Tower};
use droptower::signal::Series;
use rayon::prelude::*;
use recordings::{GRAVITY, HEIGHT_ERROR, Setup};
use thorough::thorough;

/// Contact (s), impact speed (m/s), travel (m), absorption: found, its interval, true.
type Found = [(f64, [f64; 2], f64); 4];

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
    let drop = drop::reduce(&series(&made.accelerometer), laser.as_ref(), &tower, &reduction);
    let drop = drop.map_err(|error| error.to_string())?;
    let (figures, truth) = (drop.figures(), made.truth);
    let intervals = drop.intervals.ok_or("no intervals")?;
    let absorption = figures.energy_absorption.ok_or("no absorption")?;
    Ok([
        (figures.contact_time_s, intervals.contact_time, truth.contact),
        (figures.impact_velocity_m_s, intervals.impact_speed, truth.speed),
        (figures.peak_displacement_m.ok_or("no travel")?, intervals.displacement, truth.travel),
        (absorption, intervals.energy_absorption.ok_or("no interval of the absorption")?, truth.absorption),
    ])
}

/// Share (%) of the intervals that hold the truth.
fn held(found: &[Found], figure: usize) -> f64 {
    let holds = |found: &&Found| (found[figure].1[0]..=found[figure].1[1]).contains(&found[figure].2);
    100.0 * found.iter().filter(holds).count() as f64 / found.len() as f64
}

/// Median and nine tenths of the errors: ms, %, %, points.
fn errors(found: &[Found], figure: usize) -> [f64; 2] {
    let error = |found: &Found| {
        let (value, _, truth) = found[figure];
        let scale = [1e3, 100.0 / truth.abs(), 100.0 / truth.abs(), 100.0][figure];
        scale * (value - truth).abs()
    };
    let mut errors: Vec<f64> = found.iter().map(error).collect();
    errors.sort_by(f64::total_cmp);
    [0.5, 0.9].map(|share| errors[((share * errors.len() as f64) as usize).min(errors.len() - 1)])
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
        "| recordings | n | contact | speed | travel | absorption | contact (ms) | speed (%) | travel (%) | absorption (points) |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut faults = vec![];
    for (name, is_in) in GROUPS {
        let found = setups.iter().zip(&all).filter(|(setup, _)| is_in(setup));
        let found: Vec<Found> = found.filter_map(|(_, found)| found.clone().ok()).collect();
        let held = [0, 1, 2, 3].map(|figure| held(&found, figure));
        let errors = [0, 1, 2, 3].map(|figure| errors(&found, figure));
        let cells = held.map(|share| format!("{share:.1} %")).join(" | ");
        let off = errors.map(|[median, most]| format!("{median:.2}, {most:.2}")).join(" | ");
        println!("| {name} | {} | {cells} | {off} |", found.len());
        // Of 40 recordings 95 % are held by chance in 85 to 100 %, of fewer in less.
        // Of 100 to 200 recordings 95 % are held in 91.5 to 98.5 % nineteen times in twenty; there are 88 such shares.
        let least = if thorough() { 91.5 } else { 95.0 - 350.0 * (0.05 * 0.95 / found.len() as f64).sqrt() };
        let most = if thorough() { 99.5 } else { 100.0 };
        if held.iter().any(|share| !(least..=most).contains(share)) {
            faults.push(format!("{name}: {held:?} % held"));
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
