//! The key figures at the top of a page.

use serde_json::{Map, Value};

use super::figure::{DIGITS, G};
use super::html::escape;
use base::number::{self, duration, significant};
use study::post::{BodyFigures, Measures, Results, lowest_point};

/// A figure of the summary as its card shows it.
struct Key {
    /// HTML.
    words: &'static str,
    /// Name in the summary.
    name: &'static str,
    /// From the summary's unit to the one shown.
    factor: f64,
    unit: &'static str,
    /// Second line of the card.
    beside: Beside,
}

enum Beside {
    Nothing,
    /// At which time, by its name.
    Time(&'static str),
    /// At which strain, by its name.
    Strain(&'static str),
    /// At which depth, by its name.
    Depth(&'static str),
}

const fn key(words: &'static str, name: &'static str, factor: f64, unit: &'static str) -> Key {
    Key { words, name, factor, unit, beside: Beside::Nothing }
}

const fn key_at(key: Key, beside: Beside) -> Key {
    Key { beside, ..key }
}

const BALANCE: Key = key("energy balance error", "energy_balance_error", 100.0, "%");

const IMPACT: [Key; 7] = [
    key_at(
        key("peak deceleration", "peak_acceleration_m_s2", 1.0 / G, "g"),
        Beside::Time("time_of_peak_acceleration_s"),
    ),
    key_at(key("lowest point", "peak_displacement_m", 1e3, "mm"), Beside::Time("time_of_peak_displacement_s")),
    key("energy absorbed", "energy_absorption", 100.0, "%"),
    key("rebound velocity", "rebound_velocity_m_s", 1.0, "m/s"),
    key("acceleration error E<sub>a</sub>", "acceleration_error", 100.0, "%"),
    key("displacement error E<sub>d</sub>", "displacement_error", 100.0, "%"),
    BALANCE,
];

/// An impact without a rebound.
const DESCENT: [Key; 5] = [
    key_at(
        key("largest deceleration so far", "peak_acceleration_m_s2", 1.0 / G, "g"),
        Beside::Time("time_of_peak_acceleration_s"),
    ),
    key_at(
        key("lowest so far, still descending", "peak_displacement_m", 1e3, "mm"),
        Beside::Time("time_of_peak_displacement_s"),
    ),
    key("acceleration error E<sub>a</sub>", "acceleration_error", 100.0, "%"),
    key("displacement error E<sub>d</sub>", "displacement_error", 100.0, "%"),
    BALANCE,
];

const STRETCH: [Key; 5] = [
    key_at(key("peak stress", "peak_stress_Pa", 1e-6, "MPa"), Beside::Strain("strain_at_peak_stress")),
    key("peak force", "peak_force_N", 1.0, "N"),
    key("strain at break", "strain_at_break", 100.0, "%"),
    key("final strain", "final_strain", 100.0, "%"),
    BALANCE,
];

const INDENT: [Key; 5] = [
    key_at(key("peak force", "peak_force_N", 1.0, "N"), Beside::Depth("depth_at_peak_force_m")),
    key("work", "work_J", 1.0, "J"),
    key("depth at break", "depth_at_break_m", 1e3, "mm"),
    key("final depth", "final_depth_m", 1e3, "mm"),
    BALANCE,
];

const INFLATION: [Key; 6] = [
    key("deflection", "final_deflection_m", 1e3, "mm"),
    key("volume", "final_volume_m3", 1e3, "l"),
    key("peak pressure", "peak_pressure_Pa", 1e-3, "kPa"),
    key("burst pressure", "burst_pressure_Pa", 1e-3, "kPa"),
    key("settled within", "settling", 100.0, "%"),
    BALANCE,
];

/// A drop that was recorded.
const DROP: [Key; 5] = [
    key("impact speed", "impact_velocity_m_s", 1.0, "m/s"),
    key_at(
        key("peak deceleration", "peak_acceleration_m_s2", 1.0 / G, "g"),
        Beside::Time("time_of_peak_acceleration_s"),
    ),
    key_at(key("lowest point", "peak_displacement_m", 1e3, "mm"), Beside::Time("time_of_peak_displacement_s")),
    key("energy absorbed", "energy_absorption", 100.0, "%"),
    key_at(key("rebound velocity", "rebound_velocity_m_s", 1.0, "m/s"), Beside::Time("time_of_rebound_s")),
];

/// Cards of the figures of a drop that was recorded; empty where there are none.
pub(super) fn of_drop(figures: &Map<String, Value>) -> String {
    let cards: String = DROP.iter().filter_map(|key| card(key, "", figures)).collect();
    if cards.is_empty() { cards } else { format!("<ul class=\"cards\">\n{cards}</ul>\n") }
}

/// Of film that tears: how far, which may be short of its end.
const TORN: Key = key("torn", "torn_length_m", 1e3, "mm");

/// Of film that warms up by what it absorbs.
const WARMING: Key = key("warmed up by", "warming_K", 1.0, "K");

/// Of a run that is compared with a displacement field.
const FIELD: [Key; 2] =
    [key("field error, rms", "field_rms_m", 1e3, "mm"), key("field error", "field_error", 100.0, "%")];

/// Cards of the key figures in `summary`, that of `results`, and whether the film held; `failed` tells whether the run
/// did.
pub(super) fn cards(results: &Results, summary: &Map<String, Value>, failed: bool) -> String {
    let keys = |prefix: &str| -> &[Key] {
        match results.measures {
            Measures::Impact(_) if lowest_point(&results.signals, prefix).is_none() => &DESCENT,
            Measures::Impact(_) => &IMPACT,
            Measures::Stretch(_) => &STRETCH,
            Measures::Indent(_) => &INDENT,
            Measures::Inflation(_) => &INFLATION,
        }
    };
    let bodies: &[BodyFigures] = match &results.measures {
        Measures::Impact(impact) => &impact.bodies,
        _ => &[],
    };
    let named = bodies.iter().map(|body| body.prefix.as_str()).filter(|prefix| !prefix.is_empty());
    let cards: String = named
        .chain([""])
        .flat_map(|prefix| keys(prefix).iter().filter_map(move |key| card(key, prefix, summary)))
        .collect();
    let field = FIELD.iter().filter_map(|key| card(key, "", summary)).collect::<String>();
    let is_torn = summary.get(TORN.name).and_then(Value::as_f64).is_some_and(|length| length > 0.0);
    let torn = is_torn.then(|| card(&TORN, "", summary)).flatten().unwrap_or_default();
    let warming = card(&WARMING, "", summary).unwrap_or_default();
    let unmet: String =
        bodies.iter().filter(|body| !body.had_film_contact && !failed).map(|body| not_met(&body.prefix)).collect();
    format!("<ul class=\"cards\">\n{cards}{torn}{warming}{field}{unmet}{}</ul>\n", film(summary, failed))
}

/// The card of an impactor that never met the film; `prefix` begins the names of its figures.
fn not_met(prefix: &str) -> String {
    let whose = owner(prefix);
    format!("<li><span class=\"words\">{whose}contact with the film</span><span class=\"value\">none</span></li>\n")
}

/// Whose figures have names that begin with `prefix`, before their words; empty of a single impactor.
fn owner(prefix: &str) -> String {
    prefix.strip_suffix('_').map_or_else(String::new, |body| format!("{}: ", escape(body)))
}

/// Share in % below which a card shows no digits.
const LEAST_SHARE: f64 = 0.01;

/// The card of a figure whose name begins with `prefix`, where the summary has it.
fn card(key: &Key, prefix: &str, summary: &Map<String, Value>) -> Option<String> {
    let Key { words, name, factor, unit, beside } = key;
    let number = |name: &str| summary.get(&format!("{prefix}{name}"))?.as_f64();
    let value = number(name)?;
    let whose = owner(prefix);
    let beside = match beside {
        Beside::Nothing => None,
        Beside::Time(name) => number(name).map(|time| format!("at {}", duration(time))),
        Beside::Strain(name) => number(name).map(|strain| format!("at {} %", significant(strain * 100.0, DIGITS))),
        Beside::Depth(name) => number(name).map(|depth| format!("at {} mm", significant(depth * 1e3, DIGITS))),
    };
    let shown = if *unit == "%" && (value * factor).abs() < LEAST_SHARE {
        format!("&lt; {LEAST_SHARE}")
    } else {
        number_of(value * factor)
    };
    let beside = beside.map_or(String::new(), |beside| format!("<span class=\"beside\">{}</span>", escape(&beside)));
    Some(format!(
        "<li data-figure=\"{prefix}{name}\" data-value=\"{value}\" data-factor=\"{factor}\">\
         <span class=\"words\">{whose}{words}</span><span class=\"value\">{shown}</span> <span class=\"unit\">{unit}</span>{beside}</li>\n"
    ))
}

/// Four significant digits, as short as they can be written.
fn number_of(value: f64) -> String {
    let small = value != 0.0 && value.abs() < 1e-3;
    let text = if small { number::figure(value, DIGITS) } else { significant(value, DIGITS) };
    text.replace('-', "\u{2212}")
}

/// Whether the film ruptured, and when; of a failed run, that it held until then.
fn film(summary: &Map<String, Value>, failed: bool) -> String {
    let rupture = summary.get("rupture_time_s").and_then(Value::as_f64);
    let (shown, beside) = match rupture {
        Some(time) => ("ruptured", format!("<span class=\"beside\">at {}</span>", duration(time))),
        None if failed => ("held", "<span class=\"beside\">until the run failed</span>".into()),
        None => ("held", String::new()),
    };
    format!("<li><span class=\"words\">film</span><span class=\"value\">{shown}</span>{beside}</li>\n")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_card_shows_the_figure_in_its_unit_and_names_it_in_full() {
        let summary = json!({ "peak_displacement_m": -0.169854473, "time_of_peak_displacement_s": 0.0573 });
        let html = card(&IMPACT[1], "", summary.as_object().unwrap()).unwrap();
        assert!(html.contains("data-figure=\"peak_displacement_m\" data-value=\"-0.169854473\" data-factor=\"1000\""));
        assert!(html.contains("\u{2212}169.9</span> <span class=\"unit\">mm") && html.contains("at 57.3 ms"), "{html}");
        assert_eq!(card(&IMPACT[0], "", &Map::new()), None);
    }

    #[test]
    fn the_film_of_a_failed_run_held_until_it_failed() {
        let whole = film(&Map::new(), false);
        assert!(whole.contains("held") && !whole.contains("run failed"));
        assert!(film(&Map::new(), true).contains("until the run failed"));
        let ruptured = json!({ "rupture_time_s": 0.04 });
        assert!(film(ruptured.as_object().unwrap(), true).contains("ruptured</span><span class=\"beside\">at 40.0 ms"));
    }

    #[test]
    fn numbers_are_short() {
        for (value, expected) in [(1.37e-9, "1.370e-9"), (0.0, "0"), (15.1, "15.1"), (-0.02091, "-0.02091")] {
            assert_eq!(number_of(value), expected.replace('-', "\u{2212}"));
        }
    }
}
