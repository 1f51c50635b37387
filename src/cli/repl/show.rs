//! Values as text: figures with units, tables, pictures of curves.

use rhai::{Array, Dynamic, Engine, FnPtr, Map};
use serde_json::Value;

use super::super::table;
use lab::experiment::coupon::Curve;
use lab::signal::Series;
use plot::{self, Plot, braille};
use report::{Figure, cell};
use study::post::Run;
use study::scenario_functions::Study;
use study::script::{Row, to_json};

/// Characters of a picture across and down.
const PICTURE: [usize; 2] = [64, 12];

/// Most items of a list, and most characters of a text, that are shown.
const MOST_ITEMS: usize = 12;
const MOST_LETTERS: usize = 2000;

/// The value of an input; where that is the name of a number alone, as in `run.summary.peak_force_N`, with its unit. None
/// where there is none.
pub(super) fn value(engine: &Engine, value: &Dynamic, input: &str) -> Option<String> {
    if value.is_unit() {
        return None;
    }
    Some(text(engine, value, input).trim_end().to_owned())
}

fn text(engine: &Engine, value: &Dynamic, input: &str) -> String {
    if let Some(series) = value.read_lock::<Series>() {
        return signal(&series, input);
    }
    if let Some(curve) = value.read_lock::<Curve>() {
        let points = curve.samples().map(|[strain, stress]| [strain, stress / 1e6]);
        return picture(&Plot::new("", ["strain", "stress (MPa)"], vec![plot::Curve::line("", points)]));
    }
    if let Some(run) = value.read_lock::<Run>() {
        return figures(run.summary().iter());
    }
    if let Some(scenario) = value.read_lock::<Study>() {
        return format!("scenario {}", scenario.name());
    }
    if let Some(map) = value.read_lock::<Map>() {
        let pairs: Vec<(String, Value)> =
            map.iter().map(|(name, item)| (name.to_string(), plain(engine, item))).collect();
        return figures(pairs.iter().map(|(name, item)| (name, item)));
    }
    if let Some(list) = value.read_lock::<Array>() {
        return rows(engine, &list).unwrap_or_else(|| items(engine, &list));
    }
    match to_json(value) {
        Ok(json) => number(&json, last_name(input)),
        Err(_) => brief(engine, value),
    }
}

/// A number with the unit of its name.
fn number(json: &Value, name: &str) -> String {
    match Figure::from_value(name, json) {
        Some(figure) => format!("{} {}", figure.value, figure.unit),
        None => cell(json),
    }
    .chars()
    .take(MOST_LETTERS)
    .collect()
}

/// The property or variable that the last statement of an input is; empty where it is anything else.
fn last_name(input: &str) -> &str {
    let last = input.trim().trim_end_matches(';').rsplit(';').next().unwrap_or_default().trim();
    let is_path = last.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '.');
    // A semicolon may stand in a comment.
    let has_comment = input.contains("//") || input.contains("/*");
    if is_path && !has_comment { last.rsplit('.').next().unwrap_or_default() } else { "" }
}

fn signal(series: &Series, input: &str) -> String {
    let picture =
        picture(&Plot::new("", ["time (s)", last_name(input)], vec![plot::Curve::line("", series.samples())]));
    if picture.is_empty() { format!("signal of {} samples", series.len()) } else { picture }
}

/// A plot and the names of its curves.
pub(super) fn plot(plot: &Plot) -> String {
    let names: Vec<&str> = plot.curves.iter().map(|curve| curve.name.as_str()).collect();
    format!("{}: {}\n{}", plot.title, names.join(", "), picture(plot))
}

fn picture(plot: &Plot) -> String {
    braille(plot, PICTURE)
}

/// Names, values and units below each other.
fn figures<'v>(pairs: impl Iterator<Item = (&'v String, &'v Value)>) -> String {
    let line = |(name, value): (&String, &Value)| {
        let unit = Figure::from_value(name, value);
        let [value, unit] = unit.map_or_else(|| [nested(value), String::new()], |figure| [figure.value, figure.unit]);
        vec![name.clone(), value, unit]
    };
    let lines: Vec<Vec<String>> = pairs.map(line).collect();
    if lines.is_empty() { "#{}".into() } else { table::aligned(&lines, 3) }
}

fn nested(value: &Value) -> String {
    match value {
        Value::Null => "()".into(),
        Value::Array(items) if items.len() > MOST_ITEMS => format!("list of {}", items.len()),
        Value::Object(pairs) => format!("map of {}", pairs.len()),
        other => cell(other),
    }
}

/// A list of maps as a table; nothing where it is none.
fn rows(engine: &Engine, list: &Array) -> Option<String> {
    let row = |item: &Dynamic| -> Option<Row> {
        let map = item.read_lock::<Map>()?;
        Some(map.iter().map(|(name, item)| (name.to_string(), plain(engine, item))).collect())
    };
    let rows: Vec<Row> = list.iter().map(row).collect::<Option<_>>()?;
    (!rows.is_empty()).then(|| table::rows(&rows))
}

fn items(engine: &Engine, list: &Array) -> String {
    let mut shown: Vec<String> = list.iter().take(MOST_ITEMS).map(|item| nested(&plain(engine, item))).collect();
    let more = list.len().saturating_sub(MOST_ITEMS);
    shown.extend((more > 0).then(|| format!("… {more} more")));
    format!("[{}]", shown.join(", "))
}

/// A value within another one.
fn plain(engine: &Engine, value: &Dynamic) -> Value {
    to_json(value).unwrap_or_else(|_| Value::String(brief(engine, value)))
}

/// A value in a word or two.
pub(super) fn brief(engine: &Engine, value: &Dynamic) -> String {
    if let Some(series) = value.read_lock::<Series>() {
        return format!("signal of {} samples", series.len());
    }
    if let Some(list) = value.read_lock::<Array>() {
        return format!("list of {}", list.len());
    }
    if let Some(map) = value.read_lock::<Map>() {
        return format!("map of {}", map.len());
    }
    if value.is::<FnPtr>() {
        return "function".into();
    }
    match to_json(value) {
        Ok(json) => cell(&json).chars().take(MOST_LETTERS).collect(),
        Err(_) => engine.map_type_name(value.type_name()).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use study::functions;
    use study::script::Limits;

    #[test]
    fn values_are_shown_as_what_they_are() {
        let engine = functions::engine(Limits::STUDY);
        for (input, expected) in [
            ("()", None),
            ("1 + 1", Some("2")),
            ("2.0 / 3.0", Some("0.6667")),
            ("let peak_force_N = 1234.567; peak_force_N", Some("1235 N")),
            ("let m = #{ a: #{ peak_force_N: 1234.567 } }; m.a.peak_force_N;", Some("1235 N")),
            ("let a_N = 10; let m_kg = 2; a_N / m_kg", Some("5")),
            ("let a_N = 10; let m_kg = 2.0; a_N *\n m_kg", Some("20.00")),
            ("let m_kg = 2; 1000 * m_kg // a; m_kg", Some("2000")),
            ("1 + 1 // 20 °C", Some("2")),
            ("1 + 1 // 20 °", Some("2")),
            ("\"text\"", Some("text")),
            ("[1, 2.5, \"a\"]", Some("[1, 2.500, a]")),
            ("|x| x", Some("function")),
            ("#{}", Some("#{}")),
        ] {
            let found = engine.eval::<Dynamic>(input).unwrap();
            assert_eq!(value(&engine, &found, input).as_deref(), expected, "{input}");
        }
        for (input, parts) in [
            ("#{ mass_kg: 10.72, broke: true }", ["mass_kg", "10.72", "kg"]),
            ("[#{ test: 1008, k1: 2.75 }, #{ test: 1009, k1: 2.8 }]", ["k1", "1008", "2.800"]),
            ("signal([0, 1, 2], [0, 4.5, 1])", ["time (s)", "4.500", "⠑"]),
            ("let force_N = signal([0, 1, 2], [0, 4.5, 1]); force_N", ["time (s)", " force_N\n", "⠑"]),
            ("curve([0, 1], [0, 3e6])", ["strain", "stress (MPa)", "3.000"]),
        ] {
            let found = engine.eval::<Dynamic>(input).unwrap();
            let shown = value(&engine, &found, input).unwrap();
            assert!(parts.iter().all(|part| shown.contains(part)), "{input}\n{shown}");
        }
        let scaled = "let a_N = signal([0, 1], [0, 4]); let m_kg = signal([0, 1], [1, 2]); a_N * m_kg";
        let found = engine.eval::<Dynamic>(scaled).unwrap();
        assert!(!value(&engine, &found, scaled).unwrap().contains("kg"));
    }
}
