//! Units as recordings write them: `g`, `kN`, `m/s^2`, `MPa`, `%`.

use thiserror::Error;

use super::table::{ENDS, STANDARD_GRAVITY};
use super::{DIMENSIONS, Dimension, Powers, parse_unit, scale};

const ACCELERATION: Powers = [1, 0, -2, 0, 0, 0];

/// The unit of a recorded quantity.
#[derive(Clone, Debug)]
pub struct Unit {
    symbol: String,
    factor: f64,
    powers: Powers,
}

/// A text that is no unit of a recording.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown unit `{0}`")]
pub struct UnknownUnit(pub String);

impl Unit {
    /// The unit that a recording means by `symbol`.
    ///
    /// Recordings differ from scenarios in one word: `g` (also `gn`, `g_n`, `kg_n`, …) is standard gravity, since
    /// no instrument records grams against time. `-` is a number without unit, `%` a hundredth.
    pub fn parse(symbol: &str) -> Result<Unit, UnknownUnit> {
        let symbol = symbol.trim();
        let unknown = || UnknownUnit(symbol.to_owned());
        let found = special(symbol).or_else(|| parse_unit(symbol).ok());
        let (factor, powers) = found.filter(|_| !symbol.is_empty()).ok_or_else(unknown)?;
        let usable = factor.is_normal() && factor > 0.0;
        if usable { Ok(Unit { symbol: symbol.to_owned(), factor, powers }) } else { Err(unknown()) }
    }

    /// The unit that the last parts of a name stand for, and the name before them: `acceleration_m_s2`, `force_kN`,
    /// `time_ms`. Only units that names end with in practice are looked for, since `_1`, `_a` or `_md` number and
    /// describe.
    pub fn of_name(name: &str) -> Option<(&str, Unit)> {
        let stem = |end: &str| name.strip_suffix(end)?.strip_suffix('_').filter(|stem| !stem.is_empty());
        let found = ENDS.iter().filter_map(|(end, symbol)| Some((stem(end)?, *symbol)));
        // What ends with m_s2 ends with s2, too.
        let (stem, symbol) = found.min_by_key(|(stem, _)| stem.len())?;
        Some((stem, Unit::parse(symbol).ok()?))
    }

    /// As it was written.
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// `value` of this unit in the SI unit.
    pub fn to_si(&self, value: f64) -> f64 {
        scale(value, self.factor)
    }

    /// Whether this is the SI unit itself.
    pub fn is_si(&self) -> bool {
        self.factor == 1.0
    }

    /// Whether it is a unit of `dimension`.
    pub fn measures(&self, dimension: Dimension) -> bool {
        self.powers == dimension.powers
    }

    /// The kind of quantity that it measures, where that has a name.
    pub fn dimension(&self) -> Option<Dimension> {
        DIMENSIONS.iter().copied().find(|dimension| self.measures(*dimension))
    }

    /// The SI unit of the same quantity; the same text for every unit of it.
    pub fn si_symbol(&self) -> String {
        match self.dimension() {
            Some(dimension) => dimension.unit.to_owned(),
            None => {
                let factors =
                    ["m", "kg", "s", "rad", "K", "mol"].iter().zip(self.powers).filter(|(_, power)| *power != 0);
                factors.map(|(base, power)| format!("{base}{power}")).collect::<Vec<_>>().join("*")
            }
        }
    }

    /// The ending of a name with the SI unit: `m_s2`, `N`; none for an ending that [`Unit::of_name`] would not find.
    pub fn si_suffix(&self) -> Option<&'static str> {
        let symbol = self.si_symbol();
        ENDS.iter().find(|(_, known)| *known == symbol).map(|(end, _)| end.as_str())
    }
}

/// Units are equal when they mean the same, however they are written.
impl PartialEq for Unit {
    fn eq(&self, other: &Unit) -> bool {
        let close = (self.factor / other.factor - 1.0).abs() < 1e-12;
        close && self.powers == other.powers
    }
}

/// Factor and powers of a symbol that [`super::parse_unit`] does not know, or would take for something else.
fn special(symbol: &str) -> Option<(f64, Powers)> {
    let gravity = |factor| Some((factor * STANDARD_GRAVITY, ACCELERATION));
    match symbol {
        "g" | "G" | "gn" | "g_n" | "g0" => gravity(1.0),
        "mgn" | "mg_n" => gravity(1e-3),
        "kgn" | "kg_n" => gravity(1e3),
        "-" | "–" | "mm/mm" | "m/m" | "in/in" => Some((1.0, [0; 6])),
        "%" | "percent" | "pct" => Some((0.01, [0; 6])),
        "sec" | "seconds" | "second" => Some((1.0, [0, 0, 1, 0, 0, 0])),
        "msec" => Some((1e-3, [0, 0, 1, 0, 0, 0])),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::tests::short_text;
    use crate::units::{Acceleration, Energy, Force, Length, Moment, Pressure, Strain, Time, Velocity};
    use proptest::prelude::*;

    #[test]
    fn units_of_recordings() {
        for (symbol, dimension, si) in [
            ("g", Acceleration::DIMENSION, 9.80665),
            ("kg_n", Acceleration::DIMENSION, 9806.65),
            ("m/s^2", Acceleration::DIMENSION, 1.0),
            ("N", Force::DIMENSION, 1.0),
            ("kN", Force::DIMENSION, 1e3),
            // 0.45359237 kg × standard gravity (both exact, international pound 1959).
            ("lbf", Force::DIMENSION, 0.453_592_37 * 9.806_65),
            ("MPa", Pressure::DIMENSION, 1e6),
            ("N/mm2", Pressure::DIMENSION, 1e6),
            ("psi", Pressure::DIMENSION, 0.453_592_37 * 9.806_65 / (0.0254 * 0.0254)),
            ("ksi", Pressure::DIMENSION, 453.592_37 * 9.806_65 / (0.0254 * 0.0254)),
            ("in", Length::DIMENSION, 0.0254),
            ("um", Length::DIMENSION, 1e-6),
            ("µm", Length::DIMENSION, 1e-6),
            ("ms", Time::DIMENSION, 1e-3),
            ("sec", Time::DIMENSION, 1.0),
            ("mm/s", Velocity::DIMENSION, 1e-3),
            ("-", Strain::DIMENSION, 1.0),
            ("1", Strain::DIMENSION, 1.0),
            ("%", Strain::DIMENSION, 0.01),
            ("mJ", Energy::DIMENSION, 1e-3),
            ("Nm", Moment::DIMENSION, 1.0),
            ("kNm", Moment::DIMENSION, 1e3),
        ] {
            let unit = Unit::parse(symbol).unwrap();
            assert!(unit.measures(dimension), "{symbol} is {:?}", unit.dimension());
            assert!((unit.to_si(1.0) / si - 1.0).abs() < 1e-6, "{symbol}: {} instead of {si}", unit.to_si(1.0));
        }
    }

    #[test]
    fn what_is_no_unit_is_refused() {
        for symbol in
            ["", "furlong", "°C", "kg-deacceleration", "m//s2q", "a", "d", "t", "r", "L", "M", "ch", "cg", "pc"]
        {
            assert_eq!(Unit::parse(symbol), Err(UnknownUnit(symbol.to_owned())));
        }
    }

    #[test]
    fn names_end_with_units() {
        for (name, expected) in [
            ("acceleration_m_s2", Some(("acceleration", "m/s2"))),
            ("accel_filtered_g", Some(("accel_filtered", "g"))),
            ("force_kN", Some(("force", "kN"))),
            ("time_ms", Some(("time", "ms"))),
            ("accel_1", None),
            ("max_strain_md", None),
            ("s", None),
            ("_s", None),
            ("mass", None),
            ("torn_area_m2", Some(("torn_area", "m2"))),
            ("moments_kg_m2", Some(("moments", "kg m2"))),
            ("fracture_J_m2", Some(("fracture", "J/m2"))),
            ("warming_K", Some(("warming", "K"))),
            ("K", None),
        ] {
            let found = Unit::of_name(name);
            let found = found.as_ref().map(|(stem, unit)| (*stem, unit.symbol()));
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn one_meaning_is_one_unit() {
        assert_eq!(Unit::parse("m/s2"), Unit::parse("m/s^2"));
        assert_eq!(Unit::parse("N/mm2"), Unit::parse("MPa"));
        assert_ne!(Unit::parse("Nm"), Unit::parse("J"));
    }

    proptest! {
        #[test]
        fn no_text_panics(text in short_text()) {
            let _ = Unit::parse(&text);
            let _ = Unit::of_name(&text);
        }
    }
}
