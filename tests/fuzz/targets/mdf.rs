//! Recordings in ASAM MDF 4.
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_recording;

fuzz_target!(|input: &[u8]| read_recording("drop.mf4", input));
