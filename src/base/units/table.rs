//! The units that quantities and recordings are written in.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::Powers;
use super::unit::STANDARD_GRAVITY;

/// Factor to SI and powers of the unit with this abbreviation or English name.
pub(super) fn find(symbol: &str) -> Option<(f64, Powers)> {
    UNITS.get(symbol).copied()
}

/// Pound, kg (international pound, 1959; exact).
const POUND: f64 = 0.453_592_37;

/// Foot and inch, m (1959; exact).
const FOOT: f64 = 0.3048;
const INCH: f64 = 0.0254;

/// Pound-force, N: a pound in standard gravity, 4.4482216152605 N.
const POUND_FORCE: f64 = POUND * STANDARD_GRAVITY;

/// Pound-force per square inch, Pa.
const PSI: f64 = POUND_FORCE / (INCH * INCH);

const LENGTH: Powers = [1, 0, 0, 0, 0, 0];
const MASS: Powers = [0, 1, 0, 0, 0, 0];
const TIME: Powers = [0, 0, 1, 0, 0, 0];
const VOLUME: Powers = [3, 0, 0, 0, 0, 0];
const ANGLE: Powers = [0, 0, 0, 1, 0, 0];
const FREQUENCY: Powers = [0, 0, -1, 0, 0, 0];
const PRESSURE: Powers = [-1, 1, -2, 0, 0, 0];
const FORCE: Powers = [1, 1, -2, 0, 0, 0];
const ENERGY: Powers = [2, 1, -2, 0, 0, 0];

/// Units that take a prefix: symbol, name, plural, power of ten in the SI unit, what they measure.
const PREFIXED: [([&str; 3], i32, Powers); 7] = [
    (["m", "meter", "meters"], 0, LENGTH),
    (["g", "gram", "grams"], -3, MASS),
    (["s", "second", "seconds"], 0, TIME),
    (["Hz", "hertz", "hertz"], 0, FREQUENCY),
    (["Pa", "pascal", "pascals"], 0, PRESSURE),
    (["N", "newton", "newtons"], 0, FORCE),
    (["J", "joule", "joules"], 0, ENERGY),
];

/// Prefixes of the SI: symbol, name, power of ten.
const PREFIXES: [(&str, &str, i32); 21] = [
    ("Y", "yotta", 24),
    ("Z", "zetta", 21),
    ("E", "exa", 18),
    ("P", "peta", 15),
    ("T", "tera", 12),
    ("G", "giga", 9),
    ("M", "mega", 6),
    ("k", "kilo", 3),
    ("h", "hecto", 2),
    ("da", "deca", 1),
    ("", "", 0),
    ("d", "deci", -1),
    ("c", "centi", -2),
    ("m", "milli", -3),
    ("µ", "micro", -6),
    ("n", "nano", -9),
    ("p", "pico", -12),
    ("f", "femto", -15),
    ("a", "atto", -18),
    ("z", "zepto", -21),
    ("y", "yocto", -24),
];

/// The other units: symbol, name and plural, the value in the SI unit, what they measure.
const OTHERS: &[(&str, f64, Powers)] = &[
    ("Å ångström ångströms", 1e-10, LENGTH),
    ("a₀", 5.291_772_109_03e-11, LENGTH),
    ("ua", 149_597_870_700.0, LENGTH),
    ("ch chain chains", 20.116_84, LENGTH),
    ("DM", 1828.8, LENGTH),
    ("fathom fathoms", 1.828_804, LENGTH),
    ("fermi fermis", 1e-15, LENGTH),
    ("ft foot feet", FOOT, LENGTH),
    ("in inch inches", INCH, LENGTH),
    ("μin microinch microinches", 2.54e-8, LENGTH),
    ("μ micron microns", 1e-6, LENGTH),
    ("mil mils", 2.54e-5, LENGTH),
    ("mi mile miles", 1609.344, LENGTH),
    ("M", 1852.0, LENGTH),
    ("pc parsec parsecs", 3.085_678e16, LENGTH),
    ("rd rod rods", 5.029_21, LENGTH),
    ("yd yard yards", 0.9144, LENGTH),
    ("ct carat carats", 2e-4, MASS),
    ("Da dalton daltons", 1.660_539_066_6e-27, MASS),
    ("oz ounce ounces", POUND / 16.0, MASS),
    ("dwt pennyweight", 0.001_555_174, MASS),
    ("lb pound pounds", POUND, MASS),
    ("slug slugs", POUND_FORCE / FOOT, MASS),
    ("AT", 0.029_166_67, MASS),
    ("t ton tons", 1e3, MASS),
    ("d day days", 86_400.0, TIME),
    ("h hour hours", 3600.0, TIME),
    ("min minute minutes", 60.0, TIME),
    ("shake shakes", 1e-8, TIME),
    ("a year years", 31_536_000.0, TIME),
    ("hL hl hectoliter hectoliters", 0.1, VOLUME),
    ("L l liter liters", 1e-3, VOLUME),
    ("dL dl deciliter deciliters", 1e-4, VOLUME),
    ("cL cl centiliter centiliters", 1e-5, VOLUME),
    ("mL ml milliliter milliliters", 1e-6, VOLUME),
    ("µL microliter microliters", 1e-9, VOLUME),
    ("gal gallon gallons", 0.003_785_412, VOLUME),
    ("rad radian radians", 1.0, ANGLE),
    ("r revolution revolutions", std::f64::consts::TAU, ANGLE),
    ("° degree degrees", 0.017_453_292_519_943_295, ANGLE),
    ("gon gons", 0.015_707_963_267_948_967, ANGLE),
    ("′", 2.908_882_086_657_216e-4, ANGLE),
    ("″", 4.848_136_811_095_36e-6, ANGLE),
    ("atm atmosphere atmospheres", 101_325.0, PRESSURE),
    ("at", 98_066.5, PRESSURE),
    ("bar", 1e5, PRESSURE),
    ("mbar millibar", 100.0, PRESSURE),
    ("mTorr millitorr", 0.133_322_4, PRESSURE),
    ("Torr torr", 133.322_4, PRESSURE),
    ("psi", PSI, PRESSURE),
    ("ksi", 1e3 * PSI, PRESSURE),
    ("dyn dyne dynes", 1e-5, FORCE),
    ("kgf kilogram-force kilograms-force", STANDARD_GRAVITY, FORCE),
    ("gf gram-force grams-force", 0.009_806_65, FORCE),
    ("lbf pound-force pounds-force", POUND_FORCE, FORCE),
    ("ozf ounce-force ounces-force", POUND_FORCE / 16.0, FORCE),
    ("kip kips", 1e3 * POUND_FORCE, FORCE),
    ("pdl poundal poundals", POUND * FOOT, FORCE),
    ("ton-force tons-force", 2e3 * POUND_FORCE, FORCE),
    ("eV electronvolt electronvolts", 1.602_176_634e-19, ENERGY),
    ("daeV decaelectronvolt decaelectronvolts", 1.602_176_634e-18, ENERGY),
    ("heV hectoelectronvolt hectoelectronvolts", 1.602_176_634e-17, ENERGY),
    ("keV kiloelectronvolt kiloelectronvolts", 1.602_176_634e-16, ENERGY),
    ("MeV megaelectronvolt megaelectronvolts", 1.602_176_634e-13, ENERGY),
    ("GeV gigaelectronvolt gigaelectronvolts", 1.602_176_634e-10, ENERGY),
    ("TeV teraelectronvolt teraelectronvolts", 1.602_176_634e-7, ENERGY),
    ("PeV petaelectronvolt petaelectronvolts", 1.602_176_634e-4, ENERGY),
    ("Eₕ hartree hartrees", 4.359_744_722_207_1e-18, ENERGY),
    ("Btu", 1054.35, ENERGY),
    ("Btu₃₉", 1059.67, ENERGY),
    ("Btu₅₉", 1054.8, ENERGY),
    ("Btu₆₀", 1054.68, ENERGY),
    ("cal calorie calories", 4.184, ENERGY),
    ("cal₁₅", 4.1858, ENERGY),
    ("cal₂₀", 4.1819, ENERGY),
    ("kcal kilocalorie kilocalories Cal Calorie Calories", 4184.0, ENERGY),
    ("erg ergs", 1e-7, ENERGY),
    ("quad quads", 1.055_056e18, ENERGY),
    ("thm therm therms", 105_480_400.0, ENERGY),
];

/// Factor to SI and powers of every unit, by each of its names.
static UNITS: LazyLock<HashMap<String, (f64, Powers)>> = LazyLock::new(|| {
    let prefixed = PREFIXED.iter().flat_map(|([symbol, name, plural], own, powers)| {
        PREFIXES.iter().flat_map(move |(short, long, power)| {
            let names = [format!("{short}{symbol}"), format!("{long}{name}"), format!("{long}{plural}")];
            names.map(|name| (name, (power_of_ten(own + power), *powers)))
        })
    });
    let others = OTHERS
        .iter()
        .flat_map(|(names, factor, powers)| names.split(' ').map(move |name| (name.to_owned(), (*factor, *powers))));
    prefixed.chain(others).collect()
});

/// The number nearest to 10ⁿ, which a product of others may miss.
fn power_of_ten(n: i32) -> f64 {
    format!("1e{n}").parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::units::{Unit, parse_unit, scale};

    #[test]
    fn no_two_units_have_one_name() {
        let mut seen = HashSet::new();
        let names = OTHERS.iter().flat_map(|(names, ..)| names.split(' '));
        assert_eq!(names.clone().find(|name| !seen.insert(*name)), None);
        // Hertz has no plural.
        let prefixed = PREFIXES.len() * (3 * PREFIXED.len() - 1);
        assert_eq!(UNITS.len(), prefixed + names.count());
    }

    /// Standard gravity is written `g` in recordings, which is a gram in scenarios.
    #[test]
    fn recordings_and_scenarios_mean_the_same() {
        for name in UNITS.keys().filter(|name| *name != "g") {
            let Ok((factor, powers)) = parse_unit(name) else { panic!("{name} is not known") };
            let unit = Unit::parse(name).unwrap();
            assert_eq!(unit.to_si(1.0), scale(1.0, factor), "{name}");
            assert_eq!(unit, Unit::parse(&format!("{name}*1")).unwrap(), "{name}");
            assert_eq!((factor, powers), UNITS[name], "{name}");
        }
    }

    #[test]
    fn the_pound_and_the_inch_are_exact() {
        for (name, si) in [
            ("lb", 0.453_592_37),
            ("oz", 0.028_349_523_125),
            ("lbf", 4.448_221_615_260_5),
            ("kip", 4_448.221_615_260_5),
            ("in", 0.0254),
            ("psi", 4.448_221_615_260_5 / 0.0254 / 0.0254),
        ] {
            let (found, _) = find(name).unwrap();
            assert!((found / si - 1.0).abs() < 1e-15, "{name}: {found} instead of {si}");
        }
    }
}
