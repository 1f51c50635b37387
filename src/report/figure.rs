//! Figures in words with a rounded number and a unit, and the key figures at the top of a page.

use serde_json::{Map, Value};

use crate::html::{self, Card, escape};
use crate::script_output::cell;
use base::diagnostic::steers;
use base::number::{self, duration, significant};
use base::units::{STANDARD_GRAVITY, Unit, printed};
use base::written::{LINE_FORCES, Reading};
use scene::model::Model;
use study::post::{
    BodyFigures, HEADLINES, Headline, LEAST_SHARE, Measures, Results, TestKind, Verdict, descends, headlines_of,
    reached,
};

/// Standard gravity, m/s²: decelerations are shown in multiples of it.
pub const G: f64 = STANDARD_GRAVITY;

/// Significant digits of a figure or of a cell of a table.
pub(crate) const DIGITS: usize = 4;

/// One line of a table of figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// The name in words.
    pub words: String,
    /// Rounded to four significant digits.
    pub value: String,
    /// The unit; accelerations also in multiples of g.
    pub unit: String,
}

impl Figure {
    /// The figure `name` of a summary; `None` where there is no value or it is not one number, text or truth.
    pub fn from_value(name: &str, value: &Value) -> Option<Figure> {
        let (words, Reading { unit, .. }) = named(name);
        let unit = match (unit.as_str(), value.as_f64()) {
            ("m/s²", Some(acceleration)) => format!("m/s² ({} g)", number::figure(acceleration / G, DIGITS)),
            _ => unit,
        };
        let is_single = !matches!(value, Value::Null | Value::Array(_) | Value::Object(_));
        is_single.then(|| Figure { words, value: cell(value), unit })
    }

    /// Words, value, unit.
    pub fn cells(&self) -> [String; 3] {
        [self.words.clone(), self.value.clone(), self.unit.clone()]
    }
}

/// Figures as a table of HTML; each row carries the name and the full value as data attributes.
pub(crate) fn table<'a>(figures: impl Iterator<Item = (&'a String, &'a Value)>) -> String {
    let row = |(name, value): (&String, &Value)| {
        let cells = Figure::from_value(name, value)?.cells().map(|cell| escape(&cell));
        let (name, value) = (escape(name), escape(&value.to_string()));
        Some(format!("<tr data-figure=\"{name}\" data-value=\"{value}\"><td>{}</td></tr>\n", cells.join("</td><td>")))
    };
    let rows: String = figures.filter_map(row).collect();
    if rows.is_empty() { rows } else { html::scrolled("figures", &rows) }
}

/// Words and unit in the name of a figure or of a column: `peak_acceleration_m_s2` is a peak acceleration in m/s².
pub(crate) fn named(name: &str) -> (String, Reading) {
    let force = LINE_FORCES.iter().find_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, (*unit).to_owned())));
    let other = || Unit::of_name(name).map(|(stem, unit)| (stem, printed(unit.symbol()).to_owned()));
    let (words, unit) = match force.or_else(other) {
        _ if name == "penetration" => (name, "of half its width".into()),
        _ if name == "seconds" => ("time", "s".into()),
        Some(found) => found,
        None => (name, String::new()),
    };
    (words.replace('_', " "), Reading { unit, factor: 1.0 })
}

/// The figures of a summary as a table in Markdown.
pub fn markdown(summary: &Map<String, Value>) -> String {
    let figures = summary.iter().filter_map(|(name, value)| Figure::from_value(name, value));
    let line = |figure: Figure| format!("| {} |\n", figure.cells().map(|cell| escaped(&cell)).join(" | "));
    let lines: String = figures.map(line).collect();
    format!("| figure | value | unit |\n|---|---:|---|\n{lines}")
}

/// `text` with everything that Markdown would read as markup escaped.
pub fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\n' | '\r' => out.push(' '),
            '|' | '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '#' | '~' | '&' | '!' => out.extend(['\\', c]),
            c if steers(c) => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Of a drop that was recorded: of a run it is an input.
const IMPACT_SPEED: Headline = Headline {
    test: None,
    name: "impact_velocity_m_s",
    words: "impact speed",
    factor: 1.0,
    unit: "m/s",
    at: None,
    judges: false,
};

/// Cards of the figures of a drop that was recorded; empty where there are none.
pub(crate) fn of_drop(figures: &Map<String, Value>) -> String {
    let all = std::iter::once(&IMPACT_SPEED).chain(TestKind::Impact.headlines());
    let cards: String = all.filter_map(|headline| card(headline, headline.words, "", figures)).collect();
    html::cards(&cards)
}

/// Cards of the key figures in `summary`, that of `results`, and whether the film held; the run has `failed` or not.
pub(crate) fn cards(model: &Model, results: &Results, failed: bool, summary: &Map<String, Value>) -> String {
    let bodies: &[BodyFigures] = match &results.measures {
        Measures::Impact(impact) => &impact.bodies,
        _ => &[],
    };
    let named = bodies.iter().map(|body| body.prefix.as_str()).filter(|prefix| !prefix.is_empty());
    let own = named.chain([""]).flat_map(|prefix| {
        let words = |headline: &Headline| headline.words_of(descends(results, prefix));
        let card = |headline: &'static Headline| card(headline, words(headline), prefix, summary);
        headlines_of(model, results, prefix).filter_map(card).collect::<Vec<_>>()
    });
    let is_shown = |headline: &&Headline| headline.test.is_none() && !(headline.name == TORN && holds(summary));
    let others = HEADLINES.iter().filter(is_shown).filter_map(|headline| card(headline, headline.words, "", summary));
    let unmet = bodies.iter().filter(|body| !body.had_film_contact && !failed).map(|body| not_met(&body.prefix));
    let cards: String = own.chain(others).chain(unmet).collect();
    let film = film(summary, failed, results.audit.verdict);
    // A film that ruptured is what a reader asks for first.
    let [first, last] =
        if summary.contains_key(RUPTURE) && !summary[RUPTURE].is_null() { [&film, &cards] } else { [&cards, &film] };
    html::cards(&[first.as_str(), last].concat())
}

/// When film first broke.
const RUPTURE: &str = "rupture_time_s";

/// Of film that tears: how far, which may be short of its end.
const TORN: &str = "torn_length_m";

/// Whether no film is torn.
fn holds(summary: &Map<String, Value>) -> bool {
    summary.get(TORN).and_then(Value::as_f64).is_none_or(|length| length == 0.0)
}

/// The card of an impactor that never met the film; `prefix` begins the names of its figures.
fn not_met(prefix: &str) -> String {
    Card { words: owner(prefix) + "contact with the film", value: "none", ..Card::default() }.html()
}

/// Whose figures have names that begin with `prefix`, before their words; empty of a single impactor.
fn owner(prefix: &str) -> String {
    prefix.strip_suffix('_').map_or_else(String::new, |body| format!("{}: ", escape(body)))
}

/// The card of a figure whose name begins with `prefix`, where the summary has it.
fn card(headline: &Headline, words: &str, prefix: &str, summary: &Map<String, Value>) -> Option<String> {
    let Headline { name, factor, unit, at, .. } = headline;
    let number = |name: &str| summary.get(&format!("{prefix}{name}"))?.as_f64();
    let value = number(name)?;
    // A letter behind `_` is a subscript.
    let words = words.split_once('_').map_or(words.into(), |(before, index)| format!("{before}<sub>{index}</sub>"));
    let beside = at.and_then(|at| Some(reached(at, number(at)?))).unwrap_or_default();
    let shown = if *unit == "%" && (value * factor).abs() < LEAST_SHARE {
        format!("&lt; {LEAST_SHARE}")
    } else {
        number_of(value * factor)
    };
    let attributes = format!(" data-figure=\"{prefix}{name}\" data-value=\"{value}\" data-factor=\"{factor}\"");
    let words = [owner(prefix), words].concat();
    Some(Card { attributes, words, value: &shown, unit, beside: &beside, title: "" }.html())
}

/// Four significant digits, as short as they can be written.
fn number_of(value: f64) -> String {
    let small = value != 0.0 && value.abs() < 1e-3;
    let text = if small { number::figure(value, DIGITS) } else { significant(value, DIGITS) };
    text.replace('-', "\u{2212}")
}

/// The verdict on the film, and when it ruptured; of a failed run, that it held until then.
fn film(summary: &Map<String, Value>, failed: bool, verdict: Verdict) -> String {
    let [shown, beside] = verdict.tile();
    let (shown, beside) = match summary.get(RUPTURE).and_then(Value::as_f64) {
        Some(time) => ("ruptured", format!("at {}", duration(time))),
        None if failed && verdict != Verdict::CannotBreak => ("held", "until the run failed".into()),
        None => (shown, beside.into()),
    };
    Card { words: "film".into(), value: shown, beside: &beside, ..Card::default() }.html()
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use serde_json::json;

    use super::*;

    #[test]
    fn names_become_words_and_units() {
        for (name, value, expected) in [
            ("peak_acceleration_m_s2", Value::from(153.04321), "peak acceleration 153.0 m/s² (15.61 g)"),
            ("rupture_time_s", Value::from(0.0312345), "rupture time 0.03123 s"),
            ("ruptured", Value::from(true), "ruptured yes "),
            ("penetration", Value::from(0.01), "penetration 0.01000 of half its width"),
            ("mass_kg", Value::from(0.2), "mass 0.2000 kg"),
            ("thickness_um", Value::from(12), "thickness 12 µm"),
            ("angle_deg", Value::from(45), "angle 45 °"),
            ("work_kJ", Value::from(2), "work 2 kJ"),
            ("steps", Value::from(11_240), "steps 11240 "),
            ("energy_balance_error", Value::from(4.0e-6), "energy balance error 4.000e-6 "),
        ] {
            assert_eq!(Figure::from_value(name, &value).unwrap().cells().join(" "), expected);
        }
        assert_eq!(Figure::from_value("rupture_time_s", &Value::Null), None);
    }

    #[test]
    fn shipped_scripts_name_units_that_are_known() {
        let read = |path: &Path| fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let scripts = ["scripts", "scripts/post"].map(|folder| fs::read_dir(root.join(folder)).expect("a folder"));
        let scripts = scripts.into_iter().flatten().map(|entry| entry.expect("an entry").path());
        let scripts = scripts.filter(|path| path.extension().is_some_and(|extension| extension == "rhai"));
        let texts: Vec<String> = scripts.chain([root.join("docs/guide.md")]).map(|path| read(&path)).collect();
        assert!(texts.len() > 10);
        let is_name =
            |text: &&str| text.find('_') > Some(0) && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let names: Vec<&str> = texts.iter().flat_map(|text| text.split('"')).filter(is_name).collect();
        let units =
            ["failure_mass_kg", "head_km_h", "resultant_N_mm"].map(|name| (names.contains(&name), named(name).1.unit));
        assert_eq!(units, [(true, "kg".into()), (true, "km/h".into()), (true, "N/mm".into())]);
        for name in names {
            let last = name.rsplit('_').next().unwrap_or_default();
            // Smallest, not minutes.
            let is_unit = Unit::parse(last).is_ok() && last != "min" && last.parse::<f64>().is_err();
            assert!(!is_unit || !named(name).1.unit.is_empty(), "{name} has no unit");
        }
    }

    #[test]
    fn texts_mean_themselves_in_markdown() {
        let summary = serde_json::json!({ "note": "![x](https://a.b)\n**b** <img> | &lt;" });
        let expected = "| note | \\!\\[x\\](https://a.b) \\*\\*b\\*\\* \\<img\\> \\| \\&lt; |  |\n";
        let found = markdown(summary.as_object().unwrap());
        assert!(found.ends_with(expected), "{found}");
    }

    #[test]
    fn a_card_shows_the_figure_in_its_unit_and_names_it_in_full() {
        let summary = json!({ "peak_displacement_m": -0.169854473, "time_of_peak_displacement_s": 0.0573 });
        let [peak, lowest] = [0, 1].map(|at| &HEADLINES[at]);
        let html = card(lowest, lowest.words, "", summary.as_object().unwrap()).unwrap();
        assert!(html.contains("data-figure=\"peak_displacement_m\" data-value=\"-0.169854473\" data-factor=\"1000\""));
        assert!(html.contains("\u{2212}169.9</span> <span class=\"unit\">mm") && html.contains("at 57.3 ms"), "{html}");
        assert_eq!(card(peak, peak.words, "", &Map::new()), None);
    }

    #[test]
    fn the_film_of_a_failed_run_held_until_it_failed() {
        let whole = film(&Map::new(), false, Verdict::Held);
        assert!(whole.contains("held") && !whole.contains("run failed"));
        assert!(film(&Map::new(), true, Verdict::Held).contains("until the run failed"));
        assert!(film(&Map::new(), false, Verdict::TooCoarse).contains("too coarse"));
        let ruptured = json!({ "rupture_time_s": 0.04 });
        let ruptured = film(ruptured.as_object().unwrap(), true, Verdict::Ruptured);
        assert!(ruptured.contains("ruptured</span><span class=\"beside\">at 40.0 ms"));
    }

    #[test]
    fn numbers_are_short() {
        for (value, expected) in [(1.37e-9, "1.370e-9"), (0.0, "0"), (15.1, "15.1"), (-0.02091, "-0.02091")] {
            assert_eq!(number_of(value), expected.replace('-', "\u{2212}"));
        }
    }
}
