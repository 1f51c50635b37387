//! Figures in words with a rounded number and a unit.

use serde_json::{Map, Value};

use super::html::escape;
use base::diagnostic::steers;
use base::number;
use base::units::{STANDARD_GRAVITY, Unit, printed};
use base::written::LINE_FORCES;

/// Standard gravity, m/s²: decelerations are shown in multiples of it.
pub const G: f64 = STANDARD_GRAVITY;

/// Significant digits of a figure or of a cell of a table.
pub(super) const DIGITS: usize = 4;

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
        let (words, unit) = named(name);
        let unit = match (unit.as_str(), value.as_f64()) {
            ("m/s²", Some(acceleration)) => format!("m/s² ({} g)", number::figure(acceleration / G, DIGITS)),
            _ => unit,
        };
        let value = match value {
            Value::Number(number) if number.is_f64() => number::figure(number.as_f64()?, DIGITS),
            Value::Number(number) => number.to_string(),
            Value::Bool(yes) => if *yes { "yes" } else { "no" }.into(),
            Value::String(text) => text.clone(),
            _ => return None,
        };
        Some(Figure { words, value, unit })
    }

    /// Words, value, unit.
    pub fn cells(&self) -> [String; 3] {
        [self.words.clone(), self.value.clone(), self.unit.clone()]
    }
}

/// Figures as a table of HTML; each row carries the name and the full value as data attributes.
pub(super) fn table<'a>(figures: impl Iterator<Item = (&'a String, &'a Value)>) -> String {
    let row = |(name, value): (&String, &Value)| {
        let cells = Figure::from_value(name, value)?.cells().map(|cell| escape(&cell));
        let (name, value) = (escape(name), escape(&value.to_string()));
        Some(format!("<tr data-figure=\"{name}\" data-value=\"{value}\"><td>{}</td></tr>\n", cells.join("</td><td>")))
    };
    let rows: String = figures.filter_map(row).collect();
    if rows.is_empty() {
        rows
    } else {
        format!("<div class=\"scroll\"><table class=\"figures\">\n{rows}</table></div>\n")
    }
}

/// Words and unit in the name of a figure or of a column: `peak_acceleration_m_s2` is a peak acceleration in m/s².
pub(super) fn named(name: &str) -> (String, String) {
    let force = LINE_FORCES.iter().find_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, (*unit).to_owned())));
    let other = || Unit::of_name(name).map(|(stem, unit)| (stem, printed(unit.symbol()).to_owned()));
    match force.or_else(other) {
        _ if name == "penetration" => (name.into(), "of the radius".into()),
        Some((stem, unit)) => (stem.replace('_', " "), unit),
        None => (name.replace('_', " "), String::new()),
    }
}

/// The figures of a summary as a table in Markdown.
pub fn markdown(summary: &Map<String, Value>) -> String {
    let figures = summary.iter().filter_map(|(name, value)| Figure::from_value(name, value));
    let line = |figure: Figure| format!("| {} |\n", figure.cells().map(|cell| escaped(&cell)).join(" | "));
    let lines: String = figures.map(line).collect();
    format!("| figure | value | unit |\n|---|---:|---|\n{lines}")
}

/// `text` with everything that Markdown would read as markup escaped.
pub(super) fn escaped(text: &str) -> String {
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

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    #[test]
    fn names_become_words_and_units() {
        for (name, value, expected) in [
            ("peak_acceleration_m_s2", Value::from(153.04321), "peak acceleration 153.0 m/s² (15.61 g)"),
            ("rupture_time_s", Value::from(0.0312345), "rupture time 0.03123 s"),
            ("ruptured", Value::from(true), "ruptured yes "),
            ("penetration", Value::from(0.01), "penetration 0.01000 of the radius"),
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
            ["failure_mass_kg", "head_km_h", "resultant_N_mm"].map(|name| (names.contains(&name), named(name).1));
        assert_eq!(units, [(true, "kg".into()), (true, "km/h".into()), (true, "N/mm".into())]);
        for name in names {
            let last = name.rsplit('_').next().unwrap_or_default();
            // Smallest, not minutes.
            let is_unit = Unit::parse(last).is_ok() && last != "min" && last.parse::<f64>().is_err();
            assert!(!is_unit || !named(name).1.is_empty(), "{name} has no unit");
        }
    }

    #[test]
    fn texts_mean_themselves_in_markdown() {
        let summary = serde_json::json!({ "note": "![x](https://a.b)\n**b** <img> | &lt;" });
        let expected = "| note | \\!\\[x\\](https://a.b) \\*\\*b\\*\\* \\<img\\> \\| \\&lt; |  |\n";
        assert!(
            markdown(summary.as_object().unwrap()).ends_with(expected),
            "{}",
            markdown(summary.as_object().unwrap())
        );
    }
}
