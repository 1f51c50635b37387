//! The units that quantities are written in, with the factors of `uom`.

use std::collections::HashMap;
use std::sync::LazyLock;

use uom::Conversion;
use uom::si::Unit;

use super::Powers;

/// Factor to SI and powers of each unit, by name.
type Units = HashMap<&'static str, (f64, Powers)>;

/// Factor to SI and powers of the unit with this abbreviation or English name.
pub(super) fn find(symbol: &str) -> Option<(f64, Powers)> {
    UNITS.get(symbol).copied()
}

/// Every unit by its abbreviation and by its names in singular and plural; of two units with one name the first counts.
static UNITS: LazyLock<Units> = LazyLock::new(|| {
    let mut units = Units::new();
    // The coefficient alone: to parse a quantity of `uom` instantiates a conversion for each unit, which compiles
    // slowly.
    macro_rules! units {
        ($($quantity:ident: $powers:tt { $($unit:ident),* $(,)? })*) => {
            $($({
                type This = uom::si::$quantity::$unit;
                let names = [This::abbreviation(), This::singular(), This::plural()];
                insert(&mut units, names, (<This as Conversion<f64>>::coefficient(), $powers));
            })*)*
        };
    }
    units! {
        length: [1, 0, 0, 0, 0, 0] {
            yottameter, zettameter, exameter, petameter, terameter, gigameter, megameter, kilometer, hectometer,
            decameter, meter, decimeter, centimeter, millimeter, micrometer, nanometer, picometer, femtometer,
            attometer, zeptometer, yoctometer, angstrom, bohr_radius, astronomical_unit, chain, data_mile, fathom,
            fermi, foot, inch, microinch, micron, mil, mile, nautical_mile, parsec, rod, yard, leuga, stadium,
            actus, decempeda, passus, gradus, cubitum, palmipes, pes, palmus, uncia, digitus,
        }
        mass: [0, 1, 0, 0, 0, 0] {
            yottagram, zettagram, exagram, petagram, teragram, gigagram, megagram, kilogram, hectogram, decagram,
            gram, decigram, centigram, milligram, microgram, nanogram, picogram, femtogram, attogram, zeptogram,
            yoctogram, carat, dalton, ounce, pennyweight, pound, slug, ton_assay, ton, libra, deunx, dextans,
            dodrans, bes, septunx, semis, quincunx, triens, sextans, sescuncia, uncia, semuncia, duella, sicilicus,
            sextula, semisextula, scrupulum, obolus, siliqua,
        }
        time: [0, 0, 1, 0, 0, 0] {
            yottasecond, zettasecond, exasecond, petasecond, terasecond, gigasecond, megasecond, kilosecond,
            hectosecond, decasecond, second, decisecond, centisecond, millisecond, microsecond, nanosecond,
            picosecond, femtosecond, attosecond, zeptosecond, yoctosecond, day, hour, minute, shake, year,
        }
        volume: [3, 0, 0, 0, 0, 0] {
            cubic_meter, hectoliter, liter, deciliter, centiliter, milliliter, microliter, cubic_foot, cubic_inch,
            gallon, gallon_imperial, pint_liquid, fluid_ounce,
        }
        angle: [0, 0, 0, 1, 0, 0] {
            radian, revolution, degree, gon, mil, minute, second,
        }
        frequency: [0, 0, -1, 0, 0, 0] {
            yottahertz, zettahertz, exahertz, petahertz, terahertz, gigahertz, megahertz, kilohertz, hectohertz,
            decahertz, hertz, decihertz, centihertz, millihertz, microhertz, nanohertz, picohertz, femtohertz,
            attohertz, zeptohertz, yoctohertz,
        }
        pressure: [-1, 1, -2, 0, 0, 0] {
            yottapascal, zettapascal, exapascal, petapascal, terapascal, gigapascal, megapascal, kilopascal,
            hectopascal, decapascal, pascal, decipascal, centipascal, millipascal, micropascal, nanopascal,
            picopascal, femtopascal, attopascal, zeptopascal, yoctopascal, atmosphere, atmosphere_technical, bar,
            millibar, millitorr, psi, torr,
        }
        force: [1, 1, -2, 0, 0, 0] {
            yottanewton, zettanewton, exanewton, petanewton, teranewton, giganewton, meganewton, kilonewton,
            hectonewton, decanewton, newton, decinewton, centinewton, millinewton, micronewton, nanonewton,
            piconewton, femtonewton, attonewton, zeptonewton, yoctonewton, dyne, kilogram_force, gram_force, kip,
            ounce_force, poundal, pound_force, ton_force,
        }
        energy: [2, 1, -2, 0, 0, 0] {
            yottajoule, zettajoule, exajoule, petajoule, terajoule, gigajoule, megajoule, kilojoule, hectojoule,
            decajoule, joule, decijoule, centijoule, millijoule, microjoule, nanojoule, picojoule, femtojoule,
            attojoule, zeptojoule, yoctojoule, petaelectronvolt, teraelectronvolt, gigaelectronvolt,
            megaelectronvolt, kiloelectronvolt, hectoelectronvolt, decaelectronvolt, electronvolt, hartree, btu,
            btu_39, btu_59, btu_60, calorie, calorie_15, calorie_20, calorie_nutrition, erg, kilocalorie, quad,
            therm_us,
        }
    }
    for (name, factor) in [("hl", 0.1), ("l", 1e-3), ("dl", 1e-4), ("cl", 1e-5), ("ml", 1e-6)] {
        units.entry(name).or_insert((factor, [3, 0, 0, 0, 0, 0]));
    }
    units
});

// Not inlined: it is called for some hundred units.
#[inline(never)]
fn insert(units: &mut Units, names: [&'static str; 3], meaning: (f64, Powers)) {
    for name in names {
        units.entry(name).or_insert(meaning);
    }
}
