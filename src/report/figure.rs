//! Figures as people read them: words, a rounded number, a unit.

use serde_json::{Map, Value};

use super::html::escape;

/// Standard gravity, m/s²: decelerations are shown in multiples of it.
pub const G: f64 = 9.806_65;

/// Suffixes of names, longest first, and the units they stand for.
const UNITS: [(&str, &str); 18] = [
    ("_percent", "%"),
    ("_N_mm", "N/mm"),
    ("_N_m", "N/m"),
    ("_1_s", "1/s"),
    ("_m_s2", "m/s²"),
    ("_MPa", "MPa"),
    ("_kPa", "kPa"),
    ("_kN", "kN"),
    ("_mm", "mm"),
    ("_ms", "ms"),
    ("_m_s", "m/s"),
    ("_Pa", "Pa"),
    ("_Hz", "Hz"),
    ("_J", "J"),
    ("_N", "N"),
    ("_g", "g"),
    ("_m", "m"),
    ("_s", "s"),
];

/// One line of a table of figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    pub words: String,
    pub value: String,
    /// Accelerations in multiples of g besides.
    pub unit: String,
}

impl Figure {
    /// The figure `name` of a summary; `None` where there is no value or it is not one number, text or truth.
    pub fn of(name: &str, value: &Value) -> Option<Figure> {
        let (words, unit) = named(name);
        let unit = match (unit, value.as_f64()) {
            ("m/s²", Some(acceleration)) => format!("m/s² ({} g)", rounded(acceleration / G)),
            (unit, _) => unit.into(),
        };
        let value = match value {
            Value::Number(number) if number.is_f64() => rounded(number.as_f64()?),
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

/// Figures as a table of HTML, each row with its name and its value in full.
pub(super) fn table<'a>(figures: impl Iterator<Item = (&'a String, &'a Value)>) -> String {
    let row = |(name, value): (&String, &Value)| {
        let cells = Figure::of(name, value)?.cells().map(|cell| escape(&cell));
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

/// A name as the head of a column: its words, and its unit in parentheses.
pub fn heading(name: &str) -> String {
    let (words, unit) = named(name);
    if unit.is_empty() { words } else { format!("{words} ({unit})") }
}

/// Words and unit in the name of a figure or of a column: `peak_acceleration_m_s2` is a peak acceleration in m/s².
pub fn named(name: &str) -> (String, &'static str) {
    let mut units = UNITS.iter().filter_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, *unit)));
    let (stem, unit) = units.find(|(stem, _)| !stem.is_empty()).unwrap_or((name, ""));
    (stem.replace('_', " "), if name == "penetration" { "of the radius" } else { unit })
}

/// The figures of a summary as a table in Markdown.
pub fn markdown(summary: &Map<String, Value>) -> String {
    let figures = summary.iter().filter_map(|(name, value)| Figure::of(name, value));
    // A bar in a text would end its cell.
    let line = |figure: Figure| format!("| {} |\n", figure.cells().map(|cell| cell.replace('|', "\\|")).join(" | "));
    let lines: String = figures.map(line).collect();
    format!("| figure | value | unit |\n|---|---:|---|\n{lines}")
}

/// The number with four significant digits.
pub fn rounded(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - magnitude).max(0) as usize;
    format!("{value:.decimals$}")
}

/// The number with at most so many significant digits, none of them a zero at the end.
pub fn significant(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    text.parse::<f64>().map_or(text, |rounded| rounded.to_string())
}

/// A time in ms, from 10 s on in s.
pub fn duration(seconds: f64) -> String {
    if seconds < 10.0 { format!("{:.1} ms", seconds * 1e3) } else { format!("{seconds:.1} s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words_and_units() {
        for (name, value, expected) in [
            ("peak_acceleration_m_s2", Value::from(153.04321), "peak acceleration 153.0 m/s² (15.61 g)"),
            ("rupture_time_s", Value::from(0.0312345), "rupture time 0.03123 s"),
            ("ruptured", Value::from(true), "ruptured yes "),
            ("penetration", Value::from(0.01), "penetration 0.01000 of the radius"),
            ("steps", Value::from(11_240), "steps 11240 "),
            ("energy_balance_error", Value::from(4.0e-6), "energy balance error 4.000e-6 "),
        ] {
            assert_eq!(Figure::of(name, &value).unwrap().cells().join(" "), expected);
        }
        assert_eq!(Figure::of("rupture_time_s", &Value::Null), None);
    }

    #[test]
    fn digits_and_times_are_short() {
        for (value, expected) in [(3.598_499_687, "3.6"), (4.16, "4.16"), (0.0002, "0.0002"), (60.0, "60"), (0.0, "0")]
        {
            assert_eq!(significant(value, 3), expected);
        }
        assert_eq!(duration(0.0573), "57.3 ms");
        assert_eq!(duration(2000.04), "2000.0 s");
    }
}
