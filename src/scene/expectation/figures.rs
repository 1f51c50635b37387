//! Figures against what they must be.

use serde_json::{Map, Value};

use super::{Difference, Expectations, FigureBounds};
use base::diagnostic::closest;
use base::number::significant;

/// Significant digits of bounds in messages.
const DIGITS: usize = 6;

/// The figures that are not what is expected.
pub(super) fn differences(
    expectations: &Expectations,
    recorded: &Map<String, Value>,
    given: &Map<String, Value>,
) -> Vec<Difference> {
    let figures = expectations.figures.iter();
    let differences = figures.filter_map(|(name, bounds)| match given.get(name) {
        Some(found) => difference(name, bounds, recorded.get(name), found),
        None => {
            let like = closest(name, given.keys().map(String::as_str)).map(String::from);
            Some(Difference::NoFigure { figure: name.clone(), like })
        }
    });
    differences.collect()
}

fn difference(name: &str, bounds: &FigureBounds, recorded: Option<&Value>, found: &Value) -> Option<Difference> {
    let figure = name.to_owned();
    if bounds.needs_recording() && recorded.is_none() {
        return Some(Difference::FigureNotRecorded { figure });
    }
    let expected = unmet(bounds, recorded, found)?;
    Some(Difference::FigureDiffers { figure, found: found.clone(), expected })
}

/// The expectation in words where it is not met.
fn unmet(bounds: &FigureBounds, recorded: Option<&Value>, found: &Value) -> Option<String> {
    let exactly = |is_met: bool, words: String| (!is_met).then_some(words);
    match bounds {
        FigureBounds::Flag(flag) => exactly(found.as_bool() == Some(*flag), flag.to_string()),
        FigureBounds::Number(number) => exactly(found.as_f64() == Some(*number), significant(*number, DIGITS)),
        FigureBounds::Text(text) => exactly(found.as_str() == Some(text), format!("\"{text}\"")),
        FigureBounds::Bounds { between, absolute, relative } => {
            let number = found.as_f64();
            let is_within = |[low, high]: [f64; 2]| number.is_some_and(|number| (low..=high).contains(&number));
            let words = |[low, high]: [f64; 2]| {
                let [low, high] = [low, high].map(|bound| significant(bound, DIGITS));
                format!("{low} to {high}")
            };
            let around = || {
                let recorded = recorded?.as_f64()?;
                let distance = allowed(*absolute, *relative, recorded.abs());
                Some([recorded - distance, recorded + distance])
            };
            let is_recorded = absolute.is_some() || relative.is_some();
            let unmet = between.filter(|range| !is_within(*range)).map(words);
            let Some(range) = around().filter(|_| is_recorded) else {
                // A recorded value that is no number must come again.
                let again = recorded.filter(|recorded| is_recorded && *recorded != found).map(ToString::to_string);
                return unmet.or(again);
            };
            unmet.or_else(|| (!is_within(range)).then(|| words(range)))
        }
    }
}

/// The larger of both distances.
pub(super) fn allowed(absolute: Option<f64>, relative: Option<f64>, magnitude: f64) -> f64 {
    absolute.unwrap_or(0.0).max(relative.unwrap_or(0.0) * magnitude)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn figures_are_held_against_bounds_and_records() {
        let bounds = |between: Option<[f64; 2]>, absolute: Option<f64>, relative: Option<f64>| FigureBounds::Bounds {
            between,
            absolute,
            relative,
        };
        for (bounds, recorded, found, unmet_as) in [
            (FigureBounds::Flag(false), json!(null), json!(false), None),
            (FigureBounds::Flag(false), json!(null), json!(true), Some("false")),
            (FigureBounds::Number(8.0), json!(null), json!(8), None),
            (FigureBounds::Number(8.0), json!(null), json!(9), Some("8")),
            (FigureBounds::Text("a".into()), json!(null), json!("b"), Some("\"a\"")),
            (bounds(Some([1.0, 2.0]), None, None), json!(null), json!(2.0), None),
            (bounds(Some([1.0, 2.0]), None, None), json!(null), json!(2.1), Some("1 to 2")),
            (bounds(Some([1.0, 2.0]), None, None), json!(null), json!(null), Some("1 to 2")),
            (bounds(None, Some(0.1), Some(0.01)), json!(-50.0), json!(-50.5), None),
            (bounds(None, Some(0.1), Some(0.01)), json!(-50.0), json!(-50.6), Some("-50.5 to -49.5")),
            (bounds(None, None, Some(0.01)), json!(null), json!(1.0), Some("null")),
            (bounds(None, None, Some(0.01)), json!(null), json!(null), None),
        ] {
            assert_eq!(unmet(&bounds, Some(&recorded), &found).as_deref(), unmet_as, "{bounds:?} {found}");
        }
        let missing = difference("a", &bounds(None, None, Some(0.1)), None, &json!(1.0));
        assert_eq!(missing, Some(Difference::FigureNotRecorded { figure: "a".into() }));
        let figures = vec![("peak_forse_N".to_owned(), FigureBounds::Flag(true))];
        let Value::Object(given) = json!({ "peak_force_N": 1.0, "ruptured": true }) else { panic!("an object") };
        let found = differences(&Expectations { figures, ..Expectations::default() }, &Map::new(), &given);
        let like = Some("peak_force_N".into());
        assert_eq!(found, [Difference::NoFigure { figure: "peak_forse_N".into(), like }]);
    }
}
