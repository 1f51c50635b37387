//! Numbers and quantities on the command line.

use crate::units::{Dimension, Time, UnitError};

/// The number in SI of a quantity with its unit, for clap.
pub(super) fn quantity(dimension: Dimension, text: &str) -> Result<f64, String> {
    let such_as = || format!("such as \"{}\"", dimension.example);
    dimension.parse(text).map_err(|error| match error {
        _ if is_quantity_with_comma(dimension, text) => decimal_comma(text),
        UnitError::UnknownUnit { .. } => format!("{error}; expected {} with its unit, {}", dimension.name, such_as()),
        _ => format!("expected {} with its unit, {}, found \"{text}\"", dimension.name, such_as()),
    })
}

/// A number without unit.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let found = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    found.ok_or_else(|| match point(text).parse::<f64>() {
        Ok(_) if text.contains(',') => decimal_comma(text),
        _ => format!("expected a number without unit, found \"{text}\""),
    })
}

/// A time in ms, as a number or with its unit: `15`, `15 ms`, `0.015 s`.
pub(super) fn milliseconds(text: &str) -> Result<f64, String> {
    if let Ok(number) = number(text) {
        return Ok(number);
    }
    Time::DIMENSION.parse(text).map(|seconds| 1e3 * seconds).map_err(|_| match point(text).parse::<f64>() {
        Ok(_) => decimal_comma(text),
        _ if is_quantity_with_comma(Time::DIMENSION, text) => decimal_comma(text),
        _ => format!("expected a time in ms, such as 15 or \"15 ms\", found \"{text}\""),
    })
}

fn is_quantity_with_comma(dimension: Dimension, text: &str) -> bool {
    text.contains(',') && dimension.parse(&point(text)).is_ok()
}

/// The text with its first comma as a decimal point.
fn point(text: &str) -> String {
    text.trim().replacen(',', ".", 1)
}

fn decimal_comma(text: &str) -> String {
    format!("\"{text}\" has a decimal comma; write a decimal point: \"{}\"", point(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mass;

    #[test]
    fn mistakes_state_the_form_that_is_expected() {
        for (text, expected) in [
            ("10.72", "expected a mass with its unit, such as \"10.72 kg\", found \"10.72\""),
            ("10,72 kg", "\"10,72 kg\" has a decimal comma; write a decimal point: \"10.72 kg\""),
            ("10 mm", "expected a mass with its unit, such as \"10.72 kg\", found \"10 mm\""),
            ("10 kgg", "unknown unit `kgg` in \"10 kgg\"; expected a mass with its unit, such as \"10.72 kg\""),
        ] {
            assert_eq!(quantity(Mass::DIMENSION, text).unwrap_err(), expected);
        }
        for text in ["15", "15 ms", "0.015 s"] {
            assert!((milliseconds(text).unwrap() - 15.0).abs() < 1e-12);
        }
        for (text, expected) in [
            ("15,5", "\"15,5\" has a decimal comma; write a decimal point: \"15.5\""),
            ("15,5 ms", "\"15,5 ms\" has a decimal comma; write a decimal point: \"15.5 ms\""),
            ("15 mm", "expected a time in ms, such as 15 or \"15 ms\", found \"15 mm\""),
        ] {
            assert_eq!(milliseconds(text).unwrap_err(), expected);
        }
        assert_eq!(number("0,5").unwrap_err(), "\"0,5\" has a decimal comma; write a decimal point: \"0.5\"");
        assert_eq!(number("5 %").unwrap_err(), "expected a number without unit, found \"5 %\"");
    }
}
