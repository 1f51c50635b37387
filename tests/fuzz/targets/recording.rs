//! Recordings in tables, with time and without.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::with_file;
use lab::signal::ReadOptions;
use lab::signal::file::{self, ChannelSelection};

fuzz_target!(|input: &[u8]| {
    with_file("drop.csv", input, |path| {
        let only = ReadOptions { channels: ChannelSelection::Only, ..ReadOptions::default() };
        for options in [ReadOptions::default(), only] {
            match file::read(path, &options) {
                Ok(measurement) => drop(measurement.recording()),
                Err(error) => drop((error.to_string(), error.place(), error.hint())),
            }
            drop(file::columns(path, &options).map(|table| table.over_samples()));
        }
    });
});
