//! Recordings as tests are reduced from them: drops, coupons, stress over stretch, relaxation.
//!
//! Readers: src/lab/experiment/drop src/lab/experiment/coupon src/lab/experiment/law_fit src/lab/experiment/relaxation.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use base::units::STANDARD_GRAVITY;
use droptower_fuzz::with_file;
use lab::experiment::absorption::Body;
use lab::experiment::coupon::{Coupon, CouponReader, Rules};
use lab::experiment::drop::{ChannelNames, DropChannels, Reduction, Tower};
use lab::experiment::law_fit::StressReader;
use lab::experiment::relaxation::read_relaxation;
use lab::signal::{ReadOptions, file};

fuzz_target!(|input: &[u8]| {
    with_file("md-0.02-1.csv", input, |path| {
        if let Ok(measurement) = file::read(path, &ReadOptions::default())
            && let Ok(channels) = DropChannels::find(&measurement, &ChannelNames::default())
        {
            let tower = Tower { body: Body { mass: 10.0, gravity: STANDARD_GRAVITY }, height: Some(1.0) };
            drop(channels.reduce(&tower, &Reduction::default()).map(|drop| drop.figures()));
        }
        let coupon = Coupon::new(5e-3, 10e-3, 12e-6).expect("a coupon");
        drop(CouponReader::new(coupon, Rules::default()).read(path).map_err(|error| error.to_string()));
        let reader = StressReader { kind: None, table: ReadOptions::default() };
        drop(reader.read(path).map_err(|error| error.to_string()));
        drop(read_relaxation(path, &ReadOptions::default()).map_err(|error| error.to_string()));
    });
});
