//! Meshes in STL.
//!
//! Readers: src/scene/mesh/import/mod.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_mesh;

fuzz_target!(|input: &[u8]| read_mesh("mesh.stl", input));
