//! What recordings of drops answer, in a sentence.

use super::super::figure::{self, G};
use super::test::{DropScatter, DropTest, FigureScatter};
use base::number::significant;
use lab::experiment::Warning;
use lab::experiment::drop::Drop;

/// Significant digits of a figure in a sentence.
const DIGITS: usize = 3;

/// The answer of one recording.
pub(super) fn of_one(test: &DropTest) -> String {
    let drop = match (&test.outcome, test.cause()) {
        (Ok(drop), _) => drop,
        (Err(_), cause) => return format!("No drop was reduced: {}.", cause.unwrap_or_default()),
    };
    let subject = if test.is_virtual() { "Virtual, not measured: the impactor" } else { "The impactor" };
    let mass =
        test.tower.map_or_else(String::new, |tower| format!(" of {} kg", significant(tower.body.mass, figure::DIGITS)));
    let figures = test.figures.as_ref();
    let intervals = drop.intervals.as_ref();
    let speed = with_interval(-drop.contact.velocity, intervals.map(|of| of.impact_speed), 1.0, "m/s");
    let peak = match (saturated(drop), figures.and_then(|figures| figures.peak_acceleration_m_s2)) {
        (Some(least), _) => format!(", was slowed by at least {} g", significant(least / G, DIGITS)),
        (None, Some(peak)) => format!(", was slowed by {} g at most", significant(peak / G, DIGITS)),
        (None, None) => String::new(),
    };
    let travel = match (drop.lowest_point(), figures.and_then(|figures| figures.peak_displacement_m)) {
        (Some([_, place]), _) => {
            let travel = intervals.map(|of| of.displacement.map(|place| -place));
            format!(" and stopped after {}", with_interval(-place, travel, 1e3, "mm"))
        }
        (None, Some(place)) => {
            format!(" and still descended after {} mm, when the recording ends", significant(-1e3 * place, DIGITS))
        }
        (None, None) => String::new(),
    };
    let absorbed = drop.energy_absorption.map_or_else(String::new, |absorbed| {
        let interval = intervals.and_then(|of| of.energy_absorption);
        format!("; the film absorbed {} of the energy", with_interval(absorbed, interval, 100.0, "%"))
    });
    format!("{subject}{mass} met the film at {speed}{peak}{travel}{absorbed}.")
}

/// A value with its interval of 95 %, times `factor`: `170 mm (95 %: 169 to 171)`, with the digits that its ends differ in.
fn with_interval(value: f64, interval: Option<[f64; 2]>, factor: f64, unit: &str) -> String {
    let Some([a, b]) = interval.map(|ends| ends.map(|end| factor * end)) else {
        return format!("{} {unit}", significant(factor * value, DIGITS));
    };
    let [low, high] = [a.min(b), a.max(b)];
    let decimals = (0.5 - (high - low).max(1e-9).log10()).ceil().clamp(0.0, 6.0) as usize;
    format!("{:.decimals$} {unit} (95 %: {low:.decimals$} to {high:.decimals$})", factor * value)
}

/// The least peak of an accelerometer at the end of its range, m/s².
fn saturated(drop: &Drop) -> Option<f64> {
    drop.warnings.iter().find_map(|warning| match warning {
        Warning::Saturated { peak, .. } => Some(*peak),
        _ => None,
    })
}

/// The answer of several recordings: medians with their quartiles, and what could not be reduced.
pub(super) fn of_several(names: &[String], tests: &[DropTest], scatter: &[DropScatter]) -> String {
    let failed: Vec<&str> =
        names.iter().zip(tests).filter(|(_, test)| test.outcome.is_err()).map(|(name, _)| name.as_str()).collect();
    let medians = match scatter {
        [] => None,
        [one] => {
            Some(format!("Medians and quartiles of {} drops of {}: {}.", one.drops, one.conditions(), medians(one)))
        }
        several => {
            let of = |one: &DropScatter| format!("{} ({} drops): {}", one.conditions(), one.drops, medians(one));
            Some(format!("Medians and quartiles, {}.", several.iter().map(of).collect::<Vec<_>>().join("; ")))
        }
    };
    let none = match failed.len() {
        0 => None,
        1 => Some(format!("1 of {} recordings could not be reduced: {}.", tests.len(), failed[0])),
        count => Some(format!("{count} of {} recordings could not be reduced: {}.", tests.len(), named(&failed))),
    };
    let virtual_ones = tests.iter().filter(|test| test.is_virtual()).count();
    let mark = (virtual_ones > 0).then(|| match virtual_ones == tests.len() {
        true => "All recordings are virtual, not measured.".to_owned(),
        false => format!("{virtual_ones} of the recordings are virtual, not measured."),
    });
    [medians, none, mark].into_iter().flatten().collect::<Vec<_>>().join(" ")
}

/// Most names in a sentence.
const MOST_NAMED: usize = 4;

fn named(names: &[&str]) -> String {
    let shown = names.iter().take(MOST_NAMED).copied().collect::<Vec<_>>().join(", ");
    match names.len().checked_sub(MOST_NAMED) {
        None | Some(0) => shown,
        Some(more) => format!("{shown} and {more} more"),
    }
}

/// Quantities that a sentence names.
const NAMED: [&str; 4] = ["impact_velocity_m_s", "peak_acceleration_m_s2", "peak_displacement_m", "energy_absorption"];

fn medians(scatter: &DropScatter) -> String {
    let of = |figure: &FigureScatter| {
        let quantity = figure.quantity().filter(|quantity| NAMED.contains(&quantity.name))?;
        let [median, low, high, ..] = figure.shown().map(|value| significant(value, DIGITS));
        let quartiles = if figure.count > 1 { format!(" ({low} to {high})") } else { String::new() };
        Some(format!("{} {median} {}{quartiles}", quantity.words, quantity.unit))
    };
    scatter.figures.iter().filter_map(of).collect::<Vec<_>>().join(", ")
}
