//! Meshes in the XML of VTK.
//!
//! Readers: src/scene/mesh/import/vtu.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_mesh;

fuzz_target!(|input: &[u8]| read_mesh("mesh.vtu", input));
