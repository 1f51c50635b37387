//! Recordings in HDF5.
//!
//! Readers: src/lab/signal/hdf5.rs src/lab/signal/catalogue.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_recording;

fuzz_target!(|input: &[u8]| read_recording("drop.h5", input));
