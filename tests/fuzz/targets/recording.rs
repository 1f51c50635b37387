//! Recordings in tables, with time and without.
//!
//! Readers: src/lab/signal/csv src/lab/signal/text.rs src/lab/signal/file.rs src/lab/signal/column_name.rs src/lab/signal/format.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_recording;

fuzz_target!(|input: &[u8]| read_recording("drop.csv", input));
