//! The summary of a run on the terminal.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::path::Path;

use super::findings;
use base::diagnostic::shown_path;
use base::number::{self, grouped};
use scene::model::Model;
use scene::simulate::Outcome;
use study::post::{self, Audit, Impact, Measures, Results};

/// Significant digits of a figure.
pub(super) const DIGITS: usize = 3;

/// Title, cost, figures and findings of a run; ends with a line break.
pub(super) fn run(model: &Model, outcome: &Outcome, results: &Results) -> String {
    let mut text = format!("{}  {}\n", model.name, model.subject());
    let answer = results.script_output.answer.clone().unwrap_or_else(|| post::answer(model, results, false));
    let _ = writeln!(text, "  {answer}");
    text += &cost(results.measures.audit());
    let _ = writeln!(text, "  {}", post::further(model, results).join(", "));
    if let Measures::Impact(measures) = &results.measures {
        text += &[errors(model, measures), springs_and_faces(measures)].concat();
    }
    text += &steadiness(results.measures.audit());
    text += &field(results.measures.audit());
    if let Some(torn) = outcome.torn.filter(|torn| torn.length > 0.0) {
        let _ = writeln!(text, "  the film is torn {} mm in the end", number::figure(1e3 * torn.length, DIGITS));
    }
    text += &findings::lines_of_run("  ", results.measures.findings().iter());
    for line in &results.script_output.log {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// Title and findings of a run that failed; ends with a line break.
pub(super) fn failed(model: &Model, results: &Results) -> String {
    format!("{}  {}\n{}", model.name, model.subject(), findings::lines_of_run("  ", results.measures.findings().iter()))
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

fn errors(model: &Model, measures: &Impact) -> String {
    let Some(signals) = model.reference.as_ref().and_then(|reference| reference.signals.as_ref()) else {
        return String::new();
    };
    let shown = |error: Option<f64>| error.map_or("-".into(), percent);
    let (acceleration, displacement) = (shown(measures.acceleration_error), shown(measures.displacement_error));
    format!("  against {}:  E_a {acceleration}   E_d {displacement}\n", shown_path(signals))
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
