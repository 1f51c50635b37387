//! Quantities: "12 um" ⇄ 12e-6 m, with the dimension checked.
//!
//! A unit is written as factors with powers, `kg/m3`, `m/s^2`, `N/mm`; each factor is looked up by
//! its symbol or its English name. A bare number is in the SI unit.

mod table;
mod unit;

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use thiserror::Error;

use crate::number;

pub(crate) use table::ladder;
pub use table::{STANDARD_GRAVITY, printed};
pub use unit::{Unit, UnknownUnit};

/// Powers of metre, kilogram, second, radian, kelvin and mole.
type Powers = [i8; 6];

/// 0 °C, K.
const ZERO_CELSIUS: f64 = 273.15;

/// The kind of a quantity: its name, its SI unit and the powers of the base units in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// With its article, as an error names it: "a length".
    pub name: &'static str,
    /// The unit of a bare number.
    pub unit: &'static str,
    /// A quantity as a user would write it.
    pub example: &'static str,
    powers: Powers,
}

/// Why a text is not a quantity of the dimension asked for.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum UnitError {
    /// The unit measures something else.
    #[error("expected {}, found \"{text}\"", dimension.name)]
    WrongDimension {
        /// Dimension that is asked for.
        dimension: Dimension,
        /// The quantity, as it is written.
        text: String,
    },
    /// The number has no unit.
    #[error("expected {} with its unit, found \"{text}\"", dimension.name)]
    NoUnit {
        /// Dimension that is asked for.
        dimension: Dimension,
        /// The quantity, as it is written.
        text: String,
    },
    /// A factor of the unit is not in the table.
    #[error("unknown unit `{unit}` in \"{text}\"")]
    UnknownUnit {
        /// Dimension that is asked for.
        dimension: Dimension,
        /// The factor of the unit that is not known.
        unit: String,
        /// The quantity, as it is written.
        text: String,
    },
    /// The number has a decimal comma.
    #[error("decimal comma in \"{text}\"")]
    DecimalComma {
        /// The quantity, as it is written.
        text: String,
        /// The quantity with a decimal point.
        point: String,
    },
    /// The text does not start with a number.
    #[error("expected {}, found \"{text}\", which does not start with a number", dimension.name)]
    NoNumber {
        /// Dimension that is asked for.
        dimension: Dimension,
        /// The quantity, as it is written.
        text: String,
    },
}

impl UnitError {
    /// The correction to write instead.
    pub fn hint(&self) -> String {
        let (dimension, meant) = match self {
            UnitError::DecimalComma { point, .. } => return format!("write it with a decimal point: \"{point}\""),
            UnitError::UnknownUnit { dimension, text, .. } => (dimension, dimension.meant(text)),
            UnitError::WrongDimension { dimension, .. }
            | UnitError::NoUnit { dimension, .. }
            | UnitError::NoNumber { dimension, .. } => (dimension, None),
        };
        match meant {
            Some(meant) => format!("did you mean \"{meant}\"?"),
            None => {
                format!("write it like \"{}\", or as a bare number in {}", dimension.example, dimension.unit)
            }
        }
    }
}

/// The text with a decimal point in place of the comma in the number that it starts with; none without such a comma.
pub fn with_decimal_point(text: &str) -> Option<String> {
    let (whole, rest) = text.trim().split_once(',')?;
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let fraction = rest.bytes().take_while(u8::is_ascii_digit).count();
    let fits =
        digits(whole.trim_start_matches(['+', '-'])) && fraction > 0 && !rest[fraction..].starts_with([',', '.']);
    fits.then(|| format!("{whole}.{rest}"))
}

/// The fraction that a percentage stands for: 0.1 of "10 %".
pub fn percentage(text: &str) -> Option<f64> {
    let number = text.trim().strip_suffix('%')?.trim_end();
    number.parse::<f64>().ok().filter(|number| number.is_finite()).map(|number| number / 100.0)
}

/// Share of a value below which it differs by the rounding of its unit: "9 um" is not "0.009 mm" to the last bit.
const ROUNDING: f64 = 1e-12;

/// Whether two texts are the same quantity, as "0.66m" and "660 mm" are.
pub fn is_same(one: &str, other: &str) -> bool {
    let quantity = |text: &str| {
        let (number, unit) = split_number(text.trim());
        let (factor, powers) = parse_unit(unit).ok().filter(|_| !unit.is_empty())?;
        Some((scale(number.parse().ok()?, factor), powers))
    };
    one == other
        || quantity(one).zip(quantity(other)).is_some_and(|((a, powers), (b, others))| {
            powers == others && (a - b).abs() <= ROUNDING * a.abs().max(b.abs())
        })
}

impl Dimension {
    /// The dimension with this name ("a length").
    pub fn named(name: &str) -> Option<Dimension> {
        DIMENSIONS.iter().copied().find(|d| d.name == name)
    }

    /// The SI unit as the end of a column's name, `m_s2`; empty of a number without unit.
    pub fn suffix(self) -> String {
        if self.unit == "1" { String::new() } else { self.unit.replace('/', "_").replace([' ', '(', ')'], "") }
    }

    /// The value of `text` in the SI unit.
    pub fn parse(self, text: &str) -> Result<f64, UnitError> {
        if let Some(point) = with_decimal_point(text) {
            return Err(UnitError::DecimalComma { text: text.to_owned(), point });
        }
        let (number, unit) = split_number(text.trim());
        let value: f64 = number.parse().map_err(|_| UnitError::NoNumber { dimension: self, text: text.to_owned() })?;
        if unit.is_empty() {
            return Err(UnitError::NoUnit { dimension: self, text: text.to_owned() });
        }
        if self.name == Temperature::DIMENSION.name && matches!(unit, "degC" | "°C") {
            return Ok(value + ZERO_CELSIUS);
        }
        let (share, unit) = self.with_kelvin(unit);
        let (factor, powers) = parse_unit(&unit).map_err(|UnknownFactor(unit)| UnitError::UnknownUnit {
            dimension: self,
            unit,
            text: text.to_owned(),
        })?;
        if powers != self.powers {
            return Err(UnitError::WrongDimension { dimension: self, text: text.to_owned() });
        }
        Ok(scale(value, share * factor))
    }

    /// The unit as [`parse_unit`] reads it, of a quantity for a temperature difference, which data sheets give in per cent and for
    /// a degree Celsius, and the factor that this leaves.
    fn with_kelvin<'a>(self, unit: &'a str) -> (f64, Cow<'a, str>) {
        let [.., kelvin, _] = self.powers;
        if kelvin >= 0 {
            return (1.0, Cow::Borrowed(unit));
        }
        let plain = unit.replace("degC", "K").replace("°C", "K");
        match plain.strip_prefix("%/") {
            Some(rest) => (0.01, Cow::Owned(format!("1/{rest}"))),
            None => (1.0, Cow::Owned(plain)),
        }
    }

    /// Units that are usual for it, in ascending order.
    fn usual_units(self) -> impl Iterator<Item = &'static str> {
        let is_difference = self.name == TemperatureDifference::DIMENSION.name;
        table::usual(self.unit).filter(move |unit| !(is_difference && *unit == "degC"))
    }

    /// Pattern (ECMA 262) of texts that are quantities of it, for editors: a number and a unit that is not usual for
    /// something else. It accepts more than [`Dimension::parse`], and all that this does.
    pub fn pattern(self) -> String {
        let others = DIMENSIONS.iter().filter(|other| other.powers != self.powers);
        let units: BTreeSet<&str> = others.flat_map(|other| other.usual_units()).collect();
        let units = Vec::from_iter(units).join("|").replace('(', r"\(").replace(')', r"\)");
        format!(r"^\s*[-+]?[0-9.]+(?![0-9.])([eE][-+]?[0-9.]+(?![0-9.]))?\s*(?!({units})\s*$)\S")
    }

    /// A likely meaning of `number` without its unit, of which the value is `value` (SI): the number in the unit
    /// nearest to the written one that makes it one of the `likely` values.
    pub fn likelier(self, number: &str, value: f64, likely: [f64; 2]) -> Option<String> {
        let (number, _) = split_number(number.trim());
        let units = self.usual_units().filter(|unit| !matches!(*unit, "cm" | "km" | "min" | "h" | "mm/min"));
        let quantities = units.map(|unit| format!("{number} {unit}"));
        let found = quantities.filter_map(|text| Some((self.parse(&text).ok()?, text)));
        let fits: Vec<(f64, String)> = found.filter(|(other, _)| (likely[0]..=likely[1]).contains(other)).collect();
        // Laboratories write stresses in N/mm².
        let mega = format!("{number} MPa");
        if fits.iter().any(|(_, text)| *text == mega) {
            return Some(mega);
        }
        let distance = |other: f64| (other / value).abs().ln().abs();
        fits.into_iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0))).map(|(_, text)| text)
    }

    /// The quantity in the usual unit that its unknown one probably stands for: "12 um" of "12 µ", "8 MPa" of "8 mpa".
    pub fn meant(self, text: &str) -> Option<String> {
        let (number, unit) = split_number(text.trim());
        let plain = unit.replace(['µ', 'μ'], "u").to_lowercase();
        let plain = plain.strip_suffix("ec").unwrap_or(&plain);
        let is_meant = |usual: &&str| plain == usual.to_lowercase() || (plain == "u" && usual.starts_with('u'));
        let usual = self.usual_units().find(is_meant)?;
        Some(format!("{number} {usual}"))
    }

    /// `value` (SI) with a prefix that makes the number easy to read, where the unit takes one.
    pub fn show(self, value: f64) -> String {
        let prefixes: &[(f64, &str)] = match self.unit {
            "m" | "s" => &[(1.0, ""), (1e-3, "m"), (1e-6, "u")],
            "Hz" | "Pa" => &[(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, "")],
            _ => &[],
        };
        let (factor, prefix) = prefixes.iter().copied().find(|(factor, _)| value.abs() >= *factor).unwrap_or((1.0, ""));
        let shown = if factor < 1.0 { value * (1.0 / factor).round() } else { value / factor };
        format!("{} {prefix}{}", number::plain(shown), self.unit)
    }
}

/// The leading number of `text` and what follows it. An `e` belongs to the number only if digits follow.
fn split_number(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count();
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut end = sign(0);
    end += digits(end);
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let exponent = end + 1 + sign(end + 1);
        let length = digits(exponent.min(bytes.len()));
        if length > 0 {
            end = exponent + length;
        }
    }
    (&text[..end], text[end..].trim_start())
}

/// Dividing by the whole reciprocal keeps "12 um" the same number as the literal 12e-6.
fn scale(value: f64, factor: f64) -> f64 {
    let reciprocal = (1.0 / factor).round();
    if factor < 1.0 && (reciprocal * factor - 1.0).abs() < 1e-15 { value / reciprocal } else { value * factor }
}

struct UnknownFactor(String);

/// Factor to SI and powers of a unit such as `kg/m3`: every factor after a `/` divides.
fn parse_unit(unit: &str) -> Result<(f64, Powers), UnknownFactor> {
    let mut total = (1.0, [0; 6]);
    for (place, group) in unit.split('/').enumerate() {
        let sign: i8 = if place == 0 { 1 } else { -1 };
        // J/(kg K): all factors behind a `/` divide, with brackets and without.
        let bracketed = group.strip_prefix('(').and_then(|inner| inner.strip_suffix(')'));
        let group = bracketed.filter(|inner| place > 0 && !inner.trim().is_empty()).unwrap_or(group);
        for factor in group.split(['*', '·', ' ']).filter(|f| !f.is_empty()) {
            let (symbol, power) = split_power(factor);
            let (size, powers) = table::find(symbol).ok_or_else(|| UnknownFactor(symbol.to_owned()))?;
            let power = power * sign;
            total.0 *= size.powi(i32::from(power));
            let own = powers.map(|own| own * power);
            total.1 = sum(total.1, own).ok_or_else(|| UnknownFactor(unit.to_owned()))?;
        }
    }
    Ok(total)
}

/// Powers of a product; none where no unit has as many.
fn sum(mut powers: Powers, others: Powers) -> Option<Powers> {
    for (power, other) in powers.iter_mut().zip(others) {
        *power = power.checked_add(other)?;
    }
    Some(powers)
}

/// `s2`, `s^2`, `s²`, `s^-1` → symbol and power.
fn split_power(factor: &str) -> (&str, i8) {
    if let Some(symbol) = factor.strip_suffix('²') {
        return (symbol, 2);
    }
    if let Some(symbol) = factor.strip_suffix('³') {
        return (symbol, 3);
    }
    let symbol = factor.trim_end_matches(|c: char| c.is_ascii_digit() || c == '-');
    match factor[symbol.len()..].parse() {
        Ok(power) if !symbol.is_empty() && (-4..=4).contains(&power) => (symbol.trim_end_matches('^'), power),
        _ => (factor, 1),
    }
}

macro_rules! quantities {
    ($($(#[$doc:meta])* $type:ident: $name:literal, $unit:literal, $example:literal, $powers:expr;)*) => {
        /// Every dimension of the scenario language and of recordings.
        pub const DIMENSIONS: &[Dimension] = &[$($type::DIMENSION),*];
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
            pub struct $type(pub f64);

            impl $type {
                /// Name, SI unit, example and powers of the base units.
                pub const DIMENSION: Dimension = Dimension {
                    name: $name,
                    unit: $unit,
                    example: $example,
                    powers: $powers,
                };
            }

            impl fmt::Display for $type {
                fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                    f.write_str(&Self::DIMENSION.show(self.0))
                }
            }

            impl Serialize for $type {
                fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                    // Text is for people; other forms keep every bit.
                    if serializer.is_human_readable() { serializer.collect_str(self) } else { self.0.serialize(serializer) }
                }
            }

            impl<'de> Deserialize<'de> for $type {
                fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                    if !deserializer.is_human_readable() {
                        return f64::deserialize(deserializer).map($type);
                    }
                    deserializer.deserialize_any(Written(Self::DIMENSION)).map($type)
                }
            }

            impl JsonSchema for $type {
                fn schema_name() -> Cow<'static, str> {
                    stringify!($type).into()
                }
                fn inline_schema() -> bool {
                    true
                }
                fn json_schema(_: &mut SchemaGenerator) -> Schema {
                    json_schema!({
                        "type": ["number", "string"],
                        "x-quantity": $name,
                        "x-unit": $unit,
                        "pattern": Self::DIMENSION.pattern(),
                        "examples": [$example],
                    })
                }
            }
        )*
    };
}

quantities! {
    /// m.
    Length: "a length", "m", "12 mm", [1, 0, 0, 0, 0, 0];
    /// kg.
    Mass: "a mass", "kg", "10.72 kg", [0, 1, 0, 0, 0, 0];
    /// s.
    Time: "a time", "s", "120 ms", [0, 0, 1, 0, 0, 0];
    /// m/s.
    Velocity: "a velocity", "m/s", "4.16 m/s", [1, 0, -1, 0, 0, 0];
    /// m/s².
    Acceleration: "an acceleration", "m/s2", "9.81 m/s2", [1, 0, -2, 0, 0, 0];
    /// Pa.
    Pressure: "a pressure", "Pa", "8.4 MPa", [-1, 1, -2, 0, 0, 0];
    /// kg/m³.
    Density: "a density", "kg/m3", "915 kg/m3", [-3, 1, 0, 0, 0, 0];
    /// kg/m².
    AreaDensity: "a mass per area", "kg/m2", "0.1 kg/m2", [-2, 1, 0, 0, 0, 0];
    /// m².
    Area: "an area", "m2", "20 cm2", [2, 0, 0, 0, 0, 0];
    /// m³.
    Volume: "a volume", "m3", "2 l", [3, 0, 0, 0, 0, 0];
    /// rad.
    Angle: "an angle", "rad", "45 deg", [0, 0, 0, 1, 0, 0];
    /// Hz.
    Frequency: "a frequency", "Hz", "10 kHz", [0, 0, -1, 0, 0, 0];
    /// Strain per second.
    Rate: "a rate", "1/s", "0.04 1/s", [0, 0, -1, 0, 0, 0];
    /// N.
    Force: "a force", "N", "1.2 kN", [1, 1, -2, 0, 0, 0];
    /// J.
    Energy: "an energy", "J", "9.3 J", [2, 1, -2, 0, 0, 0];
    /// J/m².
    EnergyPerArea: "an energy per area", "J/m2", "8 kJ/m2", [0, 1, -2, 0, 0, 0];
    /// rad/s.
    AngularVelocity: "an angular velocity", "rad/s", "90 deg/s", [0, 0, -1, 1, 0, 0];
    /// kg m².
    Inertia: "a moment of inertia", "kg m2", "0.02 kg m2", [2, 1, 0, 0, 0, 0];
    /// N s/m.
    ForcePerSpeed: "a force per velocity", "N s/m", "1.5 N s/m", [0, 1, -1, 0, 0, 0];
    /// N/m.
    Stiffness: "a stiffness", "N/m", "3 kN/m", [0, 1, -2, 0, 0, 0];
    /// Nm.
    Moment: "a moment", "Nm", "2.2 Nm", [2, 1, -2, -1, 0, 0];
    /// K.
    Temperature: "a temperature", "K", "23 degC", [0, 0, 0, 0, 1, 0];
    /// K.
    TemperatureDifference: "a temperature difference", "K", "50 K", [0, 0, 0, 0, 1, 0];
    /// J/mol.
    MolarEnergy: "an energy per mole", "J/mol", "100 kJ/mol", [2, 1, -2, 0, 0, -1];
    /// J/(kg K).
    HeatCapacity: "a heat capacity", "J/(kg K)", "2.3 kJ/(kg K)", [2, 0, -2, 0, -1, 0];
    /// 1/K.
    SharePerTemperature: "a share per temperature difference", "1/K", "0.8 %/K", [0, 0, 0, 0, -1, 0];
    /// A number without unit.
    Strain: "a strain", "1", "0.02 1", [0, 0, 0, 0, 0, 0];
}

/// Reads a number as SI and a string with its unit.
struct Written(Dimension);

impl de::Visitor<'_> for Written {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
    fn visit_f64<E: de::Error>(self, value: f64) -> Result<f64, E> {
        Ok(value)
    }
    fn visit_i64<E: de::Error>(self, value: i64) -> Result<f64, E> {
        Ok(value as f64)
    }
    fn visit_u64<E: de::Error>(self, value: u64) -> Result<f64, E> {
        Ok(value as f64)
    }
    fn visit_str<E: de::Error>(self, text: &str) -> Result<f64, E> {
        self.0.parse(text).map_err(E::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    /// Any text of up to 24 characters.
    pub(super) fn short_text() -> impl Strategy<Value = String> {
        vec(any::<char>(), 0..=24).prop_map(String::from_iter)
    }

    #[test]
    fn units_of_the_tour() {
        for (dimension, text, si) in [
            (Length::DIMENSION, "12 um", 12e-6),
            (Length::DIMENSION, "10 dm", 1.0),
            (Length::DIMENSION, "20mm", 0.02),
            (Length::DIMENSION, "-30 mm", -0.03),
            (Velocity::DIMENSION, "0.2 m/s", 0.2),
            (Acceleration::DIMENSION, "9.81 m/s2", 9.81),
            (Acceleration::DIMENSION, "9.81 m/s^2", 9.81),
            (Acceleration::DIMENSION, "9.81 m/s²", 9.81),
            (Density::DIMENSION, "915 kg/m3", 915.0),
            (Density::DIMENSION, "0.915 g/cm3", 915.0),
            (Pressure::DIMENSION, "29.3 MPa", 29.3e6),
            (Pressure::DIMENSION, "10 N/mm2", 10e6),
            (Rate::DIMENSION, "0.04 1/s", 0.04),
            (Rate::DIMENSION, "40 s^-1", 40.0),
            (Frequency::DIMENSION, "10 kHz", 10e3),
            (Angle::DIMENSION, "180 deg", std::f64::consts::PI),
            (Time::DIMENSION, "120 ms", 0.12),
            (Temperature::DIMENSION, "20 degC", 293.15),
            (Temperature::DIMENSION, "-40 °C", 233.15),
            (Temperature::DIMENSION, "300 K", 300.0),
            (TemperatureDifference::DIMENSION, "50 K", 50.0),
            (HeatCapacity::DIMENSION, "2.3 kJ/(kg K)", 2300.0),
            (HeatCapacity::DIMENSION, "2300 J/kg/K", 2300.0),
            (HeatCapacity::DIMENSION, "2.3 J/g K", 2300.0),
            (SharePerTemperature::DIMENSION, "0.8 %/K", 0.008),
            (SharePerTemperature::DIMENSION, "0.008 1/K", 0.008),
            (SharePerTemperature::DIMENSION, "0.8 %/°C", 0.008),
            (HeatCapacity::DIMENSION, "2.3 kJ/(kg degC)", 2300.0),
            (MolarEnergy::DIMENSION, "100 kJ/mol", 1e5),
            (Length::DIMENSION, "1e-3 m", 1e-3),
            (Mass::DIMENSION, "1.5e1 g", 0.015),
        ] {
            let found = dimension.parse(text);
            let close = matches!(found, Ok(value) if (value - si).abs() <= 1e-15 * si.abs());
            assert!(close, "{text}: {found:?} instead of {si}");
        }
    }

    #[test]
    fn micrometres_are_the_literal() {
        assert_eq!(Length::DIMENSION.parse("12 um"), Ok(12e-6));
    }

    #[test]
    fn mistakes_are_named() {
        for (dimension, text, message) in [
            (Length::DIMENSION, "12 kg", "expected a length, found \"12 kg\""),
            (Length::DIMENSION, "12", "expected a length with its unit, found \"12\""),
            (Velocity::DIMENSION, "4,16 m/s", "decimal comma in \"4,16 m/s\""),
            (Mass::DIMENSION, "3 foo", "unknown unit `foo` in \"3 foo\""),
            (Mass::DIMENSION, "10 % kg", "unknown unit `%` in \"10 % kg\""),
            (Mass::DIMENSION, "10 kg/()", "unknown unit `()` in \"10 kg/()\""),
            (Mass::DIMENSION, "10 (kg)", "unknown unit `(kg)` in \"10 (kg)\""),
            (SharePerTemperature::DIMENSION, "1 %/%/K", "unknown unit `%` in \"1 %/%/K\""),
            (SharePerTemperature::DIMENSION, "1 %/s", "expected a share per temperature difference, found \"1 %/s\""),
            (TemperatureDifference::DIMENSION, "50 degC", "unknown unit `degC` in \"50 degC\""),
            (Angle::DIMENSION, "left", "expected an angle, found \"left\", which does not start with a number"),
        ] {
            let error = dimension.parse(text).expect_err("not a quantity");
            assert_eq!(error.to_string(), message);
        }
    }

    #[test]
    fn hints_name_the_unit_that_is_meant() {
        for (dimension, text, hint) in [
            (Length::DIMENSION, "12 µ", "did you mean \"12 um\"?"),
            (Length::DIMENSION, "12 MM", "did you mean \"12 mm\"?"),
            (Time::DIMENSION, "12\u{b5}", "did you mean \"12 us\"?"),
            (Time::DIMENSION, "1.5 sec", "did you mean \"1.5 s\"?"),
            (Velocity::DIMENSION, "4 m/sec", "did you mean \"4 m/s\"?"),
            (Pressure::DIMENSION, "8.4 mpa", "did you mean \"8.4 MPa\"?"),
            (Velocity::DIMENSION, "-4,16 m/s", "write it with a decimal point: \"-4.16 m/s\""),
            (Temperature::DIMENSION, "23 degc", "did you mean \"23 degC\"?"),
            (Mass::DIMENSION, "3 foo", "write it like \"10.72 kg\", or as a bare number in kg"),
        ] {
            assert_eq!(dimension.parse(text).expect_err("not a quantity").hint(), hint);
        }
    }

    #[test]
    fn decimal_commas_and_percentages() {
        for (text, point) in [("0,5", Some("0.5")), ("1,2,3", None), ("8, 9", None), ("1,5.2", None), (",5", None)] {
            assert_eq!(with_decimal_point(text).as_deref(), point, "{text}");
        }
        for (text, share) in [("10 %", Some(0.1)), ("-2.5%", Some(-0.025)), ("%", None), ("10", None)] {
            assert_eq!(percentage(text), share, "{text}");
        }
    }

    #[test]
    fn absurd_powers_are_no_unit() {
        for (factors, sign) in [(31, "m4"), (32, "m4"), (33, "m4"), (33, "m-4"), (17, "J4")] {
            let unit = vec![sign; factors].join("*");
            assert!(Length::DIMENSION.parse(&format!("1 {unit}")).is_err(), "{factors} of {sign}");
        }
        let unit = ["m4"; 33].join("*");
        let error = Length::DIMENSION.parse(&format!("1 {unit}")).expect_err("not a length");
        assert!(matches!(error, UnitError::UnknownUnit { unit: found, .. } if found == unit));
    }

    proptest! {
        #[test]
        fn shown_quantities_read_back(value in -1e9..1e9f64, which in 0..DIMENSIONS.len()) {
            let dimension = DIMENSIONS[which];
            let back = dimension.parse(&dimension.show(value));
            let close = matches!(back, Ok(v) if (v - value).abs() <= 4e-16 * value.abs());
            prop_assert!(close, "{value} became {back:?}");
        }

        #[test]
        fn no_text_panics(text in short_text(), which in 0..DIMENSIONS.len()) {
            let _ = DIMENSIONS[which].parse(&text);
        }
    }
}
