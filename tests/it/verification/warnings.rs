//! Warnings of runs outside the valid range, and none of others.

use droptower::finding::Report;
use serde::Deserialize;

use super::claims::Claims;
use super::tower::{run, shipped};

#[derive(Deserialize)]
struct Cases {
    case: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    code: String,
    scenario: String,
    changes: Vec<String>,
    is_told: bool,
}

#[test]
fn runs_outside_the_valid_range_have_warnings() {
    let mut claims = Claims::of("warnings");
    let cases: Cases = toml::from_str(include_str!("warnings.toml")).expect("cases");
    for Case { code, scenario, changes, is_told } in cases.case {
        let warnings = run(&shipped(&scenario, &changes.iter().map(String::as_str).collect::<Vec<_>>())).warnings;
        let warned = warnings.iter().any(|warning| warning.code().name == code);
        let seen: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let seen = if seen.is_empty() { "no warning".to_owned() } else { seen.join("; ") };
        claims.holds(&format!("{code}, {scenario} {}", changes.join(" ")), &seen, warned == is_told);
    }
}

#[test]
fn the_histogram_has_the_rate_of_a_constant_speed() {
    let mut claims = Claims::of("strain rates");
    for (speed, rate) in [("0.0002", 0.04), ("0.02", 4.0), ("0.2", 40.0)] {
        let outcome = run(&shipped(&format!("stretch/md-{speed}.toml"), &[]));
        let rates = &outcome.rates;
        let bin = |rate: f64| rates.edges.partition_point(|edge| *edge <= rate) - 1;
        let near: f64 = (bin(0.98 * rate)..=bin(1.02 * rate)).map(|k| rates.shares[k]).sum();
        claims.at_most(&format!("{speed} m/s, share of strain increments not at {rate} 1/s"), 1.0 - near, 1e-2);
    }
}
