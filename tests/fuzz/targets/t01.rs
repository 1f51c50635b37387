//! Time histories of OpenRadioss.
//!
//! Readers: src/lab/signal/t01.rs src/lab/signal/catalogue.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_recording;

fuzz_target!(|input: &[u8]| read_recording("filmT01", input));
