//! Film whose curves depend on the strain rate.

use droptower::model::Model;
use droptower::simulate::Outcome;

use super::claims::Claims;
use super::solve::line;
use super::tower::{channel, impact, peaks, run, shipped};

const MATERIAL: &str = "specimen.material=scenarios/materials/lldpe-rates.toml";

/// Rates (1/s) and curves (strain, Pa) of lldpe-rates.toml, by hand from its tables; the last with k1 2.968, ke 2.882,
/// ky 0.998: 0.26/(2.968·2.882) = 0.030396, 0.030396 + (0.84 − 0.26)/2.882 = 0.231645, 1.39 + 0.231645 − 0.84 =
/// 0.781645.
const MD: [(f64, [[f64; 2]; 3]); 4] = [
    (0.04, [[0.242, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]),
    (4.0, [[0.212, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]),
    (40.0, [[0.363, 8.4e6], [0.84, 20e6], [1.39, 29.3e6]]),
    (100.0, [[0.030396, 8.3832e6], [0.231645, 19.96e6], [0.781645, 29.26e6]]),
];
/// 0.33/(2.968·2.882) = 0.038580, 0.038580 + (0.69 − 0.33)/2.882 = 0.163493, 7.01 + 0.163493 − 0.69 = 6.483493.
const TD: [(f64, [[f64; 2]; 3]); 4] = [
    (0.04, [[0.286, 8e6], [0.69, 10e6], [7.01, 16.2e6]]),
    (4.0, [[0.292, 8e6], [0.69, 10e6], [7.01, 16.2e6]]),
    (40.0, [[0.49, 8e6], [0.69, 10e6], [7.01, 16.2e6]]),
    (100.0, [[0.038580, 7.984e6], [0.163493, 9.98e6], [6.483493, 16.18e6]]),
];

/// Stress at a strain that is reached at a constant rate (1/s).
fn expected(curves: &[(f64, [[f64; 2]; 3])], rate: f64, strain: f64) -> f64 {
    let rate = rate.clamp(curves[0].0, curves[curves.len() - 1].0);
    let pair = curves.windows(2).find(|pair| rate <= pair[1].0).expect("within");
    let share = (rate / pair[0].0).ln() / (pair[1].0 / pair[0].0).ln();
    (1.0 - share) * line(&pair[0].1, strain) + share * line(&pair[1].1, strain)
}

/// Largest difference of the stress of a stretch from the curve of its rate, over the curve's.
fn deviation(outcome: &Outcome, curves: &[(f64, [[f64; 2]; 3])], rate: f64, until: f64) -> f64 {
    let (strain, stress) = (channel(&outcome.signals, "strain"), channel(&outcome.signals, "stress_Pa"));
    let within = strain.iter().zip(stress).filter(|(e, _)| **e >= 0.005 && **e < until);
    within.map(|(e, s)| (s / expected(curves, rate, *e) - 1.0).abs()).fold(0.0, f64::max)
}

/// Jaws 5 mm apart. What is left is the line between two samples across a corner, and the rounding of the printed
/// corners.
#[test]
fn a_single_element_follows_the_curve_of_its_rate() {
    let mut claims = Claims::of("curves by strain rate");
    for (direction, curves, until) in [("MD", &MD, 0.75), ("TD", &TD, 1.5)] {
        for speed in [1e-4, 2e-4, 0.002, 0.02, 0.0632, 0.2, 0.3, 0.5, 2.0] {
            let (direction_set, speed_set, until_set, sampling_set) = (
                format!("loading.stretch.direction={direction}"),
                format!("loading.stretch.velocity={speed}"),
                format!("loading.stretch.until={until}"),
                format!("output.sample_rate={}", 1e5 * speed),
            );
            let changes = [&direction_set, &speed_set, &until_set, &sampling_set].map(String::as_str);
            let outcome = run(&shipped("stretch/rates.toml", &changes));
            let rate = speed / 0.005;
            let what = |claim: &str| format!("{direction} at {rate} 1/s, {claim}");
            claims.at_most(&what("stress off the curve"), deviation(&outcome, curves, rate, until), 1e-3);
            claims.at_most(&what("energy balance error"), outcome.energy_balance_error, 1e-3);
        }
    }
}

fn tower(changes: &[&str]) -> Model {
    shipped("drop/1008.toml", &[&[MATERIAL, "specimen.mesh.size=20mm"], changes].concat())
}

#[test]
fn energy_of_a_drop_is_balanced_and_its_peaks_do_not_depend_on_the_time_step() {
    let mut claims = Claims::of("drop, curves by strain rate");
    let outcome = run(&tower(&[]));
    claims.at_most("energy balance error", outcome.energy_balance_error, 1e-3);
    let [coarse, fine] = [&[][..], &["solver.step_factor=0.5"]].map(|changes| peaks(&impact(&tower(changes))));
    claims.at_most("peak displacement, half the time step", (coarse[0] / fine[0] - 1.0).abs(), 1e-2);
    claims.at_most("peak acceleration, half the time step", (coarse[1] / fine[1] - 1.0).abs(), 2e-2);
}
