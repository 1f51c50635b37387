//! Recordings in tables, with time and without.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_recording;

fuzz_target!(|input: &[u8]| read_recording("drop.csv", input));
