//! Outlines in SVG.
//!
//! Readers: src/scene/mesh/import/svg.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_outline;

fuzz_target!(|input: &[u8]| read_outline("outline.svg", input));
