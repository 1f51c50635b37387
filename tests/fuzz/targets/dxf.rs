//! Outlines in DXF.
//!
//! Readers: src/scene/mesh/import/drawing.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_outline;

fuzz_target!(|input: &[u8]| read_outline("outline.dxf", input));
