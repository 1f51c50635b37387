//! The summary of a run on the terminal.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::path::Path;

use super::findings;
use base::diagnostic::shown_path;
use base::number::{self, duration, grouped};
use report::G;
use scene::model::Model;
use scene::simulate::Outcome;
use study::post::{Audit, BodyFigures, Impact, Indent, Inflation, Measures, Results, Stretch};

/// Significant digits of a figure.
pub(super) const DIGITS: usize = 3;

/// Title, cost, figures and findings of a run; ends with a line break.
pub(super) fn run(model: &Model, outcome: &Outcome, results: &Results) -> String {
    let mut text = format!("{}  {}\n", model.name, model.subject());
    text += &cost(results.measures.audit());
    text += &match &results.measures {
        Measures::Impact(measures) => [impact(measures), errors(model, measures)].concat(),
        Measures::Stretch(measures) => stretch(measures),
        Measures::Indent(measures) => indent(measures),
        Measures::Inflation(measures) => inflation(measures),
    };
    text += &steadiness(results.measures.audit());
    text += &field(results.measures.audit());
    // Film that tears breaks by and by: its first element is not its end, and an element takes its tear before it is deleted.
    let torn = outcome.torn.filter(|torn| torn.length > 0.0);
    let torn = torn.map(|torn| format!("torn {} mm in the end", number::figure(1e3 * torn.length, DIGITS)));
    if let Some(time) = outcome.rupture_time {
        let torn = torn.map(|torn| format!(" first, {torn}")).unwrap_or_default();
        let _ = writeln!(text, "  the film ruptured at {}{torn}", duration(time));
    } else if let Some(torn) = torn {
        let _ = writeln!(text, "  the film is {torn}");
    }
    text += &findings::lines("  ", results.measures.findings().iter());
    for line in &results.script_output.log {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// Title and findings of a run that failed; ends with a line break.
pub(super) fn failed(model: &Model, results: &Results) -> String {
    format!("{}  {}\n{}", model.name, model.subject(), findings::lines("  ", results.measures.findings().iter()))
}

/// The folder and its files; ends with a line break.
pub(super) fn folder(place: &Path, files: &[String]) -> String {
    format!("  {}: {}\n", shown_path(place), gathered(files).join("  "))
}

/// Most files of one folder that are named one by one.
const MOST_NAMED: usize = 9;

/// The names; of a folder that holds many, its name and their number.
fn gathered(files: &[String]) -> Vec<String> {
    let folder = |name: &str| name.rsplit_once('/').map_or(String::new(), |(folder, _)| folder.to_owned());
    let mut counts: HashMap<String, usize> = HashMap::new();
    for name in files {
        *counts.entry(folder(name)).or_default() += 1;
    }
    let mut named = HashSet::new();
    let mut entry = |name: &String| {
        let folder = folder(name);
        let count = counts.get(&folder).copied().filter(|count| !folder.is_empty() && *count > MOST_NAMED);
        let Some(count) = count else { return Some(name.clone()) };
        named.insert(folder.clone()).then(|| format!("{folder}/ ({count} files)"))
    };
    files.iter().filter_map(&mut entry).collect()
}

fn cost(audit: &Audit) -> String {
    format!(
        "  {} element{}, {} steps of {} us, {:.2} s ({:.0} ns per element step)\n",
        grouped(audit.elements as u64),
        if audit.elements == 1 { "" } else { "s" },
        grouped(audit.steps),
        number::figure(audit.time_step_s * 1e6, DIGITS),
        audit.wall_s,
        audit.ns_per_element_step,
    )
}

/// The errors against a displacement field; empty without one.
fn field(audit: &Audit) -> String {
    let Some(field) = &audit.field else { return String::new() };
    let millimetres = |length: f64| format!("{} mm", number::figure(length * 1e3, DIGITS));
    format!(
        "  against the field   {} (rms), {} at most, {} of what was measured; {} of {} points at {} times\n",
        field.rms_m.map_or("-".into(), millimetres),
        field.largest_m.map_or("-".into(), millimetres),
        audit.field_error.map_or("-".into(), percent),
        field.compared,
        field.points,
        field.times.len()
    )
}

fn impact(measures: &Impact) -> String {
    let balance = balance(&measures.audit);
    let of_bodies = match measures.bodies.as_slice() {
        [body] => of_body(body, &format!("energy balance error {balance}")),
        several => {
            let of_one = |body: &BodyFigures| {
                let name = body.prefix.trim_end_matches('_');
                format!("  {name}\n{}", of_body(body, &format!("rebound       {}", rebound(body))))
            };
            let all: String = several.iter().map(of_one).collect();
            format!("{all}  energy balance error {balance}\n")
        }
    };
    [of_bodies, springs_and_faces(measures)].concat()
}

/// What the springs of the frame carried, and how near film came to film.
fn springs_and_faces(measures: &Impact) -> String {
    let mut text = String::new();
    if let (Some(force), Some(elongation)) = (measures.peak_spring_force, measures.peak_spring_elongation_m) {
        let [force, elongation] = [force, 1e3 * elongation].map(|value| number::figure(value, DIGITS));
        let _ = writeln!(text, "  springs             up to {force} N, {elongation} mm longer than without force");
    }
    if let Some(least) = measures.least_film_distance_m {
        let least = number::figure(1e3 * least, DIGITS);
        let _ = writeln!(text, "  film from film      {least} mm at least, from middle to middle");
    }
    text
}

/// The figures of one impactor, with `last` at their end.
fn of_body(body: &BodyFigures, last: &str) -> String {
    let BodyFigures { peak_acceleration_m_s2: peak, peak_displacement_m: travel, .. } = body;
    let peak = with_time(peak.map(|a| format!("{:.1} g", a / G)), body.time_of_peak_acceleration_s);
    let travel = with_time(travel.map(|d| format!("{:.1} mm", d * 1e3)), body.time_of_peak_displacement_s);
    let none = match (body.had_film_contact, body.is_unfinished, body.rebound_velocity_m_s) {
        (false, ..) => "none, no contact",
        (_, true, _) => "not known, unfinished",
        (_, _, None) => "not known, no rebound",
        _ => "not known",
    };
    let absorbed = body.energy_absorption.map_or(none.into(), percent);
    format!("  peak deceleration   {peak:<22} displacement  {travel}\n  energy absorbed     {absorbed:<22} {last}\n")
}

fn rebound(body: &BodyFigures) -> String {
    body.rebound_velocity_m_s.map_or("-".into(), |velocity| format!("{} m/s", number::figure(velocity, DIGITS)))
}

fn errors(model: &Model, measures: &Impact) -> String {
    let Some(signals) = model.reference.as_ref().and_then(|reference| reference.signals.as_ref()) else {
        return String::new();
    };
    let shown = |error: Option<f64>| error.map_or("-".into(), percent);
    let (acceleration, displacement) = (shown(measures.acceleration_error), shown(measures.displacement_error));
    format!("  against {}:  E_a {acceleration}   E_d {displacement}\n", shown_path(signals))
}

fn stretch(measures: &Stretch) -> String {
    let stress =
        |pascal: Option<f64>| pascal.map_or("-".into(), |p| format!("{} MPa", number::figure(p * 1e-6, DIGITS)));
    let strain = |strain: Option<f64>| strain.map_or("-".into(), percent);
    let force = measures.peak_force.map_or("-".into(), |force| format!("{} N", number::figure(force, DIGITS)));
    let peak = format!("{} at {}", stress(measures.peak_stress), strain(measures.strain_at_peak_stress));
    let broke = match measures.strain_at_break {
        Some(at) => format!("at {}, {}", percent(at), stress(measures.stress_at_break)),
        None => "none".into(),
    };
    format!(
        "  peak stress         {peak:<22} peak force    {force}\n  break               {broke:<22} energy balance error {}\n",
        balance(&measures.audit),
    )
}

fn indent(measures: &Indent) -> String {
    let depth = |value| shown(value, 1e3, "mm");
    let peak = format!("{} at {}", shown(measures.peak_force, 1.0, "N"), depth(measures.depth_at_peak_force));
    let end = match measures.depth_at_break {
        Some(_) => format!("break at {}", depth(measures.depth_at_break)),
        None => depth(measures.final_depth),
    };
    format!(
        "  peak force          {peak:<22} depth         {end}\n  work                {:<22} energy balance error {}\n",
        shown(Some(measures.work), 1.0, "J"),
        balance(&measures.audit),
    )
}

fn inflation(measures: &Inflation) -> String {
    let pressure = |value| shown(value, 1e-3, "kPa");
    let end = match measures.burst_pressure {
        Some(_) => format!("burst at {}", pressure(measures.burst_pressure)),
        None => pressure(measures.peak_pressure),
    };
    format!(
        "  deflection          {:<22} pressure      {end}\n  settled within      {:<22} energy balance error {}\n",
        shown(measures.final_deflection, 1e3, "mm"),
        measures.settling.map_or("-".into(), |share| format!("{:.3} %", share * 100.0)),
        balance(&measures.audit),
    )
}

/// The kinetic share of a slow test and the factor on its mass; the mass added to small elements.
fn steadiness(audit: &Audit) -> String {
    let added = match (audit.added_mass_kg, audit.added_mass_share) {
        (Some(mass), Some(share)) => {
            format!(
                "  mass added to small elements: {} g, {} of the film\n",
                number::figure(1e3 * mass, DIGITS),
                percent(share)
            )
        }
        _ => String::new(),
    };
    let scaled = match (audit.mass_scaling, audit.kinetic_share) {
        (Some(scaling), Some(share)) => {
            format!("  mass scaled by {}, kinetic share {}\n", number::figure(scaling, DIGITS), percent(share))
        }
        _ => String::new(),
    };
    format!("{scaled}{added}")
}

/// The value times a factor, with its unit.
fn shown(value: Option<f64>, factor: f64, unit: &str) -> String {
    value.map_or("-".into(), |value| format!("{} {unit}", number::figure(value * factor, DIGITS)))
}

fn with_time(value: Option<String>, time: Option<f64>) -> String {
    match (value, time) {
        (Some(value), Some(time)) => format!("{value} at {}", duration(time)),
        _ => "-".into(),
    }
}

fn balance(audit: &Audit) -> String {
    let error = audit.energy_balance_error * 100.0;
    if error < 0.01 { "below 0.01 %".into() } else { format!("{error:.2} %") }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", share * 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_of_many_files_is_named_once() {
        let many = (0..20).map(|n| format!("coupons/{n}.csv"));
        let files: Vec<String> =
            ["summary.json".to_owned(), "tables/a.csv".to_owned()].into_iter().chain(many).collect();
        assert_eq!(gathered(&files), ["summary.json", "tables/a.csv", "coupons/ (20 files)"]);
    }
}
