//! Quantities and units in texts.
//!
//! Readers: src/base/units src/base/units.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use base::units::{Dimension, Unit, percentage, with_decimal_point};

const NAMES: [&str; 6] = ["time", "length", "stress", "temperature", "angle", "mass"];

fuzz_target!(|text: &str| {
    for dimension in NAMES.into_iter().filter_map(Dimension::named) {
        match dimension.parse(text) {
            Ok(value) => drop((dimension.show(value), dimension.likelier(text, value, [1e-3, 1e3]))),
            Err(error) => drop((error.to_string(), error.hint())),
        }
        drop(dimension.meant(text));
    }
    if let Ok(unit) = Unit::parse(text) {
        drop((unit.dimension(), unit.si_symbol(), unit.si_suffix(), unit.to_si(1.0)));
    }
    drop((Unit::of_name(text), percentage(text), with_decimal_point(text)));
});
