//! Recordings in ISO-MME: a folder of header, list of channels and channels.
//!
//! Readers: src/lab/signal/isomme
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::{split, with_files};
use lab::signal::{ReadOptions, file};

const FILES: [&str; 4] = ["test.mme", "Channel/test.chn", "Channel/test.001", "Channel/test.002"];

fuzz_target!(|input: &[u8]| {
    with_files(&split(&FILES, input), |folder| match file::read(folder, &ReadOptions::default()) {
        Ok(measurement) => drop(measurement.recording()),
        Err(error) => drop((error.to_string(), error.place(), error.hint())),
    });
});
