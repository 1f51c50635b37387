//! Recordings in workbooks of Excel.
//!
//! Readers: src/lab/signal/workbook.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_recording;

fuzz_target!(|input: &[u8]| read_recording("drop.xlsx", input));
