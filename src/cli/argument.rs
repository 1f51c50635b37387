//! Numbers and quantities on the command line.

use base::units::{Dimension, Time, UnitError, with_decimal_point};

/// The number in SI of a quantity with its unit, for clap.
pub(super) fn quantity(dimension: Dimension, text: &str) -> Result<f64, String> {
    let expected = || format!("expected {} with its unit, such as \"{}\"", dimension.name, dimension.example);
    dimension.parse(text).map_err(|error| match error {
        UnitError::DecimalComma { .. } => format!("{error}; {}", error.hint()),
        UnitError::UnknownUnit { .. } => match dimension.meant(text) {
            Some(meant) => format!("{error}; did you mean \"{meant}\"?"),
            None => format!("{error}; {}", expected()),
        },
        _ => format!("{}, found \"{text}\"", expected()),
    })
}

/// The number in SI of a quantity and of its standard deviation, `1 m +- 2 mm`, for clap.
pub(super) fn quantity_with_error(dimension: Dimension, text: &str) -> Result<(f64, Option<f64>), String> {
    match text.split_once("+-").or_else(|| text.split_once('±')) {
        Some((value, error)) => Ok((quantity(dimension, value.trim())?, Some(quantity(dimension, error.trim())?))),
        None => Ok((quantity(dimension, text)?, None)),
    }
}

/// A number without unit.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let found = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    found.ok_or_else(|| {
        decimal_comma(text).unwrap_or_else(|| format!("expected a number without unit, found \"{text}\""))
    })
}

/// A time in ms, as a number or with its unit: `15`, `15 ms`, `0.015 s`.
pub(super) fn milliseconds(text: &str) -> Result<f64, String> {
    let with_unit = || Time::DIMENSION.parse(text).map(|seconds| 1e3 * seconds);
    let expected = || format!("expected a time in ms, such as 15 or \"15 ms\", found \"{text}\"");
    number(text).or_else(|_| with_unit()).map_err(|_| decimal_comma(text).unwrap_or_else(expected))
}

fn decimal_comma(text: &str) -> Option<String> {
    let point = with_decimal_point(text)?;
    Some(format!("decimal comma in \"{text}\"; write it with a decimal point: \"{point}\""))
}
