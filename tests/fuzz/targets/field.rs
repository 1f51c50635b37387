//! Displacement fields of digital image correlation, and the tables of their times.
//!
//! Readers: src/lab/dic.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::with_file;
use lab::dic::{Field, FieldOptions, read_times};

fuzz_target!(|input: &[u8]| {
    with_file("field_1.csv", input, |path| {
        for unit in [None, Some(1e-3)] {
            let files = [(path.to_owned(), 0.0), (path.to_owned(), 0.1)];
            match Field::read(&files, &FieldOptions { unit }) {
                Ok(field) => drop(field.map(|field| field.points())),
                Err(error) => drop((error.to_string(), error.hint())),
            }
        }
        drop(read_times(path).map_err(|error| error.to_string()));
    });
});
