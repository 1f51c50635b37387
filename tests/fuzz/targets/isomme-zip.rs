//! Recordings in ISO-MME, zipped.
//!
//! Readers: src/lab/signal/isomme
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::with_file;
use lab::signal::{ReadOptions, file};

fuzz_target!(|input: &[u8]| {
    with_file("test.zip", input, |path| match file::read(path, &ReadOptions::default()) {
        Ok(measurement) => drop(measurement.recording()),
        Err(error) => drop((error.to_string(), error.place(), error.hint())),
    });
});
