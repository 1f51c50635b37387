//! Exports of tensile machines.
//!
//! Readers: src/lab/signal/export src/lab/experiment/coupon
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::with_file;
use lab::experiment::coupon::{CouponReader, Dimensions, Rules};

fuzz_target!(|input: &[u8]| {
    with_file("zwick.csv", input, |path| {
        match CouponReader::new(Dimensions::default(), Rules::default()).read_all(path) {
            Ok(tests) => drop(tests.iter().map(|test| test.place()).collect::<Vec<_>>()),
            Err(error) => drop((error.to_string(), error.hint())),
        }
    });
});
