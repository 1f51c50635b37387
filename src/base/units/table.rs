//! The units that quantities and recordings are written in.
//!
//! [`UNITS`] says what a unit is worth, [`WRITTEN`] where this program writes it. Units that laboratories do not use are left
//! out, since their letters mean something else in the headers of recordings: `d` is a travel, `t` a time, `a` an acceleration.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::{Powers, parse_unit, scale};

/// Standard gravity, m/s² (3rd CGPM, 1901; exact).
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Pound, kg (international pound, 1959; exact).
const POUND: f64 = 0.453_592_37;

/// Foot and inch, m (1959; exact).
const FOOT: f64 = 0.3048;
const INCH: f64 = 0.0254;

/// Pound-force, N: a pound in standard gravity, 4.4482216152605 N.
const POUND_FORCE: f64 = POUND * STANDARD_GRAVITY;

/// Pound-force per square inch, Pa.
const PSI: f64 = POUND_FORCE / (INCH * INCH);

const NUMBER: Powers = [0; 6];
const LENGTH: Powers = [1, 0, 0, 0, 0, 0];
const MASS: Powers = [0, 1, 0, 0, 0, 0];
const TIME: Powers = [0, 0, 1, 0, 0, 0];
const VOLUME: Powers = [3, 0, 0, 0, 0, 0];
const ANGLE: Powers = [0, 0, 0, 1, 0, 0];
const TEMPERATURE: Powers = [0, 0, 0, 0, 1, 0];
const AMOUNT: Powers = [0, 0, 0, 0, 0, 1];
const FREQUENCY: Powers = [0, 0, -1, 0, 0, 0];
const SPIN: Powers = [0, 0, -1, 1, 0, 0];
const PRESSURE: Powers = [-1, 1, -2, 0, 0, 0];
const FORCE: Powers = [1, 1, -2, 0, 0, 0];
const ENERGY: Powers = [2, 1, -2, 0, 0, 0];
/// A moment is energy per radian; written so it is not taken for an energy.
const MOMENT: Powers = [2, 1, -2, -1, 0, 0];

/// Names, the prefixes that are used with it, the value in the SI unit, what it measures.
const UNITS: &[(&str, &str, f64, Powers)] = &[
    ("1", "", 1.0, NUMBER),
    ("m meter meters", "n µ m c d k", 1.0, LENGTH),
    ("micron microns", "", 1e-6, LENGTH),
    ("in inch inches", "", INCH, LENGTH),
    ("ft foot feet", "", FOOT, LENGTH),
    ("mil mils", "", INCH * 1e-3, LENGTH),
    ("g gram grams", "µ m k", 1e-3, MASS),
    ("lb pound pounds", "", POUND, MASS),
    ("oz ounce ounces", "", POUND / 16.0, MASS),
    ("s second seconds", "n µ m k", 1.0, TIME),
    ("min minute minutes", "", 60.0, TIME),
    ("h hour hours", "", 3600.0, TIME),
    ("l liter liters", "m", 1e-3, VOLUME),
    ("rad radian radians", "m", 1.0, ANGLE),
    ("° deg degree degrees", "", 0.017_453_292_519_943_295, ANGLE),
    ("K", "", 1.0, TEMPERATURE),
    ("mol", "", 1.0, AMOUNT),
    ("Hz hertz", "k M", 1.0, FREQUENCY),
    ("rpm", "", std::f64::consts::TAU / 60.0, SPIN),
    ("Pa pascal pascals", "h k M G", 1.0, PRESSURE),
    ("bar", "m", 1e5, PRESSURE),
    ("atm", "", 101_325.0, PRESSURE),
    ("psi", "", PSI, PRESSURE),
    ("ksi", "", 1e3 * PSI, PRESSURE),
    ("N newton newtons", "m c da k M", 1.0, FORCE),
    ("kgf", "", STANDARD_GRAVITY, FORCE),
    ("gf", "", 0.009_806_65, FORCE),
    ("lbf", "", POUND_FORCE, FORCE),
    ("J joule joules", "µ m k M G", 1.0, ENERGY),
    ("Nm", "k", 1.0, MOMENT),
    ("Nmm", "", 1e-3, MOMENT),
];

/// Prefixes of the SI: symbols, of which keyboards have but one, name, value.
const PREFIXES: &[(&str, &str, f64)] = &[
    ("G", "giga", 1e9),
    ("M", "mega", 1e6),
    ("k", "kilo", 1e3),
    ("h", "hecto", 1e2),
    ("da", "deca", 1e1),
    ("d", "deci", 1e-1),
    ("c", "centi", 1e-2),
    ("m", "milli", 1e-3),
    ("µ μ u", "micro", 1e-6),
    ("n", "nano", 1e-9),
];

/// Factor to SI and powers of every unit, by each of its names.
static BY_NAME: LazyLock<HashMap<String, (f64, Powers)>> = LazyLock::new(|| {
    let mut found = HashMap::new();
    for (names, prefixes, factor, powers) in UNITS {
        found.extend(names.split(' ').map(|name| (name.to_owned(), (*factor, *powers))));
        for (symbols, long, size) in PREFIXES {
            if prefixes.split(' ').any(|prefix| symbols.split(' ').next() == Some(prefix)) {
                // The quotient is the number that is nearest to a power of ten.
                let value = if *size < 1.0 { factor / (1.0 / size).round() } else { factor * size };
                let mut names = names.split(' ');
                let symbol = names.next().unwrap_or_default();
                let all = symbols.split(' ').map(|short| format!("{short}{symbol}"));
                found.extend(all.chain(names.map(|name| format!("{long}{name}"))).map(|name| (name, (value, *powers))));
            }
        }
    }
    found
});

/// Factor to SI and powers of the unit with this abbreviation or English name.
pub(super) fn find(symbol: &str) -> Option<(f64, Powers)> {
    BY_NAME.get(symbol).copied()
}

/// A unit as scenarios and names write it, as it is printed, and its uses: `u` where it is suggested, `r` where a person reads a
/// quantity in it, `e` where names end with it.
type Written = (&'static str, &'static str, &'static str);

/// Units that this program writes, by the SI unit, in ascending order.
const WRITTEN: &[(&str, &[Written])] = &[
    ("1", &[("percent", "%", "e")]),
    (
        "m",
        &[
            ("um", "µm", "ure"),
            ("mm", "mm", "ure"),
            ("cm", "cm", "ue"),
            ("in", "in", "e"),
            ("m", "m", "ure"),
            ("km", "km", "u"),
        ],
    ),
    ("m2", &[("mm2", "mm²", "r"), ("cm2", "cm²", "r"), ("m2", "m²", "re")]),
    ("m3", &[("mm3", "mm³", "r"), ("cm3", "cm³", "r"), ("l", "l", "r"), ("m3", "m³", "re")]),
    ("kg", &[("mg", "mg", "ur"), ("g", "g", "ure"), ("kg", "kg", "ure")]),
    ("s", &[("us", "µs", "ure"), ("ms", "ms", "ure"), ("s", "s", "ure"), ("min", "min", "u"), ("h", "h", "u")]),
    ("m/s", &[("mm/min", "mm/min", "u"), ("mm/s", "mm/s", "ure"), ("km/h", "km/h", "ue"), ("m/s", "m/s", "ure")]),
    ("m/s2", &[("mm/s2", "mm/s²", "ue"), ("m/s2", "m/s²", "ure"), ("g_n", "g", "e"), ("kg_n", "kg_n", "e")]),
    (
        "Pa",
        &[
            ("Pa", "Pa", "ure"),
            ("kPa", "kPa", "ure"),
            ("psi", "psi", "e"),
            ("MPa", "MPa", "ure"),
            ("ksi", "ksi", "e"),
            ("GPa", "GPa", "ure"),
        ],
    ),
    ("N", &[("mN", "mN", "ure"), ("N", "N", "ure"), ("lbf", "lbf", "e"), ("kN", "kN", "ure")]),
    ("J", &[("mJ", "mJ", "ure"), ("J", "J", "ure"), ("kJ", "kJ", "ure")]),
    ("Nm", &[("Nmm", "Nmm", "ur"), ("Nm", "Nm", "ure"), ("kNm", "kNm", "ue")]),
    ("Hz", &[("Hz", "Hz", "ure"), ("kHz", "kHz", "ure"), ("MHz", "MHz", "ur")]),
    ("1/s", &[("1/s", "1/s", "ue")]),
    ("rad", &[("deg", "°", "ure"), ("rad", "rad", "ue")]),
    ("kg/m3", &[("kg/m3", "kg/m³", "ur"), ("g/cm3", "g/cm³", "u")]),
    ("kg/m2", &[("g/m2", "g/m²", "r"), ("kg/m2", "kg/m²", "r")]),
    ("kg m2", &[("kg m2", "kg m²", "e")]),
    ("N s/m", &[("N s/m", "N s/m", "u")]),
    ("N/m", &[("N/m", "N/m", "u"), ("N/mm", "N/mm", "u"), ("kN/m", "kN/m", "u")]),
    ("J/m2", &[("J/m2", "J/m²", "ure"), ("kJ/m2", "kJ/m²", "ure")]),
    ("J/(kg K)", &[("J/(kg K)", "J/(kg K)", "u"), ("kJ/(kg K)", "kJ/(kg K)", "u")]),
    ("J/mol", &[("J/mol", "J/mol", "u"), ("kJ/mol", "kJ/mol", "u")]),
    ("1/K", &[("%/K", "%/K", "u"), ("1/K", "1/K", "u")]),
    ("K", &[("degC", "°C", "u"), ("K", "K", "ue")]),
];

/// Units of the SI unit with this use.
fn written(si: &str, of: char) -> impl Iterator<Item = &'static Written> {
    let units = WRITTEN.iter().find(|(unit, _)| *unit == si).map_or(&[][..], |(_, units)| units);
    units.iter().filter(move |(.., uses)| uses.contains(of))
}

/// Units that are suggested for a quantity, in ascending order.
pub(super) fn usual(si: &str) -> impl Iterator<Item = &'static str> {
    written(si, 'u').map(|(symbol, ..)| *symbol)
}

/// Units in which a person reads a quantity, in ascending order: as they are printed, and their value in the SI unit.
pub(crate) fn ladder(si: &str) -> Vec<(&'static str, f64)> {
    written(si, 'r')
        .filter_map(|(symbol, printed, _)| Some((*printed, scale(1.0, parse_unit(symbol).ok()?.0))))
        .collect()
}

/// A unit in typographic form.
pub fn printed(symbol: &str) -> &str {
    let mut all = WRITTEN.iter().flat_map(|(_, units)| *units);
    all.find(|(known, ..)| *known == symbol).map_or(symbol, |(_, printed, _)| printed)
}

/// Ends of names with the units that they mean: `m_s2` of m/s2.
pub(super) static ENDS: LazyLock<Vec<(String, &str)>> = LazyLock::new(|| {
    let units = WRITTEN.iter().flat_map(|(si, _)| written(si, 'e'));
    units.map(|(symbol, ..)| (symbol.replace(['/', ' '], "_"), *symbol)).collect()
});

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::units::{DIMENSIONS, Unit};

    #[test]
    fn no_two_units_have_one_name() {
        let mut seen = HashSet::new();
        let names = UNITS.iter().flat_map(|(names, ..)| names.split(' '));
        assert_eq!(names.clone().find(|name| !seen.insert(*name)), None);
        // µ has three signs.
        let prefixed = UNITS.iter().flat_map(|(names, prefixes, ..)| {
            let symbols = |prefix| if prefix == "µ" { 3 } else { 1 };
            prefixes
                .split(' ')
                .filter(|prefix| !prefix.is_empty())
                .map(move |prefix| names.split(' ').count() - 1 + symbols(prefix))
        });
        assert_eq!(BY_NAME.len(), prefixed.sum::<usize>() + names.count());
    }

    #[test]
    fn units_with_a_prefix_are_the_nearest_numbers() {
        for (name, si) in
            [("um", 1e-6), ("nm", 1e-9), ("mg", 1e-6), ("ug", 1e-9), ("ml", 1e-6), ("mbar", 100.0), ("GPa", 1e9)]
        {
            assert_eq!(find(name).map(|(factor, _)| factor), Some(si), "{name}");
        }
        assert_eq!([find("µs"), find("μs"), find("microseconds")], [find("us"); 3]);
    }

    #[test]
    fn what_is_written_measures_what_it_is_written_for() {
        for (si, units) in WRITTEN {
            let dimension = DIMENSIONS.iter().find(|dimension| dimension.unit == *si).expect("a dimension");
            for (symbol, ..) in units.iter().filter(|(symbol, ..)| !matches!(*symbol, "degC" | "%/K" | "g")) {
                assert!(Unit::parse(symbol).expect(symbol).measures(*dimension), "{symbol}");
            }
        }
        assert_eq!(ladder("m3"), [("mm³", 1e-9), ("cm³", 1e-6), ("l", 1e-3), ("m³", 1.0)]);
        assert_eq!([printed("kg m2"), printed("g_n"), printed("V")], ["kg m²", "g", "V"]);
    }

    #[test]
    fn the_pound_and_the_inch_are_exact() {
        for (name, si) in [
            ("lb", 0.453_592_37),
            ("oz", 0.028_349_523_125),
            ("lbf", 4.448_221_615_260_5),
            ("in", 0.0254),
            ("psi", 4.448_221_615_260_5 / 0.0254 / 0.0254),
        ] {
            let (found, _) = find(name).unwrap();
            assert!((found / si - 1.0).abs() < 1e-15, "{name}: {found} instead of {si}");
        }
    }
}
