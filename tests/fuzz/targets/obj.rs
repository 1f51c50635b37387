//! Meshes in OBJ.
//!
//! Readers: src/scene/mesh/import/obj.rs
#![no_main]

use libfuzzer_sys::fuzz_target;

use droptower_fuzz::read_mesh;

fuzz_target!(|input: &[u8]| read_mesh("mesh.obj", input));
