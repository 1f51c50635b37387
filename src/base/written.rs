//! Quantities as a person writes them: 12 µm, 14.3 g, 143 m/s², 89 %.

use crate::number::significant;
use crate::units::{Unit, ladder};

/// Significant digits of a number that is read.
pub const DIGITS: usize = 3;

/// How values of a quantity are read: in which unit, and how many of it an SI unit has.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Symbol of the unit; empty of a number.
    pub unit: String,
    /// From the SI unit to the one that is read.
    pub factor: f64,
}

/// Ends of names that mean a force per length in a summary; in a recording they may mean a moment.
pub const LINE_FORCES: [(&str, &str); 2] = [("_N_mm", "N/mm"), ("_N_m", "N/m")];

/// Ends of names whose numbers are read in the unit that is named: `_g` is a gram or standard gravity.
const AS_NAMED: [(&str, &str); 3] = [("_g_n", "g"), ("_g", "g"), ("_percent", "%")];

/// Ends of names of numbers that are shares or strains, which are read in percent.
const SHARES: [&str; 9] =
    ["absorption", "error", "efficiency", "probability", "share", "penetration", "strain", "strain_md", "strain_td"];

impl Reading {
    /// A number without a unit.
    pub fn number() -> Reading {
        Reading { unit: String::new(), factor: 1.0 }
    }

    /// A share in percent.
    pub fn percent() -> Reading {
        Reading { unit: "%".into(), factor: 100.0 }
    }

    /// The reading of values of which the largest has this `size`, in the SI unit `unit`: that in which the number is
    /// one or more, as far as there is such a unit.
    pub fn of_unit(unit: &str, size: f64) -> Reading {
        let ladder = ladder(unit);
        if ladder.is_empty() {
            let unit = if unit == "1" { "" } else { unit };
            return Reading { unit: unit.into(), factor: 1.0 };
        }
        // What rounds to one has the unit of one.
        let reached = ladder.iter().rev().find(|(_, factor)| size.abs() >= 0.9995 * factor);
        let (symbol, factor) = match (size == 0.0, reached) {
            (true, _) => ladder.iter().find(|(_, factor)| *factor == 1.0).unwrap_or(&ladder[0]),
            (false, Some(unit)) => unit,
            (false, None) => &ladder[0],
        };
        // The quotient of a power of ten is exact where the product is not.
        Reading { unit: (*symbol).into(), factor: 1.0 / factor }
    }

    /// The words of a figure or column, and the reading of its values, of which the largest has this `size`: the end
    /// of a name is its unit, as in `peak_acceleration_m_s2`, and shares are known by their names.
    pub fn of_name(name: &str, size: f64) -> (String, Reading) {
        let words = |stem: &str| stem.replace('_', " ");
        let own = |unit: &str| Reading { unit: unit.into(), factor: 1.0 };
        let found = LINE_FORCES.iter().find_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, *unit)));
        if let Some((stem, unit)) =
            found.or_else(|| AS_NAMED.iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, *unit))))
        {
            return (words(stem), own(unit));
        }
        if let Some((stem, unit)) = Unit::of_name(name) {
            let reading = Reading::of_unit(&unit.si_symbol(), unit.to_si(size));
            return (words(stem), Reading { factor: reading.factor * unit.to_si(1.0), ..reading });
        }
        let is_share = |end: &str| name.strip_suffix(end).is_some_and(|stem| stem.is_empty() || stem.ends_with('_'));
        let reading = if SHARES.into_iter().any(is_share) { Reading::percent() } else { Reading::number() };
        (words(name), reading)
    }

    /// The value in the unit that is read.
    pub fn value(&self, si: f64) -> f64 {
        si * self.factor
    }

    /// The number alone, with a true minus.
    pub fn digits(&self, si: f64) -> String {
        digits(self.value(si))
    }

    /// The number with its unit.
    pub fn text(&self, si: f64) -> String {
        self.with_unit(&self.digits(si))
    }

    /// `text`, such as a range, with the unit.
    pub fn with_unit(&self, text: &str) -> String {
        if self.unit.is_empty() { text.to_owned() } else { format!("{text} {}", self.unit) }
    }

    /// The head of a column or axis: its words, and the unit in parentheses.
    pub fn heading(&self, words: &str) -> String {
        if self.unit.is_empty() { words.to_owned() } else { format!("{words} ({})", self.unit) }
    }
}

/// Three significant digits, all those before the point, and powers of ten where zeros would hide the number.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    let text = if value == 0.0 || !value.is_finite() {
        value.to_string()
    } else if (1e3..1e6).contains(&size) {
        format!("{}", value.round())
    } else if (1e-3..1e6).contains(&size) {
        significant(value, DIGITS)
    } else {
        format!("{value:.*e}", DIGITS - 1)
    };
    text.replace('-', "\u{2212}")
}

/// `words` with a capital, as a heading.
pub fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A value in an SI unit with the unit in which it is read.
pub fn quantity(si: f64, unit: &str) -> String {
    Reading::of_unit(unit, si).text(si)
}

/// The value of a figure or column with the unit in which it is read.
pub fn figure(name: &str, value: f64) -> String {
    Reading::of_name(name, value).1.text(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_have_the_unit_of_a_person() {
        for (value, unit, expected) in [
            (12e-6, "m", "12 µm"),
            (0.000_999_99, "m", "1 mm"),
            (-0.1678, "m", "−168 mm"),
            (0.0143, "kg", "14.3 g"),
            (143.04, "m/s2", "143 m/s²"),
            (8.4e6, "Pa", "8.4 MPa"),
            (2e-8, "m", "0.02 µm"),
            (0.0, "m", "0 m"),
            (std::f64::consts::FRAC_PI_4, "rad", "45 °"),
            (2.75, "1", "2.75"),
            (3.0, "N s/m", "3 N s/m"),
        ] {
            assert_eq!(quantity(value, unit), expected);
        }
    }

    #[test]
    fn figures_are_read_by_their_names() {
        for (name, value, expected) in [
            ("energy_absorption", 0.8866, "88.7 %"),
            ("break_strain_td", 6.461, "646 %"),
            ("peak_displacement_m", -0.1678, "−168 mm"),
            ("thickness_um", 12.0, "12 µm"),
            ("mass_g", 14.3, "14.3 g"),
            ("resultant_N_mm", 0.5, "0.5 N/mm"),
            ("peak_force_kN", 0.02, "20 N"),
            ("energy_balance_error", 0.000_237_8, "0.0238 %"),
            ("steps", 11_240.0, "11240"),
            ("k1", 2.75, "2.75"),
            ("strained", 2.0, "2"),
        ] {
            assert_eq!(figure(name, value), expected, "{name}");
        }
    }

    #[test]
    fn values_of_a_column_share_a_unit() {
        let (words, reading) = Reading::of_name("specimen.material.thickness_m", 13e-6);
        assert_eq!((words.as_str(), reading.digits(11.8296e-6)), ("specimen.material.thickness", "11.8".into()));
        assert_eq!(reading.heading("thickness"), "thickness (µm)");
    }

    #[test]
    fn numbers_have_the_digits_that_are_read() {
        for (value, expected) in
            [(1234.5, "1235"), (0.000_5, "5.00e−4"), (2.5e7, "2.50e7"), (-0.25, "−0.25"), (f64::NAN, "NaN")]
        {
            assert_eq!(digits(value), expected);
        }
    }
}
